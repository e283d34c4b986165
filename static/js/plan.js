// The plan of what is on screen: the camera as it is settled, what runs, what is left out and why.

import { ask } from "./server.js";

/** Read no more often than this while the scene changes. */
const INTERVAL_MS = 300;

/** Event `change`: `current` is new. */
export class Plan extends EventTarget {
  /** As the server gives it; `null` before the first of a scene. */
  current = null;

  #scene;
  #live;
  #stale = false;
  #reading = false;

  constructor(scene, live) {
    super();
    this.#scene = scene;
    this.#live = live;
    let seen = null;
    scene.addEventListener("open", () => { this.current = seen = null; this.#read(); });
    live.addEventListener("query", () => this.#read());
    live.addEventListener("frame", ({ detail: { revision } }) => {
      if (revision !== seen) this.#read();
      seen = revision;
    });
  }

  async #read() {
    this.#stale = true;
    if (this.#reading) return;
    this.#reading = true;
    while (this.#stale) {
      this.#stale = false;
      await this.#readOnce();
      await new Promise((resolve) => setTimeout(resolve, INTERVAL_MS));
    }
    this.#reading = false;
  }

  /** What fails here fails for the stream as well, which tells about it. */
  async #readOnce() {
    const { id } = this.#scene;
    if (id === null) return; // The view has its size before a scene is open.
    const response = await ask(this.#live.path("plan")).catch(() => null);
    const plan = await response?.json();
    if (!plan || id !== this.#scene.id) return;
    this.current = plan;
    this.dispatchEvent(new Event("change"));
  }
}
