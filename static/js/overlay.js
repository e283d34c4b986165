// What the frame on screen is and cost, in a corner of the picture.

import { element } from "./dom.js";

/** Told no more often than this: numbers that flicker cannot be read. */
const INTERVAL_MS = 250;

/** Where it may be open from the start. */
const ROOMY = "(min-width: 801px) and (min-height: 600px)";

/** Colour of a pass in bars; names and numbers stand beside it. */
export const passHue = (name) => `var(--pass-${name})`;

/** Fills the overlay; `buttons` lead to more of the kind. */
export function mountOverlay(app, overlay, buttons) {
  const { live, plan } = app;
  const summary = element("summary", {}, "Waiting for a frame…");
  const facts = element("dl", { className: "facts" });
  const bar = element("div", { className: "bar", role: "img" });
  const legend = element("ul", { className: "legend" });
  const leftOut = element("details", { className: "left-out" });
  overlay.open = matchMedia(ROOMY).matches;
  overlay.append(summary, facts, bar, legend, leftOut, element("div", { className: "more" }, ...buttons));

  let newest = null;
  let timer = null;
  live.addEventListener("frame", ({ detail }) => {
    if (newest === null) tellFrame(detail); // the first at once
    newest = detail;
    timer ??= setTimeout(() => {
      timer = null;
      tellFrame(newest);
    }, INTERVAL_MS);
  });
  plan.addEventListener("change", () => tellLeftOut(plan.current.left_out));

  function tellFrame(frame) {
    const passes = Object.entries(frame.milliseconds).filter(([name]) => name !== "queue");
    const total = passes.reduce((sum, [, ms]) => sum + ms, 0);
    const pace = frame.fps > 0 ? `${frame.fps} fps` : "still";
    summary.replaceChildren(`${pace} · ${total.toFixed(1)} ms`);
    const rows = factsOf(frame, plan.current);
    facts.replaceChildren(...rows.flatMap(([term, value]) => [element("dt", {}, term), element("dd", {}, value)]));
    bar.setAttribute("aria-label", passes.map(([name, ms]) => `${name} ${ms.toFixed(1)} milliseconds`).join(", "));
    bar.replaceChildren(...passes.map(([name, ms]) => segment(name, ms / total)));
    legend.replaceChildren(...passes.map(([name, ms]) => legendItem(name, ms)));
  }

  function tellLeftOut(entries) {
    leftOut.hidden = entries.length === 0;
    const items = entries.map(({ what, reason }) => element("li", {}, `${what}: ${reason}`));
    const isOpen = leftOut.open;
    leftOut.replaceChildren(element("summary", {}, `${entries.length} left out`), element("ul", {}, ...items));
    leftOut.open = isOpen;
  }
}

function factsOf({ number, revision, watchers, width, height, counts }, plan) {
  return [
    ["frame", number.toLocaleString()],
    ["revision", revision.toLocaleString()],
    ["watchers", watchers.toLocaleString()],
    ["size", `${width} × ${height}`],
    ["triangles", `${counts.drawn.toLocaleString()} of ${counts.triangles.toLocaleString()}`],
    ["draws", plan?.draws.length.toLocaleString() ?? "–"],
  ];
}

function segment(name, part) {
  const made = element("span", { title: name });
  made.style.flexGrow = part;
  made.style.background = passHue(name);
  return made;
}

function legendItem(name, ms) {
  const swatch = element("span", { className: "hue" });
  swatch.style.background = passHue(name);
  return element("li", { "data-pass": name }, swatch, `${name} `, element("output", {}, ms.toFixed(1)));
}
