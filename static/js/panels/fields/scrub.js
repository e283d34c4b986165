// Changing a number by dragging sideways over its label.

/** Pixels that a hand moves without meaning to. */
const DEAD_ZONE_PX = 3;

/** Lets `handle` be dragged: `begin()` gives the number at the start, `move(start, pixels)` gets the way from there. */
export function scrubbable(handle, begin, move) {
  handle.classList.add("scrub");
  handle.addEventListener("pointerdown", (down) => {
    if (down.button !== 0) return;
    const start = begin();
    whileDragging((event) => {
      const pixels = event.clientX - down.clientX;
      if (!handle.hasPointerCapture(event.pointerId)) {
        if (Math.abs(pixels) < DEAD_ZONE_PX) return;
        handle.setPointerCapture(event.pointerId);
      }
      move(start, pixels);
    });
  });
}

/** Calls `onMove` for each move of the pointer until it is lifted. */
export function whileDragging(onMove) {
  const drag = new AbortController();
  const { signal } = drag;
  addEventListener("pointermove", onMove, { signal });
  addEventListener("pointerup", () => drag.abort(), { signal });
  addEventListener("pointercancel", () => drag.abort(), { signal });
}
