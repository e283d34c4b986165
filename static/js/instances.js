// What the server knows of the instances: ids, triangles, bounds of their meshes.

import { getJson } from "./server.js";
import { union } from "./vec.js";

/** Event `change`: `list` is new. */
export class Instances extends EventTarget {
  list = [];

  #scene;

  constructor(scene) {
    super();
    this.#scene = scene;
    scene.addEventListener("open", () => { this.list = []; this.read(); });
    scene.addEventListener("saved", () => this.read());
  }

  named(name) {
    return this.list.find((instance) => instance.name === name);
  }

  /** Reads it again, as of time `t` for those that spin. */
  async read(t = 0) {
    const { id } = this.#scene;
    const list = await getJson(`${this.#scene.path}/instances?t=${t}`).catch(() => null);
    if (!list || id !== this.#scene.id) return;
    this.list = list;
    this.dispatchEvent(new Event("change"));
  }

  /** The box around all that is meant to be looked at. */
  bounds() {
    const visible = this.list.filter(({ visible, bounds }) => visible && bounds);
    const framed = visible.filter(({ name }) => this.#scene.document.instances[name]?.framed !== false);
    return union((framed.length > 0 ? framed : visible).map(({ bounds }) => bounds));
  }
}
