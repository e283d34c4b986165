// A map of the document as a list to choose from, and the fields of what is chosen.

import { field } from "./field.js";
import { pointerOf } from "../merge.js";
import { button, element } from "../dom.js";
import { arrange } from "./parts.js";
import { setAt } from "./edit.js";
import { follow, rebuilt } from "./follow.js";

/**
 * The names in the map `part` as a list of buttons.
 *
 * @param {{name: string | null, select: (name: string) => void} & EventTarget} chosen
 * @param {(name: string) => {lead?: HTMLElement, show?: (entry: object) => void}} rowOf what stands before a name, and
 *   follows the entry
 */
export function entryList(scene, part, chosen, label, rowOf = () => ({})) {
  const list = element("ul", { className: "entries", "data-part": part, "aria-label": label });
  const rows = new Map();
  const mark = () => {
    for (const [name, { pick }] of rows) pick.setAttribute("aria-pressed", String(name === chosen.name));
  };
  const revealChosen = () => reveal(list, rows.get(chosen.name)?.item);
  follow(scene, list, (document) => {
    const entries = document[part];
    for (const name of rows.keys()) if (!(name in entries)) rows.delete(name);
    for (const name of Object.keys(entries)) if (!rows.has(name)) rows.set(name, makeRow(name, chosen, rowOf(name)));
    arrange(list, Object.keys(entries).map((name) => rows.get(name).item));
    for (const [name, { show }] of rows) show?.(entries[name]);
    mark();
  });
  chosen.addEventListener("change", () => {
    mark();
    revealChosen();
  });
  // It has no size while its panel is folded.
  new ResizeObserver(revealChosen).observe(list);
  list.addEventListener("keydown", moveBetweenRows);
  return list;
}

function makeRow(name, chosen, { lead, show }) {
  const pick = button(name, () => chosen.select(name), { className: "entry", "data-name": name });
  const item = element("li", {}, ...(lead ? [lead] : []), pick);
  return { item, pick, show };
}

/** Scrolls the list, and nothing around it, to where an item shows. */
function reveal(list, item) {
  if (!item) return;
  const above = item.offsetTop - list.offsetTop;
  list.scrollTop = Math.min(Math.max(list.scrollTop, above + item.offsetHeight - list.clientHeight), above);
}

/** Arrow keys go from name to name. */
function moveBetweenRows(event) {
  const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
  if (step === undefined || !event.target.matches(".entry")) return;
  event.preventDefault();
  const picks = [...event.currentTarget.querySelectorAll(".entry")];
  picks[picks.indexOf(event.target) + step]?.focus();
}

/** A check box before a name, for a member of the entry that is `true` or `false`. */
export function leadToggle(scene, part, name, member, label) {
  const box = element("input", {
    type: "checkbox", title: label, "aria-label": `${label}: ${name}`, "data-member": member, "data-name": name,
  });
  box.addEventListener("change", () => setAt(scene, pointerOf(part, name, member), box.checked));
  return { lead: box, show: (entry) => { box.checked = entry[member]; } };
}

/**
 * The fields of the chosen entry, which `build(name, entry, pointer)` makes; again when another is chosen, or when what
 * `keyOf(entry, document)` gives has changed.
 */
export function entryEditor(scene, part, chosen, keyOf, build) {
  const host = element("div", { className: "editor", "data-part": part });
  const entryOf = (document) => document[part][chosen.name];
  const editor = rebuilt(
    scene,
    host,
    (document) => entryOf(document) && [chosen.name, keyOf(entryOf(document), document)],
    (document) => (entryOf(document) ? build(chosen.name, entryOf(document), pointerOf(part, chosen.name)) : []),
  );
  chosen.addEventListener("change", editor.refresh);
  return host;
}

/** Where the focus goes when what had it is no longer there. */
function focusChosen(list) {
  (list.querySelector(".entry[aria-pressed=true]") ?? list.querySelector(".entry"))?.focus();
}

/** A button that removes an entry; what the server says against it is shown beneath. */
export function removeField(scene, pointer, label) {
  const remove = button(label, () => {
    const list = remove.closest(".panel").querySelector(".entries");
    setAt(scene, pointer, null);
    focusChosen(list);
  }, { className: "danger", "data-action": "remove" });
  const made = field(scene, pointer, {}, { element: remove, inputs: [remove], show: () => {} });
  made.classList.add("bare");
  return made;
}
