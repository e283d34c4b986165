// Which scene the page's address names, and opening it.

import { Problem, ask, getJson, scenePath } from "./server.js";

const HOME = "demo";
const GALLERY = "gallery-";

/** Opens the scene that the address names; one of the gallery need not be there yet. */
export async function openAddressed(app) {
  if (addressed() !== app.scene.id) await openScene(app, addressed());
}

/** Opens a scene by id. Failures are shown. */
export async function openScene(app, id) {
  try {
    if (id.startsWith(GALLERY)) await createPiece(id);
    await app.scene.open(id);
  } catch (problem) {
    const actions = id === HOME ? { "Try again": () => openScene(app, id) } : { "Open the demo": () => openScene(app, HOME) };
    app.notices.show(problem, "The scene could not be opened", actions);
  }
}

/** Lets the address name a scene. */
export function showAddress(id) {
  if (id !== addressed()) history.pushState(null, "", id === HOME ? location.pathname : `#${encodeURIComponent(id)}`);
}

/** Every piece of the gallery is one scene: who opens it first creates it, and changes to it stay. */
async function createPiece(id) {
  const scenes = await getJson("/scenes");
  if (scenes.some((scene) => scene.id === id)) return;
  const query = new URLSearchParams({ from: id.slice(GALLERY.length) });
  try {
    await ask(`${scenePath(id)}?${query}`, { method: "PUT", headers: { "If-None-Match": "*" } });
  } catch (problem) {
    // Somebody else may have been quicker.
    if (!(problem instanceof Problem) || problem.status !== 412) throw problem;
  }
}

function addressed() {
  try {
    return decodeURIComponent(location.hash.slice(1)) || HOME;
  } catch {
    return HOME; // a broken escape
  }
}
