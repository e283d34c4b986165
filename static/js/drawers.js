// The drawers beside the picture, of which one at a time is open: the panels from the start, where there is room.

const WIDE = "(min-width: 801px)";

export class Drawers {
  #drawers;
  #opener;

  /** The first of the drawers is the panels': `opener` opens and closes them, the link `skip` leads into them. */
  constructor(drawers, opener, skip) {
    this.#drawers = drawers;
    this.#opener = opener;
    const [panels] = drawers;
    opener.addEventListener("click", () => this.#open(panels.hidden ? panels : null));
    skip.addEventListener("click", (event) => {
      event.preventDefault(); // The address names the scene.
      this.show(panels);
    });
    this.showHome();
  }

  /** Opens a drawer and goes into it. */
  show(drawer) {
    this.#open(drawer);
    drawer.focus();
  }

  /** As it is from the start. */
  showHome() {
    this.#open(matchMedia(WIDE).matches ? this.#drawers[0] : null);
  }

  #open(shown) {
    for (const drawer of this.#drawers) drawer.hidden = drawer !== shown;
    this.#opener.setAttribute("aria-expanded", !this.#drawers[0].hidden);
  }
}
