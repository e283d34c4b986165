// Maps of a material: a texture by its name, or an image that becomes one.

import { freeName } from "../../actions.js";
import { attempt, field } from "../field.js";
import { patchAt } from "../../merge.js";
import { element } from "../../dom.js";
import { setAt } from "../edit.js";
import { nameControl } from "./choice.js";
import { IMAGE_TYPES, fileChooser, takesDrop, uploadFor } from "./file.js";

/** A field for the name of a texture. An image chosen or dropped here is uploaded, becomes a texture, and is set. */
export function mapField(scene, pointer, words) {
  const names = nameControl({ none: "none" }, "textures", (name) => setAt(scene, pointer, name));
  const take = ([file]) => attempt(made, () => addTexture(scene, file, (name) => patchAt(pointer, name)));
  const chooser = fileChooser("Image…", IMAGE_TYPES, take);
  chooser.setAttribute("aria-label", `${words.label}: choose an image`);
  const made = field(scene, pointer, words, {
    ...names,
    element: element("div", { className: "file" }, names.element, chooser),
  });
  takesDrop(made, take);
  return made;
}

/** Makes a texture of an image, in one change with the patch that `use(name)` gives. Answers its name. */
export function addTexture(scene, image, use = () => ({})) {
  return uploadFor(scene, image, (file) => {
    const name = freeName(file.replace(/\.[^.]*$/, ""), scene.document.textures);
    scene.edit({ ...use(name), textures: { [name]: { file, filter: "trilinear", wrap: "repeat" } } });
    return name;
  });
}
