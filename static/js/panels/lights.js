// The lights.

import { field } from "./field.js";
import { button, element } from "../dom.js";
import { panel, row } from "./parts.js";
import { addEntry } from "./edit.js";
import { entryEditor, entryList, leadToggle, removeField } from "./entries.js";
import { colorField } from "./fields/color.js";
import { directionField } from "./fields/direction.js";
import { numberField } from "./fields/number.js";
import { toggleField } from "./fields/toggle.js";
import { vectorField } from "./fields/vector.js";

/** New lights, with the defaults that their fields show. */
const SHINING = { enabled: true, color: "#ffffff", intensity: 1 };
const NEW_SUN = { type: "directional", direction: [-0.5, -1, -0.3], ...SHINING };
const NEW_LAMP = { type: "point", attenuation: { constant: 1, linear: 0, quadratic: 1 }, ...SHINING };
/** Above what the camera looks at, so that it lights something one sees. */
const LAMP_HEIGHT = 1.5;

/** List with switches, add, and the fields of the chosen one, which the shadow panel is about as well. */
export function lightsPanel({ scene, camera }, chosen) {
  const add = (base, light) => chosen.select(addEntry(scene, "lights", base, light));
  const list = entryList(scene, "lights", chosen, "Lights",
    (name) => leadToggle(scene, "lights", name, "enabled", "On"));
  const editor = entryEditor(scene, "lights", chosen, ({ type }) => type, (name, { type }, pointer) => [
    element("h3", {}, name),
    toggleField(scene, `${pointer}/enabled`, { label: "On" }),
    type === "point" ? positionField(scene, pointer) : sunField(scene, pointer, camera),
    colorField(scene, `${pointer}/color`, { label: "Colour" }),
    numberField(scene, `${pointer}/intensity`, { label: "Intensity", step: 0.05, min: 0, range: [0, 10] }),
    ...(type === "point" ? [attenuationField(scene, pointer)] : []),
    removeField(scene, pointer, "Delete"),
  ]);
  return panel("lights", "Lights", list,
    row(
      button("Add a sun", () => add("sun", NEW_SUN), {
        id: "add-directional-light", title: "A directional light: from infinitely far",
      }),
      button("Add a lamp", () => add("lamp", { ...NEW_LAMP, position: above(camera) }), {
        id: "add-point-light", title: "A point light",
      }),
    ),
    editor);
}

function above(camera) {
  const [x, y, z] = camera.current?.target ?? [0, 0, 0];
  return [x, y + LAMP_HEIGHT, z];
}

function sunField(scene, pointer, camera) {
  const words = { label: "Direction", hint: "The way its light travels" };
  return directionField(scene, `${pointer}/direction`, words, camera);
}

function positionField(scene, pointer) {
  return vectorField(scene, `${pointer}/position`, { label: "Position", unit: "world units", step: 0.05 });
}

/** How the light fades with the distance d: 1 / (constant + linear·d + quadratic·d²). */
function attenuationField(scene, pointer) {
  const at = `${pointer}/attenuation`;
  const part = (member, label) => numberField(scene, `${at}/${member}`, { label, step: 0.05, min: 0 });
  const words = { label: "Fading with distance", hint: "Divided by constant + linear · d + quadratic · d²" };
  const parts = [part("constant", "Constant"), part("linear", "Linear"), part("quadratic", "Quadratic")];
  const columns = element("div", { className: "columns" }, ...parts);
  return field(scene, at, words, { element: columns, inputs: [], show: () => {} });
}
