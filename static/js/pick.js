// What is at a pixel of the view.

import { getJson } from "./server.js";

/** The server's answer for (x, y) in pixels of the view; `instance: null` for the background. */
export async function pick({ live, scene }, x, y) {
  const { viewSize, size, frame } = live;
  const query = new URLSearchParams({
    ...size,
    x: pixel(x, viewSize.width, size.width),
    y: pixel(y, viewSize.height, size.height),
    t: frame?.t ?? 0,
  });
  return getJson(`${scene.path}/pick?${query}`);
}

function pixel(at, viewSide, side) {
  return Math.min(Math.max(Math.floor((at * side) / viewSide), 0), side - 1);
}
