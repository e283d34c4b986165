// Where an instance stands: M = T · Rz · Ry · Rx · Spin · S, scaled about the world's origin by `model_scale`.

import { AXES, add, degrees, dot, radians, rotated, times, unit } from "./vec.js";

// As the server has them, until it has told so of a new instance.
export const translationOf = ({ translation = [0, 0, 0] }) => translation;
export const rotationOf = ({ rotation_deg = [0, 0, 0] }) => rotation_deg;
export const scaleOf = ({ scale = 1 }) => (Array.isArray(scale) ? scale : [scale, scale, scale]);

/** A vector turned by `rotation_deg`: about x, then y, then z. */
function turnedBy(v, rotationDeg) {
  return rotationDeg.reduce((result, deg, axis) => rotated(result, AXES[axis], deg), v);
}

/** The instance's own axes in the world, without its spin. */
export function axesOf(instance) {
  return AXES.map((axis) => turnedBy(axis, rotationOf(instance)));
}

/** The function that takes a point of the mesh to the world at time `t`. */
export function worldFromMesh(instance, modelScale, t) {
  const { spin } = instance;
  const scale = scaleOf(instance);
  const spun = spin ? (v) => rotated(v, unit(spin.axis), spin.deg_per_s * t) : (v) => v;
  return (point) => {
    const scaled = point.map((x, axis) => x * scale[axis]);
    return times(add(turnedBy(spun(scaled), rotationOf(instance)), translationOf(instance)), modelScale);
  };
}

/** `rotation_deg` after a further turn about an axis of the world. */
export function turnedFurther(rotationDeg, axis, deg) {
  // What is turned last, or followed by nothing, only adds up: numbers stay as people wrote them.
  const followed = rotationDeg.slice(axis + 1).some((angle) => angle !== 0);
  if (!followed) return rotationDeg.map((angle, i) => (i === axis ? tidyDeg(angle + deg) : angle));
  const columns = axesOf({ rotation_deg: rotationDeg }).map((column) => rotated(column, AXES[axis], deg));
  return anglesOf(columns, rotationDeg).map(tidyDeg);
}

/** The angles about x, y and z of a rotation; of the two ways to write it, the one nearer to `before`. */
function anglesOf([x, y, z], before) {
  const about = (a, b) => degrees(Math.atan2(a, b));
  const sinY = -dot(x, AXES[2]);
  const pitch = degrees(Math.asin(Math.min(Math.max(sinY, -1), 1)));
  const isLocked = Math.abs(sinY) > 1 - 1e-9;
  const one = isLocked ? [about(-z[1], y[1]), pitch, 0] : [about(y[2], z[2]), pitch, about(x[1], x[0])];
  const other = [one[0] + 180, 180 - one[1], one[2] + 180];
  const away = (angles) => angles.reduce((sum, angle, i) => sum + 1 - Math.cos(radians(angle - before[i])), 0);
  return away(one) <= away(other) ? one : other;
}

/** Within ±180°, without digits that nobody sees. */
function tidyDeg(deg) {
  const wrapped = ((((deg + 180) % 360) + 360) % 360) - 180;
  return Number(wrapped.toFixed(3));
}
