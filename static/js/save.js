// Taking along what is on screen: the frame, the scene, the command that makes the same picture.

import { ask } from "./server.js";
import { element } from "./dom.js";

/** The frame on screen as a lossless PNG. */
export async function saveFrame(app) {
  await download(app, framePath(app), `${app.scene.id}.png`);
}

/** The scene's document; its files stay on the server. */
export async function saveScene(app) {
  await download(app, app.scene.path, `${app.scene.id}.json`);
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
