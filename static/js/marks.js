// What the page draws over the picture, in step with it: the selected instance's outline and handles.

import { Gizmo } from "./gizmo.js";
import { Outline } from "./outline.js";

/** Answers the gizmo, whose mode buttons switch. */
export function mountMarks(app, marks) {
  const outline = new Outline(app, marks);
  const gizmo = new Gizmo(app, marks);
  const draw = () => {
    const shown = shownNow(app);
    outline.draw(shown);
    gizmo.draw(shown);
  };
  app.live.addEventListener("frame", draw);
  app.live.addEventListener("query", draw);
  app.scene.addEventListener("change", ({ detail }) => { if (!detail.own) draw(); });
  app.selection.addEventListener("change", draw);
  app.instances.addEventListener("change", draw);
  gizmo.addEventListener("mode", draw);
  return gizmo;
}

/** The output that shows what lights see, not the camera. */
const LIGHTS_VIEW = "shadow_map";

/**
 * What the picture on screen shows: not the newest document, but that of its revision. `null` while nothing is
 * selected, or the selected instance is not in the picture yet.
 */
function shownNow({ scene, live, camera, selection }) {
  if (selection.name === null || live.output === LIGHTS_VIEW) return null;
  const document = scene.documentAt(live.frame?.revision) ?? scene.document;
  const instance = document.instances?.[selection.name];
  const t = live.frame?.t ?? 0;
  const shownCamera = camera.at(document, t);
  const size = live.viewSize;
  const isSeen = size.width > 0 && size.height > 0; // a window can be too low for the view
  if (!instance || !shownCamera || !isSeen) return null;
  return { document, instance, t, camera: shownCamera, size, revision: live.frame?.revision };
}
