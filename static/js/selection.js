// Which instance is selected.

/** Event `change`: `name` is new. */
export class Selection extends EventTarget {
  /** @type {string | null} */
  name = null;

  #scene;

  constructor(scene) {
    super();
    this.#scene = scene;
    scene.addEventListener("open", () => this.select(null));
    scene.addEventListener("change", () => { if (!this.instance) this.select(null); });
  }

  /** The selected instance in the document. */
  get instance() {
    return this.#scene.document?.instances?.[this.name];
  }

  select(name) {
    if (name === this.name) return;
    this.name = name;
    this.dispatchEvent(new Event("change"));
  }

  /** Changes fields of the selected instance, if there still is one. */
  edit(patch) {
    if (this.name !== null) this.#scene.edit({ instances: { [this.name]: patch } });
  }
}
