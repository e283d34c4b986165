// Steering: the camera, and the selected instance, by mouse, keys and fingers.

import assert from "node:assert/strict";
import { until } from "./harness.mjs";
import { ROOM } from "./page.mjs";
import { changed, server, visiting } from "./visiting.mjs";

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
  for (const key of ["w", "a", "s", "d", "q", "e", "ArrowLeft", "ArrowUp", "ArrowRight", "ArrowDown", "+", "-"]) {
    await steers(`the key ${key}`, () => page.keyboard.press(key, { delay: 80 }));
  }
  for (const key of ["f", "Home", "."]) {
    await steers("a drag", () => visit.drag(visit.at(0.5, 0.5), visit.at(0.6, 0.6), { button: "right" }));
    await steers(`the key ${key}`, () => page.keyboard.press(key));
  }
});

visiting("a question mark lists the keys", async (visit) => {
  const { page } = visit;
  await visit.focusView();
  await page.keyboard.type("?");
  await page.waitForSelector("#help[open]");
  assert.match(await page.$eval("#help", ({ textContent }) => textContent), /Double click/);
  await page.keyboard.press("Escape");
  await page.waitForSelector("#help:not([open])");
});

visiting("the wheel keeps what is under the pointer there", async (visit) => {
  const { page } = visit;
  const distance = ({ position, target }) => Math.hypot(...position.map((x, i) => x - target[i]));
  const { point } = await visit.middleOf("ball");
  const before = await visit.pick(point);
  assert.equal(before.instance, "ball");
  const { camera } = await visit.document();
  await page.mouse.move(...point);
  for (let step = 0; step < 4; step++) await page.mouse.wheel({ deltaY: -100 });
  await visit.stands();
  const after = await visit.pick(point);
  const moved = (await visit.document()).camera;
  assert.ok(distance(moved) < 0.7 * distance(camera), `${distance(camera)} → ${distance(moved)}`);
  assert.equal(after.instance, "ball");
  const off = Math.hypot(...after.position.map((x, i) => x - before.position[i]));
  assert.ok(off < 0.03, `${before.position} → ${after.position}`);
});

/** Where a handle can be gripped: at a part of the length of what is drawn of it. */
async function gripOf(page, handle, part) {
  await page.waitForSelector(`#gizmo .handle.${handle} .hit[d]:not([d=""])`);
  return page.$eval(`#gizmo .handle.${handle} .over`, (path, part) => {
    const { x, y } = path.getPointAtLength(path.getTotalLength() * part);
    const { x: left, y: top } = path.ownerSVGElement.getBoundingClientRect();
    return [left + x, top + y];
  }, part);
}

visiting("handles turn about each axis and scale along each", async (visit) => {
  const { page } = visit;
  const box = async () => (await visit.document()).instances.box;
  const dragged = async (mode, handle, part, [dx, dy], name) => {
    const what = `${mode} ${handle}`;
    await server.ask("PUT", visit.path, { ...ROOM, name });
    await page.waitForFunction((name) => document.querySelector("#scene-name").textContent === name, {}, name);
    await visit.stands();
    await page.click(`#selected [data-mode=${mode}]`);
    const grip = await gripOf(page, handle, part);
    await visit.changes(what, () => visit.drag(grip, [grip[0] + dx, grip[1] + dy]));
    return box();
  };
  await visit.focusView();
  await page.keyboard.press("2");
  await page.waitForSelector('#outline[data-instance="box"]');
  const before = await box();
  for (const [i, handle] of ["x", "y", "z"].entries()) {
    const turned = await dragged("turn", handle, 0.4, [25, 25], `turn ${handle}`);
    assert.notDeepEqual(turned.rotation_deg, before.rotation_deg, `turn ${handle}`);
    assert.deepEqual([turned.translation, turned.scale], [before.translation, before.scale]);
    const scaled = await dragged("scale", handle, 0.3, handle === "y" ? [0, -30] : [-20, 20], `scale ${handle}`);
    assert.ok(scaled.scale[i] !== 1, `scale ${handle}: ${scaled.scale}`);
    assert.deepEqual(scaled.scale.toSpliced(i, 1), [1, 1], `scale ${handle} alone`);
    assert.deepEqual(scaled.rotation_deg, before.rotation_deg);
  }
  const larger = await dragged("scale", "centre", 0.1, [30, -10], "scale all");
  assert.ok(larger.scale > 1, `${larger.scale}`);
  const moved = await dragged("move", "centre", 0.1, [40, 0], "move all");
  assert.notDeepEqual(moved.translation, before.translation);
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
  const before = (await visit.document()).instances.ball.translation;
  const arm = await gripOf(page, "y", 0.6);
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
  const turned = await changed(visit, (document) => document.camera, camera);
  const distance = ({ position, target }) => Math.hypot(...position.map((x, i) => x - target[i]));

  const fingers = [await page.touchscreen.touchStart(150, 250), await page.touchscreen.touchStart(210, 250)];
  for (let i = 1; i <= 5; i++) {
    await fingers[0].move(150 - 10 * i, 250);
    await fingers[1].move(210 + 10 * i, 250);
  }
  for (const finger of fingers) await finger.end();
  await until("a camera that is nearer", async () => distance((await visit.document()).camera) < 0.6 * distance(turned));
});

visiting("a double click looks at what was not selected before, whatever handles come up", async (visit) => {
  const { page } = visit;
  const { instances: { ball }, camera } = await visit.document();
  const { box } = await visit.middleOf("ball");
  const offset = await page.$eval("#view", (view) => { const { x, y } = view.getBoundingClientRect(); return { x, y }; });
  // The middle of a ball is where its handles come up.
  const middle = [offset.x + (box.left + box.right) / 2, offset.y + (box.top + box.bottom) / 2];
  await page.mouse.click(...middle);
  await page.waitForSelector("#gizmo .handle.centre:not([hidden])", { polling: 5 });
  await page.mouse.click(...middle);
  const { target } = await changed(visit, (document) => document.camera, camera);
  await visit.stands();
  const settled = (await visit.document()).camera.target;
  const away = Math.hypot(...settled.map((value, axis) => value - ball.translation[axis]));
  assert.ok(Math.abs(away - 0.5) < 0.02, `on the ball's surface: ${away} from its centre, ${target} on the way`);
  assert.deepEqual((await visit.document()).instances.ball, ball, "no handle was dragged");
});
