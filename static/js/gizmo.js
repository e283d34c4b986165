// The handles at the selected instance: move along axes, turn about them, scale.

import { basis, pointOnPlane, project, rayAt, scaleAt } from "./camera.js";
import { svg } from "./dom.js";
import { axesOf, rotationOf, scaleOf, translationOf, turnedFurther } from "./transform.js";
import { DOUBLE_CLICK_MS, placeIn } from "./input/pointer.js";
import { AXES, add, cross, degrees, dot, rounding, sub, times } from "./vec.js";

/** Length of a handle, in pixels of the view. */
const REACH_PX = 84;
/** A shorter one points at the eye and cannot be dragged along. */
const LEAST_PX = 14;
/** Where an arm begins, outside of the handle at the centre if it is long enough. */
const START_PX = 16;
const RING_POINTS = 64;
/** Of a ring's radius, how far behind its centre is still drawn: all of a ring that is seen from the front. */
const FRONT_PART = 0.35;
/** So many pixels double or halve the size. */
const DOUBLE_PX = 120;
const LEAST_FACTOR = 0.01;
/** Digits of a move, as a part of a handle's length: finer than a pixel. */
const MOVE_DIGITS = 4;
const NAMES = ["x", "y", "z"];

export const MODES = { move: "Move", turn: "Turn", scale: "Scale" };

/** Event `mode`: another one is on. */
export class Gizmo extends EventTarget {
  #app;
  #group = svg("g", { id: "gizmo" });
  #handles;
  #mode = "move";
  #selectedAt = -Infinity;

