// The bar of the selected instance: how its handles work, and what can be done with it.

import * as actions from "./actions.js";
import { button, byId, element } from "./dom.js";
import { MODES } from "./gizmo.js";

/** Fills the bar; it shows while something is selected. */
export function mountSelectionBar(app, gizmo, bar) {
  const { scene, selection } = app;
  const name = element("strong");
  const modes = Object.entries(MODES).map(([mode, label]) => button(label, () => { gizmo.mode = mode; }, { "data-mode": mode }));
  const hide = button("Hide", () => actions.toggleInstance(app, selection.name), { "data-action": "hide" });
  bar.append(
    name,
    ...modes,
    button("Frame", () => actions.frameSelected(app), { "data-action": "frame" }),
    button("Duplicate", () => actions.duplicateInstance(app, selection.name), { "data-action": "duplicate" }),
    hide,
    button("Delete", () => actions.deleteSelected(app), { "data-action": "delete" }),
  );
  const follow = () => {
    bar.hidden = selection.name === null;
    name.textContent = selection.name;
    hide.textContent = selection.instance?.visible === false ? "Show" : "Hide";
    for (const made of modes) made.setAttribute("aria-pressed", made.dataset.mode === gizmo.mode);
  };
  const say = () => {
    byId("selection-said").textContent = `${selection.name ?? "Nothing"} is selected`;
  };
  selection.addEventListener("change", follow);
  selection.addEventListener("change", say);
  scene.addEventListener("change", follow);
  gizmo.addEventListener("mode", follow);
  follow();
}
