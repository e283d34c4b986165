// Between the two ways a document writes colours: linear numbers and sRGB strings.

/** Linear RGB of an sRGB string, `#rrggbb` or `#rgb`; `undefined` if it is none. */
export function linearFromHex(text) {
  const digits = /^#?(?:([0-9a-f]{6})|([0-9a-f]{3}))$/i.exec(text.trim());
  if (!digits) return undefined;
  const long = digits[1] ?? [...digits[2]].map((digit) => digit + digit).join("");
  return [0, 2, 4].map((i) => linearFromSrgb(Number.parseInt(long.slice(i, i + 2), 16) / 255));
}

/** The nearest `#rrggbb` of linear RGB within 0–1. */
export function hexFromLinear(linear) {
  const codes = linear.map((channel) => Math.round(255 * srgbFromLinear(Math.min(Math.max(channel, 0), 1))));
  return `#${codes.map((code) => code.toString(16).padStart(2, "0")).join("")}`;
}

/** Linear RGB of either way of writing. */
export function linearOf(color) {
  return typeof color === "string" ? linearFromHex(color) ?? [0, 0, 0] : color;
}

// Source: IEC 61966-2-1.
function linearFromSrgb(code) {
  return code <= 0.04045 ? code / 12.92 : ((code + 0.055) / 1.055) ** 2.4;
}

function srgbFromLinear(linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * linear ** (1 / 2.4) - 0.055;
}
