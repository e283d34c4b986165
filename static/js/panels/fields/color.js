// Colours: one that a screen can show, and a factor for what is brighter than that.

import { field } from "../field.js";
import { element } from "../../dom.js";
import { setAt } from "../edit.js";
import { NumberControl } from "./number.js";
import { hexFromLinear, linearFromHex, linearOf } from "./srgb.js";

const STRENGTH = { step: 0.05, min: 0 };

/**
 * A field for a colour. Within 0–1 it writes an sRGB string, which is what people mean by a colour; above, linear
 * numbers.
 *
 * @param {{absent?: string}} words `absent` says what holds without a value, and then emptying the text removes it
 */
export function colorField(scene, pointer, words) {
  return field(scene, pointer, words, colorControl(words, (value) => setAt(scene, pointer, value)));
}

function colorControl({ label, absent }, write) {
  const swatch = element("input", { type: "color", "aria-label": label });
  const text = element("input", {
    type: "text", className: "hex", spellcheck: false, autocomplete: "off", placeholder: absent ?? "",
    title: "As on the web: #rrggbb or #rgb", "aria-label": `${label}, as #rrggbb`,
  });
  const strength = new NumberControl(STRENGTH, (factor) => write(colorOf(swatch.value, factor)));
  const times = element("label", { className: "times", title: "Brighter than a screen can show: times this" });
  times.append(element("span", {}, "×"), strength.element);
  strength.adopt(times.firstChild);
  strength.inputs[0].setAttribute("aria-label", `${label}, times`);

  let isTyping = false;

  swatch.addEventListener("input", () => write(colorOf(swatch.value, factorOf(strength))));
  text.addEventListener("input", () => { isTyping = true; });
  text.addEventListener("change", () => {
    isTyping = false;
    if (text.value.trim() === "" && absent !== undefined) return write(null);
    const linear = linearFromHex(text.value);
    // What is no colour goes to the server as it is, which says what is wrong with it.
    write(linear ? colorOf(hexFromLinear(linear), factorOf(strength)) : text.value);
  });
  const box = element("div", { className: "color" }, swatch, text, times);
  return {
    element: box,
    inputs: [text, swatch, strength.inputs[0]],
    show: (color) => {
      box.classList.toggle("absent", color === undefined);
      if (!isRefused(color)) showOnScreen(color, swatch, strength);
      if (!isTyping) text.value = textOf(color, swatch.value);
    },
  };
}

function showOnScreen(color, swatch, strength) {
  const linear = linearOf(color ?? [0, 0, 0]);
  const factor = Math.max(1, ...linear);
  swatch.value = hexFromLinear(linear.map((channel) => channel / factor));
  swatch.title = `Linear RGB ${linear.map((channel) => Number(channel.toPrecision(4))).join(", ")}`;
  strength.show(color === undefined ? undefined : factor);
}

/** A text that is no colour; it stands in the document only until the server has answered. */
const isRefused = (color) => typeof color === "string" && linearFromHex(color) === undefined;

function textOf(color, hex) {
  if (color === undefined) return "";
  return isRefused(color) ? color : hex;
}

function factorOf(strength) {
  return strength.inputs[0].valueAsNumber || 1;
}

/** What the user means by a colour of the screen times a factor. */
function colorOf(hex, factor) {
  const linear = linearFromHex(hex).map((channel) => Number((channel * factor).toPrecision(5)));
  if (Math.max(...linear) > 1) return linear;
  return factor === 1 ? hex : hexFromLinear(linear);
}
