// Vectors: a number for each axis.

import { field } from "../field.js";
import { element } from "../../dom.js";
import { setAt } from "../edit.js";
import { NumberControl } from "./number.js";

/**
 * A field for an array of numbers, by default x, y and z.
 *
 * @param {{axes?: string[], step?: number, min?: number, max?: number}} words
 */
export function vectorField(scene, pointer, words) {
  return field(scene, pointer, words, vectorControl(words, (value) => setAt(scene, pointer, value)));
}

/** The control of {@link vectorField}. */
export function vectorControl({ axes = ["x", "y", "z"], ...words }, write) {
  let vector = axes.map(() => 0);
  const controls = axes.map((axis, i) => axisControl(axis, words, (number) => {
    vector = vector.with(i, number);
    write(vector);
  }));
  return {
    element: element("div", { className: "vector" }, ...controls.map((control) => control.element)),
    inputs: controls.flatMap((control) => control.inputs),
    show: (value) => {
      vector = Array.isArray(value) ? value : vector;
      controls.forEach((control, i) => control.show(vector[i]));
    },
  };
}

function axisControl(axis, words, write) {
  const control = new NumberControl(words, write);
  const label = element("label", {}, element("span", {}, axis), control.element);
  control.adopt(label.firstChild);
  return { element: label, inputs: control.inputs, show: (number) => control.show(number) };
}
