// The plan as a picture: what feeds the passes, the passes in their order, what is left out.

import { button, element, svg } from "./dom.js";
import { passHue } from "./overlay.js";

/** In units of the picture. */
const WIDTH = 860;
const [BOX_WIDTH, BOX_HEIGHT, GAP] = [180, 46, 12];
const LINE = 18;
/** More draws than this are summed up. */
const MOST_DRAWS = 12;
const COLUMNS = { sources: 10, passes: 330, reasons: 540 };

/** Fills the dialog; answers what opens it. */
export function mountPlanPicture(app, dialog) {
  const body = element("div", { className: "plan-body" });
  const title = element("h2", { id: "plan-title" }, "What a frame runs, and what it leaves out");
  dialog.append(title, body, button("Close", () => dialog.close(), { className: "close" }));
  const draw = () => { if (dialog.open) body.replaceChildren(...contentOf(app.plan.current, app.live.frame)); };
  app.plan.addEventListener("change", draw);
  return () => {
    dialog.showModal();
    draw();
  };
}

function contentOf(plan, frame) {
  if (!plan) return [element("p", {}, "The plan is not there yet.")];
  const { settings, bytes } = plan;
  const megabytes = (bytes / 1e6).toFixed(1);
  const text = `${settings.width} × ${settings.height} pixels, ${settings.samples} samples each; ${megabytes} MB of working memory.`;
  return [element("p", {}, text), picture(plan, frame), leftOut(plan.left_out), spared(plan.elisions), drawTable(plan.draws)];
}

function picture(plan, frame) {
  const sources = [
    ...sourceBoxes("Lights", plan.lights, lightText, "shadow"),
    ...sourceBoxes("Draws", plan.draws, drawText, "geometry"),
    ...sourceBoxes("Effects", plan.post, effectText, "post"),
  ];
  const passesHeight = plan.passes.length * (BOX_HEIGHT + GAP);
  const sourcesHeight = sources.reduce((sum, { height }) => sum + height + GAP, 0);
  const height = Math.max(passesHeight, sourcesHeight) + GAP;
  const made = svg("svg", {
    viewBox: `0 0 ${WIDTH} ${height}`, class: "plan", role: "img", "aria-label": "The passes in order, with what feeds them",
  });
  const tops = new Map(plan.passes.map(({ name }, i) => [name, GAP + i * (BOX_HEIGHT + GAP)]));
  made.append(...[...tops.values()].slice(1).map(connector));
  made.append(...plan.passes.flatMap((pass) => passBox(pass, tops.get(pass.name), frame)));
  let top = GAP;
  for (const source of sources) {
    made.append(...source.draw(top, tops.get(source.feeds) ?? GAP));
    top += source.height + GAP;
  }
  return made;
}

/** From one pass down to the next, whose box begins at `top`. */
function connector(top) {
  return svg("path", { d: `M${COLUMNS.passes + BOX_WIDTH / 2} ${top - GAP}v${GAP}`, class: "flow" });
}

/** A pass: name and time, and beside it why it runs or not. */
function passBox({ name, runs, reason }, top, frame) {
  const x = COLUMNS.passes;
  const ms = frame?.milliseconds[name];
  const time = runs && ms !== undefined ? `${ms.toFixed(2)} ms` : runs ? "" : "left out";
  const middle = top + BOX_HEIGHT / 2;
  const box = svg("rect", { x, y: top, width: BOX_WIDTH, height: BOX_HEIGHT, rx: 8, class: runs ? "pass" : "pass skipped" });
  box.style.setProperty("--hue", passHue(name));
  return [
    box,
    svg("text", { x: x + 12, y: middle, class: "name" }, name),
    svg("text", { x: x + BOX_WIDTH - 12, y: middle, class: "time" }, time),
    ...wrapped(reason, 46).map((line, i, lines) => {
      const y = middle + (i - (lines.length - 1) / 2) * LINE;
      return svg("text", { x: COLUMNS.reasons, y, class: "reason" }, line);
    }),
  ];
}

