// The dialog that lists keys and gestures.

import { button, element } from "./dom.js";

const SECTIONS = {
  "Look around": [
    ["Drag, one finger, arrow keys", "turn about the target"],
    ["Right drag, Shift drag, two fingers", "pan"],
    ["Wheel, pinch, + −", "zoom towards what is under the pointer"],
    ["W A S D, Q E", "fly: forward, left, back, right, down, up"],
    ["Double click", "look at what was clicked"],
    ["F, Home or .", "frame the whole scene"],
  ],
  "Instances": [
    ["Click, or 1 – 9", "select one (by number: the first nine names)"],
    ["W A S D, Q E", "move it along the axes of the world, as seen from the camera"],
    ["Z X", "turn it about the vertical"],
    ["0 or Esc", "back to the camera"],
    ["Delete", "remove it"],
    ["Ctrl Z, Ctrl Shift Z", "undo, redo what was changed; the camera stays"],
  ],
  "Switches": [
    ["F1", "shadows"],
    ["F2", "soft or hard shadows"],
    ["F3", "post-processing"],
    ["F4", "next effect"],
    ["F5", "directional lights"],
    ["F6", "point lights"],
  ],
};

/** Fills the dialog; answers what opens it. */
export function mountHelp(dialog) {
  const title = element("h2", { id: "help-title" }, "Keys and gestures");
  const note = element("p", {}, "Keys work while the picture has the focus: click it, or reach it with Tab. This list: ?");
  const sections = Object.entries(SECTIONS).map(([heading, rows]) => section(heading, rows));
  const close = button("Close", () => dialog.close(), { className: "close" });
  dialog.append(title, note, element("div", { className: "sections" }, ...sections), close);
  return () => { if (!dialog.open) dialog.showModal(); };
}

function section(heading, rows) {
  const list = element("dl", {}, ...rows.flatMap(([keys, effect]) => [element("dt", {}, keys), element("dd", {}, effect)]));
  return element("section", {}, element("h3", {}, heading), list);
}
