// Mouse, pen and fingers on the view: turning, panning, pinching, clicking.

import { panned, pointOnPlane, turned, zoomed } from "../camera.js";
import { pick } from "../pick.js";
import { tried } from "../tried.js";

const TURN_DEG_PER_PX = 0.35;
/** A pointer that moved less was a click. */
const CLICK_PX = 4;
export const DOUBLE_CLICK_MS = 350;

/** Where an event lies in an element. */
export function placeIn(element, { clientX, clientY }) {
  const box = element.getBoundingClientRect();
  return { x: clientX - box.left, y: clientY - box.top };
}

export class Pointer {
  #app;
  #view;
  /** Pointer id → where it is, for all that are down. */
  #down = new Map();
  /** What the first pointer of a gesture began: button, whether it pans, how far it went. */
  #gesture = null;
  #lastClick = { time: -Infinity, x: 0, y: 0 };

  constructor(app, view) {
    this.#app = app;
    this.#view = view;
    view.addEventListener("pointerdown", (event) => { if (!event.defaultPrevented) this.#begin(event); });
    view.addEventListener("pointermove", (event) => { if (this.#down.has(event.pointerId)) this.#follow(event); });
    view.addEventListener("pointerup", (event) => this.#end(event));
    view.addEventListener("pointercancel", (event) => this.#end(event));
    view.addEventListener("contextmenu", (event) => event.preventDefault());
  }

  #begin(event) {
    const isFirst = this.#down.size === 0;
    this.#view.setPointerCapture(event.pointerId);
    this.#down.set(event.pointerId, placeIn(this.#view, event));
    this.#gesture = { button: event.button, pans: event.button !== 0 || event.shiftKey, travelled: isFirst ? 0 : Infinity };
    this.#view.classList.add("dragging");
  }

  #follow(event) {
    const before = summed([...this.#down.values()]);
    this.#down.set(event.pointerId, placeIn(this.#view, event));
    const after = summed([...this.#down.values()]);
    this.#gesture.travelled += Math.hypot(after.x - before.x, after.y - before.y);
    if (this.#gesture.travelled >= CLICK_PX) this.#app.motion.move(this.#moveOf(before, after));
  }

  /** What a drag does to the camera. */
  #moveOf(before, after) {
    const [dx, dy] = [after.x - before.x, after.y - before.y];
    const { viewSize } = this.#app.live;
    if (this.#down.size > 1) return (camera) => pinched(camera, before, after, viewSize);
    if (this.#gesture.pans) return (camera) => panned(camera, dx, dy, viewSize);
    return (camera) => turned(camera, -dx * TURN_DEG_PER_PX, dy * TURN_DEG_PER_PX);
  }

  #end(event) {
    if (!this.#down.delete(event.pointerId) || this.#down.size > 0) return;
    this.#view.classList.remove("dragging");
    const { button, travelled } = this.#gesture;
    if (event.type === "pointerup" && button === 0 && travelled < CLICK_PX) this.#click(placeIn(this.#view, event));
  }

  /** One click selects what is there, two look at it. */
  async #click({ x, y }) {
    const now = performance.now();
    const last = this.#lastClick;
    const isDouble = now - last.time < DOUBLE_CLICK_MS && Math.hypot(x - last.x, y - last.y) < 3 * CLICK_PX;
    this.#lastClick = { time: isDouble ? -Infinity : now, x, y };
    const hit = await tried(this.#app.notices, "What is there cannot be told", () => pick(this.#app, x, y));
    if (!hit) return;
    if (!isDouble) this.#app.selection.select(hit.instance);
    else if (hit.position) this.#app.motion.glide((camera) => ({ ...camera, target: hit.position }));
  }
}

/** The centre of the pointers, and how far the first two are apart. */
function summed(places) {
  const mean = (axis) => places.reduce((sum, place) => sum + place[axis], 0) / places.length;
  const [a, b = { x: a.x + 1, y: a.y }] = places;
  return { x: mean("x"), y: mean("y"), spread: Math.hypot(a.x - b.x, a.y - b.y) || 1 };
}

/** What was between the fingers stays there. */
function pinched(camera, before, after, size) {
  const point = pointOnPlane(camera, before.x, before.y, size);
  const nearer = zoomed(camera, point, before.spread / after.spread);
  return panned(nearer, after.x - before.x, after.y - before.y, size);
}
