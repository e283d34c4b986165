// Maps of a material: a texture by its name, or an image that becomes one.

import { attempt, field } from "../../fields.js";
import { element } from "../../dom.js";
import { addEntry, setAt } from "../edit.js";
import { nameControl } from "./choice.js";
import { IMAGE_TYPES, fileChooser, takesDrop, upload } from "./file.js";

/** A field for the name of a texture. An image chosen or dropped here is uploaded, becomes a texture, and is set. */
export function mapField(scene, pointer, words) {
  const names = nameControl({ none: "none" }, "textures", (name) => setAt(scene, pointer, name));
  const take = ([file]) => attempt(made, async () => setAt(scene, pointer, await addTexture(scene, file)));
  const chooser = fileChooser("Image…", IMAGE_TYPES, take);
  chooser.setAttribute("aria-label", `${words.label}: choose an image`);
  const made = field(scene, pointer, words, {
    ...names,
    element: element("div", { className: "file" }, names.element, chooser),
  });
  takesDrop(made, take);
  return made;
}

/** Uploads an image and makes a texture of it, whose name it answers. */
export async function addTexture(scene, image) {
  const file = await upload(scene, image);
  return addEntry(scene, "textures", file.replace(/\.[^.]*$/, ""), { file, filter: "trilinear", wrap: "repeat" });
}
