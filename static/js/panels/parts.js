// What panels are made of.

import { element } from "../dom.js";

/** A foldable part of the page under a heading. `id` becomes `panel-id`. */
export function panel(id, title, ...children) {
  const heading = element("summary", {}, element("h2", {}, title));
  return element("details", { className: "panel", id: `panel-${id}` }, heading,
    element("div", { className: "panel-body" }, ...children));
}

/** Things that belong together, under a small heading. */
export function group(title, ...children) {
  const heading = element("h3", {}, title);
  return element("div", { className: "group", role: "group", "aria-label": title }, heading, ...children);
}

/** A line of buttons or small fields. */
export function row(...children) {
  return element("div", { className: "row" }, ...children);
}

/** A short explanation in the panel itself. */
export function note(text) {
  return element("p", { className: "note" }, text);
}

/** Makes `children` the children of `parent`, moving only those out of place, so that the focus stays where it is. */
export function arrange(parent, children) {
  const keep = new Set(children);
  for (const child of [...parent.children]) if (!keep.has(child)) child.remove();
  children.forEach((child, i) => {
    if (parent.children[i] !== child) parent.insertBefore(child, parent.children[i] ?? null);
  });
}
