// Scenes and files: what is opened, dropped and saved.

import assert from "node:assert/strict";
import { mkdir, mkdtemp, rm, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import path from "node:path";
import { test } from "node:test";
import { decode, onPage, until } from "./harness.mjs";
import { ROOM, Visit } from "./page.mjs";
import { PATIENT, browser, saved, server, visiting } from "./visiting.mjs";

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

/** Files in a folder that is there as long as `use(folder)` takes. */
async function withFiles(files, use) {
  const folder = await mkdtemp(path.join(tmpdir(), "rasterd-drop-"));
  try {
    for (const [name, content] of Object.entries(files)) {
      await mkdir(path.dirname(path.join(folder, name)), { recursive: true });
      await writeFile(path.join(folder, name), content);
    }
    return await use(folder);
  } finally {
    await rm(folder, { recursive: true });
  }
}

/** Drops files and folders, named by their paths, at a place of the window. */
async function drop(page, [x, y], paths) {
  const data = { items: [], files: paths, dragOperationsMask: 1 };
  const session = await page.createCDPSession();
  for (const type of ["dragEnter", "dragOver", "drop"]) await session.send("Input.dispatchDragEvent", { type, x, y, data });
  await session.detach();
}

const MODEL = {
  "pyramid.obj": "mtllib pyramid.mtl\nusemtl gold\nv -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nv 0 1.5 0\nf 1 5 2\nf 2 5 3\nf 3 5 4\nf 4 5 1\n",
  "pyramid.mtl": "newmtl gold\nKd 0.9 0.6 0.1\nKq 3\n",
};

visiting("an OBJ with its material that is dropped appears", async (visit) => {
  const { page } = visit;
  await withFiles(MODEL, async (folder) => {
    const paths = Object.keys(MODEL).map((name) => path.join(folder, name));
    await visit.changes("a drop", () => drop(page, visit.at(0.5, 0.5), paths));
    const document = await visit.document();
    assert.deepEqual(document.meshes.pyramid, { type: "obj", file: "pyramid.obj" });
    await page.waitForSelector('#outline[data-instance="pyramid"]');
    const warnings = await page.$$eval('#notices .notice[data-kind=warning]', (all) => all.map(({ textContent }) => textContent).join());
    assert.match(warnings, /pyramid\.mtl.*line 3/);
  });
});

visiting("a folder that is dropped brings all its files", async (visit) => {
  const { page } = visit;
  const files = { "model/pyramid.obj": MODEL["pyramid.obj"], "model/materials/pyramid.mtl": MODEL["pyramid.mtl"] };
  await withFiles(files, async (folder) => {
    await visit.changes("a drop", () => drop(page, visit.at(0.5, 0.5), [path.join(folder, "model")]));
    assert.deepEqual((await visit.document()).instances.pyramid.mesh, "pyramid");
    const names = (await server.json(`${visit.path}/files`)).map(({ name }) => name).sort();
    assert.deepEqual(names, ["pyramid.mtl", "pyramid.obj"]);
  });
});

visiting("a scene that is dropped is opened", async (visit) => {
  const { page } = visit;
  await withFiles({ "other.json": JSON.stringify({ ...ROOM, name: "a dropped room", instances: {} }) }, async (folder) => {
    await visit.changes("a drop", () => drop(page, visit.at(0.5, 0.5), [path.join(folder, "other.json")]));
    await page.waitForFunction(() => document.querySelector("#scene-name").textContent === "a dropped room");
    assert.notEqual(decodeURIComponent(new URL(page.url()).hash), `#${visit.scene}`);
  });
});

visiting("an image that is dropped on a map becomes a texture there", async (visit) => {
  const { page } = visit;
  await visit.openPanel("materials");
  await page.click('#panel-materials .entry[data-name="red"]');
  const field = await page.waitForSelector('#panel-materials .field[data-pointer="/materials/red/diffuse_map"]');
  await field.scrollIntoView();
  const { x, y, width, height } = await field.boundingBox();
  const image = await (await server.ask("GET", `${visit.path}/frame.png?width=64&height=64`)).arrayBuffer();
  await withFiles({ "photo.png": Buffer.from(image) }, async (folder) => {
    await visit.changes("a drop", () => drop(page, [x + width / 2, y + height / 2], [path.join(folder, "photo.png")]));
    const { materials, textures, instances } = await visit.document();
    assert.equal(materials.red.diffuse_map, "photo");
    assert.equal(textures.photo.file, "photo.png");
    assert.deepEqual(Object.keys(instances), Object.keys(ROOM.instances), "the page has left it to the field");
  });
});

visiting("the frame and the scene are saved", async (visit) => {
  const { page } = visit;
  const save = (button, name) => saved(name, async () => {
    await page.click("#open-save");
    await page.click(button);
  });
  await visit.stands();
  const png = await decode(page, await save("#save-png", `${visit.scene}.png`));
  const size = await page.$eval("#view img:not(.coming)", (img) => [img.naturalWidth, img.naturalHeight]);
  assert.deepEqual([png.width, png.height], size);
  const query = `width=${png.width}&height=${png.height}`;
  const drawn = await decode(page, await (await server.ask("GET", `${visit.path}/frame.png?${query}`)).arrayBuffer());
  assert.ok(png.data.equals(drawn.data), "the saved picture is the scene's");
  const json = JSON.parse(await save("#save-json", `${visit.scene}.json`));
  assert.deepEqual(json, await visit.document());
});

visiting("the copied command fetches the picture on screen", async (visit) => {
  const { page } = visit;
  await browser.defaultBrowserContext().overridePermissions(server.url, ["clipboard-read", "clipboard-sanitized-write"]);
  await page.click("#open-save");
  await page.click("#copy-curl");
  const command = await until("a copied command", () => page.evaluate(() => navigator.clipboard.readText()));
  const [, name, url] = /^curl -o '([^']+)' '([^']+)'$/.exec(command) ?? assert.fail(command);
  assert.equal(name, `${visit.scene}.png`);
  const response = await fetch(url);
  assert.equal(response.headers.get("content-type"), "image/png");
  const { width, height } = await decode(page, await response.arrayBuffer());
  const size = await page.$eval("#view img:not(.coming)", (img) => [img.naturalWidth, img.naturalHeight]);
  assert.deepEqual([width, height], size);
});
