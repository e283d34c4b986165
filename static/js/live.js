// The live view: the stream of the open scene, and what the server tells of each of its frames.

import { same } from "./merge.js";
import { Picture } from "./picture.js";
import { Problem, ask, scenePath } from "./server.js";

/** Sharper than two device pixels nobody sees. */
const MAX_PIXEL_RATIO = 2;
/** For a picture sharper than the view's own pixels nobody waits longer than for this many, for any than for these. */
const [MAX_SHARP_PIXELS, MAX_PIXELS] = [2_000_000, 8_000_000];
const RESIZED_MS = 150;
/** A stream that has shown nothing so long after an event will not: some browsers have no streams. */
const STREAM_PATIENCE_MS = 4000;
/** So long there are stills before a stream is tried again; twice as long each time. */
const FIRST_STILLS_MS = 15_000;
/** No browser tells whenever a stream has ended: after this one takes the place of the other. */
const RENEW_MS = 10_000;
/** An unchanged frame comes once a second; after this the line is dead, or a frame takes far too long. */
const SILENCE_MS = 15_000;
/** What was shown last is remembered this often. */
const KEEP_MS = 1000;
const [FIRST_RETRY_MS, LAST_RETRY_MS] = [250, 5000];

const pause = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

/**
 * Events:
 * - `frame`: the stream shows a frame; `detail` is what the server says of it.
 * - `query`: size, output, budget or time changed.
 * - `report`: how far a report on the open scene is; `detail` is `{stage, done}`, the latter 0–1.
 * - `lost`, `back`: the connection.
 * - `problem`: the server cannot make this picture; `detail.problem`.
 */
export class Live extends EventTarget {
  /** What the server said of the last frame; `null` before the first of a scene. */
  frame = null;
  /** Of the picture, in pixels. */
  size = { width: 0, height: 0 };

  #scene;
  #view;
  #picture;
  #output = "color";
  #budget = null;
  #frozenAt = null;
  #events = null;
  /** Grows with each start and stop, so that what belongs to an older one can tell. */
  #turn = 0;
  /** Whether a stream is asked for, or stills are. */
  #streams = true;
  /** How many streams. */
  #asked = 0;
  /** Until then there are stills. */
  #stillsUntil = -Infinity;
  #stillsMs = FIRST_STILLS_MS;
  /** The scene's revision that cannot be drawn, as long as nothing else is tried. */
  #refused = null;
  #heardAt = 0;
  #keptAt = 0;

