// The wheel on the view: nearer to what is under the pointer, or away from it.

import { pointOnPlane } from "../camera.js";
import { pick } from "../pick.js";
import { clamp } from "../vec.js";
import { placeIn } from "./pointer.js";

const LOG_PER_PX = 0.0016;
/** What one event of a wheel that counts in lines amounts to. */
const LINE_PX = 16;
const MOST_PX = 400;
/** What is under the pointer is asked for anew after a pause, or when it has moved. */
const PAUSE_MS = 400;
const MOVED_PX = 4;

export class Wheel {
  #app;
  /** What the wheel turns towards, where and when. */
  #aim = { time: -Infinity, x: 0, y: 0, point: null };
  #isAsking = false;

  constructor(app, view) {
    this.#app = app;
    view.addEventListener("wheel", (event) => {
      event.preventDefault(); // The page would scroll.
      if (app.camera.current) this.#turn(event, placeIn(view, event));
    }, { passive: false });
  }

  #turn({ timeStamp, deltaY, deltaMode }, { x, y }) {
    const { time } = this.#aim;
    const hasMoved = Math.hypot(x - this.#aim.x, y - this.#aim.y) > MOVED_PX;
    if (timeStamp - time > PAUSE_MS || hasMoved) this.#aimAt(x, y);
    this.#aim.time = timeStamp;
    const px = deltaY * (deltaMode === WheelEvent.DOM_DELTA_LINE ? LINE_PX : 1);
    this.#app.motion.zoom(this.#aim.point, clamp(px, -MOST_PX, MOST_PX) * LOG_PER_PX);
  }

  /** Until the server has said what is there, and for the background, the plane through the target has to do. */
  #aimAt(x, y) {
    const { camera, live } = this.#app;
    this.#aim = { x, y, point: pointOnPlane(camera.current, x, y, live.viewSize) };
    if (!this.#isAsking) this.#ask();
  }

  /** One question at a time; the next is about the newest aim. */
  async #ask() {
    this.#isAsking = true;
    for (let asked = null; asked !== this.#aim;) {
      asked = this.#aim;
      const hit = await pick(this.#app, asked.x, asked.y).catch(() => null);
      if (hit?.position) asked.point = hit.position;
    }
    this.#isAsking = false;
  }
}
