// The drawer with error against run time: measured on demand, shown beside the picture.

import { button, element } from "./dom.js";
import { Measuring } from "./measuring.js";
import { same } from "./merge.js";

/** What one may spend on a report. */
const SECONDS = [10, 30, 60];
const USUAL_SECONDS = 30;
const INTRODUCTION = "Draws the exact picture of what is on screen, compares every setting of samples, shadows, textures and "
  + "size with it, and times them. From then on, that decides what “Quality” in the panel “Render” chooses.";
/** What is being done, by the stages of `report` events. */
const STAGES = {
  reference: "Drawing the exact picture…",
  errors: "Comparing the settings with it…",
  components: "Comparing edges, shadows and textures…",
  timing: "Timing the settings against each other…",
  ways: "Drawing it in other ways…",
  stability: "Running the stiff cases…",
};
const WAITING = "Waiting for the server…";

/** Fills the drawer; `close` closes it. */
export function mountReport(app, drawer, close) {
  const { scene, live } = app;
  const measuring = new Measuring(app);
  const figure = new Figure();
  drawer.append(
    button("Close", close, { className: "close" }),
    element("h2", { id: "report-title" }, "Error and time"),
    element("p", { className: "note introduction" }, INTRODUCTION),
    commands(measuring),
    progress(measuring, live),
    figure.element,
  );
  measuring.addEventListener("made", ({ detail }) => {
    figure.show(detail);
    figure.compare(scene.document);
    live.settleAnew(); // From now on a budget buys what was measured.
  });
  scene.addEventListener("change", () => figure.compare(scene.document));
  scene.addEventListener("open", () => figure.clear());
}

/** The seconds to spend, and the button that begins and cancels. */
function commands(measuring) {
  const options = SECONDS.map((seconds) => element("option", { value: seconds }, `${seconds} s`));
  const seconds = element("select", { id: "report-seconds" }, ...options);
  seconds.value = USUAL_SECONDS;
  const toggle = button("", () => (measuring.isUnderWay ? measuring.cancel() : measuring.begin(seconds.value)), { id: "measure" });
  const follow = () => {
    toggle.textContent = measuring.isUnderWay ? "Cancel" : "Measure";
    seconds.disabled = measuring.isUnderWay;
  };
  measuring.addEventListener("change", follow);
  follow();
  return element("div", { className: "row" }, element("label", { htmlFor: seconds.id }, "Time to spend"), seconds, toggle);
}

/** How far the measurement is. */
function progress(measuring, live) {
  const bar = element("progress", { id: "report-progress", max: 1, "aria-label": "Measuring" });
  const stage = element("p", { className: "note", role: "status" });
  const say = (text) => { if (stage.textContent !== text) stage.textContent = text; }; // once to a screen reader
  const box = element("div", { className: "progress", hidden: true }, bar, stage);
  measuring.addEventListener("change", () => {
    box.hidden = !measuring.isUnderWay;
    bar.removeAttribute("value"); // Nobody knows yet.
    say(WAITING);
  });
  live.addEventListener("report", ({ detail }) => {
    bar.value = detail.done;
    say(STAGES[detail.stage] ?? WAITING);
  });
  return box;
}

/** The figure of the last report, its files, and whether it still is about what is on screen. */
class Figure {
  #image = element("img");
  #zoom = button("", () => this.#turn(), { className: "zoom", title: "Full size, or as wide as there is room" });
  #links = element("p", { className: "links" });
  #partial = element("p", { className: "note", id: "report-partial" }, "Not every setting was measured in that time; more seconds show more.");
  #remark = element("p", { className: "note", id: "report-remark", role: "status" });
  #urls = [];
  /** The scene's document as it was measured. */
  #measured = null;

  constructor() {
    this.#zoom.append(this.#image);
    this.#zoom.setAttribute("aria-pressed", false);
    const caption = element("figcaption", {}, this.#links, this.#partial, this.#remark);
    this.element = element("figure", { hidden: true }, caption, element("div", { className: "paper" }, this.#zoom));
  }

  show({ id, document, files: { svg, html, json }, isPartial }) {
    this.clear();
    this.#measured = document;
    this.#image.src = this.#address(svg);
    this.#image.alt = `Error over time of ${id} at many settings, time per pass, and error over each setting`;
    const page = html && element("a", { href: this.#address(html), target: "_blank", id: "report-page" }, "Open with all numbers");
    const data = json && element("a", { href: this.#address(json), download: `${id}-report.json`, id: "report-data" }, "Save as JSON");
    this.#links.replaceChildren(...[page, data].filter(Boolean));
    this.#partial.hidden = !isPartial;
    this.element.hidden = false;
  }

  /** Says so if `document` is another than was measured. */
  compare(document) {
    const isOther = this.#measured !== null && !same(document, this.#measured);
    this.#remark.textContent = isOther ? "The scene or the view has changed since this was measured." : "";
  }

  clear() {
    this.#urls.forEach((url) => URL.revokeObjectURL(url));
    this.#urls = [];
    this.#measured = null;
    this.element.hidden = true;
  }

  #address(file) {
    const url = URL.createObjectURL(file);
    this.#urls.push(url);
    return url;
  }

  #turn() {
    this.#zoom.setAttribute("aria-pressed", this.#zoom.ariaPressed !== "true");
  }
}
