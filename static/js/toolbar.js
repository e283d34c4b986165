// The row of buttons above the picture: what the function keys do, and what files need.

import * as actions from "./actions.js";
import { button, byId, element } from "./dom.js";

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
export function mountToolbar(app, bar, help) {
  const switches = SWITCHES.map((entry) => makeSwitch(app, entry));
  bar.append(
    element("div", { className: "group" }, ...switches.map(({ made }) => made)),
    element("div", { className: "group" }, button("Frame all", () => actions.frameScene(app), { id: "frame-all", title: "Show the whole scene (F)" })),
    element("div", { className: "group" }, button("?", help, { id: "open-help", "aria-label": "Keys and gestures", title: "Keys and gestures (?)" }), drawerButton()),
  );
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

function drawerButton() {
  const panels = byId("panels");
  const isWide = matchMedia("(min-width: 801px)").matches;
  panels.hidden = !isWide;
  const made = button("Panels", () => {
    panels.hidden = !panels.hidden;
    made.setAttribute("aria-expanded", !panels.hidden);
  }, { id: "toggle-panels", "aria-controls": "panels", "aria-expanded": isWide });
  return made;
}
