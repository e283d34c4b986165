// JSON merge patches (RFC 7396): applying one, and finding the one that leads from here to there.

const isObject = (value) => typeof value === "object" && value !== null && !Array.isArray(value);

/** `target` with `patch` merged in. Neither is changed; what stays the same is shared. */
export function merged(target, patch) {
  if (!isObject(patch)) return patch;
  const result = isObject(target) ? { ...target } : {};
  for (const [key, value] of Object.entries(patch)) {
    if (value === null) delete result[key];
    else result[key] = merged(result[key], value);
  }
  return result;
}

/** The patch that makes `to` of `from`; `undefined` if they are the same. */
export function difference(from, to) {
  if (!isObject(from) || !isObject(to)) return same(from, to) ? undefined : to;
  const patch = {};
  for (const key of Object.keys(from)) if (!(key in to)) patch[key] = null;
  for (const [key, value] of Object.entries(to)) {
    const change = key in from ? difference(from[key], value) : value;
    if (change !== undefined) patch[key] = change;
  }
  return Object.keys(patch).length > 0 ? patch : undefined;
}

/** Whether two JSON values are equal. */
export function same(a, b) {
  if (a === b) return true;
  if (Array.isArray(a) && Array.isArray(b)) return a.length === b.length && a.every((item, i) => same(item, b[i]));
  if (!isObject(a) || !isObject(b)) return false;
  const keys = Object.keys(a);
  return keys.length === Object.keys(b).length && keys.every((key) => key in b && same(a[key], b[key]));
}

/** The value at a JSON pointer (RFC 6901), or `undefined`. */
export function valueAt(document, pointer) {
  return steps(pointer).reduce((value, step) => value?.[step], document);
}

/** The merge patch that sets what is at a JSON pointer; `null` removes it. */
export function patchAt(pointer, value) {
  return steps(pointer).reduceRight((inner, step) => ({ [step]: inner }), value);
}

/** A JSON pointer from its steps. */
export function pointerOf(...path) {
  return path.map((step) => `/${String(step).replaceAll("~", "~0").replaceAll("/", "~1")}`).join("");
}

function steps(pointer) {
  return pointer.split("/").slice(1).map((step) => step.replaceAll("~1", "/").replaceAll("~0", "~"));
}
