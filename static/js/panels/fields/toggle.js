// Yes or no.

import { field } from "../field.js";
import { element } from "../../dom.js";
import { setAt } from "../edit.js";

/** A check box for `true` and `false`. */
export function toggleField(scene, pointer, words) {
  const box = element("input", { type: "checkbox" });
  box.addEventListener("change", () => setAt(scene, pointer, box.checked));
  const made = field(scene, pointer, words, {
    element: box,
    inputs: [box],
    show: (value) => { box.checked = value === true; },
  });
  made.classList.add("toggle");
  return made;
}
