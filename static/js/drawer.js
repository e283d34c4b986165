// The drawer with the panels: open where there is room for it.

const WIDE = "(min-width: 801px)";

/** `opener` opens and closes the drawer `panels`. */
export function mountDrawer(panels, opener) {
  const show = (isOpen) => {
    panels.hidden = !isOpen;
    opener.setAttribute("aria-expanded", isOpen);
  };
  opener.addEventListener("click", () => show(panels.hidden));
  show(matchMedia(WIDE).matches);
}
