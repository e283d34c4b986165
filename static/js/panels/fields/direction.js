// Directions of light: a ball that shows how it falls, to be turned by dragging, and the numbers.

import { field } from "../field.js";
import { clamp, degrees, radians, sub } from "../../vec.js";
import { element, svg } from "../../dom.js";
import { setAt } from "../edit.js";
import { whileDragging } from "./scrub.js";
import { vectorControl } from "./vector.js";

/** Arrow keys: to the right and up. */
const TURNS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
/** Of an arrow key; with Shift, of a fine step. */
const STEP_DEG = 5;
const FINE_STEP_DEG = 1;
/** Straight up or down there is no azimuth left to turn. */
const MAX_ELEVATION_DEG = 89.9;
const DECIMALS = 4;

/**
 * A field for the way light travels. The ball is seen as the camera sees the scene, or a drag to the right would not
 * move the light to the right in the picture.
 */
export function directionField(scene, pointer, words, camera) {
  return field(scene, pointer, words, new DirectionControl(words, camera, (value) => setAt(scene, pointer, value)));
}

class DirectionControl {
  element;
  inputs;

  #camera;
  #write;
  #angles = { azimuth: 0, elevation: 90 };
  #ball;
  #numbers;

  constructor(words, camera, write) {
    this.#camera = camera;
    this.#write = write;
    this.#ball = ballElement(words.label);
    this.#numbers = vectorControl({ ...words, step: 0.05 }, write);
    this.element = element("div", { className: "direction" }, this.#ball, this.#numbers.element);
    this.inputs = [this.#ball, ...this.#numbers.inputs];
    this.#ball.addEventListener("pointerdown", (down) => this.#drag(down));
    this.#ball.addEventListener("keydown", (event) => this.#take(event));
    this.#repaintWithCamera();
  }

  show(travel) {
    this.#numbers.show(travel);
    if (travel) this.#angles = anglesOf(travel);
    this.#paint();
  }

  #paint() {
    paint(this.#ball, seenFrom(this.#camera, this.#angles));
  }

  #turn(from, right, up) {
    this.#angles = turned(from, right, up);
    this.#write(travelOf(this.#angles));
  }

  /** The half turn of the ball's front goes across its width; at the back, the light goes against the hand. */
  #drag(down) {
    down.preventDefault();
    this.#ball.focus();
    const start = this.#angles;
    const degreesPerPixel = 180 / this.#ball.clientWidth;
    const side = towardsLight(seenFrom(this.#camera, start))[2] < 0 ? -1 : 1;
    whileDragging((event) => {
      const right = (event.clientX - down.clientX) * degreesPerPixel * side;
      this.#turn(start, right, (down.clientY - event.clientY) * degreesPerPixel);
    });
  }

  #take(event) {
    const turn = TURNS[event.key];
    if (turn === undefined) return;
    event.preventDefault();
    const step = event.shiftKey ? FINE_STEP_DEG : STEP_DEG;
    this.#turn(this.#angles, turn[0] * step, turn[1] * step);
  }

  /** For as long as the ball is on the page. */
  #repaintWithCamera() {
    const onChange = () => {
      if (this.#ball.isConnected) this.#paint();
      else this.#camera.removeEventListener("change", onChange);
    };
    this.#camera.addEventListener("change", onChange);
  }
}

/** The light's angles for somebody who stands where the camera does. */
function seenFrom({ current }, { azimuth, elevation }) {
  const [x, , z] = current ? sub(current.position, current.target) : [0, 0, 1];
  return { azimuth: azimuth - degrees(Math.atan2(x, z)), elevation };
}

function turned({ azimuth, elevation }, right, up) {
  const turn = (((azimuth + right + 180) % 360) + 360) % 360 - 180;
  return { azimuth: turn, elevation: clamp(elevation + up, -MAX_ELEVATION_DEG, MAX_ELEVATION_DEG) };
}

/** From where light comes that travels along `travel`: azimuth 0° from +z, 90° from +x; elevation 90° from above. */
function anglesOf([x, y, z]) {
  return {
    azimuth: degrees(Math.atan2(-x, -z)),
    elevation: degrees(Math.atan2(-y, Math.hypot(x, z))),
  };
}

function travelOf(angles) {
  return towardsLight(angles).map((part) => Number((-part).toFixed(DECIMALS)));
}

function towardsLight({ azimuth, elevation }) {
  const level = Math.cos(radians(elevation));
  return [
    Math.sin(radians(azimuth)) * level,
    Math.sin(radians(elevation)),
    Math.cos(radians(azimuth)) * level,
  ];
}

function ballElement(label) {
  const ball = element("div", {
    className: "ball", tabIndex: 0, role: "slider",
    title: "Drag to turn the light; arrow keys turn it by 5°, with Shift by 1°",
    "aria-label": `${label}: ball to turn with the arrow keys`, "aria-valuemin": -90, "aria-valuemax": 90,
  });
  ball.append(svg("svg", { viewBox: "-1.15 -1.15 2.3 2.3", "aria-hidden": "true" }, svg("circle", { r: 0.11 })));
  return ball;
}

/** Lit from where the light comes, which is a dot, hollow when it is behind. */
function paint(ball, angles) {
  const [x, y, z] = towardsLight(angles);
  const dot = ball.querySelector("circle");
  dot.setAttribute("cx", x.toFixed(3));
  dot.setAttribute("cy", (-y).toFixed(3));
  ball.classList.toggle("from-behind", z < 0);
  ball.style.setProperty("--light-x", `${(50 + 50 * x).toFixed(1)}%`);
  ball.style.setProperty("--light-y", `${(50 - 50 * y).toFixed(1)}%`);
  ball.setAttribute("aria-valuenow", Math.round(angles.elevation));
  ball.setAttribute("aria-valuetext", `light from ${describe(x, y, z)}`);
}

/** `12° above, 30° to the right, from behind`, as the camera sees it. */
function describe(x, y, z) {
  const size = (sine) => Math.round(degrees(Math.abs(Math.asin(sine))));
  const height = `${size(y)}° ${y < 0 ? "below" : "above"}`;
  const side = `${size(x)}° to the ${x < 0 ? "left" : "right"}`;
  return `${height}, ${side}, ${z < 0 ? "behind what one sees" : "before what one sees"}`;
}
