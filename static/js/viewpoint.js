// The open scene's camera as the page steers it.

import { distanceOf, framed } from "./camera.js";
import { add, rotated, rounding, sub, unit } from "./vec.js";
import { same } from "./merge.js";

/** Significant digits of what is written, as a part of the distance: finer than a pixel. */
const DIGITS = 6;
/** The near plane of a camera that has none of its own, as a part of the distance; the server frames alike. */
const NEAR_PART = 1e-3;
/** Where the given planes would cut what the camera looks at, they give way. */
const [NEAR_LIMIT, FAR_LIMIT] = [1 / 50, 4];

/** Event `change`: the user moved the camera, or the document did. */
export class Viewpoint extends EventTarget {
  #scene;
  #live;
  #plan;
  /** At the start of time, unrounded; `null` while the scene leaves its place to the server. */
  #steered = null;
  /** What the document says, to tell its changes from ours. */
  #written = null;
  /** The document's planes before the page moved them. */
  #planes = {};

  constructor(scene, live, plan) {
    super();
    this.#scene = scene;
    this.#live = live;
    this.#plan = plan;
    scene.addEventListener("open", () => this.#follow());
    scene.addEventListener("change", () => this.#follow());
    plan.addEventListener("change", () => this.dispatchEvent(new Event("change")));
  }

  /** As it stands now; `null` until it is known. */
  get current() {
    const camera = this.#steered ?? this.#settled(this.#scene.document);
    return camera && turnedByTime(camera, this.#turnDeg(this.#scene.document, this.#time));
  }

  /** As it stands in a picture of `document` at time `t`. */
  at(document, t) {
    const camera = this.#settled(document);
    return camera && turnedByTime(camera, this.#turnDeg(document, t));
  }

  /** Steers: `move` makes the new camera of the current one. */
  change(move) {
    const { current } = this;
    if (!current) return;
    this.#steered = turnedByTime(move(current), -this.#turnDeg(this.#scene.document, this.#time));
    this.#write();
    this.dispatchEvent(new Event("change"));
  }

  /** `camera` moved to where `box` fills the view. */
  framed(camera, box) {
    return framed(camera, box, this.#live.viewSize);
  }

  get #time() {
    return this.#live.frame?.t ?? 0;
  }

  #turnDeg({ camera }, t) {
    return (camera?.orbit_deg_per_s ?? 0) * t;
  }

  /** The document's camera, its place filled in by the server where it has none. */
  #settled({ camera = {} }) {
    if (camera.position) return { target: [0, 0, 0], up: [0, 1, 0], fov_y_deg: 45, ...camera };
    const planned = this.#plan.current?.camera;
    return planned ? { ...planned, ...camera } : null;
  }

  #follow() {
    const { camera } = this.#scene.document;
    if (same(camera, this.#written)) return;
    this.#written = camera;
    this.#steered = null;
    this.#planes = { near: camera?.near, far: camera?.far };
    this.dispatchEvent(new Event("change"));
  }

  #write() {
    const { position, target, orthographic } = this.#steered;
    const distance = distanceOf(this.#steered);
    const round = rounding(distance, DIGITS);
    const camera = { position: position.map(round), target: target.map(round), ...this.#planesAt(distance) };
    if (orthographic) camera.orthographic = { height: Number(orthographic.height.toPrecision(DIGITS)) };
    this.#written = { ...this.#scene.document.camera, ...camera };
    this.#scene.edit({ camera });
  }

  /** Near and far, as the document has them as long as what is looked at lies between. */
  #planesAt(distance) {
    const { near = distance * NEAR_PART, far } = this.#planes;
    const limit = { near: distance * NEAR_LIMIT, far: distance * FAR_LIMIT };
    const planes = { near: this.#planes.near <= limit.near ? near : Number(Math.min(near, limit.near).toPrecision(1)) };
    if (far) planes.far = far >= limit.far ? far : Number(limit.far.toPrecision(2));
    return planes;
  }
}

/** About the target, as `orbit_deg_per_s` does it. */
function turnedByTime(camera, deg) {
  if (deg === 0) return camera;
  const offset = rotated(sub(camera.position, camera.target), unit(camera.up), deg);
  return { ...camera, position: add(camera.target, offset) };
}
