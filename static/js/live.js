// The live view: the stream of the open scene, and what the server tells of each of its frames.

import { Picture } from "./picture.js";
import { Problem, ask, scenePath } from "./server.js";

/** Sharper than two device pixels nobody sees; more than this many nobody waits for. */
const MAX_PIXEL_RATIO = 2;
const MAX_PIXELS = 2_000_000;
const RESIZED_MS = 150;
/** A stream that has shown nothing so long after its first event will not: some browsers have no streams. */
const STREAM_PATIENCE_MS = 4000;
/** An unchanged frame comes once a second; after this the line is dead, or a frame takes far too long. */
const SILENCE_MS = 15_000;
/** What was shown last is remembered this often. */
const KEEP_MS = 1000;
const [FIRST_RETRY_MS, LAST_RETRY_MS] = [250, 5000];

const pause = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

/**
 * Events:
 * - `frame`: the stream shows a frame; `detail` is what the server says of it.
 * - `query`: size or output changed.
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
  #events = null;
  /** Grows with each start and stop, so that what belongs to an older one can tell. */
  #turn = 0;
  #hasStreams = true;
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
    scene.addEventListener("gone", () => this.#stop());
    document.addEventListener("visibilitychange", () => (document.hidden ? this.#stop() : this.#wake()));
    setInterval(() => this.#listenForSilence(), SILENCE_MS / 4);
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

  /** The size of the view in its own pixels, those of pointers. */
  get viewSize() {
    return { width: this.#view.clientWidth, height: this.#view.clientHeight };
  }

  /** The query of what is on screen, and more. */
  query(more = {}) {
    const output = this.#output === "color" ? {} : { output: this.#output };
    return new URLSearchParams({ ...this.size, ...output, ...more });
  }

  /** The path of the open scene's resource `name` with the query of what is on screen. */
  path(name, more) {
    return `${scenePath(this.#scene.id, name)}?${this.query(more)}`;
  }

  #restart() {
    this.frame = null;
    this.#start();
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
    if (this.#hasStreams) this.#showStream(turn);
    this.#listen(turn);
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
    this.#events?.close();
  }

  async #showStream(turn) {
    const shows = await this.#picture.show(this.path("stream.mjpg"));
    if (!shows && turn === this.#turn && this.#hasStreams) this.#recover();
  }

  #listen(turn) {
    this.#events = new EventSource(this.path("events"));
    this.#events.addEventListener("frame", ({ data }) => this.#take(JSON.parse(data)));
    this.#events.addEventListener("problem", ({ data }) => this.#refuse(Problem.from(JSON.parse(data))));
    this.#events.addEventListener("error", () => { if (turn === this.#turn) this.#recover(); });
    this.#events.addEventListener("frame", () => setTimeout(() => this.#doubtStreams(turn), STREAM_PATIENCE_MS), { once: true });
  }

  #take(frame) {
    this.frame = frame;
    this.#heardAt = performance.now();
    this.#keep();
    if (!this.#hasStreams && !this.#picture.isWaiting) this.#picture.show(this.path("frame.jpg", { t: frame.t }));
    this.#scene.see(frame.revision);
    this.#tell("frame", frame);
  }

  #keep() {
    if (this.#heardAt - this.#keptAt < KEEP_MS) return;
    this.#keptAt = this.#heardAt;
    this.#picture.keep();
  }

  #doubtStreams(turn) {
    if (turn !== this.#turn || !this.#picture.isWaiting) return;
    this.#hasStreams = false;
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
      try {
        await this.#probe();
        if (turn === this.#turn) this.#resume(lost);
        return;
      } catch (problem) {
        if (turn !== this.#turn) return;
        if (!problem.isPassing) return this.#giveUp(problem);
        if (!lost) this.#tell("lost");
        lost = true;
      }
    }
  }

  #resume(lost) {
    if (lost) this.#tell("back");
    this.#scene.resume();
    this.#wake();
  }

  #giveUp(problem) {
    if (problem.status === 404) this.#scene.refresh();
    else this.#refuse(problem);
  }

  /** Throws the `Problem` that keeps the server from showing this picture. */
  async #probe() {
    await ask("/healthz", { signal: AbortSignal.timeout(LAST_RETRY_MS) });
    const { body } = await ask(this.path("events"));
    body.cancel();
  }

  #listenForSilence() {
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
    const fit = Math.min(ratio, Math.sqrt(MAX_PIXELS / Math.max(width * height, 1)));
    const [w, h] = [width, height].map((side) => Math.max(16, Math.round(side * fit)));
    if (w === this.size.width && h === this.size.height) return false;
    this.size = { width: w, height: h };
    return true;
  }

  #tell(type, detail) {
    this.dispatchEvent(new CustomEvent(type, { detail }));
  }
}