/** A curve that leaves and arrives level, with a head. */
const arrow = ([fromX, fromY], [toX, toY]) =>
  `M${fromX} ${fromY}C${fromX + 30} ${fromY} ${toX - 23} ${toY} ${toX} ${toY}m-7 -5l7 5l-7 5`;

/** A box that lists lights or draws, with an arrow to the pass they feed. */
function sourceBoxes(title, entries, textOf, feeds) {
  if (entries.length === 0) return [];
  const more = entries.length - MOST_DRAWS;
  const lines = entries.slice(0, MOST_DRAWS).map(textOf);
  if (more > 0) lines.push(`and ${more} more`);
  const height = (lines.length + 1) * LINE + 14;
  const [x, width] = [COLUMNS.sources, COLUMNS.passes - COLUMNS.sources - 50];
  const draw = (top, passTop) => {
    const [from, to] = [top + LINE, passTop + BOX_HEIGHT / 2];
    return [
      svg("rect", { x, y: top, width, height, rx: 8, class: "source" }),
      svg("text", { x: x + 12, y: top + LINE, class: "name" }, `${title} (${entries.length})`),
      ...lines.map((line, i) => svg("text", { x: x + 12, y: top + (i + 2) * LINE, class: "reason" }, shortened(line, 40))),
      svg("path", { d: arrow([x + width, from], [COLUMNS.passes - 7, to]), class: "flow" }),
    ];
  };
  return [{ height, feeds, draw }];
}

const shadowText = (shadow) => (shadow ? `${shadow.filter} shadow, ${shadow.resolution} px` : "no shadow");
const lightText = ({ name, type, shadow }) => `${name}: ${type}, ${shadowText(shadow)}`;
const effectText = ({ effects, kind }) => `${effects.join(" + ")}: ${kind}`;
const drawText = ({ instance, triangles, transparent }) =>
  `${instance}: ${triangles.toLocaleString()} triangles${transparent ? ", transparent" : ""}`;

function leftOut(entries) {
  if (entries.length === 0) return element("p", {}, "Nothing is left out.");
  const saving = (saves) => (saves ? `; saves ${saves}` : "");
  const items = entries.map(({ what, reason, saves }) =>
    element("li", {}, element("strong", {}, what), `: ${reason}${saving(saves)}`));
  return element("section", {}, element("h3", {}, "Left out"), element("ul", { className: "left-out" }, ...items));
}

/** What the passes are spared on the way, and why the picture stays the same. */
function spared(elisions) {
  if (elisions.length === 0) return element("p", {}, "Nothing is spared: every step runs.");
  const items = elisions.map(({ name, saves, exact }) =>
    element("li", {}, element("strong", {}, name.replaceAll("_", " ")), `: ${saves}, since ${exact}`));
  return element("details", {}, element("summary", {}, "Spared on the way"), element("ul", { className: "left-out" }, ...items));
}

/** Which way through the shading each instance takes. */
function drawTable(draws) {
  const row = (cell, values) => element("tr", {}, ...values.map((value) => element(cell, {}, value)));
  const rows = draws.map(({ instance, mesh, material, triangles, variant }) =>
    row("td", [instance, mesh, material ?? "–", triangles.toLocaleString(), variant.join(", ")]));
  const head = element("thead", {}, row("th", ["Instance", "Mesh", "Material", "Triangles", "Shaded with"]));
  return element("details", {}, element("summary", {}, "Draws, one by one"), element("table", {}, head, element("tbody", {}, ...rows)));
}

const shortened = (text, most) => (text.length > most ? `${text.slice(0, most - 1)}…` : text);

/** Lines of at most `most` characters, broken at blanks; SVG breaks none. */
function wrapped(text, most) {
  const lines = [""];
  for (const word of text.split(" ")) {
    const longer = `${lines.at(-1)} ${word}`.trim();
    if (longer.length <= most) lines[lines.length - 1] = longer;
    else lines.push(word);
  }
  return lines;
}
