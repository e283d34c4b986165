// Edits of the open scene's document.

import { freeName } from "../actions.js";
import { patchAt, pointerOf, valueAt } from "../merge.js";

/** Sets what is at a JSON pointer; `null` removes it. A merge patch replaces an array as a whole. */
export function setAt(scene, pointer, value) {
  const array = arrayAround(scene.document, pointer);
  if (array === undefined) return scene.edit(patchAt(pointer, value));
  const items = structuredClone(valueAt(scene.document, array));
  const path = pointer.slice(array.length + 1).split("/");
  const last = path.pop();
  const holder = path.reduce((inner, step) => inner[step], items);
  if (value === null) delete holder[last];
  else holder[last] = value;
  scene.edit(patchAt(array, items));
}

/** The pointer of the outermost array that holds the value at `pointer`. */
function arrayAround(document, pointer) {
  const tokens = pointer.split("/");
  const around = tokens.slice(1).map((_, i) => tokens.slice(0, i + 1).join("/"));
  return around.find((outer) => Array.isArray(valueAt(document, outer)));
}

/** Adds an entry to a map of the document, under `base` or a name made from it, which it answers. */
export function addEntry(scene, part, base, entry) {
  const name = freeName(base, scene.document[part]);
  scene.edit(patchAt(pointerOf(part, name), entry));
  return name;
}
