// Undo and redo of what the user changes in the scene. Looking around is no change of it, and what others change
// stays.

import { difference, merged } from "./merge.js";

/** Edits that follow each other more closely are one step: a drag, a held key, a slider. */
const STEP_MS = 500;
const MAX_STEPS = 200;

/** Event `change`: there is something else to undo or to redo. */
export class History extends EventTarget {
  #scene;
  /** The newest last; each a list of patches that lead back, the newest last too. */
  #done = [];
  /** The newest last; each a patch that leads on. */
  #undone = [];
  #content = {};
  #editedAt = -Infinity;
  #isGoing = false;

  constructor(scene) {
    super();
    this.#scene = scene;
    scene.addEventListener("open", () => this.#begin());
    scene.addEventListener("change", ({ detail }) => this.#follow(detail.own && !this.#isGoing));
  }

  get canUndo() {
    return this.#done.length > 0;
  }

  get canRedo() {
    return this.#undone.length > 0;
  }

  undo() {
    const step = this.#done.pop();
    if (step) this.#undone.push(this.#go((content) => step.reduceRight(merged, content)));
    this.#tell();
  }

  redo() {
    const patch = this.#undone.pop();
    if (patch) this.#done.push([this.#go((content) => merged(content, patch))]);
    this.#tell();
  }

  #begin() {
    [this.#done, this.#undone] = [[], []];
    this.#content = contentOf(this.#scene.document);
    this.#tell();
  }

  /** Takes notice of a change; one by the user's hand can be undone. */
  #follow(isStep) {
    const content = contentOf(this.#scene.document);
    const back = difference(content, this.#content);
    this.#content = content;
    if (!isStep || back === undefined) return;
    const now = performance.now();
    if (now - this.#editedAt > STEP_MS || !this.canUndo) this.#done.push([]);
    this.#editedAt = now;
    this.#done.at(-1).push(back);
    this.#done.splice(0, this.#done.length - MAX_STEPS);
    this.#undone = [];
    this.#tell();
  }

  /** Changes the scene to what `change` makes of it. Answers the patch that leads back. */
  #go(change) {
    const before = this.#content;
    const after = change(before);
    this.#editedAt = -Infinity;
    this.#isGoing = true;
    this.#scene.edit(difference(before, after) ?? {});
    this.#isGoing = false;
    return difference(after, before) ?? {};
  }

  #tell() {
    this.dispatchEvent(new Event("change"));
  }
}

function contentOf({ camera, ...content }) {
  return content;
}
