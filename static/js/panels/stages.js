// A playground of passes: any stage of the pipeline on its own.

import { element } from "../dom.js";
import { note, panel } from "./parts.js";

/** Outputs of the live view, with what one sees and where in the pipeline it comes from. */
const STAGES = [
  ["color", "Colour", "The finished picture, after shading, resolve and all post effects."],
  ["depth", "Depth", "How far away each pixel's surface is, near dark and far bright: what the raster stage keeps to decide which triangle is in front."],
  ["normal", "Normals", "Which way each surface faces, x, y and z as red, green and blue: interpolated by the raster stage, bent by normal and bump maps."],
  ["albedo", "Albedo", "The surfaces' own colours with their maps, before any light falls on them: the first thing shading looks up."],
  ["ids", "Instances", "Each instance in a colour of its own, as the raster stage tells them apart."],
  ["wireframe", "Wireframe", "The edges of the triangles in front: what the geometry stage hands on."],
  ["shadow_map", "Shadow map", "The scene as the first light with a shadow sees it, near dark and far bright: drawn before everything else."],
  ["tiles", "Tiles", "The screen in tiles, brighter where more triangles fall: how the work is shared out before the raster stage."],
  ["shaded", "Shaded samples", "How often each pixel is shaded: brighter along edges, where several triangles meet in one pixel."],
];

/** A group of radio buttons that set what the live view shows. */
export function stagesPanel({ live }) {
  const options = STAGES.map(([output, label, text]) => option(live, output, label, text));
  const choices = element("div", { className: "stages", role: "radiogroup", "aria-label": "Stage shown" }, ...options);
  return panel("stages", "Stages", note("Any step of the pipeline on its own, live."), choices);
}

function option(live, output, label, text) {
  const id = `stage-${output}`;
  const radio = element("input", { type: "radio", name: "stage", id, value: output, checked: live.output === output, "aria-describedby": `${id}-text` });
  radio.addEventListener("change", () => { live.output = output; });
  return element("div", { className: "stage" }, radio,
    element("label", { htmlFor: id }, label),
    element("p", { id: `${id}-text` }, text));
}
