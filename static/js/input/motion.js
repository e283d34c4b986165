// All movement, frame by frame: drags, held keys, the wheel's rest, glides. What goes on together is one step.

import { basis, distanceOf, flown, turned, zoomed } from "../camera.js";
import { add, mix, rounding, times } from "../vec.js";
import { rotationOf, translationOf, turnedFurther } from "../transform.js";

/** Per second: the camera by a part of its distance, about its target, towards it. */
const [FLY_PART, TURN_DEG, ZOOM_LOG] = [0.8, 90, 1.2];
/** Per second: an instance by a part of the camera's distance, about the vertical. */
const [MOVE_PART, SPIN_DEG] = [0.35, 90];
/** Digits that are left of a part of that distance. */
const MOVE_DIGITS = 6;
/** The least that a key does, however short it is pressed. */
const TAP_S = 0.03;
/** After a pause, time is not made up for. */
const LONGEST_STEP_S = 0.1;
/** The wheel's rest shrinks by e in this time. */
const WHEEL_S = 0.06;
const GLIDE_MS = 250;

/** Key codes and the direction each stands for: right, up, forward. */
const DIRECTIONS = {
  KeyD: [1, 0, 0], KeyA: [-1, 0, 0], KeyE: [0, 1, 0], KeyQ: [0, -1, 0], KeyW: [0, 0, 1], KeyS: [0, 0, -1],
};
/** About the camera's target: yaw, pitch. */
const TURNS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
const ZOOMS = { Equal: -1, NumpadAdd: -1, Minus: 1, NumpadSubtract: 1 };
const SPINS = { KeyZ: 1, KeyX: -1 };

export const isHeldKey = (code) => [DIRECTIONS, TURNS, ZOOMS, SPINS].some((keys) => code in keys);

export class Motion {
  #app;
  /** Key code → seconds that it owes from being pressed. */
  #held = new Map();
  #released = new Set();
  #steps = [];
  #wheel = null;
  #glide = null;
  #running = false;
  #last = 0;

  constructor(app) {
    this.#app = app;
  }

  /** Moves the camera with the next frame: `step` makes the new camera of the current one. */
  move(step) {
    this.#glide = null;
    this.#steps.push(step);
    this.#run();
  }

  /** Nearer to `point` or away, by the logarithm of a factor, smoothly. */
  zoom(point, log) {
    this.#glide = null;
    this.#wheel = { point, log: log + (this.#wheel?.log ?? 0) };
    this.#run();
  }

  /** Takes the camera to where `arrive` puts it, on a straight way. */
  glide(arrive) {
    const { current } = this.#app.camera;
    if (!current) return;
    const isStill = matchMedia("(prefers-reduced-motion: reduce)").matches;
    this.#wheel = null;
    this.#glide = { from: current, to: arrive(current), begin: performance.now(), ms: isStill ? 1 : GLIDE_MS };
    this.#run();
  }

