// The materials: how surfaces answer to light.

import { button, element } from "../dom.js";
import { group, panel, row } from "./parts.js";
import { Chosen } from "./chosen.js";
import { addEntry } from "./edit.js";
import { entryEditor, entryList, removeField } from "./entries.js";
import { choiceField } from "./fields/choice.js";
import { colorField } from "./fields/color.js";
import { mapField } from "./fields/map.js";
import { numberField } from "./fields/number.js";
import { hexFromLinear, linearOf } from "./fields/srgb.js";
import { toggleField } from "./fields/toggle.js";
import { SHADINGS } from "./words.js";

/** What a new material is; the server's defaults, so that its fields show them at once. */
const NEW_MATERIAL = {
  shading: "blinn_phong", diffuse: [0.8, 0.8, 0.8], specular: [0, 0, 0], shininess: 32, emissive: [0, 0, 0],
  opacity: 1, double_sided: false, bump_scale: 0.02,
};

/** List, add, and the fields of the chosen one. It follows the selected instance. */
export function materialsPanel({ scene, selection }) {
  const chosen = new Chosen(scene, "materials");
  selection.addEventListener("change", () => {
    const { material } = scene.document.instances[selection.name] ?? {};
    if (material) chosen.select(material);
  });
  const add = (base, material) => chosen.select(addEntry(scene, "materials", base, material));
  const editor = entryEditor(scene, "materials", chosen, () => null, (name, _, pointer) => [
    element("h3", {}, name),
    ...surfaceFields(scene, pointer),
    group("Maps", ...mapFields(scene, pointer)),
    group("Transparency", ...transparencyFields(scene, pointer)),
    row(
      button("Duplicate", () => add(name, scene.document.materials[name]), { "data-action": "duplicate" }),
      removeField(scene, pointer, "Delete"),
    ),
  ]);
  return panel("materials", "Materials",
    entryList(scene, "materials", chosen, "Materials", swatchRow),
    row(button("Add a material", () => add("material", NEW_MATERIAL), { id: "add-material" })),
    editor);
}

/** The diffuse colour before the name. */
function swatchRow() {
  const lead = element("span", { className: "swatch", "aria-hidden": "true" });
  return { lead, show: ({ diffuse }) => { lead.style.background = hexFromLinear(linearOf(diffuse)); } };
}

function surfaceFields(scene, pointer) {
  return [
    choiceField(scene, `${pointer}/shading`, { label: "Shading" }, SHADINGS),
    colorField(scene, `${pointer}/diffuse`, {
      label: "Diffuse", hint: "Light scattered evenly: the surface's own colour",
    }),
    colorField(scene, `${pointer}/specular`, { label: "Specular", hint: "Light mirrored: the colour of highlights" }),
    numberField(scene, `${pointer}/shininess`, {
      label: "Shininess", step: 1, min: 0, range: [0, 256], hint: "Higher makes highlights smaller and sharper",
    }),
    colorField(scene, `${pointer}/ambient`, {
      label: "Ambient", absent: "as diffuse",
      hint: "What it makes of the light from everywhere; empty: the diffuse colour with its map",
    }),
    colorField(scene, `${pointer}/emissive`, { label: "Emissive", hint: "Light it gives off itself" }),
  ];
}

function mapFields(scene, pointer) {
  return [
    mapField(scene, `${pointer}/diffuse_map`, { label: "Diffuse map" }),
    mapField(scene, `${pointer}/specular_map`, { label: "Specular map" }),
    mapField(scene, `${pointer}/emissive_map`, { label: "Emissive map" }),
    mapField(scene, `${pointer}/normal_map`, {
      label: "Normal map", hint: "Tangent-space normals: red along u, green along v",
    }),
    mapField(scene, `${pointer}/bump_map`, { label: "Bump map", hint: "Heights, from black to white" }),
    numberField(scene, `${pointer}/bump_scale`, {
      label: "Bump height", unit: "world units", step: 0.005, range: [0, 0.2],
      hint: "Height where the bump map is white",
    }),
    mapField(scene, `${pointer}/opacity_map`, { label: "Opacity map" }),
  ];
}

function transparencyFields(scene, pointer) {
  return [
    numberField(scene, `${pointer}/opacity`, { label: "Opacity", step: 0.01, min: 0, max: 1, range: [0, 1] }),
    numberField(scene, `${pointer}/alpha_cutoff`, {
      label: "Alpha cut-off", absent: "none", step: 0.05, min: 0, max: 1,
      hint: "Below this opacity nothing is drawn, above it everything is opaque; empty: surfaces blend",
    }),
    toggleField(scene, `${pointer}/double_sided`, { label: "Seen from both sides" }),
  ];
}
