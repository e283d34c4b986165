// Files of the scene: names of what was uploaded, and ways to upload more.

import { attempt, field } from "../field.js";
import { ask, getJson, scenePath } from "../../server.js";
import { button, element } from "../../dom.js";
import { setAt } from "../edit.js";

/** What the server can read as an image. */
export const IMAGE_TYPES = ".png,.jpg,.jpeg,.webp,.bmp,.tga,.gif,.hdr";

/**
 * A field for the name of a file, which can be chosen from the user's disk or dropped here.
 *
 * @param {{accept: string}} words `accept` as of an input for files
 * @param {(name: string) => void} [write] in place of setting the value
 */
export function fileField(scene, pointer, words, write = (name) => setAt(scene, pointer, name)) {
  const take = ([file]) => attempt(made, () => uploadFor(scene, file, write));
  const name = element("output", { className: "file-name" });
  const chooser = fileChooser("Choose…", words.accept, take);
  chooser.setAttribute("aria-label", `${words.label}: choose a file`);
  const made = field(scene, pointer, words, {
    element: element("div", { className: "file" }, name, chooser),
    inputs: [chooser],
    show: (value) => { name.value = value ?? "none"; },
  });
  takesDrop(made, take);
  return made;
}

/** A button that lets the user choose files. */
export function fileChooser(label, accept, take, { multiple = false, ...properties } = {}) {
  const input = element("input", { type: "file", accept, multiple });
  input.addEventListener("change", () => {
    if (input.files.length > 0) take([...input.files]);
    input.value = "";
  });
  return button(label, () => input.click(), properties);
}

/** Files dropped on `target` are its own; the page leaves alone what is prevented. */
export function takesDrop(target, take) {
  const own = (event) => {
    if (!event.dataTransfer.types.includes("Files")) return;
    event.preventDefault();
    target.classList.toggle("file-over", event.type === "dragenter" || event.type === "dragover");
    if (event.type === "drop" && event.dataTransfer.files.length > 0) take([...event.dataTransfer.files]);
  };
  for (const type of ["dragenter", "dragover", "dragleave", "drop"]) target.addEventListener(type, own);
}

/**
 * Uploads a file and lets `use(name)` put its name into the document; answers what `use` does. If the document does
 * not come to have it, the file goes again.
 */
export async function uploadFor(scene, file, use) {
  const { id } = scene;
  const name = await upload(scene, file);
  const used = use(name);
  await scene.settled();
  const isUsed = JSON.stringify(scene.document).includes(JSON.stringify(name));
  if (scene.id === id && !isUsed) await ask(scenePath(id, "files", name), { method: "DELETE" });
  return used;
}

/** Puts a file into the scene, under a name that no other has, which it answers. */
export async function upload(scene, file) {
  const files = await getJson(scenePath(scene.id, "files"));
  const name = freshFileName(files.map((there) => there.name), file.name);
  await ask(scenePath(scene.id, "files", name), { method: "PUT", body: file });
  return name;
}

/** Names are looked up without regard to case where they are not found as they are. */
function freshFileName(taken, name) {
  const known = new Set(taken.map((there) => there.toLowerCase()));
  const [, stem, ending] = /^(.*?)(\.[^.]*)?$/s.exec(name);
  let fresh = name;
  for (let number = 2; known.has(fresh.toLowerCase()); number += 1) fresh = `${stem}-${number}${ending ?? ""}`;
  return fresh;
}
