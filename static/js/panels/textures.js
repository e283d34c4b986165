// The textures: images and checkers that materials map onto surfaces.

import { button, element } from "../dom.js";
import { panel, row } from "./parts.js";
import { tried } from "../tried.js";
import { Chosen } from "./chosen.js";
import { addEntry } from "./edit.js";
import { entryEditor, entryList, removeField } from "./entries.js";
import { choiceField } from "./fields/choice.js";
import { colorField } from "./fields/color.js";
import { IMAGE_TYPES, fileChooser, fileField } from "./fields/file.js";
import { addTexture } from "./fields/map.js";
import { numberField } from "./fields/number.js";

const FILTERS = [["nearest", "Nearest texel"], ["bilinear", "Bilinear"], ["trilinear", "Trilinear"]];
const WRAPS = [["repeat", "Repeats"], ["mirror", "Repeats mirrored"], ["clamp", "Its border goes on"]];
const COLOR_SPACES = [[null, "By use"], ["srgb", "sRGB (colours)"], ["linear", "Linear (data)"]];
const NEW_CHECKER = { checker: { colors: ["#888888", "#eeeeee"], cells: 8 }, filter: "trilinear", wrap: "repeat" };

/** List, add, and the fields of the chosen one. */
export function texturesPanel({ scene, notices }) {
  const chosen = new Chosen(scene, "textures");
  const addImage = ([file]) =>
    tried(notices, "The image could not be added", async () => chosen.select(await addTexture(scene, file)));
  const addChecker = () => chosen.select(addEntry(scene, "textures", "checker", NEW_CHECKER));
  const editor = entryEditor(scene, "textures", chosen, ({ file }) => file !== undefined, (name, texture, pointer) => [
    element("h3", {}, name),
    ...(texture.file === undefined ? checkerFields : imageFields)(scene, pointer),
    choiceField(scene, `${pointer}/filter`, {
      label: "Filter", hint: "How it is read between texels and from afar",
    }, FILTERS),
    choiceField(scene, `${pointer}/wrap`, { label: "Beyond its edges" }, WRAPS),
    choiceField(scene, `${pointer}/color_space`, {
      label: "Colour space", hint: "By use: linear for normal, bump and opacity maps, else sRGB",
    }, COLOR_SPACES),
    removeField(scene, pointer, "Delete"),
  ]);
  return panel("textures", "Textures",
    entryList(scene, "textures", chosen, "Textures"),
    row(
      fileChooser("Add an image…", IMAGE_TYPES, addImage, { id: "add-image" }),
      button("Add a checker", addChecker, { id: "add-checker" }),
    ),
    editor);
}

function imageFields(scene, pointer) {
  return [fileField(scene, `${pointer}/file`, { label: "Image", accept: IMAGE_TYPES })];
}

function checkerFields(scene, pointer) {
  return [
    colorField(scene, `${pointer}/checker/colors/0`, { label: "First colour" }),
    colorField(scene, `${pointer}/checker/colors/1`, { label: "Second colour" }),
    numberField(scene, `${pointer}/checker/cells`, { label: "Cells along a side", step: 1, min: 1, max: 2048 }),
  ];
}