  press(code) {
    if (this.#held.has(code)) return;
    this.#held.set(code, TAP_S);
    this.#run();
  }

  release(code) {
    if (this.#held.has(code)) this.#released.add(code);
  }

  releaseAll() {
    for (const code of this.#held.keys()) this.#released.add(code);
  }

  #run() {
    if (!this.#running) this.#last = performance.now();
    this.#schedule();
  }

  #schedule() {
    if (this.#running) return;
    this.#running = true;
    requestAnimationFrame((now) => this.#tick(now));
  }

  #tick(now) {
    const seconds = Math.min(Math.max(now - this.#last, 0) / 1000, LONGEST_STEP_S);
    this.#last = now;
    this.#running = false;
    const held = this.#takeHeld(seconds);
    const smooth = [this.#wheelStep(seconds), ...this.#keySteps(held), this.#glideStep(now)];
    const steps = [...this.#steps.splice(0), ...smooth].filter(Boolean);
    if (steps.length > 0) this.#app.camera.change((camera) => steps.reduce((moved, step) => step(moved), camera));
    if (this.#app.selection.instance) this.#moveInstance(held);
    if (this.#held.size > 0 || this.#wheel !== null || this.#glide !== null) this.#schedule();
  }

  /** The seconds that each key counts for in this frame. */
  #takeHeld(seconds) {
    const held = new Map([...this.#held].map(([code, owed]) => [code, owed + seconds]));
    for (const code of this.#held.keys()) this.#held.set(code, 0);
    for (const code of this.#released) this.#held.delete(code);
    this.#released.clear();
    return held;
  }

  #keySteps(held) {
    const steps = [];
    const fly = this.#app.selection.name === null ? weighed(DIRECTIONS, held) : null;
    if (fly) steps.push((camera) => flown(camera, times(fly, FLY_PART * distanceOf(camera))));
    const turn = weighed(TURNS, held);
    if (turn) steps.push((camera) => turned(camera, turn[0] * TURN_DEG, turn[1] * TURN_DEG));
    const zoom = summed(ZOOMS, held);
    if (zoom) steps.push((camera) => zoomed(camera, camera.target, Math.exp(zoom * ZOOM_LOG)));
    return steps;
  }

  #wheelStep(seconds) {
    if (!this.#wheel) return null;
    const { point, log } = this.#wheel;
    const part = Math.abs(log) < 0.002 ? 1 : 1 - Math.exp(-Math.max(seconds, 0.008) / WHEEL_S);
    this.#wheel = part === 1 ? null : { point, log: log * (1 - part) };
    return (camera) => zoomed(camera, point, Math.exp(log * part));
  }

  #glideStep(now) {
    if (!this.#glide) return null;
    const { from, to, begin, ms } = this.#glide;
    const part = Math.min(Math.max((now - begin) / ms, 0), 1);
    if (part === 1) this.#glide = null;
    const eased = part * part * (3 - 2 * part);
    return () => between(from, to, eased);
  }

  /** Along the axes of the world that lie next to the camera's, so that D goes right as one sees it. */
  #moveInstance(held) {
    const { camera: { current }, selection, scene } = this.#app;
    const { instance } = selection;
    const steps = weighed(DIRECTIONS, held);
    const spin = summed(SPINS, held);
    if (steps && current) {
      const distance = distanceOf(current) / scene.document.render.model_scale;
      const by = worldAxes(current).map((axis, i) => times(axis, steps[i] * MOVE_PART * distance)).reduce(add);
      selection.edit({ translation: add(translationOf(instance), by).map(rounding(distance, MOVE_DIGITS)) });
    }
    if (spin) selection.edit({ rotation_deg: turnedFurther(rotationOf(instance), 1, spin * SPIN_DEG) });
  }
}

/** The sum of the held keys' directions, each times its seconds; `null` if none is held. */
function weighed(directions, held) {
  const parts = Object.entries(directions).filter(([code]) => held.has(code)).map(([code, by]) => times(by, held.get(code)));
  return parts.length > 0 ? parts.reduce(add) : null;
}

function summed(signs, held) {
  return Object.entries(signs).reduce((sum, [code, sign]) => sum + sign * (held.get(code) ?? 0), 0);
}

/** The world's axes next to the camera's right, up and forward. */
function worldAxes(camera) {
  const { forward } = basis(camera);
  const isAlongX = Math.abs(forward[0]) > Math.abs(forward[2]);
  const away = isAlongX ? [Math.sign(forward[0]), 0, 0] : [0, 0, Math.sign(forward[2]) || -1];
  return [[-away[2], 0, away[0]], [0, 1, 0], away];
}

function between(from, to, part) {
  const camera = { ...to, position: mix(from.position, to.position, part), target: mix(from.target, to.target, part) };
  if (to.orthographic) camera.orthographic = { height: mix([from.orthographic.height], [to.orthographic.height], part)[0] };
  return camera;
}
