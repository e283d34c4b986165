// Streams in the programs that show them: what stands still is on screen at once, and no frame is lost.

import assert from "node:assert/strict";
import { execFile } from "node:child_process";
import { once } from "node:events";
import http from "node:http";
import { after, before, test } from "node:test";
import { promisify } from "node:util";
import { Server, chromium, decode, firefox, onPage, until } from "./harness.mjs";

/** Behind each picture, in the framing for browsers. */
const NEXT_HEAD = "\r\n--frame\r\nContent-Type: image/jpeg\r\n\r\n";

const BLUE = "#0000ff";
const RED = "#ff0000";

let server;
before(async () => { server = await Server.start(); });
after(() => server.stop());

/** Nothing but a colour. */
const plain = (color) => ({
  instances: {},
  environment: { background: { type: "color", color } },
  render: { width: 320, height: 240, samples: 1 },
});

/**
 * A page with a scene's stream, up to the first picture of revision 2 and the head behind it. Then nothing more comes,
 * but the connection stays: what the browser shows now, it shows without the next picture's help.
 */
async function pageThatStopsAfterTheChange(scene) {
  const proxy = http.createServer((request, response) => {
    if (request.url !== "/stream") {
      response.setHeader("Content-Type", "text/html");
      return response.end("<!doctype html><style>body { margin: 0 }</style><img src=/stream>");
    }
    const headers = { accept: request.headers.accept };
    const upstream = http.get(`${server.url}/scenes/${scene}/stream.mjpg`, { headers }, (stream) => {
      response.writeHead(200, { "Content-Type": stream.headers["content-type"] });
      let come = "";
      let passed = 0;
      stream.on("data", (bytes) => {
        come += bytes.toString("latin1");
        const changed = come.indexOf(" revision=2 ");
        const end = changed < 0 ? -1 : come.indexOf(NEXT_HEAD, changed);
        const wanted = end < 0 ? come.length : end + NEXT_HEAD.length;
        response.write(Buffer.from(come.slice(passed, wanted), "latin1"));
        passed = wanted;
        if (end >= 0) stream.destroy();
      });
      stream.on("error", () => {});
    });
    response.on("close", () => upstream.destroy());
  });
  proxy.listen(0, "127.0.0.1");
  await once(proxy, "listening");
  return proxy;
}

for (const [name, launch] of [["Chromium", chromium], ["Firefox", firefox]]) {
  test(`the last picture of a scene that stands still is on screen in ${name}`, { timeout: 180_000 }, async (t) => {
    const browser = await launch();
    t.after(() => browser.close());
    const scene = `last-${name}`;
    await server.ask("PUT", `/scenes/${scene}`, plain(BLUE));
    const proxy = await pageThatStopsAfterTheChange(scene);
    t.after(() => { proxy.close(); proxy.closeAllConnections(); });

    await onPage(browser, `last-picture-${name}`, async (page) => {
      const decoder = await browser.newPage();
      const shows = async ([r, g, b]) => {
        const { data, width } = await decode(decoder, await page.screenshot({ clip: { x: 0, y: 0, width: 320, height: 240 } }));
        const at = 4 * (120 * width + 160);
        return [r, g, b].every((value, i) => Math.abs(value - data[at + i]) < 16);
      };
      await page.bringToFront();
      await page.goto(`http://127.0.0.1:${proxy.address().port}/`, { waitUntil: "domcontentloaded" });
      await until("the first picture", () => shows([0, 0, 255]));
      const began = performance.now();
      await server.ask("PATCH", `/scenes/${scene}`, { environment: { background: { color: RED } } });
      await until("the changed picture", () => shows([255, 0, 0]));
      t.diagnostic(`${name}: ${Math.round(performance.now() - began)} ms from the change to a screenshot that has it`);
    });
  });
}

for (const framing of ["length", "advance"]) {
  test(`ffmpeg counts every frame of the framing ${framing}`, { timeout: 120_000 }, async () => {
    const sent = () => server.metric("stream_frames_sent_total");
    await server.ask("PUT", "/scenes/spinning", {
      ...plain(BLUE),
      meshes: { box: { type: "box" } },
      instances: { box: { mesh: "box", spin: { axis: [0, 1, 0], deg_per_s: 20 } } },
    });
    const before = await sent();
    const url = `${server.url}/scenes/spinning/stream.mjpg?framing=${framing}`;
    const options = ["-hide_banner", "-i", url, "-fps_mode", "passthrough", "-f", "framemd5", "-"];
    const decoding = promisify(execFile)("ffmpeg", options);
    await until("some frames", async () => (await sent()) > before + 40);
    await server.ask("DELETE", "/scenes/spinning");
    const { stdout, stderr } = await decoding;
    const sums = stdout.split("\n").filter((line) => line && !line.startsWith("#")).map((line) => line.split(",").at(-1).trim());
    assert.equal(sums.length, (await sent()) - before, stderr);
    assert.equal(new Set(sums).size, sums.length, "a scene that moves has no picture twice");
  });
}
