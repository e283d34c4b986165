// The gallery: scenes that come with the program.

import { openScene } from "../address.js";
import { button, element } from "../dom.js";
import { getJson } from "../server.js";
import { group } from "./parts.js";
import { tried } from "../tried.js";

/** Pictures to open a scene by, each kept under an id of its own. */
export function galleryPart(app) {
  const pieces = element("div", { id: "gallery" });
  tried(app.notices, "The gallery could not be read", async () => {
    pieces.append(...(await getJson("/gallery")).map((piece) => pieceButton(app, piece)));
  });
  return group("Gallery", pieces);
}

function pieceButton(app, { name, title, description, picture }) {
  const made = button("", () => openScene(app, `gallery-${name}`), { title: description, "data-gallery": name });
  made.append(element("img", { src: picture, alt: "", loading: "lazy" }), element("span", {}, title));
  return made;
}
