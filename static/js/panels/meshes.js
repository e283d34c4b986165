// The meshes: shapes and models that instances place in the scene.

import { element } from "../dom.js";
import { Chosen } from "./chosen.js";
import { entryEditor, entryList, removeField } from "./entries.js";
import { fileField } from "./fields/file.js";
import { numberField } from "./fields/number.js";
import { vectorField } from "./fields/vector.js";
import { note, panel } from "./parts.js";

const LENGTH = { step: 0.05, min: 0, unit: "world units" };
const count = (label, min, max = 2048) => ({ label, step: 1, min, max });

/** The fields of each type of mesh: member, kind of field, words. */
const FIELDS = {
  box: [["size", vectorField, { label: "Size", ...LENGTH }]],
  plane: [
    ["size", vectorField, { label: "Size", axes: ["x", "z"], ...LENGTH }],
    ["uv_repeat", vectorField, { label: "Texture repeats", axes: ["x", "z"], step: 1 }],
  ],
  sphere: [
    ["radius", numberField, { label: "Radius", ...LENGTH }],
    ["segments", numberField, count("Segments around", 3)],
    ["rings", numberField, count("Rings from pole to pole", 2)],
  ],
  torus: [
    ["radius", numberField, { label: "Radius", hint: "From the axis to the tube's centre", ...LENGTH }],
    ["tube", numberField, { label: "Tube radius", ...LENGTH }],
    ["segments", numberField, count("Segments around", 3)],
    ["sides", numberField, count("Sides of the tube", 3)],
  ],
  cylinder: [
    ["radius", numberField, { label: "Radius", ...LENGTH }],
    ["height", numberField, { label: "Height", ...LENGTH }],
    ["segments", numberField, count("Segments around", 3)],
  ],
  cone: [
    ["radius", numberField, { label: "Radius at the base", ...LENGTH }],
    ["height", numberField, { label: "Height", ...LENGTH }],
    ["segments", numberField, count("Segments around", 3)],
  ],
  teapot: [
    ["height", numberField, { label: "Height", ...LENGTH }],
    ["segments", numberField, count("Segments a patch", 1, 256)],
  ],
  obj: [["file", fileField, { label: "File", accept: ".obj" }]],
  triangles: [],
};

/** List, and the measures of the chosen one. It follows the selected instance. */
export function meshesPanel({ scene, selection }) {
  const chosen = new Chosen(scene, "meshes");
  selection.addEventListener("change", () => {
    const { mesh } = scene.document.instances[selection.name] ?? {};
    if (mesh) chosen.select(mesh);
  });
  const editor = entryEditor(scene, "meshes", chosen, ({ type }) => type, (name, mesh, pointer) => [
    element("h3", {}, name),
    note(describe(mesh)),
    ...FIELDS[mesh.type].map(([member, kind, words]) => kind(scene, `${pointer}/${member}`, words)),
    removeField(scene, pointer, "Delete"),
  ]);
  return panel("meshes", "Meshes", entryList(scene, "meshes", chosen, "Meshes"), editor);
}

function describe({ type, positions, indices }) {
  if (type === "obj") return "A model from a file.";
  if (type !== "triangles") return `A built-in shape: ${type}.`;
  return `${(indices?.length ?? positions.length / 3).toLocaleString()} triangles written out in the document.`;
}
