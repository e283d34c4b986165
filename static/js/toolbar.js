// The row of buttons above the picture: what the function keys do, and what files need.

import * as actions from "./actions.js";
import { button, byId, element } from "./dom.js";
import { takeFiles } from "./drop.js";
import { copyCommand, saveFrame, saveScene } from "./save.js";

/** Each with its function key, and what it shows of the document. */
const SWITCHES = [
  { key: "F1", label: () => "Shadows", act: actions.toggleShadows, isOn: actions.areShadowsOn },
  { key: "F2", label: () => "Soft", act: actions.toggleSoftShadows, isOn: actions.areShadowsSoft, isThere: actions.castShadows },
  { key: "F3", label: () => "Post", act: actions.togglePost, isOn: actions.isPostOn },
  { key: "F4", label: (app) => `Effect: ${actions.effectName(app)}`, act: actions.nextEffect },
  ...["directional", "point"].map((type, i) => ({
    key: `F${5 + i}`,
    label: () => ["Sun", "Lamps"][i],
    act: (app) => actions.toggleLights(app, type),
    isOn: (app) => actions.areLightsOn(app, type),
    isThere: (app) => actions.hasLights(app, type),
  })),
];

/** Fills the toolbar; it follows the document from then on. */
export function mountToolbar(app, bar) {
  const switches = SWITCHES.map((entry) => makeSwitch(app, entry));
  const groups = [
    switches.map(({ made }) => made),
    historyButtons(app),
    [button("Frame all", () => actions.frameScene(app), { id: "frame-all", title: "Show the whole scene (F)" })],
    [...fileButtons(app), saveMenu(app)],
  ];
  bar.append(...groups.map((buttons) => element("div", { className: "group" }, ...buttons)));
  const follow = () => switches.forEach(({ update }) => update());
  app.scene.addEventListener("open", follow);
  app.scene.addEventListener("change", follow);
}

function makeSwitch(app, { key, label, act, isOn, isThere }) {
  const made = button("", () => act(app), { title: key, disabled: true, "data-switch": key, "aria-keyshortcuts": key });
  const update = () => {
    made.textContent = label(app);
    made.disabled = isThere ? !isThere(app) : false;
    if (isOn) made.setAttribute("aria-pressed", isOn(app));
  };
  return { made, update };
}

function historyButtons({ history }) {
  const undo = button("↶", () => history.undo(), { id: "undo", title: "Undo (Ctrl+Z)", "aria-label": "Undo" });
  const redo = button("↷", () => history.redo(), { id: "redo", title: "Redo (Ctrl+Shift+Z)", "aria-label": "Redo" });
  const follow = () => {
    undo.disabled = !history.canUndo;
    redo.disabled = !history.canRedo;
  };
  history.addEventListener("change", follow);
  follow();
  return [undo, redo];
}

function fileButtons(app) {
  const input = element("input", { type: "file", multiple: true, hidden: true, id: "files" });
  input.addEventListener("change", () => {
    takeFiles(app, [...input.files]);
    input.value = ""; // The same file may be chosen again.
  });
  const title = "Models (OBJ with MTL and textures), images, scenes (JSON); or drop them anywhere";
  return [button("Add files", () => input.click(), { id: "add-files", title }), input];
}

function saveMenu(app) {
  const menu = element("div", { id: "save-menu", popover: "auto" },
    button("Frame as PNG", () => saveFrame(app), { id: "save-png" }),
    button("Scene as JSON", () => saveScene(app), { id: "save-json" }),
    button("Copy as curl command", () => copyCommand(app), { id: "copy-curl" }));
  menu.addEventListener("click", () => menu.hidePopover());
  const opener = button("Save", () => {}, { id: "open-save", popoverTargetElement: menu });
  menu.addEventListener("beforetoggle", () => {
    const box = opener.getBoundingClientRect();
    menu.style.top = `${box.bottom + 4}px`;
    menu.style.left = `${Math.min(box.left, innerWidth - 220)}px`;
  });
  document.body.append(menu);
  return opener;
}
