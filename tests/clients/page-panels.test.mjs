// What panels and toolbar do beside setting single values.

import assert from "node:assert/strict";
import { until } from "./harness.mjs";
import { choice, color, number } from "./fields.mjs";
import { ROOM } from "./page.mjs";
import { changed, visiting } from "./visiting.mjs";

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

visiting("lights, materials and textures are added and removed", async (visit) => {
  const { page } = visit;
  const namesOf = async (part) => Object.keys((await visit.document())[part]);
  const adders = [
    ["lights", "#add-directional-light", "sun 2"],
    ["lights", "#add-point-light", "lamp 2"],
    ["materials", "#add-material", "material"],
    ["textures", "#add-checker", "checker"],
  ];
  for (const [panel, adder, name] of adders) {
    await visit.openPanel(panel);
    const before = await namesOf(panel);
    await page.click(adder);
    await changed(visit, (document) => Object.keys(document[panel]), before);
    assert.deepEqual((await namesOf(panel)).sort(), [...before, name].sort());
    await page.waitForSelector(`#panel-${panel} .entry[data-name="${name}"][aria-pressed=true]`);
    await page.click(`#panel-${panel} .editor [data-action=remove]`);
    await page.waitForFunction((row) => !document.querySelector(row), {}, `#panel-${panel} .entry[data-name="${name}"]`);
    await until("the end of what was added", async () => !(await namesOf(panel)).includes(name));
    assert.deepEqual(await namesOf(panel), before);
  }
});

visiting("new lights shine, and switches in the list turn them off", async (visit) => {
  const { page } = visit;
  await visit.openPanel("lights");
  for (const [adder, name] of [["#add-directional-light", "sun 2"], ["#add-point-light", "lamp 2"]]) {
    await visit.changes(name, () => page.click(adder));
    await visit.changes(`${name} off`, () => page.click(`#panel-lights input[data-member=enabled][data-name="${name}"]`));
    assert.equal((await visit.document()).lights[name].enabled, false);
  }
});

visiting("instances of shapes and meshes are added, spun, scaled along each axis, duplicated and removed", async (visit) => {
  const { page } = visit;
  await visit.openPanel("instances");
  await page.select("#add-instance-mesh", "shape torus");
  await visit.changes("a torus", () => page.click("#add-instance"));
  const { meshes, instances } = await visit.document();
  assert.equal(meshes[instances.torus.mesh].type, "torus");

  await page.select("#add-instance-mesh", "mesh ball");
  await visit.changes("another ball", () => page.click("#add-instance"));
  const added = (document) => document.instances["ball 2"];
  assert.equal(added(await visit.document()).mesh, "ball");

  const editor = "#panel-instances .editor";
  const { scale } = added(await visit.document());
  await page.click(`${editor} [data-action=scale-axes]`);
  assert.deepEqual(await changed(visit, (document) => added(document).scale, scale), [1, 1, 1]);
  await visit.changes("a higher ball", () => number(1, 1.5)(page, `${editor} .field[data-pointer="/instances/ball 2/scale"]`));
  assert.deepEqual(added(await visit.document()).scale, [1, 1.5, 1]);

  await page.click(`${editor} [data-action=spin]`);
  assert.deepEqual((await changed(visit, (document) => added(document).spin, undefined)).axis, [0, 1, 0]);
  await page.waitForSelector(`${editor} .field[data-pointer="/instances/ball 2/spin/axis"]`);
  await page.click(`${editor} [data-action=spin]`);
  await until("the end of the spin", async () => added(await visit.document()).spin === undefined);

  await page.click(`${editor} [data-action=duplicate]`);
  await until("a duplicate", async () => (await visit.document()).instances["ball 3"]);
  await page.waitForSelector(`#panel-instances .entry[data-name="ball 3"][aria-pressed=true]`);
  await visit.changes("one ball less", () => page.click(`${editor} [data-action=remove]`));
  assert.equal((await visit.document()).instances["ball 3"], undefined);
});

visiting("what is added is outlined", async (visit) => {
  const { page } = visit;
  await visit.openPanel("instances");
  await page.select("#add-instance-mesh", "shape torus");
  await page.click("#add-instance");
  await page.waitForSelector('#outline[data-instance="torus"]');
});

visiting("what is in use is not removed, and the page says why", async (visit) => {
  const { page } = visit;
  await visit.openPanel("textures");
  await page.click('#panel-textures .entry[data-name="tiles"]');
  await page.click("#panel-textures .editor [data-action=remove]");
  const error = "#panel-textures .editor .field.bare .error";
  await page.waitForFunction((error) => document.querySelector(error)?.checkVisibility(), {}, error);
  assert.match(await page.$eval(error, ({ textContent }) => textContent), /tiles/);
  assert.ok((await visit.document()).textures.tiles);
  visit.complaints = visit.complaints.filter((text) => !/status of 422/.test(text)); // Chromium names each failed request
});

visiting("shadows are set for all lights at once", async (visit) => {
  const { page } = visit;
  await visit.openPanel("shadow");
  const filters = async () => Object.values((await visit.document()).lights).map(({ shadow }) => shadow?.filter);
  for (const filter of ["hard", "pcf", "pcss", "none"]) {
    await visit.changes(filter, () => page.click(`#panel-shadow [data-filter=${filter}]`));
    assert.deepEqual(await filters(), [filter, filter]);
    await page.waitForSelector(`#panel-shadow [data-filter=${filter}][aria-pressed=true]`);
  }
  await page.select("#shadow-light", "sun");
  await page.waitForSelector('#panel-shadow .field[data-pointer="/lights/sun/shadow/filter"]');
  await choice("Even edge (PCF)")(page, '#panel-shadow .field[data-pointer="/lights/sun/shadow/filter"]');
  await visit.changes("the same for all", () => page.click("#panel-shadow [data-action=copy-shadow]"));
  assert.deepEqual(await filters(), ["pcf", "pcf"]);
});

visiting("the panel switches all effects off and on, and a kernel gets another size", async (visit) => {
  const { page } = visit;
  await visit.openPanel("post");
  const { post } = await visit.document();
  await visit.changes("no effects", () => page.click("#post-on"));
  assert.deepEqual((await visit.document()).post, []);
  await visit.changes("the effects again", () => page.click("#post-on"));
  assert.deepEqual((await visit.document()).post, post);
  await page.select("#add-effect-type", "kernel");
  await visit.changes("a kernel", () => page.click("#add-effect"));
  const sides = (document) => document.post[1].kernel.map((row) => row.length);
  for (const [size, side] of [["5 × 5", 5], ["3 × 3", 3]]) {
    const before = sides(await visit.document());
    await page.click(`#post-chain [data-effect=kernel] ::-p-text(${size})`);
    assert.deepEqual(await changed(visit, sides, before), Array(side).fill(side));
  }
});

visiting("the sky's sun gets a place of its own", async (visit) => {
  const { page } = visit;
  await visit.openPanel("sky");
  const sun = ({ environment }) => environment.background.sun_direction;
  const button = "#panel-sky [data-action=own-sun]";
  await choice("Sky with a sun")(page, '#panel-sky .field[data-pointer="/environment/background"]');
  await page.waitForSelector(button);
  await page.click(button);
  await changed(visit, sun, undefined);
  await page.waitForSelector('#panel-sky .field[data-pointer="/environment/background/sun_direction"]');
  await page.click(button);
  await until("a sun that follows the light", async () => sun(await visit.document()) === undefined);
});
