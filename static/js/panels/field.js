// Form fields bound to the open scene's document: a label, a control, and the server's word on it.

import { valueAt } from "../merge.js";
import { Problem } from "../server.js";
import { element } from "../dom.js";
import { follow } from "./follow.js";

/** The fields by their elements, `.field[data-pointer]`. */
const fields = new WeakMap();
let count = 0;

/**
 * A field for the value at `pointer`.
 *
 * @param {OpenScene} scene
 * @param {string} pointer JSON pointer of the value
 * @param {{label?: string, unit?: string, hint?: string}} words for people; `hint` explains a term
 * @param {Control} control
 *
 * @typedef {object} Control what is between label and error
 * @property {HTMLElement} element
 * @property {HTMLElement[]} inputs what takes the focus; the label belongs to the first
 * @property {(value: any, document: object) => void} show shows a value of the document, unless one is being typed
 * @property {(label: HTMLElement) => void} [adopt] takes the label into service, say for dragging
 */
export function field(scene, pointer, words, control) {
  const id = `field-${(count += 1)}`;
  const labels = words.label === undefined ? [] : [labelOf(words, control, id)];
  const error = element("p", { className: "error", id: `${id}-error`, role: "alert", hidden: true });
  const box = element("div", { className: "field", "data-pointer": pointer }, ...labels, control.element, error);
  for (const input of control.inputs) describe(input, error.id, words.hint);
  for (const label of labels) control.adopt?.(label);
  fields.set(box, { scene, pointer, control, error });
  follow(scene, box, (document) => {
    if (error.hidden) control.show(valueAt(document, pointer), document);
  });
  return box;
}

/** A field of the page itself, which no value of the document stands behind. */
export function plainField(words, control) {
  const label = labelOf(words, control, `field-${(count += 1)}`);
  for (const input of control.inputs) explain(input, words.hint);
  control.adopt?.(label);
  return element("div", { className: "field" }, label, control.element);
}

/** A label of one input; several inputs are a group, each with a name of its own. */
function labelOf({ label, unit, hint }, { element: box, inputs }, id) {
  const isGroup = inputs.length !== 1;
  const made = element(isGroup ? "span" : "label", { className: "label", id: `${id}-label`, title: hint ?? "" }, label);
  if (unit) made.append(" ", element("span", { className: "unit" }, unit));
  if (isGroup) {
    box.setAttribute("role", "group");
    box.setAttribute("aria-labelledby", made.id);
  } else {
    inputs[0].id = id;
    made.htmlFor = id;
  }
  return made;
}

function describe(input, errorId, hint) {
  input.setAttribute("aria-describedby", errorId);
  explain(input, hint);
}

function explain(input, hint) {
  if (hint) input.setAttribute("aria-description", hint);
}

/**
 * Shows what the server refused beneath the fields it belongs to, and what was wished in them. What comes of removing
 * an entry is shown where it was to be removed, wherever the reference to it stands.
 *
 * Answers the errors that no visible field takes.
 *
 * @param {{pointer?: string, detail: string}[]} errors
 * @param {object} [patch] that was refused
 */
export function showErrors(errors, patch) {
  const texts = new Map();
  const left = [];
  for (const error of errors) {
    const box = removedBy(patch) ?? (error.pointer === undefined ? changedBy(patch) : fieldOf(error.pointer));
    if (box) texts.set(box, [...(texts.get(box) ?? []), textOf(box, error)]);
    else left.push(error);
  }
  for (const [box, lines] of texts) refuse(box, lines.join("\n"), patch);
  return left;
}

/** Does `action`, and shows beneath a field what the server has against it. */
export async function attempt(box, action) {
  clearErrors();
  try {
    return await action();
  } catch (problem) {
    if (!(problem instanceof Problem)) throw problem;
    refuse(box, problem.message);
  }
}

/** Takes all errors away; the fields show the document again. */
export function clearErrors() {
  for (const box of document.querySelectorAll(".field.refused")) {
    const { scene, pointer, control, error } = fields.get(box);
    mark(box, control, error, "");
    control.show(valueAt(scene.document, pointer), scene.document);
  }
}

function refuse(box, text, patch) {
  const { scene, pointer, control, error } = fields.get(box);
  const wished = valueAt(patch, pointer);
  if (wished !== undefined && wished !== null) control.show(wished, scene.document);
  mark(box, control, error, text);
}

function mark(box, control, error, text) {
  box.classList.toggle("refused", text !== "");
  error.textContent = text;
  error.hidden = text === "";
  for (const input of control.inputs) input.setAttribute("aria-invalid", String(text !== ""));
}

/** The innermost visible field around a pointer. */
function fieldOf(pointer) {
  const around = visibleFields().filter((box) => `${pointer}/`.startsWith(`${box.dataset.pointer}/`));
  return around.sort((a, b) => b.dataset.pointer.length - a.dataset.pointer.length)[0];
}

/** The one visible field that a patch changes: what an error is about that does not say it, such as a limit. */
function changedBy(patch) {
  const changed = visibleFields().filter((box) => valueAt(patch, box.dataset.pointer) !== undefined);
  const innermost = changed.filter((box) => !changed.some((other) => isBelow(other, box)));
  return innermost.length === 1 ? innermost[0] : undefined;
}

const isBelow = (inner, outer) => inner.dataset.pointer.startsWith(`${outer.dataset.pointer}/`);

/** The visible field whose value the patch takes away. */
function removedBy(patch) {
  return visibleFields().find((box) => valueAt(patch, box.dataset.pointer) === null);
}

function visibleFields() {
  return [...document.querySelectorAll(".field[data-pointer]")].filter((box) => box.checkVisibility());
}

/** An error of somewhere else says where. */
function textOf(box, { pointer = box.dataset.pointer, detail }) {
  const isHere = `${pointer}/`.startsWith(`${box.dataset.pointer}/`);
  return isHere ? detail : `${placeName(pointer)}: ${detail}`;
}

function placeName(pointer) {
  return pointer.split("/").slice(1).join(" › ").replaceAll("~1", "/").replaceAll("~0", "~");
}
