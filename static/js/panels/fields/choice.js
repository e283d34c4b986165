// Choices among words, or among the names in a map of the document.

import { field } from "../field.js";
import { same } from "../../merge.js";
import { element } from "../../dom.js";
import { setAt } from "../edit.js";

/**
 * A field that offers `options`, pairs of value and label. The value `null` stands for none.
 *
 * @param {{fallback?: any}} words `fallback` is what holds without a value
 */
export function choiceField(scene, pointer, words, options) {
  const control = choiceControl(() => options, (value) => setAt(scene, pointer, value));
  return field(scene, pointer, words, { ...control, show: (value = words.fallback) => control.show(value) });
}

/**
 * A field that offers the names in the map `part` of the document.
 *
 * @param {{none?: string}} words `none` says what holds without a name, and offers that too
 */
export function nameField(scene, pointer, words, part) {
  return field(scene, pointer, words, nameControl(words, part, (value) => setAt(scene, pointer, value)));
}

/** The control of {@link nameField}. */
export function nameControl({ none }, part, write) {
  const first = none === undefined ? [] : [[null, none]];
  const names = (document) => Object.keys(document[part]).map((name) => [name, name]);
  return choiceControl((document) => [...first, ...names(document)], write);
}

/** The control of a choice of what `optionsOf(document)` gives. */
export function choiceControl(optionsOf, write) {
  const select = element("select");
  let options = [];
  select.addEventListener("change", () => write(options[select.selectedIndex][0]));
  const show = (value = null, document) => {
    const offered = withValue(optionsOf(document), value);
    if (!same(offered, options)) {
      options = offered;
      select.replaceChildren(...options.map(([, label]) => element("option", {}, label)));
    }
    select.selectedIndex = options.findIndex(([option]) => option === value);
  };
  return { element: select, inputs: [select], show };
}

/** A value that is not offered can be seen all the same. */
function withValue(options, value) {
  return options.some(([option]) => option === value) ? options : [...options, [value, String(value ?? "—")]];
}
