// The open scene: its document as the user wants it, and how the server comes to have the same.

import { Problem, ask, getJson, jsonOf, scenePath, sendJson } from "./server.js";
import { difference, merged } from "./merge.js";

/** So long after the last edit the scene is read again: the server fills in the defaults of what is new. */
const SETTLED_MS = 250;
/** So long after the server could not take an edit it is asked again. */
const RETRY_MS = 1000;
/** Pictures lag behind the document by a few revisions; more are not asked for. */
const REMEMBERED_REVISIONS = 64;

const pause = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

/**
 * One scene at a time. Edits are visible at once in `document`; one PATCH at a time takes what has changed since
 * the last to the server, so a slow server gets the newest state and never a queue.
 *
 * Events:
 * - `open`: another scene is open; `document` and `summary` are new.
 * - `change`: `document` has changed, by an edit or by somebody else; `detail.own` tells which.
 * - `saved`: the server has all edits; `summary` is new.
 * - `unsent`: the server cannot take an edit now; it is sent again until `saved`.
 * - `problem`: the server refused edits, which are undone; `detail.problem`, `detail.patch`.
 * - `gone`: the scene was deleted.
 */
export class OpenScene extends EventTarget {
  /** @type {string | null} */
  id = null;
  /** With all defaults filled in, and with edits that the server may not have yet. */
  document = null;
  /** As the server describes it. */
  summary = null;

  #confirmed = null;
  #etag = "";
  #revision = 0;
  /** Until the server has all edits: the promise of that. */
  #sending = null;
  #reading = null;
  #settling = 0;
  #documents = new Map();

  get path() {
    return scenePath(this.id);
  }

  /** Opens a scene. Throws a `Problem`, and then the one before stays open. */
  async open(id) {
    const { document, etag, summary } = await read(id);
    clearTimeout(this.#settling);
    Object.assign(this, { id, document, summary });
    this.#confirmed = document;
    this.#etag = etag;
    this.#revision = summary?.revision ?? 0;
    this.#documents.clear();
    this.#remember();
    this.#tell("open");
  }

  /** The document that a picture of this revision shows, if it is known. */
  documentAt(revision) {
    return this.#documents.get(revision);
  }

  /** Merges `patch` into the document now, and lets the server know as soon as it has time. */
  edit(patch) {
    this.document = merged(this.document, patch);
    this.#tell("change", { own: true });
    this.#send();
  }

  /** Resolves when the server has answered all edits, well or not, and the scene is read again. */
  async settled() {
    await this.#sending;
    await this.refresh();
  }

  /** A frame shows this revision: if it is newer than ours, somebody else has changed the scene. */
  async see(revision) {
    if (revision <= this.#revision || this.#sending || this.#reading) return;
    await this.refresh();
  }

  /** Reads the scene again, keeping edits that the server does not have yet. */
  async refresh() {
    this.#reading ??= this.#read().finally(() => { this.#reading = null; });
    return this.#reading;
  }

  async #read() {
    const { id } = this;
    const revision = this.#revision;
    try {
      const { document, etag, summary } = await read(id);
      // What came from before an edit of ours would undo it; the scene is read again when that has settled.
      if (id !== this.id || this.#sending || this.#revision !== revision) return;
      const isNew = etag !== this.#etag;
      if (summary?.revision < this.#revision) this.#documents.clear(); // a new server, which counts anew
      this.#revision = summary?.revision ?? this.#revision;
      this.summary = summary ?? this.summary;
      this.#take(document, etag);
      this.#remember();
      if (isNew) this.#tell("change", { own: false });
      this.#tell("saved");
    } catch (problem) {
      this.#fail(problem, id);
    }
  }

  #send() {
    if (this.#sending) return;
    const { id } = this;
    clearTimeout(this.#settling);
    this.#sending = this.#sendAll(id).then(() => {
      this.#sending = null;
      if (id !== this.id) this.#send();
      else this.#settling = setTimeout(() => this.refresh(), SETTLED_MS);
    });
  }

  /** Sends patch after patch until the server has answered all edits. */
  async #sendAll(id) {
    for (;;) {
      const patch = difference(this.#confirmed, this.document);
      if (patch === undefined || id !== this.id) return;
      try {
        const summary = await sendJson("PATCH", scenePath(id), patch, { "Content-Type": "application/merge-patch+json" });
        if (id === this.id) this.#confirm(patch, summary);
      } catch (problem) {
        if (!(problem instanceof Problem)) throw problem;
        if (id !== this.id || problem.status === 404) return; // reading the scene tells that it is gone
        if (problem.isPassing) await this.#waitToSend();
        else this.#takeBack(patch, problem);
      }
    }
  }

  #confirm(patch, summary) {
    this.#confirmed = merged(this.#confirmed, patch);
    this.#revision = summary.revision;
    this.summary = summary;
    this.#remember();
  }

  async #waitToSend() {
    this.#tell("unsent");
    await pause(RETRY_MS);
  }

  /** Undoes the edits of a refused patch and keeps those that came after it. */
  #takeBack(patch, problem) {
    const later = difference(merged(this.#confirmed, patch), this.document);
    this.document = later === undefined ? this.#confirmed : merged(this.#confirmed, later);
    this.#tell("change", { own: false });
    this.#tell("problem", { problem, patch });
  }

  #remember() {
    this.#documents.set(this.#revision, this.#confirmed);
    if (this.#documents.size > REMEMBERED_REVISIONS) this.#documents.delete(this.#documents.keys().next().value);
  }

  /** The server's document, under the edits that it does not have. */
  #take(document, etag) {
    const unsent = difference(this.#confirmed, this.document);
    this.#confirmed = document;
    this.#etag = etag;
    this.document = unsent === undefined ? document : merged(document, unsent);
  }

  #fail(problem, id) {
    if (!(problem instanceof Problem)) throw problem;
    if (id !== this.id || problem.isPassing) return;
    if (problem.status === 404) this.#tell("gone");
    else this.#tell("problem", { problem });
  }

  #tell(type, detail) {
    this.dispatchEvent(new CustomEvent(type, { detail }));
  }
}

/** The summary first: under a revision that is too old the next frame makes us read again, under a newer one nothing. */
async function read(id) {
  const summaries = await getJson("/scenes");
  const response = await ask(scenePath(id));
  const document = await jsonOf(response);
  return { document, etag: response.headers.get("ETag"), summary: summaries.find((entry) => entry.id === id) ?? null };
}
