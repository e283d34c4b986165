// Taking along what is on screen: the frame, the scene, the command that makes the same picture.

import { ask, getJson, scenePath } from "./server.js";
import { tried } from "./tried.js";
import { element } from "./dom.js";

/** The frame on screen as a lossless PNG. */
export async function saveFrame(app) {
  await download(app, framePath(app), `${app.scene.id}.png`);
}

/** The scene's document, and the offer of its files: without them it cannot be opened again. */
export async function saveScene(app) {
  const { notices, scene: { id, path } } = app;
  await download(app, path, `${id}.json`);
  const files = await tried(notices, "The scene's files could not be listed", () => getJson(scenePath(id, "files")));
  if (!files?.length) return;
  const count = files.length === 1 ? "file" : `${files.length} files`;
  notices.say(`${id}.json is saved without the scene's ${count}, which it needs to be opened again`, {
    "Save them too": () => saveFiles(app, id, files),
  });
}

async function saveFiles(app, id, files) {
  for (const { name } of files) await download(app, scenePath(id, "files", name), name);
}

/** The command that fetches the same picture. */
export async function copyCommand(app) {
  const command = commandOf(app);
  try {
    await navigator.clipboard.writeText(command);
    app.notices.say("The curl command is copied");
  } catch {
    app.notices.hold("Copy this command", command); // no clipboard without a secure origin
  }
}

/** In single quotes, which a path of ours cannot hold: everything in it is percent-encoded. */
function commandOf(app) {
  return `curl -o '${app.scene.id}.png' '${location.origin}${framePath(app)}'`;
}

function framePath({ live }) {
  const t = live.frame?.t ?? 0;
  return live.path("frame.png", { t });
}

async function download({ notices }, path, name) {
  try {
    const response = await ask(path);
    const url = URL.createObjectURL(await response.blob());
    element("a", { href: url, download: name }).click();
    setTimeout(() => URL.revokeObjectURL(url), 60_000);
  } catch (problem) {
    notices.show(problem, `${name} could not be saved`);
  }
}
