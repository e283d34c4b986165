// The keyboard, while the focus is on the view, on what lies around it, or nowhere.

import * as actions from "../actions.js";
import { isHeldKey } from "./motion.js";

/** Function keys, as in the desktop programs; only while the view itself has the focus. */
const FUNCTION_KEYS = {
  F1: actions.toggleShadows,
  F2: actions.toggleSoftShadows,
  F3: actions.togglePost,
  F4: actions.nextEffect,
  F5: (app) => actions.toggleLights(app, "directional"),
  F6: (app) => actions.toggleLights(app, "point"),
};

const KEYS = {
  KeyF: actions.frameScene,
  Home: actions.frameScene,
  Period: actions.frameScene,
  Escape: (app) => app.selection.select(null),
  Digit0: (app) => app.selection.select(null),
  Numpad0: (app) => app.selection.select(null),
  Delete: actions.deleteSelected,
  Backspace: actions.deleteSelected,
};

/** Takes keys for `view`; `help` shows what they are. */
export function takeKeys(app, view, help) {
  const { motion } = app;
  document.addEventListener("keydown", (event) => {
    if (event.defaultPrevented || event.ctrlKey || event.altKey || event.metaKey) return;
    if (event.key === "?" && !event.repeat && !isText(event.target)) help();
    if (!isForView(event.target, view)) return;
    const act = actionOf(event, view);
    if (!act && !isHeldKey(event.code)) return;
    event.preventDefault();
    if (event.repeat) return; // a held key acts once, or as long as it is held
    if (act) act(app);
    else motion.press(event.code);
  });
  document.addEventListener("keydown", (event) => takeHistoryKey(app, event));
  document.addEventListener("keyup", (event) => motion.release(event.code));
  window.addEventListener("blur", () => motion.releaseAll());
  view.addEventListener("blur", () => motion.releaseAll());
}

/** Undo and redo, wherever the focus is but where text is typed. */
function takeHistoryKey({ history }, event) {
  const isCommand = (event.ctrlKey || event.metaKey) && !event.altKey;
  const key = event.key.toLowerCase();
  if (!isCommand || !["z", "y"].includes(key) || isTyped(event.target)) return;
  event.preventDefault();
  if (key === "y" || event.shiftKey) history.redo();
  else history.undo();
}

/** What the key does at once; `undefined` if it does nothing, or as long as it is held. */
function actionOf({ code, target }, view) {
  if (target === view && code in FUNCTION_KEYS) return FUNCTION_KEYS[code];
  const digit = /^(?:Digit|Numpad)([1-9])$/.exec(code)?.[1];
  if (digit) return (app) => actions.selectNth(app, Number(digit));
  return KEYS[code];
}

/** Whatever is on the picture lets keys through, as far as it needs none itself. */
function isForView(target, view) {
  const isAround = view.closest("main").contains(target) && !isText(target);
  return isAround || target === document.body;
}

/** Where these keys take back what was typed. */
const isTyped = (target) => isText(target) && !target.matches("select, [type=checkbox], [type=radio], [type=range], [type=color]");

const isText = (target) => target.matches?.("input, textarea, select, [contenteditable]") ?? false;
