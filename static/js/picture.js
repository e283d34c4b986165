// The picture on screen: an <img> that shows a stream, or one still after the other.

/** Keeps what is there on screen until the next has something to show. */
export class Picture {
  #view;
  #shown = null;
  #coming = null;

  constructor(view) {
    this.#view = view;
  }

  /** Shows what comes from `url`. The promise tells whether anything did; a later call makes it `false`. */
  show(url) {
    this.#drop(this.#coming);
    const image = this.#make();
    this.#coming = image;
    return new Promise((resolve) => {
      image.addEventListener("load", () => resolve(this.#take(image)), { once: true });
      image.addEventListener("error", () => resolve(false), { once: true });
      image.src = url;
    });
  }

  /** Whether something was asked for and has shown nothing yet. */
  get isWaiting() {
    return this.#coming !== null;
  }

  /** Ends the streams. What was shown stays, as far as the browser gives it away (Firefox: the first frame). */
  stop() {
    this.#drop(this.#coming);
    this.#coming = null;
    if (this.#shown instanceof HTMLImageElement) this.#freeze();
  }

  #freeze() {
    const still = document.createElement("canvas");
    [still.width, still.height] = [this.#shown.naturalWidth, this.#shown.naturalHeight];
    if (still.width > 0) still.getContext("2d").drawImage(this.#shown, 0, 0);
    this.#shown.before(still);
    this.#drop(this.#shown);
    this.#shown = still;
  }

  #make() {
    const image = document.createElement("img");
    image.alt = "";
    image.draggable = false;
    image.className = "coming";
    this.#view.prepend(image);
    return image;
  }

  #take(image) {
    if (image !== this.#coming) return false;
    this.#drop(this.#shown);
    image.className = "";
    this.#shown = image;
    this.#coming = null;
    return true;
  }

  /** Without a source first, or a browser goes on reading the stream. */
  #drop(image) {
    if (!image) return;
    image.src = "";
    image.remove();
  }
}
