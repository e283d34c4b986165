// The edge of what one instance shows in the picture, traced from the picture of ids.

import { ask } from "./server.js";

/** Right, down, left, up: the cell ahead on the right and on the left of a vertex, as offsets from it. */
const STEPS = [
  { x: 1, y: 0, right: [0, 0], left: [0, -1] },
  { x: 0, y: 1, right: [-1, 0], left: [0, 0] },
  { x: -1, y: 0, right: [-1, -1], left: [-1, 0] },
  { x: 0, y: -1, right: [0, -1], left: [-1, -1] },
];
const UP = 3;

/** An SVG path in pixels of the view; empty if the instance does not show, or the picture cannot be had. */
export async function silhouette(live, scene, id) {
  const query = new URLSearchParams({ ...live.size, output: "ids", t: live.frame?.t ?? 0 });
  const { viewSize } = live;
  try {
    const response = await ask(`${scene.path}/frame.png?${query}`);
    const pixels = await pixelsOf(await response.blob());
    return traced(maskOf(pixels, colourOf(id)), viewSize.width / pixels.width);
  } catch {
    return ""; // The box has to do.
  }
}

/** The colour of an id, as the server defines it: the top 24 bits of a product that spreads neighbours far apart. */
function colourOf(id) {
  const bits = Math.imul(id, 0x9e3779b1) >>> 8;
  return [bits >> 16, (bits >> 8) & 255, bits & 255];
}

async function pixelsOf(blob) {
  const picture = await createImageBitmap(blob, { colorSpaceConversion: "none" });
  const canvas = new OffscreenCanvas(picture.width, picture.height);
  const context = canvas.getContext("2d");
  context.drawImage(picture, 0, 0);
  return context.getImageData(0, 0, canvas.width, canvas.height);
}

/** Which pixels have the colour, with a way to ask that is `false` outside of the picture. */
function maskOf({ data, width, height }, [red, green, blue]) {
  const inside = new Uint8Array(width * height);
  for (let i = 0; i < inside.length; i++) {
    inside[i] = data[4 * i] === red && data[4 * i + 1] === green && data[4 * i + 2] === blue;
  }
  const has = (x, y) => x >= 0 && y >= 0 && x < width && y < height && inside[y * width + x] === 1;
  return { width, height, has };
}

/** The borders of the mask. Each begins at a pixel with nothing to its left; what one border passes begins no other. */
function traced(mask, scale) {
  const passed = new Set();
  let path = "";
  for (let y = 0; y < mask.height; y++) {
    for (let x = 0; x < mask.width; x++) {
      if (!mask.has(x, y) || mask.has(x - 1, y) || passed.has(y * mask.width + x)) continue;
      path += border(mask, x, y, scale, passed);
    }
  }
  return path;
}

/** Follows one border with the inside on the right; through the middles of pixel sides, so that slopes are smooth. */
function border(mask, startX, startY, scale, passed) {
  const points = [];
  let [x, y, heading] = [startX, startY + 1, UP];
  do {
    const step = STEPS[heading];
    if (heading === UP) passed.add((y - 1) * mask.width + x);
    points.push(`${((x + step.x / 2) * scale).toFixed(1)} ${((y + step.y / 2) * scale).toFixed(1)}`);
    x += step.x;
    y += step.y;
    heading = nextHeading(mask, x, y, heading);
  } while (x !== startX || y !== startY + 1 || heading !== UP);
  return `M${points.join("L")}Z`;
}

function nextHeading(mask, x, y, heading) {
  const has = ([dx, dy]) => mask.has(x + dx, y + dy);
  const { right, left } = STEPS[heading];
  if (!has(right)) return (heading + 1) % 4;
  return has(left) ? (heading + 3) % 4 : heading;
}
