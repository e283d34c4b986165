// The scenes of the server: open, create, rename, delete.

import { openScene } from "../address.js";
import { button, element } from "../dom.js";
import { ask, getJson, scenePath, sendJson } from "../server.js";
import { confirmed } from "./confirm.js";
import { textField } from "./fields/text.js";
import { onceOpen } from "./follow.js";
import { galleryPart } from "./gallery.js";
import { arrange, panel, row } from "./parts.js";
import { tried } from "../tried.js";

/** List, create, the name of the open one, delete, and the gallery. */
export function scenesPanel(app) {
  const { scene, notices } = app;
  const list = element("ul", { className: "entries", id: "scene-list", "aria-label": "Scenes" });
  const rows = new Map();
  const refresh = () => tried(notices, "The scenes could not be listed", async () =>
    showScenes(app, list, rows, await getJson("/scenes")));
  const create = () => tried(notices, "The scene could not be created", () => createScene(app));
  const remove = () => tried(notices, "The scene could not be deleted", () => deleteScene(app, refresh));
  const made = panel("scenes", "Scenes",
    list,
    row(button("New scene", create, { id: "new-scene" })),
    onceOpen(scene, textField(scene, "/name", { label: "Name of this scene" })),
    onceOpen(scene, row(button("Delete this scene…", remove, { id: "delete-scene", className: "danger" }))),
    galleryPart(app),
  );
  for (const type of ["open", "saved"]) scene.addEventListener(type, () => made.open && refresh());
  made.addEventListener("toggle", () => made.open && refresh());
  return made;
}

/** Rows that stay keep the focus. */
function showScenes(app, list, rows, scenes) {
  for (const { id } of scenes) if (!rows.has(id)) rows.set(id, sceneRow(app, id));
  arrange(list, scenes.map(({ id }) => rows.get(id).item));
  for (const { id, name } of scenes) rows.get(id).show(name, id === app.scene.id);
}

function sceneRow(app, id) {
  const words = element("span");
  const open = button(words, () => openScene(app, id), { className: "entry", "data-id": id });
  open.append(element("code", {}, id));
  const show = (name, isOpen) => {
    words.textContent = name || "without a name";
    open.setAttribute("aria-pressed", String(isOpen));
  };
  return { item: element("li", {}, open), show };
}

async function createScene(app) {
  const { id } = await sendJson("POST", "/scenes", {});
  await openScene(app, id);
}

/** The page goes to another scene first: it always has one. */
async function deleteScene(app, refresh) {
  const { id, document } = app.scene;
  if (!(await confirmed(`Delete “${document.name || id}” with its files? This cannot be undone.`, "Delete"))) return;
  const others = (await getJson("/scenes")).filter((summary) => summary.id !== id);
  if (others.length > 0) await openScene(app, others[0].id);
  else await createScene(app);
  await ask(scenePath(id), { method: "DELETE" });
  await refresh();
}
