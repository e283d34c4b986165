// The page in Chromium: what a visitor does, and what becomes of picture and scene.

import assert from "node:assert/strict";
import { mkdtemp, rm, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import path from "node:path";
import { after, before, test } from "node:test";
import { Server, chromium, firefox, onPage, until } from "./harness.mjs";
import { ROOM, Visit } from "./page.mjs";

const PATIENT = { timeout: 300_000 };

let server;
let browser;
let scenes = 0;
before(async () => {
  server = await Server.start();
  browser = await chromium();
});
after(async () => {
  await browser.close();
  await server.stop();
});

/** A test on a page that shows a room of its own. */
function visiting(name, look, room = ROOM) {
  test(name, PATIENT, () => onPage(browser, name, async (page) => {
    const scene = `room-${(scenes += 1)}`;
    await server.ask("PUT", `/scenes/${scene}`, room);
    const visit = await Visit.begin(page, server, scene);
    await look(visit);
    await visit.streams();
    assert.deepEqual(visit.complaints, [], "nothing to complain about in the console");
  }));
}

/** The scene's value at a path, once it is another than `before`. */
async function changed(visit, pick, before) {
  const text = JSON.stringify(before);
  return until("a changed document", async () => {
    const value = pick(await visit.document());
    return JSON.stringify(value) !== text && { value };
  });
}

test("the demo opens without a complaint and without other hosts", PATIENT, () => onPage(browser, "demo", async (page) => {
  const visit = await Visit.begin(page, server, "demo");
  assert.match(await page.title(), /rasterd/);
  assert.deepEqual(visit.complaints, []);
}));

visiting("mouse and keys steer the camera", async (visit) => {
  const { page } = visit;
  const camera = async () => (await visit.document()).camera;
  const steers = async (what, act) => {
    const before = await camera();
    await visit.changes(what, act);
    await changed(visit, (document) => document.camera, before);
    await visit.stands();
  };
  const distance = ({ position, target }) => Math.hypot(...position.map((x, i) => x - target[i]));

  await steers("a drag", () => visit.drag(visit.at(0.9, 0.1), visit.at(0.6, 0.3)));
  const { target } = await camera();
  await steers("a drag with the right button", () => visit.drag(visit.at(0.5, 0.5), visit.at(0.6, 0.6), { button: "right" }));
  assert.notDeepEqual((await camera()).target, target, "the right button pans");
  const far = distance(await camera());
  await page.mouse.move(...visit.at(0.5, 0.6));
  await steers("a step of the wheel", () => page.mouse.wheel({ deltaY: -200 }));
  assert.ok(distance(await camera()) < far, "the wheel zooms in");
  await steers("a double click", () => page.mouse.click(...visit.at(0.3, 0.8), { count: 2 }));
  await visit.focusView();
  await page.keyboard.press("Escape");
  for (const key of ["w", "a", "s", "d", "q", "e", "ArrowLeft", "ArrowUp", "+", "-"]) {
    await steers(`the key ${key}`, () => page.keyboard.press(key, { delay: 80 }));
  }
  await steers("the key f", () => page.keyboard.press("f"));
});

visiting("keys that are held together move at once", async (visit) => {
  const { page } = visit;
  const before = (await visit.document()).camera;
  await visit.focusView();
  await page.keyboard.down("w");
  await page.keyboard.down("d");
  await visit.drag(visit.at(0.5, 0.5), visit.at(0.6, 0.5));
  await page.keyboard.up("w");
  await page.keyboard.up("d");
  await visit.stands();
  const { position, target } = (await visit.document()).camera;
  assert.notDeepEqual(target, before.target, "the keys fly");
  const direction = ({ position, target }) => position.map((x, i) => x - target[i]);
  const [now, then] = [direction({ position, target }), direction(before)].map((v) => v.map((x) => x / Math.hypot(...v)));
  assert.ok(now.reduce((sum, x, i) => sum + x * then[i], 0) < 0.999, "the mouse turns meanwhile");
});

visiting("one PATCH at a time follows a drag", async (visit) => {
  const { page } = visit;
  let [underWay, most, all] = [0, 0, 0];
  const isPatch = (request) => request.method() === "PATCH";
  page.on("request", (request) => { if (isPatch(request)) { underWay += 1; all += 1; most = Math.max(most, underWay); } });
  page.on("requestfinished", (request) => { if (isPatch(request)) underWay -= 1; });
  await page.mouse.move(...visit.at(0.2, 0.5));
  await page.mouse.down();
  for (let i = 0; i < 60; i++) await page.mouse.move(...visit.at(0.2 + i / 100, 0.5));
  await page.mouse.up();
  await visit.stands();
  assert.equal(most, 1);
  assert.ok(all > 1, "the camera moves while the mouse does");
});

visiting("function keys and their buttons switch shadows, effects and lights", async (visit) => {
  const { page } = visit;
  await visit.focusView();
  for (const key of ["F1", "F2", "F3", "F4", "F5", "F6"]) {
    const pressed = await visit.changes(key, () => page.keyboard.press(key));
    const clicked = await visit.changes(`the button ${key}`, () => page.click(`[data-switch=${key}]`));
    assert.notEqual(pressed, clicked);
    await visit.focusView();
  }
});

visiting("a click selects, and the outline runs around what was clicked", async (visit) => {
  const { page } = visit;
  for (const name of ["ball", "box"]) {
    const { point, box } = await visit.middleOf(name);
    await page.mouse.click(...point);
    await page.waitForSelector(`#outline[data-instance="${name}"][data-kind=silhouette]`);
    const drawn = await page.$eval("#outline path", (path) => {
      const { x, y, width, height } = path.getBBox();
      return { left: x, right: x + width, top: y, bottom: y + height };
    });
    for (const side of ["left", "right", "top", "bottom"]) {
      assert.ok(Math.abs(drawn[side] - box[side]) <= 2, `${side} of ${name}: ${drawn[side]} of ${box[side]}`);
    }
  }
  await visit.focusView();
  await page.keyboard.press("Escape");
  await page.waitForSelector('#outline[data-kind=none]');
});

visiting("digits select, keys then move and turn the instance, and 0 goes back to the camera", async (visit) => {
  const { page } = visit;
  await visit.focusView();
  await page.keyboard.press("2");
  await page.waitForSelector('#outline[data-instance="box"]');
  const box = ({ instances }) => instances.box;
  const { camera } = await visit.document();
  for (const [key, member] of [["w", "translation"], ["a", "translation"], ["s", "translation"], ["d", "translation"],
    ["q", "translation"], ["e", "translation"], ["z", "rotation_deg"], ["x", "rotation_deg"]]) {
    const before = box(await visit.document());
    await visit.changes(`the key ${key}`, () => page.keyboard.press(key, { delay: 120 }));
    const after = box(await visit.document());
    assert.notDeepEqual(after[member], before[member], key);
  }
  assert.deepEqual((await visit.document()).camera, camera, "the camera has not moved");
  await page.keyboard.press("0");
  const still = box(await visit.document());
  await visit.changes("w without a selection", () => page.keyboard.press("w", { delay: 120 }));
  assert.deepEqual(box(await visit.document()), still);
});

visiting("handles move, and the bar duplicates, hides and deletes what is selected", async (visit) => {
  const { page } = visit;
  await visit.focusView();
  await page.keyboard.press("1");
  await page.waitForSelector("#gizmo .handle.y .hit");
  const before = (await visit.document()).instances.ball.translation;
  const arm = await page.$eval("#gizmo .handle.y .over", (path) => {
    const { x, y } = path.getPointAtLength(path.getTotalLength() * 0.6);
    const { x: left, y: top } = path.ownerSVGElement.getBoundingClientRect();
    return [left + x, top + y];
  });
  await visit.changes("a drag of the handle y", () => visit.drag(arm, [arm[0], arm[1] - 40]));
  const after = (await visit.document()).instances.ball.translation;
  assert.ok(after[1] > before[1] + 0.05 && after[0] === before[0] && after[2] === before[2], `${before} → ${after}`);

  await visit.changes("duplicate", () => page.click("#selected [data-action=duplicate]"));
  assert.ok((await visit.document()).instances["ball 2"]);
  await visit.changes("hide", () => page.click("#selected [data-action=hide]"));
  assert.equal((await visit.document()).instances["ball 2"].visible, false);
  await page.click("#selected [data-action=delete]");
  await changed(visit, ({ instances }) => Object.keys(instances).length, 4);
});

/** Panel, what to choose in it, pointer, and what to do with its field. */
const CONTROLS = [
  ["instances", "box", "/instances/box/translation", number(1, 1.1)],
  ["instances", "box", "/instances/box/rotation_deg", number(0, 40)],
  ["instances", "box", "/instances/box/scale", number(0, 0.5)],
  ["instances", "box", "/instances/box/mesh", choice("ball")],
  ["instances", "box", "/instances/box/material", choice("red")],
  ["instances", "box", "/instances/box/casts_shadow", click()],
  ["instances", "floor", "/instances/floor/receives_shadow", click()],
  ["instances", "box", "/instances/box/visible", click()],
  ["materials", "red", "/materials/red/diffuse", color("#20a040")],
  ["materials", "red", "/materials/red/specular", color("#ffffff")],
  ["materials", "red", "/materials/red/shininess", number(0, 4)],
  ["materials", "red", "/materials/red/ambient", color("#4040ff")],
  ["materials", "red", "/materials/red/emissive", color("#301000")],
  ["materials", "red", "/materials/red/opacity", number(0, 0.5)],
  ["materials", "red", "/materials/red/diffuse_map", choice("tiles")],
  ["materials", "red", "/materials/red/shading", choice("Unlit")],
  ["textures", "tiles", "/textures/tiles/checker/cells", number(0, 3)],
  ["meshes", "ball", "/meshes/ball/radius", number(0, 0.3)],
  ["lights", "sun", "/lights/sun/color", color("#ff8080")],
  ["lights", "sun", "/lights/sun/intensity", number(0, 0.6)],
  ["lights", "sun", "/lights/sun/enabled", click()],
  ["lights", "lamp", "/lights/lamp/position", number(0, -1)],
  ["lights", "lamp", "/lights/lamp/attenuation/quadratic", number(0, 0.2)],
  ["sky", null, "/environment/background", choice("One colour")],
  ["sky", null, "/environment/ambient", color("#808080")],
  ["shadow", "sun", "/lights/sun/shadow/resolution", number(0, 48)],
  ["shadow", "sun", "/lights/sun/shadow/radius", number(0, 6)],
  ["shadow", "sun", "/lights/sun/shadow/filter", choice("Soft (PCSS)")],
  ["shadow", "sun", "/render/shadows", click()],
  ["render", null, "/render/samples", choice("1")],
  ["render", null, "/render/cull", choice("Front faces")],
  ["render", null, "/render/shading", choice("Normals as colours")],
  ["render", null, "/render/model_scale", number(0, 0.7)],
  ["render", null, "/camera/fov_y_deg", number(0, 60)],
];

function number(place, value) {
  return async (page, field) => {
    const input = (await page.$$(`${field} input[type=number]`))[place];
    await input.click({ count: 3 });
    await page.keyboard.type(String(value));
    await page.keyboard.press("Enter");
  };
}

function choice(label) {
  return async (page, field) => {
    const value = await page.$eval(`${field} select`, (select, label) => [...select.options].find(({ text }) => text === label).value, label);
    await page.select(`${field} select`, value);
  };
}

function color(hex) {
  return async (page, field) => {
    const input = await page.$(`${field} input.hex`);
    await input.click({ count: 3 });
    await page.keyboard.type(hex);
    await page.keyboard.press("Enter");
  };
}

function click() {
  return (page, field) => page.click(`${field} input[type=checkbox]`);
}

const valueAt = (document, pointer) => pointer.split("/").slice(1).reduce((value, step) => value?.[step], document);

for (const panel of new Set(CONTROLS.map(([panel]) => panel))) {
  visiting(`every field of the panel ${panel} changes scene and picture`, async (visit) => {
    const { page } = visit;
    await visit.openPanel(panel);
    for (const [, entry, pointer, act] of CONTROLS.filter(([of]) => of === panel)) {
      await server.ask("PUT", visit.path, ROOM);
      await visit.stands();
      if (panel === "shadow") await page.select("#shadow-light", entry);
      else if (entry) await page.click(`#panel-${panel} .entry[data-name="${entry}"]`);
      if (entry && panel === "instances") await page.keyboard.press("Escape");
      const field = `#panel-${panel} .field[data-pointer="${pointer}"]`;
      await page.waitForSelector(field);
      const before = valueAt(await visit.document(), pointer);
      await visit.changes(pointer, () => act(page, field));
      await changed(visit, (document) => valueAt(document, pointer), before);
    }
  });
}

visiting("effects are added, moved and removed", async (visit) => {
  const { page } = visit;
  await visit.openPanel("post");
  const types = async () => (await visit.document()).post.map(({ type }) => type);
  await page.select("#add-effect-type", "blur");
  await visit.changes("a blur", () => page.click("#add-effect"));
  assert.deepEqual(await types(), ["tonemap", "blur"]);
  await visit.changes("a wider blur", () => number(0, 12)(page, '.field[data-pointer="/post/1/radius"]'));
  await page.click('#post-chain [data-effect=blur] [data-action="move up"]');
  await until("another order", async () => (await types())[0] === "blur");
  await visit.changes("no blur", () => page.click("#post-chain [data-effect=blur] [data-action=remove]"));
  assert.deepEqual(await types(), ["tonemap"]);
});

visiting("each stage is shown on its own", async (visit) => {
  const { page } = visit;
  await visit.openPanel("stages");
  const looks = new Set([await visit.stands()]);
  for (const stage of ["depth", "normal", "albedo", "ids", "wireframe", "shadow_map", "tiles", "shaded"]) {
    looks.add(await visit.changes(stage, () => page.click(`#stage-${stage}`)));
  }
  assert.equal(looks.size, 9, "no stage looks like another");
});

visiting("what the server refuses is said at its field", async (visit) => {
  const { page } = visit;
  await visit.openPanel("materials");
  await page.click('#panel-materials .entry[data-name="red"]');
  await color("no colour")(page, '.field[data-pointer="/materials/red/diffuse"]');
  const error = '.field[data-pointer="/materials/red/diffuse"] .error';
  await page.waitForFunction((error) => document.querySelector(error)?.checkVisibility(), {}, error);
  assert.match(await page.$eval(error, ({ textContent }) => textContent), /colou?r|#rrggbb/i);
  assert.equal((await visit.document()).materials.red.diffuse, ROOM.materials.red.diffuse);
  visit.complaints = visit.complaints.filter((text) => !/status of 422/.test(text)); // Chromium names each failed request
});

test("scenes are created, opened from the gallery, renamed and deleted", PATIENT, () => onPage(browser, "scenes", async (page) => {
  await server.ask("PUT", "/scenes/old", ROOM);
  const visit = await Visit.begin(page, server, "old");
  await visit.openPanel("scenes");
  const isNamed = (text) => page.waitForFunction((text) => document.querySelector("#scene-name").textContent === text, {}, text);
  await page.click("#new-scene");
  await page.waitForFunction(() => !["", "#old"].includes(location.hash));
  const created = decodeURIComponent(new URL(page.url()).hash.slice(1));
  await page.click('.field[data-pointer="/name"] input');
  await page.keyboard.type("brand new");
  await page.keyboard.press("Enter");
  await isNamed("brand new");
  assert.equal((await server.json(`/scenes/${created}`)).name, "brand new");

  const look = await visit.stands();
  await page.click('[data-gallery="triangles"]');
  await until("the gallery's picture", async () => (await visit.looks()) !== look);
  await server.json("/scenes/gallery-triangles");

  await page.waitForSelector(`#scene-list [data-id="${created}"]`);
  await page.click(`#scene-list [data-id="${created}"]`);
  await isNamed("brand new");
  await page.click("#delete-scene");
  await page.waitForSelector("dialog.confirm .danger");
  await page.click("dialog.confirm .danger");
  await until("the end of the scene", async () => (await server.json("/scenes")).every(({ id }) => id !== created));
  assert.deepEqual(visit.complaints, []);
}));

visiting("an OBJ with its material that is dropped appears", async (visit) => {
  const { page } = visit;
  const folder = await mkdtemp(path.join(tmpdir(), "rasterd-drop-"));
  try {
    const files = { "pyramid.obj": "mtllib pyramid.mtl\nusemtl gold\nv -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nv 0 1.5 0\nf 1 5 2\nf 2 5 3\nf 3 5 4\nf 4 5 1\n", "pyramid.mtl": "newmtl gold\nKd 0.9 0.6 0.1\nKq 3\n" };
    for (const [name, text] of Object.entries(files)) await writeFile(path.join(folder, name), text);
    const data = { items: [], files: Object.keys(files).map((name) => path.join(folder, name)), dragOperationsMask: 1 };
    const session = await page.createCDPSession();
    const [x, y] = visit.at(0.5, 0.5);
    await visit.changes("a drop", async () => {
      for (const type of ["dragEnter", "dragOver", "drop"]) await session.send("Input.dispatchDragEvent", { type, x, y, data });
    });
    const document = await visit.document();
    assert.deepEqual(document.meshes.pyramid, { type: "obj", file: "pyramid.obj" });
    await page.waitForSelector('#outline[data-instance="pyramid"]');
    const warnings = await page.$$eval('#notices .notice[data-kind=warning]', (all) => all.map(({ textContent }) => textContent).join());
    assert.match(warnings, /pyramid\.mtl.*line 3/);
  } finally {
    await rm(folder, { recursive: true });
  }
});

visiting("two pages on one scene stay in step", async (visit) => {
  await onPage(browser, "second page", async (page) => {
    const other = await Visit.begin(page, server, visit.scene);
    const seen = await other.stands();
    await visit.page.bringToFront();
    await visit.changes("a drag", () => visit.drag(visit.at(0.9, 0.1), visit.at(0.5, 0.3)));
    await page.bringToFront();
    await until("the other page's picture", async () => (await other.looks()) !== seen);
    await other.openPanel("render");
    await visit.page.bringToFront();
    await visit.openPanel("render");
    await number(0, 25)(visit.page, '#panel-render .field[data-pointer="/camera/fov_y_deg"]');
    await page.bringToFront();
    await page.waitForFunction(() => document.querySelector('#panel-render .field[data-pointer="/camera/fov_y_deg"] input[type=number]').value === "25");
    await visit.page.bringToFront();
  });
});

test("the page comes back by itself when the server does", PATIENT, () => onPage(browser, "restart", async (page) => {
  const first = await Server.start();
  await first.ask("PUT", "/scenes/demo", ROOM);
  const visit = await Visit.begin(page, first, "demo");
  await first.stop();
  const says = (text) => page.waitForFunction((text) => document.querySelector("#notices").textContent.includes(text), {}, text);
  await says("connection to the server is lost");
  const second = await Server.start({ listen: first.address });
  try {
    await second.ask("PUT", "/scenes/demo", ROOM);
    await until("the notice to go", () => page.$eval("#notices", ({ textContent }) => !textContent.includes("is lost")));
    await visit.isShown();
    await visit.changes("a drag after the restart", () => visit.drag(visit.at(0.9, 0.1), visit.at(0.5, 0.3)));
  } finally {
    await second.stop();
  }
}));

test("the page works in Firefox", PATIENT, async () => {
  const other = await firefox();
  try {
    await onPage(other, "firefox", async (page) => {
      await server.ask("PUT", "/scenes/firefox", ROOM);
      const visit = await Visit.begin(page, server, "firefox");
      const { camera } = await visit.document();
      await visit.changes("a drag", () => visit.drag(visit.at(0.9, 0.1), visit.at(0.5, 0.3)));
      await changed(visit, (document) => document.camera, camera);
      await visit.changes("F1", () => page.keyboard.press("F1"));
      assert.deepEqual(visit.complaints, []);
    });
  } finally {
    await other.close();
  }
});

visiting("the page works on a narrow screen and with a finger", async (visit) => {
  const { page } = visit;
  await page.setViewport({ width: 360, height: 740, hasTouch: true, isMobile: true });
  await page.reload({ waitUntil: "domcontentloaded" });
  await visit.isShown();
  const wide = await page.evaluate(() => document.documentElement.scrollWidth);
  assert.ok(wide <= 360, `${wide} px wide`);
  const { camera } = await visit.document();
  const touch = await page.touchscreen.touchStart(180, 250);
  for (let i = 1; i <= 5; i++) await touch.move(180 - 10 * i, 250);
  await touch.end();
  await changed(visit, (document) => document.camera, camera);
});
