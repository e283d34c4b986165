// How long after the mouse moves the picture on screen changes: `node tests/clients/latency.mjs [url]`, of the release
// build (`cargo build --release`) unless the URL of a running server is given.
//
// Asked of the browser itself: a move's own time stamp, and the first animation frame in which the view's pixels
// are others than before.

import { Server, chromium } from "./harness.mjs";

const MOVES = 60;
const VIEW = { width: 1280, height: 720 };

const [url] = process.argv.slice(2);
const server = url ? null : await Server.start({ profile: "release" });
const browser = await chromium();
const page = await browser.newPage();
// The drawer takes its part of the window.
await page.setViewport({ width: VIEW.width, height: VIEW.height + 200 });
await page.goto(`${url ?? server.url}/#${process.env.SCENE ?? "demo"}`);
await page.click("#toggle-panels");
await page.waitForFunction(() => / ms$/.test(document.querySelector("#overlay > summary").textContent));
const bar = await page.$eval("#view", (view) => view.getBoundingClientRect().top);
await page.setViewport({ width: VIEW.width, height: VIEW.height + bar });
await page.evaluate(() => new Promise((resolve) => setTimeout(resolve, 2000)));

await page.evaluate(() => {
  const canvas = new OffscreenCanvas(64, 36);
  const context = canvas.getContext("2d", { willReadFrequently: true });
  const look = () => {
    context.drawImage(document.querySelector("#view img:not(.coming)"), 0, 0, 64, 36);
    return context.getImageData(0, 0, 64, 36).data;
  };
  const differ = (a, b) => a.some((value, i) => Math.abs(value - b[i]) > 2);
  let begun = null;
  window.latencies = [];
  document.querySelector("#view").addEventListener("pointermove", ({ timeStamp, buttons }) => {
    if (buttons && begun === null) begun = { at: timeStamp, before: look() };
  }, { capture: true });
  const tick = (now) => {
    if (begun && differ(begun.before, look())) {
      window.latencies.push(now - begun.at);
      begun = null;
    }
    requestAnimationFrame(tick);
  };
  requestAnimationFrame(tick);
});

const { width, height } = await page.$eval("#view img:not(.coming)", (img) => ({ width: img.naturalWidth, height: img.naturalHeight }));
await page.mouse.move(400, 400);
await page.mouse.down();
for (let i = 0; i < MOVES; i++) {
  const seen = await page.evaluate(() => window.latencies.length);
  await page.mouse.move(400 + (i % 2 ? 0 : 25), 400 + i);
  await page.waitForFunction((seen) => window.latencies.length > seen, { polling: 5 }, seen);
  await new Promise((resolve) => setTimeout(resolve, 350)); // so that nothing is under way when the next begins
}
await page.mouse.up();
const sorted = (await page.evaluate(() => window.latencies)).sort((a, b) => a - b);
const part = (p) => sorted[Math.min(Math.floor(sorted.length * p), sorted.length - 1)].toFixed(0);
const frame = await page.$eval("#overlay > summary", ({ textContent }) => textContent);
console.log(`${width} × ${height}, ${sorted.length} moves: median ${part(0.5)} ms, p95 ${part(0.95)} ms, least ${part(0)} ms (the server's frame: ${frame})`);
await browser.close();
await server?.stop();
