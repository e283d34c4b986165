// Having the server measure error against run time of what is on screen.

import { same } from "./merge.js";
import { Problem, ask, scenePath } from "./server.js";

/** Pixels in a row: a report is made in a size of its own, where its reference is affordable. */
const WIDTH = 320;
const FAILED = "The report could not be made";

/**
 * One measurement at a time.
 *
 * Events:
 * - `change`: one has begun or ended.
 * - `made`: there is a report; `detail` is a {@link Made}.
 *
 * @typedef {object} Made
 * @property {string} id of the scene
 * @property {object} document of the scene, as it was measured
 * @property {{svg: Blob, html?: Blob, json?: Blob}} files only the figure if the scene has changed meanwhile
 * @property {boolean} isPartial whether the time was too short for all that there is to measure
 */
export class Measuring extends EventTarget {
  #app;
  #abort = null;

  constructor(app) {
    super();
    this.#app = app;
    app.scene.addEventListener("open", () => this.cancel());
  }

  get isUnderWay() {
    return this.#abort !== null;
  }

  /** The server stops as well, unless others wait for the same report. */
  cancel() {
    this.#abort?.abort();
  }

  async begin(seconds) {
    const { scene, live, notices } = this.#app;
    notices.clear(FAILED);
    this.#abort = new AbortController();
    this.#tell("change");
    try {
      const t = live.frame?.t ?? 0;
      live.frozenAt = t; // What is measured stays on screen, and the server has its hands free.
      this.#tell("made", await made(scene, queryOf(live, t, seconds), this.#abort.signal));
    } catch (problem) {
      if (problem.name === "AbortError") return;
      if (!(problem instanceof Problem)) throw problem;
      notices.show(problem, FAILED);
    } finally {
      this.#abort = null;
      live.frozenAt = null;
      this.#tell("change");
    }
  }

  #tell(type, detail) {
    this.dispatchEvent(new CustomEvent(type, { detail }));
  }
}

/** The figure first: a browser has few connections, and the server keeps the report for the other files. */
async function made(scene, query, signal) {
  await scene.settled(); // The server shall measure what the page shows.
  const { id, document } = scene;
  const file = async (format) => (await ask(`${scenePath(id, `report.${format}`)}?${query}`, { signal })).blob();
  const files = { svg: await file("svg") };
  // Of a scene that has changed they would be another report.
  if (!same(document, scene.document)) return { id, document, files, isPartial: false };
  Object.assign(files, { html: await file("html"), json: await file("json") });
  const { unfinished } = JSON.parse(await files.json.text());
  return { id, document, files, isPartial: unfinished.length > 0 };
}

/** What is on screen, but for its budget: a report tells of all of them. */
function queryOf({ viewSize: { width, height } }, t, seconds) {
  const size = { width: WIDTH, height: Math.max(1, Math.round(WIDTH * height / width)) };
  return new URLSearchParams({ ...size, t, budget_s: seconds });
}
