// Vectors of three numbers, and rotations of them.

export const add = (a, b) => a.map((x, i) => x + b[i]);
export const sub = (a, b) => a.map((x, i) => x - b[i]);
export const times = (a, factor) => a.map((x) => x * factor);
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export const length = (a) => Math.hypot(...a);
export const mix = (a, b, part) => a.map((x, i) => x + (b[i] - x) * part);
export const clamp = (x, low, high) => Math.min(Math.max(x, low), high);
export const radians = (deg) => (deg * Math.PI) / 180;
export const degrees = (rad) => (rad * 180) / Math.PI;
/** The axes of the world. */
export const AXES = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];

/** Rounds coordinates of what is about `size` large to so many digits of that. */
export function rounding(size, digits) {
  const places = clamp(digits - 1 - Math.floor(Math.log10(size)), 0, 20);
  return (x) => Number(x.toFixed(places));
}

/** `a` at length 1, or `fallback` if it has no direction. */
export function unit(a, fallback = [0, 1, 0]) {
  const size = length(a);
  return size > 0 ? times(a, 1 / size) : fallback;
}

/** `v` turned right-handed about `axis`, a unit vector (Rodrigues). */
export function rotated(v, axis, deg) {
  const [cos, sin] = [Math.cos(radians(deg)), Math.sin(radians(deg))];
  const along = times(axis, dot(axis, v) * (1 - cos));
  return add(add(times(v, cos), times(cross(axis, v), sin)), along);
}

/** The eight corners of a box. */
export function corners({ min, max }) {
  return [0, 1, 2, 3, 4, 5, 6, 7].map((corner) => min.map((low, axis) => ((corner >> axis) & 1 ? max[axis] : low)));
}

/** The box around several boxes; `null` around none. */
export function union(boxes) {
  if (boxes.length === 0) return null;
  const reduce = (key, pick) => [0, 1, 2].map((axis) => pick(...boxes.map((box) => box[key][axis])));
  return { min: reduce("min", Math.min), max: reduce("max", Math.max) };
}
