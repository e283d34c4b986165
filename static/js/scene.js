// The open scene: its document as the user wants it, and how the server comes to have the same.

import { Problem, ask, getJson, scenePath, sendJson } from "./server.js";
import { difference, merged } from "./merge.js";

/** So long after the last edit the scene is read again: the server fills in the defaults of what is new. */
const SETTLED_MS = 250;
/** Pictures lag behind the document by a few revisions; more are not asked for. */
const REMEMBERED_REVISIONS = 64;

/**
 * One scene at a time. Edits are visible at once in `document`; one PATCH at a time takes what has changed since
 * the last to the server, so a slow server gets the newest state and never a queue.
 *
 * Events:
 * - `open`: another scene is open; `document` and `summary` are new.
 * - `change`: `document` has changed, by an edit or by somebody else; `detail.own` tells which.
 * - `saved`: the server has all edits; `summary` is new.
 * - `problem`: the server refused an edit, which is undone; `detail.problem`, `detail.patch`.
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

  /** Sends what an earlier failure to reach the server left unsent. */
  resume() {
    this.#send();
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
    this.#sending = this.#sendAll(id).then((sent) => {
      this.#sending = null;
      if (id !== this.id) this.#send();
      else if (sent) this.#settling = setTimeout(() => this.refresh(), SETTLED_MS);
    });
  }

  /** Sends patch after patch until nothing is left. Answers whether the server took any. */
  async #sendAll(id) {
    let sent = false;
    try {
      for (;;) {
        const patch = difference(this.#confirmed, this.document);
        if (patch === undefined || id !== this.id) return sent;
        const summary = await this.#sendOne(id, patch);
        if (id !== this.id) return sent;
        sent = true;
        this.#confirmed = merged(this.#confirmed, patch);
        this.#revision = summary.revision;
        this.summary = summary;
        this.#remember();
      }
    } catch (problem) {
      this.#fail(problem, id);
      return sent;
    }
  }

  async #sendOne(id, patch) {
    try {
      return await sendJson("PATCH", scenePath(id), patch, { "Content-Type": "application/merge-patch+json" });
    } catch (problem) {
      if (problem instanceof Problem && !problem.isPassing) problem.patch = patch;
      throw problem;
    }
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
    if (problem.status === 404) return this.#tell("gone");
    if (problem.patch) {
      this.document = this.#confirmed;
      this.#tell("change", { own: false });
    }
    this.#tell("problem", { problem, patch: problem.patch });
  }

  #tell(type, detail) {
    this.dispatchEvent(new CustomEvent(type, { detail }));
  }
}

async function read(id) {
  const [response, summaries] = await Promise.all([ask(scenePath(id)), getJson("/scenes")]);
  const document = await response.json();
  return { document, etag: response.headers.get("ETag"), summary: summaries.find((entry) => entry.id === id) ?? null };
}
