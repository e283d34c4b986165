// Files and folders from outside: models into the open scene, documents as scenes of their own.

import { openScene } from "./address.js";
import { freeName, frameInstance } from "./actions.js";
import { Problem, ask, getJson, scenePath } from "./server.js";

/** What the server can read. */
const KNOWN = ["obj", "mtl", "json", "png", "jpg", "jpeg", "webp", "bmp", "tga", "gif", "hdr"];

const extensionOf = ({ name }) => /\.([^.]+)$/.exec(name)?.[1].toLowerCase() ?? "";
const stemOf = (name) => name.replace(/\.[^.]*$/, "");
const named = (files) => (files.length === 1 ? files[0].name : `${files.length} files`);
const isCarried = (event) => event.dataTransfer?.types.includes("Files");

/** Takes files that are dropped anywhere, unless a field has taken them. */
export function takeDrops(app, hint) {
  document.addEventListener("dragover", (event) => {
    if (!isCarried(event) || event.defaultPrevented) return;
    event.preventDefault();
    hint.hidden = false;
  });
  document.addEventListener("dragleave", (event) => { if (!event.relatedTarget) hint.hidden = true; });
  // At the window, so that fields come first.
  window.addEventListener("drop", async (event) => {
    hint.hidden = true;
    if (!isCarried(event) || event.defaultPrevented) return;
    event.preventDefault();
    // Entries must be taken before the first await: afterwards the list is empty.
    const entries = [...event.dataTransfer.items].map((item) => item.webkitGetAsEntry()).filter(Boolean);
    try {
      takeFiles(app, (await Promise.all(entries.map(filesUnder))).flat());
    } catch (error) {
      app.notices.show(error, "The files could not be read");
    }
  });
}

/** The files of a dropped file or folder, however deep. */
async function filesUnder(entry) {
  if (entry.isFile) return [await new Promise((resolve, reject) => entry.file(resolve, reject))];
  const reader = entry.createReader();
  const found = [];
  for (;;) {
    // A reader hands over some entries at a time, and none at the end.
    const some = await new Promise((resolve, reject) => reader.readEntries(resolve, reject));
    if (some.length === 0) return found;
    found.push(...(await Promise.all(some.map(filesUnder))).flat());
  }
}

/** Files chosen or dropped: a scene's document with its files, or files for the open scene. */
export async function takeFiles(app, all) {
  const files = all.filter((file) => KNOWN.includes(extensionOf(file)));
  tellUnknown(app, all.filter((file) => !files.includes(file) && !file.name.startsWith(".")));
  if (files.length === 0) return;
  const uploading = `Taking ${named(files)}`;
  app.notices.hold(uploading, "Sending…");
  try {
    if (files.some((file) => extensionOf(file) === "json")) await createScene(app, files);
    else await addModels(app, files);
  } catch (problem) {
    if (!(problem instanceof Problem)) throw problem;
    app.notices.show(problem, "The files could not be taken");
  } finally {
    app.notices.clear(uploading);
  }
}

function tellUnknown({ notices }, files) {
  const detail = "is neither a model nor an image nor a scene";
  notices.warn(files.map(({ name }) => ({ file: name, detail })), "Left out");
}

async function createScene(app, files) {
  const form = new FormData();
  for (const file of files) {
    if (extensionOf(file) === "json") form.append("scene", new Blob([file], { type: "application/json" }));
    else form.append("file", file, file.name);
  }
  const response = await ask("/scenes", { method: "POST", body: form });
  await openScene(app, (await response.json()).id);
}

/** Every OBJ becomes an instance. What it refers to goes first, so that it is read once and whole. */
async function addModels(app, files) {
  const models = files.filter((file) => extensionOf(file) === "obj");
  const others = files.filter((file) => extensionOf(file) !== "obj");
  await putAll(app, [...others, ...models]);
  if (models.length === 0) return app.notices.say(`${named(files)}: now among the scene's files`);
  const names = models.map((file) => addInstance(app, file.name));
  if (!app.scene.document.name) app.scene.edit({ name: names.at(-1) });
  await app.scene.settled();
  await showModel(app, names.at(-1));
}

/** Sends files one after another, and tells which took the place of others. */
async function putAll({ scene: { id }, notices }, files) {
  const there = await getJson(scenePath(id, "files"));
  const taken = new Set(there.map(({ name }) => name));
  const replaced = [];
  for (const file of files) {
    await ask(scenePath(id, "files", file.name), { method: "PUT", body: file });
    if (taken.has(file.name)) replaced.push({ file: file.name, detail: "took the place of the scene's file of that name" });
    taken.add(file.name);
  }
  notices.warn(replaced, "Replaced");
}

/** The instance's name. A model that is there already has only got a new file. */
function addInstance({ scene }, file) {
  const { meshes = {}, instances = {} } = scene.document;
  const mesh = Object.keys(meshes).find((name) => meshes[name].file === file);
  const instance = Object.keys(instances).find((name) => instances[name].mesh === mesh);
  if (mesh !== undefined && instance !== undefined) return instance;
  const meshName = mesh ?? freeName(stemOf(file), meshes);
  const name = freeName(stemOf(file), instances);
  scene.edit({ meshes: { [meshName]: { type: "obj", file } }, instances: { [name]: { mesh: meshName } } });
  return name;
}

async function showModel(app, name) {
  if (!app.scene.document.instances?.[name]) return; // the server refused it, and has said why
  app.selection.select(name);
  app.notices.warn(app.scene.summary?.warnings ?? []);
  app.notices.say(`“${name}” is in the scene`, { "Its z axis points up": () => turnZUp(app, name) });
  await frameInstance(app, name);
}

async function turnZUp(app, name) {
  app.scene.edit({ instances: { [name]: { rotation_deg: [-90, 0, 0] } } });
  await app.scene.settled();
  await frameInstance(app, name);
}
