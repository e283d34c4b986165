// The page: makes its parts and lets them know each other.

import { openAddressed, openScene, showAddress } from "./address.js";
import { button, byId } from "./dom.js";
import { Drawers } from "./drawers.js";
import { takeDrops } from "./drop.js";
import { History } from "./history.js";
import { Instances } from "./instances.js";
import { Live } from "./live.js";
import { Notices } from "./notices.js";
import { mountOverlay } from "./overlay.js";
import { mountPlanPicture } from "./plan-picture.js";
import { Plan } from "./plan.js";
import { OpenScene } from "./scene.js";
import { Selection } from "./selection.js";
import { Viewpoint } from "./viewpoint.js";
import { Motion } from "./input/motion.js";
import { takeKeys } from "./input/keys.js";
import { Pointer } from "./input/pointer.js";
import { Wheel } from "./input/wheel.js";
import { mountHelp } from "./help.js";
import { mountMarks } from "./marks.js";
import { mountPanels } from "./panels/index.js";
import { mountReport } from "./report.js";
import { mountSelectionBar } from "./selection-bar.js";
import { mountToolbar } from "./toolbar.js";

const view = byId("view");
const app = makeApp();
const help = mountHelp(byId("help"));
new Pointer(app, view);
new Wheel(app, view);
takeKeys(app, view, help);
mountToolbar(app, byId("toolbar"));
const drawers = new Drawers([byId("panels"), byId("report")], byId("toggle-panels"), byId("skip"));
byId("open-help").addEventListener("click", help);
mountSelectionBar(app, mountMarks(app, byId("marks")), byId("selected"));
mountOverlay(app, byId("overlay"), [
  button("Picture of the plan", mountPlanPicture(app, byId("plan")), { id: "open-plan" }),
  button("Error and time", openReport, { id: "open-report" }),
]);
takeDrops(app, byId("drop-hint"));
tellOfScene();
tellOfConnection();
mountPanels(app);
mountReport(app, byId("report"), () => drawers.showHome());
window.addEventListener("hashchange", () => openAddressed(app));
openAddressed(app);
view.focus({ preventScroll: true });

function makeApp() {
  const scene = new OpenScene();
  const live = new Live(scene, view);
  const plan = new Plan(scene, live);
  const camera = new Viewpoint(scene, live, plan);
  const app = {
    scene, live, plan, camera,
    selection: new Selection(scene),
    instances: new Instances(scene),
    history: new History(scene),
    notices: new Notices(byId("notices")),
  };
  app.motion = new Motion(app);
  return app;
}

/** The picture, which has less room then, is not to be covered. */
function openReport() {
  byId("overlay").open = false;
  drawers.show(byId("report"));
}

/** Name and address of the open scene, and what becomes of it. */
function tellOfScene() {
  const { scene, notices } = app;
  const showName = () => {
    const name = scene.document.name || scene.id;
    byId("scene-name").textContent = name;
    byId("scene-name").title = name;
    document.title = `${name} · rasterd`;
  };
  scene.addEventListener("change", showName);
  scene.addEventListener("open", () => {
    notices.clearAll();
    showName();
    showAddress(scene.id);
    notices.warn(scene.summary?.warnings ?? []);
  });
  scene.addEventListener("gone", () => {
    const text = `“${scene.id}” was deleted, or the server has started anew without it.`;
    notices.hold("The scene is no longer there", text, { "Open the demo": () => openScene(app, "demo") });
  });
}

function tellOfConnection() {
  const { live, scene, notices } = app;
  const [lost, refused] = ["The connection to the server is lost", "The picture could not be drawn"];
  const unsent = "The last change is not sent yet";
  live.addEventListener("lost", () => notices.hold(lost, "The picture is the last one that came. Trying again…"));
  live.addEventListener("back", () => {
    notices.clear(lost);
    notices.say("The connection is back");
  });
  live.addEventListener("problem", ({ detail: { problem } }) => notices.show(problem, refused));
  live.addEventListener("frame", () => [lost, refused].forEach((title) => notices.clear(title)));
  scene.addEventListener("unsent", () => notices.hold(unsent, "The server cannot take it now. Trying again…"));
  for (const type of ["saved", "open", "gone"]) scene.addEventListener(type, () => notices.clear(unsent));
}
