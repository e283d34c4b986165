// A playground of passes: any stage of the pipeline on its own.

import { element } from "../dom.js";
import { note, panel } from "./parts.js";

/** Outputs of the live view, with what one sees and where in the pipeline it comes from. */
const STAGES = [
  ["color", "Colour",
    "The finished picture: what is left after shading, resolve and all post effects."],
  ["depth", "Depth",
    "How far away things are, near dark and far bright: what the raster stage compares to find the nearest triangle."],
  ["normal", "Normals",
    "Which way surfaces face, x, y and z as red, green and blue: what shading gets to work out how light falls on them."],
  ["albedo", "Albedo",
    "The surfaces' own colours with their maps: what shading begins with, before any light."],
  ["ids", "Instances",
    "A colour for each instance: what the raster stage has found to be in front at each pixel."],
  ["wireframe", "Wireframe",
    "The edges of the triangles in front: what the geometry stage hands to the raster stage."],
  ["shadow_map", "Shadow maps",
    "What each light sees, side by side, six for a lamp, bright near the light: drawn before everything else."],
  ["tiles", "Tiles",
    "How many triangles each tile lists: 1 dark blue, 4 green, 25 yellow, 160 red, 1024 white. How the geometry "
      + "stage shares out the work."],
  ["shaded", "Shaded fragments",
    "How many fragments are shaded for each pixel: 1 dark blue, 4 green, 8 yellow, 12 red, 16 white. Where shading "
      + "spends its time."],
];

/** A group of radio buttons that set what the live view shows. */
export function stagesPanel({ live }) {
  const options = STAGES.map(([output, label, text]) => option(live, output, label, text));
  const choices = element("div", { className: "stages", role: "radiogroup", "aria-label": "Stage shown" }, ...options);
  return panel("stages", "Stages", note("Any step of the pipeline on its own, live."), choices);
}

function option(live, output, label, text) {
  const id = `stage-${output}`;
  const radio = element("input", {
    type: "radio", name: "stage", id, value: output, checked: live.output === output, "aria-describedby": `${id}-text`,
  });
  radio.addEventListener("change", () => { live.output = output; });
  return element("div", { className: "stage" }, radio,
    element("label", { htmlFor: id }, label),
    element("p", { id: `${id}-text` }, text));
}
