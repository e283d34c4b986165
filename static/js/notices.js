// What went wrong, what is worth knowing: messages above the picture, read out by screen readers.

import { button, element } from "./dom.js";

/** How long messages stay that go by themselves; longer where they offer something. */
const [PASSING_MS, OFFERING_MS] = [4000, 12_000];

/** One message per title: a new one takes the place of the one before. */
export class Notices {
  #list;
  #shown = new Map();

  constructor(list) {
    this.#list = list;
  }

  /** An error. `actions` are further buttons: label → function. */
  show(problem, title = "That did not work", actions = {}) {
    const items = (problem.errors ?? []).map((entry) => placed(entry, entry.pointer ?? entry.parameter));
    const detail = element("p", {}, problem.message ?? problem.detail ?? String(problem));
    this.#put(title, "bad", items.length > 0 ? [element("ul", {}, ...items)] : [detail], actions);
  }

  /** What the server remarked on files: `[{file, line, detail}]`. */
  warn(warnings, title = "Warnings") {
    if (warnings.length === 0) return this.clear(title);
    this.#put(title, "warning", [element("ul", {}, ...warnings.map((entry) => placed(entry)))]);
  }

  /** Something that goes by itself. */
  say(text, actions = {}) {
    const notice = this.#put(text, "passing", [], actions);
    const isOffer = Object.keys(actions).length > 0;
    setTimeout(() => { if (this.#shown.get(text) === notice) this.clear(text); }, isOffer ? OFFERING_MS : PASSING_MS);
  }

  /** Something that stays until it is cleared. */
  hold(title, text, actions = {}) {
    this.#put(title, "held", [element("p", {}, text)], actions);
  }

  clear(title) {
    this.#shown.get(title)?.remove();
    this.#shown.delete(title);
  }

  clearAll() {
    for (const title of [...this.#shown.keys()]) this.clear(title);
  }

  #put(title, kind, parts, actions = {}) {
    this.clear(title);
    const doing = Object.entries(actions).map(([label, act]) => button(label, () => { this.clear(title); act(); }));
    const close = button("×", () => this.clear(title), { className: "close", "aria-label": `Dismiss: ${title}` });
    const heading = element("h2", {}, title);
    const notice = element("div", { className: "notice", "data-kind": kind }, heading, ...parts, ...doing, close);
    this.#shown.set(title, notice);
    this.#list.append(notice);
    return notice;
  }
}

/** A list item: pointer, file and line, as far as they are there, and the detail. */
function placed({ file, line, detail }, pointer) {
  const place = [pointer, file, line === undefined ? "" : `line ${line}`].filter(Boolean).join(", ");
  return place ? element("li", {}, element("code", {}, place), ` ${detail}`) : element("li", {}, detail);
}
