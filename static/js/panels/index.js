// The panels beside the picture.

import { byId } from "../dom.js";
import { clearErrors, showErrors } from "./field.js";
import { Problem } from "../server.js";
import { Chosen } from "./chosen.js";
import { onceOpen } from "./follow.js";
import { instancesPanel } from "./instances.js";
import { lightsPanel } from "./lights.js";
import { materialsPanel } from "./materials.js";
import { meshesPanel } from "./meshes.js";
import { postPanel } from "./post.js";
import { renderPanel } from "./render.js";
import { scenesPanel } from "./scenes.js";
import { shadowPanel } from "./shadow.js";
import { skyPanel } from "./sky.js";
import { stagesPanel } from "./stages.js";
import { texturesPanel } from "./textures.js";

const REFUSED = "The change was refused";

/** Puts the panels into `#panels`; they follow the open scene from then on. */
export function mountPanels(app) {
  const light = new Chosen(app.scene, "lights");
  const instances = instancesPanel(app);
  instances.open = true;
  const panelsOfScene = [
    stagesPanel(app),
    instances,
    materialsPanel(app),
    texturesPanel(app),
    meshesPanel(app),
    lightsPanel(app, light),
    shadowPanel(app, light),
    skyPanel(app),
    postPanel(app),
    renderPanel(app),
  ];
  byId("panels").append(scenesPanel(app), ...panelsOfScene.map((panel) => onceOpen(app.scene, panel)));
  tellOfRefusals(app);
}

/** What the server refuses is shown beneath its field, or as a message; it stands until the next edit. */
function tellOfRefusals({ scene, notices }) {
  scene.addEventListener("problem", ({ detail: { problem, patch } }) => {
    const { message, title, status } = problem;
    const errors = problem.errors.length > 0 ? problem.errors : [{ detail: message }];
    const left = showErrors(errors, patch);
    if (left.length > 0) notices.show(new Problem(message, { title, status, errors: left }), REFUSED);
  });
  const clear = () => {
    clearErrors();
    notices.clear(REFUSED);
  };
  scene.addEventListener("open", clear);
  scene.addEventListener("change", ({ detail }) => { if (detail.own) clear(); });
}
