// Mouse, pen and fingers on the view: turning, panning, zooming, picking.

import { distanceOf, panned, pointOnPlane, turned, zoomed } from "../camera.js";
import { clamp } from "../vec.js";
import { pick } from "../pick.js";

const TURN_DEG_PER_PX = 0.35;
const ZOOM_PER_PX = 0.0016;
const LINE_PX = 16;
/** A pointer that moved less was a click. */
const CLICK_PX = 4;
/** What is under the pointer is asked for anew after a pause of the wheel. */
const WHEEL_PAUSE_MS = 400;
const DOUBLE_CLICK_MS = 350;

/** Takes the pointer on `view`. */
export function takePointer(app, view, motion) {
  const pointers = new Map();
  let gesture = null;
  const at = (event) => {
    const box = view.getBoundingClientRect();
    return { x: event.clientX - box.left, y: event.clientY - box.top };
  };

  view.addEventListener("pointerdown", (event) => {
    if (event.defaultPrevented) return;
    view.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, at(event));
    const isOnly = pointers.size === 1;
    gesture = { travelled: isOnly ? 0 : Infinity, pans: event.button !== 0 || event.shiftKey, button: event.button };
    view.classList.add("dragging");
  });

  view.addEventListener("pointermove", (event) => {
    const last = pointers.get(event.pointerId);
    if (!last) return;
    const before = centreOf(pointers);
    pointers.set(event.pointerId, at(event));
    const after = centreOf(pointers);
    const [dx, dy] = [after.x - before.x, after.y - before.y];
    gesture.travelled += Math.abs(dx) + Math.abs(dy);
    if (gesture.travelled < CLICK_PX) return;
    const { viewSize } = app.live;
    if (pointers.size > 1) motion.move((camera) => pinched(camera, before, after, viewSize));
    else if (gesture.pans) motion.move((camera) => panned(camera, dx, dy, viewSize));
    else motion.move((camera) => turned(camera, -dx * TURN_DEG_PER_PX, dy * TURN_DEG_PER_PX));
  });

  for (const type of ["pointerup", "pointercancel"]) {
    view.addEventListener(type, (event) => {
      if (!pointers.delete(event.pointerId) || pointers.size > 0) return;
      view.classList.remove("dragging");
      const isClick = type === "pointerup" && gesture.travelled < CLICK_PX && gesture.button === 0;
      if (isClick) click(at(event));
    });
  }

  let lastClick = { time: -Infinity, x: 0, y: 0 };
  async function click({ x, y }) {
    const now = performance.now();
    const isNear = Math.hypot(x - lastClick.x, y - lastClick.y) < 3 * CLICK_PX;
    const isDouble = isNear && now - lastClick.time < DOUBLE_CLICK_MS;
    lastClick = { time: isDouble ? -Infinity : now, x, y };
    const { instance, position } = await pick(app, x, y);
    if (!isDouble) app.selection.select(instance);
    else if (position) motion.glide((camera) => ({ ...camera, target: position }));
  }

  let wheel = { time: -Infinity, x: 0, y: 0, point: null };
  view.addEventListener("wheel", (event) => {
    event.preventDefault();
    const { current } = app.camera;
    if (!current) return;
    const { x, y } = at(event);
    const isNew = event.timeStamp - wheel.time > WHEEL_PAUSE_MS || Math.hypot(x - wheel.x, y - wheel.y) > CLICK_PX;
    if (isNew) wheel = { x, y, point: pointOnPlane(current, x, y, app.live.viewSize) };
    if (isNew) aim(wheel);
    wheel.time = event.timeStamp;
    const px = event.deltaY * (event.deltaMode === WheelEvent.DOM_DELTA_LINE ? LINE_PX : 1);
    motion.zoom(wheel.point, clamp(px, -400, 400) * ZOOM_PER_PX);
  }, { passive: false });

  /** Until the answer is there, the plane through the target has to do. */
  async function aim(turn) {
    const { position } = await pick(app, turn.x, turn.y);
    if (position) turn.point = position;
  }

  view.addEventListener("contextmenu", (event) => event.preventDefault());
}

/** The centre of the fingers, and how far they are apart. */
function centreOf(pointers) {
  const all = [...pointers.values()];
  const x = all.reduce((sum, p) => sum + p.x, 0) / all.length;
  const y = all.reduce((sum, p) => sum + p.y, 0) / all.length;
  return { x, y, spread: all.length > 1 ? Math.hypot(all[0].x - all[1].x, all[0].y - all[1].y) : 1 };
}

/** What was between the fingers stays there. */
function pinched(camera, before, after, size) {
  const point = pointOnPlane(camera, before.x, before.y, size);
  const near = zoomed(camera, point, (before.spread || 1) / (after.spread || 1));
  return distanceOf(near) > 0 ? panned(near, after.x - before.x, after.y - before.y, size) : camera;
}