  constructor(app, marks) {
    super();
    this.#app = app;
    app.selection.addEventListener("change", () => { this.#selectedAt = performance.now(); });
    marks.append(this.#group);
    this.#handles = [...NAMES, "centre"].map((name, axis) => this.#makeHandle(name, axis));
  }

  get mode() {
    return this.#mode;
  }

  set mode(mode) {
    this.#mode = mode;
    this.dispatchEvent(new Event("mode"));
  }

  /** Puts the handles where the instance is in the picture. */
  draw(shown) {
    const place = shown && placeOf(shown);
    this.#group.dataset.mode = this.#mode;
    this.#group.toggleAttribute("hidden", !place);
    if (place) this.#handles.forEach((handle, axis) => handle.draw(pathOf(this.#mode, place, axis)));
  }

  #makeHandle(name, axis) {
    const paths = ["hit", "under", "over"].map((layer) => svg("path", { class: layer }));
    const label = svg("text", {}, name === "centre" ? "" : name.toUpperCase());
    const group = svg("g", { class: `handle ${name}`, "data-handle": name }, ...paths, label);
    group.addEventListener("pointerdown", (event) => this.#grab(event, group, axis));
    this.#group.append(group);
    const draw = ({ d, end }) => {
      paths.forEach((path) => path.setAttribute("d", d));
      group.toggleAttribute("hidden", d === "");
      label.setAttribute("x", end.x);
      label.setAttribute("y", end.y);
    };
    return { draw };
  }

  /** Follows the pointer until it lets go: every move starts from what was there when it took hold. */
  #grab(event, handle, axis) {
    const { scene, camera, live, selection } = this.#app;
    if (event.button !== 0 || !camera.current) return;
    // The click that selected brought the handles under the pointer: a second one is not meant for them.
    if (performance.now() - this.#selectedAt < DOUBLE_CLICK_MS) return;
    event.preventDefault(); // The view would turn the camera.
    const marks = handle.ownerSVGElement;
    marks.parentNode.focus({ preventScroll: true });
    handle.setPointerCapture(event.pointerId);
    const shown = { document: scene.document, instance: selection.instance, camera: camera.current, size: live.viewSize };
    const drag = DRAGS[this.#mode](placeOf(shown), axis, placeIn(marks, event));
    const follow = (move) => selection.edit(drag(placeIn(marks, move)));
    const release = () => {
      handle.removeEventListener("pointermove", follow);
      handle.classList.remove("held");
    };
    handle.classList.add("held");
    handle.addEventListener("pointermove", follow);
    handle.addEventListener("lostpointercapture", release, { once: true });
  }
}

/** What handles are drawn and dragged by; `null` if the instance's origin is behind the camera. */
function placeOf({ document, instance, camera, size }) {
  const modelScale = document.render.model_scale;
  const origin = times(translationOf(instance), modelScale);
  const centre = project(camera, origin, size);
  if (!centre) return null;
  const reach = REACH_PX / scaleAt(camera, centre.depth, size);
  return { instance, modelScale, camera, size, origin, centre, reach };
}

// ── What handles look like ──

function pathOf(mode, place, axis) {
  if (axis === 3) return mode === "turn" ? { d: "", end: place.centre } : { d: dotPath(place.centre, 9), end: place.centre };
  if (mode === "turn") return ringPath(place, axis);
  return armPath(place, mode === "scale" ? axesOf(place.instance)[axis] : AXES[axis], mode);
}

function armPath({ camera, size, origin, centre, reach }, direction, mode) {
  const end = project(camera, add(origin, times(direction, reach)), size);
  const length = end ? Math.hypot(end.x - centre.x, end.y - centre.y) : 0;
  if (length < LEAST_PX) return { d: "", end: centre };
  const [dx, dy] = [(end.x - centre.x) / length, (end.y - centre.y) / length];
  const tip = mode === "scale" ? dotPath(end, 6) : arrowPath(end, dx, dy);
  const start = Math.min(START_PX, length / 2);
  const d = `M${centre.x + dx * start} ${centre.y + dy * start}L${end.x} ${end.y}${tip}`;
  return { d, end: { x: end.x + dx * 18, y: end.y + dy * 18 } };
}

function arrowPath({ x, y }, dx, dy) {
  const [backX, backY] = [x - dx * 12, y - dy * 12];
  return `M${backX - dy * 6} ${backY + dx * 6}L${x} ${y}L${backX + dy * 6} ${backY - dx * 6}Z`;
}

const dotPath = ({ x, y }, r) => `M${x - r} ${y}a${r} ${r} 0 1 0 ${2 * r} 0a${r} ${r} 0 1 0 ${-2 * r} 0Z`;

/** The half of the ring that faces the camera. */
function ringPath({ camera, size, origin, reach }, axis) {
  const { forward } = basis(camera);
  const points = ringPoints(origin, reach, axis);
  const isFront = (point) => dot(sub(point, origin), forward) <= FRONT_PART * reach;
  // From the first point that comes to the front, so that the half is one piece.
  const first = Math.max(points.findIndex((point, i) => isFront(point) && !isFront(points.at(i - 1))), 0);
  const front = [...points.slice(first), ...points.slice(0, first)].filter(isFront);
  const ordered = front.map((point) => project(camera, point, size)).filter(Boolean);
  if (ordered.length < 2) return { d: "", end: { x: 0, y: 0 } };
  const closes = ordered.length === RING_POINTS ? "Z" : "";
  const end = ordered[Math.floor(ordered.length * (axis + 1) / 4)];
  return { d: `M${ordered.map(({ x, y }) => `${x.toFixed(1)} ${y.toFixed(1)}`).join("L")}${closes}`, end };
}

function ringPoints(origin, radius, axis) {
  const [u, v] = [AXES[(axis + 1) % 3], AXES[(axis + 2) % 3]];
  return Array.from({ length: RING_POINTS }, (_, i) => {
    const angle = (i / RING_POINTS) * 2 * Math.PI;
    return add(origin, add(times(u, radius * Math.cos(angle)), times(v, radius * Math.sin(angle))));
  });
}

// ── What dragging does: (place, axis, where it began) → (where it is now) → fields of the instance ──

const DRAGS = { move: dragMove, turn: dragTurn, scale: dragScale };

function dragMove(place, axis, from) {
  const { camera, size, origin, instance, modelScale } = place;
  const along = (to) => times(AXES[axis], alongAxis(place, AXES[axis], to) - alongAxis(place, AXES[axis], from));
  const across = (to) => sub(pointOnPlane(camera, to.x, to.y, size, origin), pointOnPlane(camera, from.x, from.y, size, origin));
  const by = axis === 3 ? across : along;
  const round = rounding(place.reach / modelScale, MOVE_DIGITS);
  return (to) => ({ translation: add(translationOf(instance), times(by(to), 1 / modelScale)).map(round) });
}

/** By how far the pointer goes along the ring's tangent where it took hold. */
function dragTurn(place, axis, from) {
  const { camera, size, origin, reach, instance } = place;
  const away = (point) => {
    const at = project(camera, point, size);
    return at ? Math.hypot(at.x - from.x, at.y - from.y) : Infinity;
  };
  const held = ringPoints(origin, reach, axis).reduce((best, point) => (away(point) < away(best) ? point : best));
  const tangent = cross(AXES[axis], sub(held, origin));
  const [a, b] = [held, add(held, times(tangent, 0.01))].map((point) => project(camera, point, size));
  const perRadian = [(b.x - a.x) / 0.01, (b.y - a.y) / 0.01];
  const lengthSquared = Math.max(perRadian[0] ** 2 + perRadian[1] ** 2, LEAST_PX ** 2);
  return (to) => {
    const radians = ((to.x - from.x) * perRadian[0] + (to.y - from.y) * perRadian[1]) / lengthSquared;
    return { rotation_deg: turnedFurther(rotationOf(instance), axis, Number(degrees(radians).toFixed(1))) };
  };
}

function dragScale(place, axis, from) {
  const { instance } = place;
  const tidied = (x) => Number(x.toPrecision(4));
  if (axis === 3) {
    const uniform = (to) => 2 ** ((to.x - from.x - (to.y - from.y)) / DOUBLE_PX);
    const { scale = 1 } = instance;
    return (to) => ({ scale: Array.isArray(scale) ? scale.map((x) => tidied(x * uniform(to))) : tidied(scale * uniform(to)) });
  }
  const direction = axesOf(instance)[axis];
  const start = alongAxis(place, direction, from);
  return (to) => {
    const factor = Math.max(alongAxis(place, direction, to) / start, LEAST_FACTOR);
    return { scale: scaleOf(instance).map((x, i) => (i === axis ? tidied(x * factor) : x)) };
  };
}

/** How far along an axis through the origin the point lies that is next to the pointer's ray. */
function alongAxis({ camera, size, origin }, axis, { x, y }) {
  const ray = rayAt(camera, x, y, size);
  const offset = sub(origin, ray.origin);
  const between = dot(axis, ray.direction);
  return (between * dot(ray.direction, offset) - dot(axis, offset)) / (1 - between * between);
}
