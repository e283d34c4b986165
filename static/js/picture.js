// The picture on screen: an <img> that shows a stream, or one still after the other.

import { element } from "./dom.js";

/** Keeps what is there on screen until the next has something to show. */
export class Picture {
  #view;
  #shown = null;
  #coming = null;
  /** Behind the image, with what it showed last: a stream that breaks off leaves a browser with nothing. */
  #kept = element("canvas", { width: 0, height: 0 });

  constructor(view) {
    this.#view = view;
    view.prepend(this.#kept);
  }

  /** Whether something was asked for and has shown nothing yet. */
  get isWaiting() {
    return this.#coming !== null;
  }

  /** Whether what is shown has lost its picture: a stream that broke off, as some browsers tell it. */
  get isBroken() {
    return this.#shown !== null && this.#shown.naturalWidth === 0;
  }

  /** Shows what comes from `url`. The promise tells whether anything did; a later call makes it `false`. */
  show(url) {
    this.#drop(this.#coming);
    const image = element("img", { alt: "", draggable: false, className: "coming" });
    this.#kept.after(image);
    this.#coming = image;
    this.#view.ariaBusy = true;
    return new Promise((resolve) => {
      image.addEventListener("load", () => resolve(this.#take(image)), { once: true });
      image.addEventListener("error", () => resolve(this.#giveUp(image)), { once: true });
      image.src = url;
    });
  }

  /** Remembers what is shown now, as far as the browser gives it away (Firefox: a stream's first frame). */
  keep() {
    if (!this.#shown?.naturalWidth) return;
    [this.#kept.width, this.#kept.height] = [this.#shown.naturalWidth, this.#shown.naturalHeight];
    this.#kept.getContext("2d").drawImage(this.#shown, 0, 0);
  }

  /** Ends the streams. What was shown stays. */
  stop() {
    this.keep();
    this.#drop(this.#coming);
    this.#drop(this.#shown);
    this.#coming = this.#shown = null;
  }

  #take(image) {
    if (image !== this.#coming) return false;
    this.#drop(this.#shown);
    image.className = "";
    this.#shown = image;
    this.#coming = null;
    this.#view.ariaBusy = false;
    return true;
  }

  #giveUp(image) {
    if (image !== this.#coming) return false;
    this.#drop(image);
    this.#coming = null;
    return false;
  }

  /** Without a source first, or a browser goes on reading the stream. */
  #drop(image) {
    if (!image) return;
    image.src = "";
    image.remove();
  }
}
