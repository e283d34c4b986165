// The page under test, with the hands and eyes of somebody who uses it.

import assert from "node:assert/strict";
import { decode, until } from "./harness.mjs";

/** A scene with something for every control: two lights with soft and hard shadows, an effect, three instances. */
export const ROOM = {
  name: "a room",
  camera: { position: [3, 2.2, 4], target: [0, 0.5, 0], fov_y_deg: 40 },
  lights: {
    sun: { type: "directional", direction: [-0.5, -1, -0.3], intensity: 1.6, shadow: { filter: "pcf", resolution: 512 } },
    lamp: { type: "point", position: [1.2, 1.6, 1.4], color: [1, 0.7, 0.4], intensity: 3 },
  },
  textures: { tiles: { checker: { colors: ["#777777", "#dddddd"], cells: 8 } } },
  materials: { floor: { diffuse_map: "tiles" }, red: { diffuse: "#c03020", specular: [0.4, 0.4, 0.4] } },
  meshes: { floor: { type: "plane", size: [8, 8] }, box: { type: "box" }, ball: { type: "sphere" } },
  instances: {
    ball: { mesh: "ball", material: "red", translation: [-0.9, 0.5, 0.3] },
    box: { mesh: "box", translation: [0.7, 0.5, -0.2], rotation_deg: [0, 25, 0] },
    floor: { mesh: "floor", material: "floor" },
  },
  post: [{ type: "tonemap", operator: "aces" }],
};

/** What is clear of panels, bars and overlay: a part of the window, in its pixels. */
const CLEAR = { x: 40, y: 120, width: 460, height: 300 };
export const WINDOW = { width: 900, height: 640 };

export class Visit {
  /** Everything a visit should never see. */
  complaints = [];

  /** Opens `scene` on a new page and waits until its picture is there. */
  static async begin(page, server, scene, window = WINDOW) {
    const visit = new Visit();
    Object.assign(visit, { page, server, scene });
    page.on("console", (message) => { if (["error", "warn"].includes(message.type())) visit.complaints.push(message.text()); });
    page.on("pageerror", (error) => visit.complaints.push(String(error)));
    page.on("request", (request) => {
      const { protocol, origin } = new URL(request.url());
      if (protocol.startsWith("http") && origin !== server.url) visit.complaints.push(`a request to ${request.url()}`);
    });
    await page.setViewport(window);
    await page.goto(`${server.url}/#${scene}`, { waitUntil: "domcontentloaded" });
    await visit.isShown();
    await visit.streams();
    await page.$eval("#overlay", (overlay) => { overlay.open = false; });
    return visit;
  }

  get path() {
    return `/scenes/${this.scene}`;
  }

  document() {
    return this.server.json(this.path);
  }

  async isShown() {
    await until("a frame", () => this.page.$eval("#overlay > summary", ({ textContent }) => / ms$/.test(textContent)));
  }

  /** The picture is a stream's, not one of the stills that the page falls back to. */
  async streams() {
    await until("a stream on screen", () => this.page.$('#view img:not(.coming)[src*="/stream.mjpg"]'));
  }

  /** A part of the picture as a PNG, without what the page draws over it. */
  async looks() {
    await this.#showOverlays(false);
    const png = await this.page.screenshot({ clip: CLEAR, captureBeyondViewport: false });
    await this.#showOverlays(true);
    return Buffer.from(png).toString("base64");
  }

  /** Only their opacity changes: what is hidden would lose the focus. */
  async #showOverlays(isShown) {
    await this.page.$$eval("#marks, #window > :not(#view)", (overlays, opacity) => {
      for (const { style } of overlays) Object.assign(style, { opacity, transition: "none" });
    }, isShown ? "" : "0");
  }

  /** What it looks like when it has stopped changing. */
  async stands() {
    let before = null;
    return until("a picture that stands still", async () => {
      const now = await this.looks();
      const stands = now === before;
      before = now;
      if (!stands) await new Promise((resolve) => setTimeout(resolve, 120));
      return stands && now;
    });
  }

  /** `act`, after which the picture looks different; answers what it looks like then. */
  async changes(what, act) {
    const before = await this.stands();
    await act();
    await until(`another picture after ${what}`, async () => (await this.looks()) !== before);
    return this.stands();
  }

  /** A place in the picture that nothing lies over, by parts of its width and height. */
  at(x, y) {
    return [CLEAR.x + x * CLEAR.width, CLEAR.y + y * CLEAR.height];
  }

  async drag(from, to, options = {}) {
    const { mouse } = this.page;
    await mouse.move(...from);
    await mouse.down(options);
    await mouse.move(...to, { steps: 5 });
    await mouse.up(options);
  }

  async focusView() {
    await this.page.focus("#view");
  }

  /** Unfolds a panel, and folds all others so that what it holds is near. */
  async openPanel(name) {
    await this.page.$$eval("#panels > details", (panels, id) => {
      for (const panel of panels) panel.open = panel.id === id;
    }, `panel-${name}`);
  }

  /** What the server says is at a place of the window. */
  async pick([x, y]) {
    const view = await this.page.$eval("#view", (view) => {
      const { x, y } = view.getBoundingClientRect();
      return { x, y, width: view.clientWidth, height: view.clientHeight };
    });
    const { width, height } = view;
    const query = new URLSearchParams({ width, height, x: Math.floor(x - view.x), y: Math.floor(y - view.y) });
    return this.server.json(`${this.path}/pick?${query}`);
  }

  /** Where the window shows the middle of an instance's pixels, by the server's picture of ids. */
  async middleOf(instance) {
    const { id } = (await this.server.json(`${this.path}/instances`)).find(({ name }) => name === instance);
    const size = await this.page.$eval("#view", ({ clientWidth, clientHeight }) => ({ width: clientWidth, height: clientHeight }));
    const offset = await this.page.$eval("#view", (view) => { const { x, y } = view.getBoundingClientRect(); return { x, y }; });
    const response = await this.server.ask("GET", `${this.path}/frame.png?output=ids&width=${size.width}&height=${size.height}`);
    const { width, data } = await decode(this.page, await response.arrayBuffer());
    const bits = Math.imul(id, 0x9e3779b1) >>> 8;
    const colour = [bits >> 16, (bits >> 8) & 255, bits & 255];
    const mask = [];
    for (let i = 0; i < data.length / 4; i++) {
      if (colour.every((value, channel) => data[4 * i + channel] === value)) mask.push([i % width, Math.floor(i / width)]);
    }
    assert.ok(mask.length > 0, `${instance} is in the picture`);
    const range = (axis) => {
      const values = mask.map((place) => place[axis]);
      return values.reduce(([low, high], value) => [Math.min(low, value), Math.max(high, value)], [Infinity, -Infinity]);
    };
    const [[left, right], [top, bottom]] = [range(0), range(1)];
    const middle = mask[Math.floor(mask.length / 2)];
    return { point: [offset.x + middle[0], offset.y + middle[1]], box: { left, right, top, bottom } };
  }
}