  constructor(scene, view) {
    super();
    this.#scene = scene;
    this.#view = view;
    this.#picture = new Picture(view);
    this.#measure();
    this.#watchSize();
    scene.addEventListener("open", () => this.#restart());
    scene.addEventListener("saved", () => this.#tryChanged());
    scene.addEventListener("gone", () => this.#stop());
    document.addEventListener("visibilitychange", () => (document.hidden ? this.#stop() : this.#wake()));
    setInterval(() => this.#lookAfter(), SILENCE_MS / 4);
  }

  /** Which stage of the pipeline is shown: a word of the query's `output`. */
  get output() {
    return this.#output;
  }

  set output(output) {
    if (output === this.#output) return;
    this.#output = output;
    this.#requery();
  }

  /** What a picture may cost or err by: `preset`, `max_ms` or `max_error` of the query; `null`: the scene says. */
  get budget() {
    return this.#budget;
  }

  set budget(budget) {
    if (same(budget, this.#budget)) return;
    this.#budget = budget;
    this.#requery();
  }

  /** Has the server settle the budget anew: what it knows of the scene has changed. */
  settleAnew() {
    if (this.#budget !== null) this.#requery();
  }

  /** Seconds at which time stands still for the view; `null`: it goes on. */
  set frozenAt(t) {
    if (t === this.#frozenAt) return;
    this.#frozenAt = t;
    this.#requery();
  }

  /** The size of the view in its own pixels, those of pointers. */
  get viewSize() {
    return { width: this.#view.clientWidth, height: this.#view.clientHeight };
  }

  /** The query of what is on screen, and more. */
  query(more = {}) {
    const output = this.#output === "color" ? {} : { output: this.#output };
    const time = this.#frozenAt === null ? {} : { t: this.#frozenAt };
    return new URLSearchParams({ ...this.size, ...output, ...time, ...this.#budget, ...more });
  }

  /** The path of the open scene's resource `name` with the query of what is on screen. */
  path(name, more) {
    return `${scenePath(this.#scene.id, name)}?${this.query(more)}`;
  }

  #restart() {
    this.frame = null;
    this.#stillsUntil = -Infinity;
    this.#stillsMs = FIRST_STILLS_MS;
    // What else follows the scene comes first: bars that grow take their part of the view.
    queueMicrotask(() => (this.#measure() ? this.#requery() : this.#start()));
  }

  #requery() {
    this.#tell("query");
    this.#start();
  }

  #start() {
    this.#stopListening();
    if (document.hidden || this.#scene.id === null) return;
    const turn = this.#turn;
    this.#heardAt = performance.now();
    this.#streams = this.#heardAt >= this.#stillsUntil;
    this.#listen(turn);
    if (this.#streams) this.#showStream(turn);
  }

  /** Others may have changed the scene meanwhile, and a new server counts revisions anew. */
  #wake() {
    if (this.#scene.id !== null) this.#scene.refresh();
    this.#start();
  }

  #stop() {
    this.#stopListening();
    this.#picture.stop();
  }

  #stopListening() {
    this.#turn += 1;
    this.#refused = null;
    this.#events?.close();
  }

  /** Shows the stream, and a new one after a while, for as long as the turn lasts. */
  async #showStream(turn) {
    let isWaiting = true;
    const doubt = () => { if (isWaiting && turn === this.#turn) this.#doubtStreams(); };
    this.#events.addEventListener("frame", () => setTimeout(doubt, STREAM_PATIENCE_MS), { once: true });
    const shows = await this.#picture.show(this.#nextStream());
    isWaiting = false;
    if (turn !== this.#turn) return;
    if (!shows) return this.#recover();
    this.#stillsMs = FIRST_STILLS_MS;
    setTimeout(() => { if (turn === this.#turn) this.#showStream(turn); }, RENEW_MS);
  }

  /** Chromium shows the stream that it has for an address, be it dead: each has another address than the one before. */
  #nextStream() {
    this.#asked += 1;
    return this.path("stream.mjpg") + "&".repeat(this.#asked % 2);
  }

  #listen(turn) {
    this.#events = new EventSource(this.path("events"));
    this.#events.addEventListener("frame", ({ data }) => this.#take(JSON.parse(data)));
    this.#events.addEventListener("report", ({ data }) => this.#tell("report", JSON.parse(data)));
    this.#events.addEventListener("problem", ({ data }) => this.#refuse(Problem.from(JSON.parse(data))));
    this.#events.addEventListener("error", () => { if (turn === this.#turn) this.#recover(); });
  }

  #take(frame) {
    this.frame = frame;
    this.#heardAt = performance.now();
    this.#keep();
    if (!this.#streams) this.#showStill(frame);
    this.#scene.see(frame.revision);
    this.#tell("frame", frame);
  }

  #showStill({ t }) {
    if (this.#heardAt >= this.#stillsUntil) this.#start();
    else if (!this.#picture.isWaiting) this.#picture.show(this.path("frame.jpg", { t }));
  }

  #keep() {
    if (this.#heardAt - this.#keptAt < KEEP_MS) return;
    this.#keptAt = this.#heardAt;
    if (this.#picture.isBroken) this.#recover();
    else this.#picture.keep();
  }

  #doubtStreams() {
    this.#stillsUntil = performance.now() + this.#stillsMs;
    this.#stillsMs *= 2;
    this.#picture.stop();
    this.#start();
  }

  #refuse(problem) {
    this.#tell("problem", { problem });
  }

  /** The stream has ended or cannot be had: finds out why, waits until it can be had, and starts again. */
  async #recover() {
    this.#stopListening();
    const turn = this.#turn;
    let lost = false;
    for (let wait = FIRST_RETRY_MS; turn === this.#turn; wait = Math.min(wait * 2, LAST_RETRY_MS)) {
      await pause(wait);
      const revision = this.#scene.summary?.revision;
      try {
        await this.#probe();
        if (turn === this.#turn) this.#resume(lost);
        return;
      } catch (problem) {
        if (turn !== this.#turn) return;
        if (!problem.isPassing) return this.#giveUp(problem, revision);
        if (!lost) this.#tell("lost");
        lost = true;
      }
    }
  }

  #resume(lost) {
    if (lost) this.#tell("back");
    this.#wake();
  }

  #giveUp(problem, revision) {
    if (problem.status === 404) return this.#scene.refresh();
    this.#refused = revision;
    this.#refuse(problem);
  }

  /** What could not be drawn may be drawn once it is another. */
  #tryChanged() {
    if (this.#refused !== null && this.#scene.summary?.revision !== this.#refused) this.#start();
  }

  /** Throws the `Problem` that keeps the server from showing this picture. */
  async #probe() {
    await ask("/healthz", { signal: AbortSignal.timeout(LAST_RETRY_MS) });
    const { body } = await ask(this.path("events"));
    body.cancel();
  }

  #lookAfter() {
    if (this.#refused !== null) this.#scene.refresh(); // no frame tells of changes
    const isListening = this.#events !== null && this.#events.readyState !== EventSource.CLOSED;
    if (isListening && performance.now() - this.#heardAt > SILENCE_MS) this.#recover();
  }

  #watchSize() {
    let timer = 0;
    new ResizeObserver(() => {
      clearTimeout(timer);
      timer = setTimeout(() => this.#measure() && this.#requery(), RESIZED_MS);
    }).observe(this.#view);
  }

  /** Whether the picture's size has changed. */
  #measure() {
    const { width, height } = this.viewSize;
    const ratio = Math.min(devicePixelRatio || 1, MAX_PIXEL_RATIO);
    const [sharpest, largest] = [MAX_SHARP_PIXELS, MAX_PIXELS].map((most) => Math.sqrt(most / Math.max(width * height, 1)));
    const fit = Math.min(ratio, Math.max(sharpest, 1), largest);
    const [w, h] = [width, height].map((side) => Math.max(16, Math.round(side * fit)));
    if (w === this.size.width && h === this.size.height) return false;
    this.size = { width: w, height: h };
    return true;
  }

  #tell(type, detail) {
    this.dispatchEvent(new CustomEvent(type, { detail }));
  }
}
