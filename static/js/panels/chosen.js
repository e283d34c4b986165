// Which entry of a map of the document a panel is about.

/** A name in the map `part` of the document, the first where nothing else is chosen; event `change`. */
export class Chosen extends EventTarget {
  /** @type {string | null} */
  name = null;
  #scene;
  #part;

  constructor(scene, part) {
    super();
    this.#scene = scene;
    this.#part = part;
    for (const type of ["open", "change"]) scene.addEventListener(type, () => this.select(this.name));
    scene.addEventListener("problem", ({ detail: { patch } }) => this.#keep(patch?.[part] ?? {}));
  }

  /** An entry that could not be removed is chosen again, so that one sees why. */
  #keep(refused) {
    const kept = Object.keys(refused).find((name) => refused[name] === null);
    if (kept !== undefined) this.select(kept);
  }

  /** Chooses an entry. One that is not there gives way to the one before, and that to the first. */
  select(name) {
    const entries = this.#scene.document?.[this.#part] ?? {};
    const next = [name, this.name, ...Object.keys(entries)].find((known) => known in entries) ?? null;
    if (next === this.name) return;
    this.name = next;
    this.dispatchEvent(new Event("change"));
  }
}
