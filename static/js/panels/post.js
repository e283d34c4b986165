// The chain of post effects, in the order they are applied.

import { isPostOn, togglePost } from "../actions.js";
import { button, element } from "../dom.js";
import { pointerOf } from "../merge.js";
import { setAt } from "./edit.js";
import { EFFECTS } from "./effects.js";
import { follow, rebuilt } from "./follow.js";
import { note, panel, row } from "./parts.js";

/** The switch for all, the chain, and what can be added to it. */
export function postPanel(app) {
  const { scene } = app;
  const keyOf = ({ post }) => post.map(({ type, kernel }) => [type, kernel?.length]);
  const chain = rebuilt(scene, element("ol", { id: "post-chain", "aria-label": "Effects in order" }), keyOf,
    ({ post }) => post.map((effect, i) => effectItem(scene, effect, i, post.length)));
  return panel("post", "Post", postSwitch(app), chain.element, adder(scene),
    note("Each effect works on what the one before has made."));
}

/** Switches the whole chain; the actions remember what was in it. */
function postSwitch(app) {
  const box = element("input", { type: "checkbox", id: "post-on" });
  box.addEventListener("change", () => togglePost(app));
  follow(app.scene, box, () => { box.checked = isPostOn(app); });
  const label = element("label", { className: "label", htmlFor: box.id }, "Effects on");
  return element("div", { className: "field toggle" }, label, box);
}

function effectItem(scene, effect, i, count) {
  const { label, hint, fields } = EFFECTS[effect.type];
  const action = (name, text, act, disabled) =>
    button(text, act, { "data-action": name, "aria-label": `${label}: ${name}`, title: name, disabled });
  const head = row(
    element("h3", { title: hint ?? "" }, `${i + 1}. ${label}`),
    action("move up", "↑", () => move(scene, i, -1), i === 0),
    action("move down", "↓", () => move(scene, i, 1), i === count - 1),
    action("remove", "×", () => write(scene, scene.document.post.toSpliced(i, 1)), false),
  );
  return element("li", { "data-effect": effect.type }, head, ...fields(scene, pointerOf("post", i), effect));
}

const write = (scene, chain) => setAt(scene, "/post", chain);

/** Moves an effect; the focus goes with it. */
function move(scene, i, step) {
  const chain = [...scene.document.post];
  [chain[i], chain[i + step]] = [chain[i + step], chain[i]];
  write(scene, chain);
  const buttons = document.querySelectorAll(`#post-chain > :nth-child(${i + step + 1}) [data-action^="move"]:enabled`);
  buttons[step < 0 ? 0 : buttons.length - 1]?.focus();
}

function adder(scene) {
  const select = element("select", { id: "add-effect-type", "aria-label": "Effect to add" },
    ...Object.entries(EFFECTS).map(([type, { label }]) => element("option", { value: type }, label)));
  const add = button("Add", () => {
    const type = select.value;
    write(scene, [...scene.document.post, { type, ...EFFECTS[type].first }]);
  }, { id: "add-effect" });
  return row(select, add);
}
