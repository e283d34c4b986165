// Shadows: whether there are any, and how each light's are drawn.

import { button, element } from "../dom.js";
import { panel } from "./parts.js";
import { entryEditor } from "./entries.js";
import { choiceField } from "./fields/choice.js";
import { numberField } from "./fields/number.js";
import { toggleField } from "./fields/toggle.js";
import { follow } from "./follow.js";

const FILTERS = [["none", "None"], ["hard", "Hard"], ["pcf", "Even edge (PCF)"], ["pcss", "Soft (PCSS)"]];
const SHORT_FILTERS = [["none", "None"], ["hard", "Hard"], ["pcf", "PCF"], ["pcss", "PCSS"]];
const CULLS = [["none", "All faces"], ["front", "All but front faces"], ["back", "All but back faces"]];

const HALF_ANGLE = "Tangent of half the angle under which it is seen; the sun: 0.0047";

/** The switch for all, a shortcut for all lights, and the fields of the light that is chosen in the lights panel. */
export function shadowPanel({ scene }, chosen) {
  const keyOf = ({ type, shadow }) => [type, shadow?.filter];
  const editor = entryEditor(scene, "lights", chosen, keyOf, (name, light, pointer) => [
    choiceField(scene, `${pointer}/shadow/filter`, { label: "Shadow", fallback: "none" }, FILTERS),
    ...shadowFields(scene, `${pointer}/shadow`, light),
    button("Use these settings for all lights", () => copyToAll(scene, name), { "data-action": "copy-shadow" }),
  ]);
  return panel("shadow", "Shadow",
    toggleField(scene, "/render/shadows", { label: "Draw shadows" }),
    allLights(scene),
    lightChoice(scene, chosen),
    editor);
}

function allLights(scene) {
  const buttons = SHORT_FILTERS.map(([filter, label]) =>
    button(label, () => setForAll(scene, filter), { "data-filter": filter, "aria-label": `All lights: ${label}` }));
  const line = element("div", {
    className: "segments", role: "group", "aria-label": "Shadows of all lights",
  }, ...buttons);
  follow(scene, line, ({ lights }) => {
    for (const each of buttons) {
      const isOfAll = Object.values(lights).every(({ shadow }) => (shadow?.filter ?? "none") === each.dataset.filter);
      each.setAttribute("aria-pressed", String(isOfAll));
    }
  });
  return element("div", { className: "field" }, element("span", { className: "label" }, "All lights"), line);
}

/** Each keeps its other settings. A light without a shadow needs none that draws nothing. */
function setForAll(scene, filter) {
  const { lights } = scene.document;
  const changed = Object.entries(lights).filter(([, { shadow }]) => shadow !== undefined || filter !== "none");
  scene.edit({ lights: Object.fromEntries(changed.map(([name]) => [name, { shadow: { filter } }])) });
}

function copyToAll(scene, name) {
  const { lights } = scene.document;
  const { shadow } = lights[name];
  const settings = shadow === undefined ? null : { search_radius: null, ...shadow };
  scene.edit({ lights: Object.fromEntries(Object.keys(lights).map((other) => [other, { shadow: settings }])) });
}

/** Which light the fields beneath are about. */
function lightChoice(scene, chosen) {
  const select = element("select", { id: "shadow-light" });
  const update = () => {
    const names = Object.keys(scene.document.lights);
    select.replaceChildren(...names.map((name) => element("option", { value: name }, name)));
    select.value = chosen.name ?? "";
  };
  select.addEventListener("change", () => chosen.select(select.value));
  chosen.addEventListener("change", update);
  follow(scene, select, update);
  const label = element("label", { className: "label", htmlFor: select.id }, "Light");
  return element("div", { className: "field" }, label, select);
}

function shadowFields(scene, at, { type, shadow }) {
  const byFilter = { hard: [], pcf: pcfFields(scene, at), pcss: pcssFields(scene, at, type) };
  const own = byFilter[shadow?.filter];
  return own ? [...own, ...mapFields(scene, at, type)] : [];
}

function pcfFields(scene, at) {
  return [
    numberField(scene, `${at}/radius`, {
      label: "Radius", unit: "texels", step: 0.1, min: 0, max: 1024, range: [0, 8],
      hint: "Of the filter: how wide the even edge is",
    }),
    tapsField(scene, `${at}/pcf_taps`, "Samples to filter"),
  ];
}

function tapsField(scene, at, label) {
  return numberField(scene, at, { label, step: 1, min: 1, max: 1024 });
}

function pcssFields(scene, at, type) {
  const size = type === "point"
    ? { label: "Size of the light", unit: "world units", range: [0, 0.5], hint: "Its radius" }
    : { label: "Size of the light", unit: "tangent", range: [0, 0.2], hint: HALF_ANGLE };
  return [
    numberField(scene, `${at}/light_radius`, { ...size, step: 0.001, min: 0 }),
    numberField(scene, `${at}/search_radius`, {
      label: "Search radius", unit: "texels", absent: "from the size", step: 1, min: 0, max: 1024,
      hint: "How far blockers are looked for",
    }),
    tapsField(scene, `${at}/search_taps`, "Samples to find blockers"),
    tapsField(scene, `${at}/filter_taps`, "Samples to filter"),
  ];
}

function mapFields(scene, at, type) {
  return [
    numberField(scene, `${at}/resolution`, {
      label: "Resolution", unit: type === "point" ? "texels a side of each of 6 faces" : "texels a side",
      step: 128, min: 1, max: 16384,
    }),
    numberField(scene, `${at}/bias`, {
      label: "Offset", unit: "× just enough", step: 0.1, min: 0, max: 1000, range: [0, 10],
      hint: "Bias against surfaces shading themselves, as a multiple of the offset that is just enough",
    }),
    choiceField(scene, `${at}/cull`, { label: "What casts" }, CULLS),
  ];
}
