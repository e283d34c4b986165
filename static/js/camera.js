// A camera as a value: where it stands, how it moves, where a point appears in its picture.
//
// `{position, target, up, fov_y_deg}` or, in place of the angle, `orthographic: {height}`, as in a scene document.
// Sizes and pixels are those of the view, y down.

import { add, clamp, corners, cross, degrees, dot, length, mix, radians, rotated, sub, times, unit } from "./vec.js";

/** Closer to the vertical, turning would flip the picture over. */
const MAX_PITCH_DEG = 89;
/** How much of the tighter side a framed box fills, as the server does it. */
const FRAME_FILL = 0.9;
/** Outside of this, distances lose their digits. */
const [MIN_DISTANCE, MAX_DISTANCE] = [1e-5, 1e8];

/** Unit vectors to the right, up and into the picture. Seen along `up`, the world axis least along it stands in. */
export function basis({ position, target, up }) {
  const forward = unit(sub(target, position), [0, 0, -1]);
  const across = cross(forward, unit(up));
  const right = unit(length(across) > 1e-6 ? across : cross(forward, leastAxis(forward)));
  return { right, up: cross(right, forward), forward };
}

function leastAxis(v) {
  const sizes = v.map(Math.abs);
  const least = sizes.indexOf(Math.min(...sizes));
  return [0, 1, 2].map((axis) => Number(axis === least));
}

export const distanceOf = ({ position, target }) => length(sub(position, target));

/** View pixels per world unit, `depth` in front of the camera. */
export function scaleAt(camera, depth, { height }) {
  if (camera.orthographic) return height / camera.orthographic.height;
  return height / (2 * Math.tan(radians(camera.fov_y_deg / 2)) * depth);
}

/** Where a world point appears, and how far in front of the camera it lies; `null` behind it. */
export function project(camera, point, size) {
  const { right, up, forward } = basis(camera);
  const offset = sub(point, camera.position);
  const depth = dot(offset, forward);
  if (depth <= 0 && !camera.orthographic) return null;
  const scale = scaleAt(camera, depth, size);
  return { x: size.width / 2 + dot(offset, right) * scale, y: size.height / 2 - dot(offset, up) * scale, depth };
}

/** A segment in the picture, cut off at the camera: two pixels, or `null` if it lies behind. */
export function projectSegment(camera, from, to, size) {
  const { forward } = basis(camera);
  const least = camera.orthographic ? -Infinity : distanceOf(camera) * 1e-3;
  const depths = [from, to].map((point) => dot(sub(point, camera.position), forward));
  if (depths.every((depth) => depth < least)) return null;
  const cut = mix(from, to, (least - depths[0]) / (depths[1] - depths[0]));
  const ends = [from, to].map((point, i) => (depths[i] < least ? cut : point));
  return ends.map((point) => project(camera, point, size));
}

/** The ray that a pixel sees. */
export function rayAt(camera, x, y, size) {
  const { right, up, forward } = basis(camera);
  const scale = scaleAt(camera, 1, size);
  const aside = add(times(right, (x - size.width / 2) / scale), times(up, (size.height / 2 - y) / scale));
  if (camera.orthographic) return { origin: add(camera.position, aside), direction: forward };
  return { origin: camera.position, direction: unit(add(forward, aside)) };
}

/** What a pixel shows of the plane through `point` that faces the camera. */
export function pointOnPlane(camera, x, y, size, point = camera.target) {
  const { origin, direction } = rayAt(camera, x, y, size);
  const { forward } = basis(camera);
  return add(origin, times(direction, dot(sub(point, origin), forward) / dot(direction, forward)));
}

/** Turned about the target; never over the top. */
export function turned(camera, yawDeg, pitchDeg) {
  const up = unit(camera.up);
  const offset = sub(camera.position, camera.target);
  const distance = length(offset);
  const height = dot(offset, up);
  const pitch = degrees(Math.asin(clamp(height / distance, -1, 1)));
  const level = unit(sub(offset, times(up, height)), times(basis(camera).up, -1));
  const newPitch = radians(clamp(pitch + pitchDeg, -MAX_PITCH_DEG, MAX_PITCH_DEG));
  const outward = add(times(rotated(level, up, yawDeg), Math.cos(newPitch)), times(up, Math.sin(newPitch)));
  return { ...camera, position: add(camera.target, times(outward, distance)) };
}

/** Moved along with its target by a world vector. */
export function moved(camera, by) {
  return { ...camera, position: add(camera.position, by), target: add(camera.target, by) };
}

/** Moved so that the target follows a pointer that moves by (dx, dy) pixels. */
export function panned(camera, dx, dy, size) {
  const { right, up } = basis(camera);
  const unitsPerPixel = 1 / scaleAt(camera, distanceOf(camera), size);
  return moved(camera, add(times(right, -dx * unitsPerPixel), times(up, dy * unitsPerPixel)));
}

/** Moved along its own axes: `steps` right, up (the world's) and forward. */
export function flown(camera, steps) {
  const { right, forward } = basis(camera);
  const by = [right, unit(camera.up), forward].map((axis, i) => times(axis, steps[i])).reduce(add);
  return moved(camera, by);
}

/** Nearer to `point` by `factor` < 1, farther by > 1: the point keeps its place in the picture. */
export function zoomed(camera, point, factor) {
  const distance = distanceOf(camera);
  const allowed = clamp(distance * factor, MIN_DISTANCE, MAX_DISTANCE) / distance;
  const drawn = (from) => add(point, times(sub(from, point), allowed));
  const result = { ...camera, position: drawn(camera.position), target: drawn(camera.target) };
  if (camera.orthographic) result.orthographic = { height: camera.orthographic.height * allowed };
  return result;
}

/** Facing the way it does, at the distance where the box fills the picture. */
export function framed(camera, box, { width, height }) {
  const target = box.min.map((low, axis) => (low + box.max[axis]) / 2);
  const { right, up, forward } = basis(camera);
  const offsets = corners(box).map((corner) => sub(corner, target));
  const aspect = width / height;
  if (camera.orthographic) {
    const halfHeight = Math.max(...offsets.map((o) => Math.max(Math.abs(dot(o, right)) / aspect, Math.abs(dot(o, up)))));
    const depth = Math.max(...offsets.map((o) => -dot(o, forward)));
    const newHeight = (2 * halfHeight) / FRAME_FILL || 1;
    const position = sub(target, times(forward, 2 * depth + newHeight));
    return { ...camera, position, target, orthographic: { height: newHeight } };
  }
  const tanY = Math.tan(radians(camera.fov_y_deg / 2)) * FRAME_FILL;
  const needed = (o) => Math.max(Math.abs(dot(o, right)) / (tanY * aspect), Math.abs(dot(o, up)) / tanY) - dot(o, forward);
  const distance = Math.max(...offsets.map(needed)) || 1;
  return { ...camera, position: sub(target, times(forward, distance)), target };
}
