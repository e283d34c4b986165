// The instances: meshes placed in the scene.

import { duplicateInstance, freeName } from "../actions.js";
import { button, element } from "../dom.js";
import { valueAt } from "../merge.js";
import { panel, row } from "./parts.js";
import { addEntry, setAt } from "./edit.js";
import { entryEditor, entryList, leadToggle, removeField } from "./entries.js";
import { rebuilt } from "./follow.js";
import { nameField } from "./fields/choice.js";
import { numberField } from "./fields/number.js";
import { toggleField } from "./fields/toggle.js";
import { vectorField } from "./fields/vector.js";
import { SHAPES } from "./words.js";

/** List, add, and the fields of the selected one. */
export function instancesPanel(app) {
  const { scene, selection } = app;
  const list = entryList(scene, "instances", selection, "Instances",
    (name) => leadToggle(scene, "instances", name, "visible", "Visible"));
  const keyOf = ({ scale, spin }) => [Array.isArray(scale), spin !== undefined];
  const editor = entryEditor(scene, "instances", selection, keyOf, (name, instance, pointer) => [
    element("h3", {}, name),
    nameField(scene, `${pointer}/mesh`, { label: "Mesh" }, "meshes"),
    nameField(scene, `${pointer}/material`, { label: "Material", none: "As the model has it" }, "materials"),
    ...placementFields(scene, pointer, instance),
    ...flagFields(scene, pointer),
    ...spinFields(scene, pointer, instance),
    row(
      button("Duplicate", () => duplicateInstance(app, name), { "data-action": "duplicate" }),
      removeField(scene, pointer, "Delete"),
    ),
  ]);
  return panel("instances", "Instances", list, adder(app), editor);
}

function placementFields(scene, pointer, { scale }) {
  const isPerAxis = Array.isArray(scale);
  const scaleField = isPerAxis ? vectorField : numberField;
  return [
    vectorField(scene, `${pointer}/translation`, { label: "Position", unit: "world units", step: 0.05 }),
    vectorField(scene, `${pointer}/rotation_deg`, {
      label: "Rotation", unit: "°", step: 1, hint: "About x, then y, then z",
    }),
    scaleField(scene, `${pointer}/scale`, { label: "Scale", step: 0.05 }),
    button(isPerAxis ? "Scale all axes alike" : "Scale each axis by itself",
      () => changeScaleAxes(scene, `${pointer}/scale`), { className: "link", "data-action": "scale-axes" }),
  ];
}

function changeScaleAxes(scene, pointer) {
  const scale = valueAt(scene.document, pointer);
  setAt(scene, pointer, Array.isArray(scale) ? scale[0] : [scale, scale, scale]);
}

function flagFields(scene, pointer) {
  return [
    toggleField(scene, `${pointer}/visible`, { label: "Visible" }),
    toggleField(scene, `${pointer}/casts_shadow`, { label: "Casts a shadow" }),
    toggleField(scene, `${pointer}/receives_shadow`, { label: "Shadows fall on it" }),
    toggleField(scene, `${pointer}/framed`, { label: "Automatic framing looks at it" }),
  ];
}

function spinFields(scene, pointer, { spin }) {
  if (spin === undefined) {
    const start = () => setAt(scene, `${pointer}/spin`, { axis: [0, 1, 0], deg_per_s: 45 });
    return [button("Let it spin", start, { className: "link", "data-action": "spin" })];
  }
  return [
    vectorField(scene, `${pointer}/spin/axis`, { label: "Spin about", hint: "Axis in the instance's own space" }),
    numberField(scene, `${pointer}/spin/deg_per_s`, { label: "Spin speed", unit: "°/s", step: 1, range: [-180, 180] }),
    button("Stop spinning", () => setAt(scene, `${pointer}/spin`, null), { className: "link", "data-action": "spin" }),
  ];
}

/** Adds an instance of a mesh; a built-in shape becomes a mesh in the same step. */
function adder(app) {
  const { scene, selection } = app;
  const select = element("select", { id: "add-instance-mesh", "aria-label": "What to add" });
  const shapes = optionGroup("Shapes", SHAPES.map(([type, label]) => [`shape ${type}`, label]));
  rebuilt(scene, select, (document) => Object.keys(document.meshes), (document) => {
    const meshes = Object.keys(document.meshes).map((name) => [`mesh ${name}`, name]);
    return [shapes, optionGroup("Meshes of the scene", meshes)];
  });
  const add = button("Add", () => {
    const [, kind, name] = /^(shape|mesh) (.*)$/s.exec(select.value);
    selection.select(kind === "shape" ? addShape(app, name) : addInstance(app, name));
  }, { id: "add-instance" });
  return row(select, add);
}

function optionGroup(label, options) {
  return element("optgroup", { label }, ...options.map(([value, text]) => element("option", { value }, text)));
}

function addInstance(app, mesh) {
  return addEntry(app.scene, "instances", mesh, placed(app, mesh));
}

function addShape(app, type) {
  const { meshes, instances } = app.scene.document;
  const mesh = freeName(type, meshes);
  const name = freeName(type, instances);
  app.scene.edit({ meshes: { [mesh]: { type } }, instances: { [name]: placed(app, mesh) } });
  return name;
}

/** Where the camera looks, so that one sees it. The defaults are for its fields, until the server has answered. */
function placed({ camera }, mesh) {
  return {
    mesh, translation: camera.current?.target ?? [0, 0, 0], rotation_deg: [0, 0, 0], scale: 1,
    visible: true, framed: true, casts_shadow: true, receives_shadow: true,
  };
}
