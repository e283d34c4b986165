// Numbers: typed, stepped with the arrow keys, dragged by their label, or set by a slider.

import { field } from "../../fields.js";
import { element } from "../../dom.js";
import { setAt } from "../edit.js";
import { scrubbable } from "./scrub.js";

/** More digits than this no picture shows. */
const DIGITS = 7;

const short = (number) => Number(number.toPrecision(DIGITS));

/**
 * A field for a number.
 *
 * @param {{step?: number, min?: number, max?: number, range?: [number, number], absent?: string}} words
 *   `step` of an arrow key and of dragging; `range` adds a slider; `absent` says what holds without a value, and then
 *   an empty field removes it
 */
export function numberField(scene, pointer, words) {
  return field(scene, pointer, words, numberControl(words, (value) => setAt(scene, pointer, value)));
}

/** The control of {@link numberField}; `write` gets each new number, or `null`. */
export function numberControl({ step = 0.1, min = -Infinity, max = Infinity, range, absent }, write) {
  const input = element("input", { type: "number", step: "any", placeholder: absent ?? "" });
  if (Number.isFinite(min)) input.min = min;
  if (Number.isFinite(max)) input.max = max;
  const slider = range && sliderOf(range, step);
  let isTyping = false;
  let last;

  const show = (value) => {
    last = value;
    if (isTyping) return;
    const text = value === undefined ? "" : String(short(value));
    if (input.value !== text) input.value = text;
    input.setCustomValidity("");
    if (slider) slider.value = value ?? range[0];
  };
  const set = (value) => {
    isTyping = false;
    const inside = short(Math.min(Math.max(value, min), max));
    show(inside);
    write(inside);
  };
  const commit = () => {
    if (!isTyping) return;
    isTyping = false;
    if (input.value !== "") return write(input.valueAsNumber);
    if (absent !== undefined && !input.validity.badInput) return write(null);
    input.setCustomValidity("This needs a number.");
    input.reportValidity();
  };

  input.addEventListener("input", () => { isTyping = true; input.setCustomValidity(""); });
  input.addEventListener("change", commit);
  input.addEventListener("keydown", (event) => {
    if (event.key === "Enter") commit();
    if (event.key === "Escape") {
      isTyping = false;
      show(last);
    }
    const direction = { ArrowUp: 1, ArrowDown: -1 }[event.key];
    if (direction === undefined) return;
    event.preventDefault();
    set((input.valueAsNumber || 0) + direction * step * (event.shiftKey ? 10 : 1));
  });
  slider?.addEventListener("input", () => set(slider.valueAsNumber));

  const adopt = (label) => {
    slider?.setAttribute("aria-label", `${label.firstChild.textContent}, slider`);
    scrubbable(label, () => input.valueAsNumber || 0, (start, pixels) => set(start + pixels * step));
  };
  const box = slider ? element("div", { className: "with-slider" }, slider, input) : input;
  return { element: box, inputs: [input], show, adopt };
}

function sliderOf([low, high], step) {
  return element("input", { type: "range", min: low, max: high, step });
}
