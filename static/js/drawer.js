// The drawer with the panels: open where there is room for it.

const WIDE = "(min-width: 801px)";

/** `opener` opens and closes the drawer `panels`; the link `skip` leads into it. */
export function mountDrawer(panels, opener, skip) {
  const show = (isOpen) => {
    panels.hidden = !isOpen;
    opener.setAttribute("aria-expanded", isOpen);
  };
  opener.addEventListener("click", () => show(panels.hidden));
  skip.addEventListener("click", (event) => {
    event.preventDefault(); // The address names the scene.
    show(true);
    panels.focus();
  });
  show(matchMedia(WIDE).matches);
}
