// What the view may cost or err by, and which settings the server chooses for that.

import { element } from "../dom.js";
import { ask } from "../server.js";
import { plainField } from "./field.js";
import { choiceControl } from "./fields/choice.js";
import { NumberControl } from "./fields/number.js";
import { group } from "./parts.js";

/** Presets and limits of the frame query. */
const KINDS = [
  ["scene", "As the scene says"],
  ["draft", "Draft"],
  ["normal", "Normal"],
  ["high", "High"],
  ["reference", "Reference"],
  ["max_ms", "At most so many ms"],
  ["max_error", "At most such an error"],
];

/** What a limit begins with, and the words of its field. */
const LIMITS = {
  max_ms: {
    first: 16,
    words: { label: "Time", unit: "ms", step: 1, min: 1, hint: "From the request of a frame to its last pixel, encoded" },
  },
  max_error: {
    first: 0.01,
    words: {
      label: "Error", unit: "RMSE", step: 0.001, min: 0.0001,
      hint: "Root mean square error of linear light in 0–1; 0.004 is 1/255",
    },
  },
};

const HINT = "Chooses samples, shadows and filters of the view, and of what is saved from it. The scene stays as it is";

/** A choice of what the view may cost, a field for the limit if there is one, and what comes of it. */
export function budgetGroup({ live, plan }) {
  const control = choiceControl(() => KINDS, (kind) => choose(kind));
  control.show("scene");
  const limits = Object.fromEntries(Object.entries(LIMITS).map((entry) => [entry[0], limitField(live, ...entry)]));
  const settled = element("p", { className: "note", id: "settled", role: "status" });
  const choose = (kind) => {
    for (const [name, { box }] of Object.entries(limits)) box.hidden = name !== kind;
    live.budget = limits[kind]?.budget() ?? presetOf(kind);
    settled.textContent = "";
  };
  choose("scene");
  plan.addEventListener("change", () => tellSettled(live, settled));
  const quality = plainField({ label: "Quality", hint: HINT }, control);
  quality.id = "quality";
  return group("View", quality, ...Object.values(limits).map(({ box }) => box), settled);
}

const presetOf = (kind) => (kind === "scene" ? null : { preset: kind });

/** The field of a limit, and the budget that it stands for. */
function limitField(live, name, { first, words }) {
  let limit = first;
  const budget = () => ({ [name]: limit });
  const control = new NumberControl(words, (value) => {
    limit = value;
    live.budget = budget();
  });
  control.show(first);
  const box = plainField(words, control);
  box.id = `limit-${name}`;
  return { box, budget };
}

/** Says in `line` what the server has made of the budget. */
async function tellSettled(live, line) {
  const { budget } = live;
  const settings = budget && await settingsOf(live);
  if (budget === live.budget) line.textContent = settings ? inWords(settings, budget) : "";
}

/** The `Render-Settings` of the view, if there are any: what fails here fails for the stream as well, which tells. */
async function settingsOf(live) {
  // One who has the picture, whichever it is, gets none, but all that is said of it.
  const response = await ask(live.path("frame.png"), { headers: { "If-None-Match": "*" } }).catch(() => null);
  return response?.headers.get("Render-Settings");
}

/** A `Render-Settings` header for people, and whether it keeps to the budget; a preset asks for no numbers. */
function inWords(header, { max_ms: mostMs = Infinity, max_error: mostError = Infinity }) {
  const { error, ms, source, ...settings } = Object.fromEntries(header.split(", ").map((pair) => pair.split("=")));
  const verdict = ms > mostMs || error > mostError ? "Nothing keeps to that; this comes nearest: " : "";
  const basis = source === "measured" ? "as measured on this scene" : "estimated; “Error and time” measures it";
  return `${verdict}${Object.entries(settings).map(settingInWords).filter(Boolean).join(", ")}. `
    + `About ${short(ms)} ms a frame and an error of ${short(error)}, ${basis}.`;
}

const WORDS = {
  samples: (count) => (count === "1" ? "1 sample a pixel" : `${count} samples a pixel`),
  shadow_resolution: (side) => `shadow maps of ${side} px`,
  pcf_taps: (taps) => `${taps} PCF taps`,
  search_taps: (taps) => `${taps} search taps`,
  filter_taps: (taps) => `${taps} filter taps`,
  texture_filter: (filter) => `${filter} textures`,
  render_scale: (scale) => (scale === "1" ? "" : `drawn at ${short(100 * scale)} % of the size`),
};

const settingInWords = ([name, value]) => WORDS[name]?.(value) ?? `${name} ${value}`;

const short = (number) => String(Number(Number(number).toPrecision(3)));
