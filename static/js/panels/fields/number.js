// Numbers: typed, stepped with the arrow keys, dragged by their label, or set by a slider.

import { field } from "../field.js";
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
  return field(scene, pointer, words, new NumberControl(words, (value) => setAt(scene, pointer, value)));
}

/** The control of {@link numberField}. */
export class NumberControl {
  element;
  inputs;

  #input;
  #slider;
  #words;
  #write;
  #isTyping = false;
  /** What was to be shown last, also while something is being typed. */
  #last;

  /** `write` gets each new number, or `null`. */
  constructor({ step = 0.1, min = -Infinity, max = Infinity, range, absent }, write) {
    this.#words = { step, min, max, absent };
    this.#write = write;
    this.#input = inputOf(this.#words);
    this.#slider = range && element("input", { type: "range", min: range[0], max: range[1], step });
    this.inputs = [this.#input];
    this.element = range ? element("div", { className: "with-slider" }, this.#slider, this.#input) : this.#input;
    this.#listen();
  }

  show(value) {
    this.#last = value;
    if (this.#isTyping) return;
    const text = value === undefined ? "" : String(short(value));
    if (this.#input.value !== text) this.#input.value = text;
    this.#input.setCustomValidity("");
    if (this.#slider) this.#slider.value = value ?? this.#slider.min;
  }

  /** The label can be dragged, and names the slider as well. */
  adopt(label) {
    this.#slider?.setAttribute("aria-label", `${label.firstChild.textContent}, slider`);
    scrubbable(label, () => this.#number, (start, pixels) => this.#set(start + pixels * this.#words.step));
  }

  get #number() {
    return this.#input.valueAsNumber || 0;
  }

  #listen() {
    this.#input.addEventListener("input", () => {
      this.#isTyping = true;
      this.#input.setCustomValidity("");
    });
    this.#input.addEventListener("change", () => this.#commit());
    this.#input.addEventListener("keydown", (event) => this.#take(event));
    this.#slider?.addEventListener("input", () => this.#set(this.#slider.valueAsNumber));
  }

  #take(event) {
    if (event.key === "Enter") this.#commit();
    if (event.key === "Escape") this.#cancel();
    const direction = { ArrowUp: 1, ArrowDown: -1 }[event.key];
    if (direction === undefined) return;
    event.preventDefault();
    this.#set(this.#number + direction * this.#words.step * (event.shiftKey ? 10 : 1));
  }

  #set(value) {
    const inside = short(Math.min(Math.max(value, this.#words.min), this.#words.max));
    this.#isTyping = false;
    this.show(inside);
    this.#write(inside);
  }

  /** What was typed goes to the server as it is: it knows best what is wrong with it. */
  #commit() {
    if (!this.#isTyping) return;
    this.#isTyping = false;
    const { value, valueAsNumber, validity } = this.#input;
    if (value !== "") return this.#write(valueAsNumber);
    if (this.#words.absent !== undefined && !validity.badInput) return this.#write(null);
    this.#input.setCustomValidity("This needs a number.");
    this.#input.reportValidity();
  }

  #cancel() {
    this.#isTyping = false;
    this.show(this.#last);
  }
}

function inputOf({ min, max, absent = "" }) {
  const input = element("input", { type: "number", step: "any", placeholder: absent });
  if (Number.isFinite(min)) input.min = min;
  if (Number.isFinite(max)) input.max = max;
  return input;
}
