// A line of text.

import { field } from "../field.js";
import { element } from "../../dom.js";
import { setAt } from "../edit.js";

/** A field for a string, written when it is left or with Enter. */
export function textField(scene, pointer, words) {
  const input = element("input", { type: "text", autocomplete: "off" });
  let isTyping = false;
  input.addEventListener("input", () => { isTyping = true; });
  input.addEventListener("change", () => {
    isTyping = false;
    setAt(scene, pointer, input.value);
  });
  return field(scene, pointer, words, {
    element: input,
    inputs: [input],
    show: (value = "") => { if (!isTyping && input.value !== value) input.value = value; },
  });
}
