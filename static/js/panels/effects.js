// The effects of post-processing: what people call them, what they begin as, and their fields.

import { valueAt } from "../merge.js";
import { button, element } from "../dom.js";
import { setAt } from "./edit.js";
import { choiceField } from "./fields/choice.js";
import { gridField } from "./fields/grid.js";
import { numberField } from "./fields/number.js";

const OPERATORS = [["aces", "ACES"], ["reinhard", "Reinhard"], ["none", "None"]];
const amount = (label) => ({ label, step: 0.01, min: 0, max: 1, range: [0, 1] });
const RADIUS = { label: "Radius", unit: "px", step: 0.5, min: 0, max: 256, range: [0, 32] };
const KERNEL_SIDES = [3, 5, 7];

/** By type: label, first values, and the fields at a pointer. */
export const EFFECTS = {
  tonemap: {
    label: "Tone mapping",
    hint: "Brings what is brighter than the screen into its range",
    first: { operator: "aces", exposure: 1 },
    fields: (scene, at) => [
      choiceField(scene, `${at}/operator`, { label: "Curve" }, OPERATORS),
      numberField(scene, `${at}/exposure`, { label: "Exposure", step: 0.05, min: 0, range: [0, 4] }),
    ],
  },
  blur: {
    label: "Blur",
    first: { radius: 4 },
    fields: (scene, at) => [numberField(scene, `${at}/radius`, RADIUS)],
  },
  bloom: {
    label: "Bloom",
    hint: "What is bright glows",
    first: { threshold: 1, intensity: 0.2, radius: 8 },
    fields: (scene, at) => [
      numberField(scene, `${at}/threshold`, {
        label: "Glows from", unit: "brightness", step: 0.05, min: 0, range: [0, 4],
      }),
      numberField(scene, `${at}/intensity`, { label: "Intensity", step: 0.05, min: 0, range: [0, 2] }),
      numberField(scene, `${at}/radius`, RADIUS),
    ],
  },
  sharpen: {
    label: "Sharpen",
    first: { amount: 0.5 },
    fields: (scene, at) => [numberField(scene, `${at}/amount`, { label: "Amount", step: 0.05, min: 0, range: [0, 3] })],
  },
  grayscale: {
    label: "Greys",
    first: { amount: 1 },
    fields: (scene, at) => [numberField(scene, `${at}/amount`, amount("Amount"))],
  },
  vignette: {
    label: "Vignette",
    hint: "Darker corners",
    first: { amount: 0.5 },
    fields: (scene, at) => [numberField(scene, `${at}/amount`, amount("Amount"))],
  },
  fxaa: {
    label: "FXAA",
    hint: "Smooths edges in the finished picture",
    first: {},
    fields: () => [],
  },
  color_matrix: {
    label: "Colour matrix",
    hint: "Each channel as a mix of the three, and a number added; begins as sepia",
    first: { matrix: [[0.393, 0.769, 0.189, 0], [0.349, 0.686, 0.168, 0], [0.272, 0.534, 0.131, 0]] },
    fields: (scene, at) => [
      gridField(scene, `${at}/matrix`, { label: "Red, green, blue; added" },
        ["red out", "green out", "blue out"], ["red in", "green in", "blue in", "added"]),
    ],
  },
  kernel: {
    label: "Kernel",
    hint: "Each pixel as a sum of its neighbours with weights; begins as an edge finder",
    first: { kernel: [[-1, -1, -1], [-1, 8, -1], [-1, -1, -1]] },
    fields: kernelFields,
  },
};

function kernelFields(scene, at, { kernel }) {
  const resize = (side) => setAt(scene, `${at}/kernel`, resized(valueAt(scene.document, `${at}/kernel`), side));
  const sizes = KERNEL_SIDES.map((side) =>
    button(`${side} × ${side}`, () => resize(side), { "aria-pressed": String(side === kernel.length) }));
  return [
    element("div", { className: "segments", role: "group", "aria-label": "Size of the kernel" }, ...sizes),
    gridField(scene, `${at}/kernel`, { label: "Weights" }, numbered("row", kernel), numbered("column", kernel)),
  ];
}

const numbered = (word, lines) => lines.map((_, i) => `${word} ${i + 1}`);

/** The same weights about the centre. */
function resized(kernel, side) {
  const shift = (kernel.length - side) / 2;
  const steps = Array.from({ length: side }, (_, i) => i + shift);
  return steps.map((y) => steps.map((x) => kernel[y]?.[x] ?? 0));
}
