// The page as a whole: that it opens, tells what it shows, stays in step and comes back.

import assert from "node:assert/strict";
import { test } from "node:test";
import { Server, firefox, onPage, until } from "./harness.mjs";
import { number } from "./fields.mjs";
import { ROOM, Visit } from "./page.mjs";
import { PATIENT, browser, changed, server, visiting } from "./visiting.mjs";

test("the demo opens without a complaint and without other hosts", PATIENT, (t) => onPage(browser, "demo", async (page) => {
  const began = performance.now();
  const visit = await Visit.begin(page, server, "demo");
  t.diagnostic(`${Math.round(performance.now() - began)} ms from the address to the stream on screen and the first numbers`);
  assert.match(await page.title(), /rasterd/);
  assert.deepEqual(visit.complaints, []);
}));

/** The overlay's facts by their names. */
const factsOn = (page) => page.evaluate(() => Object.fromEntries(
  [...document.querySelectorAll("#overlay .facts dt")].map((term) => [term.textContent, term.nextElementSibling.textContent])));

visiting("the overlay tells of the frame what the server tells", async (visit) => {
  const { page } = visit;
  await page.$eval("#overlay", (overlay) => { overlay.open = true; });
  const { revision } = (await server.json("/scenes")).find(({ id }) => id === visit.scene);
  const plan = await server.json(`${visit.path}/plan`);
  const sizeOfPicture = () => page.$eval("#view img:not(.coming)", (img) => `${img.naturalWidth} × ${img.naturalHeight}`);
  const facts = await until("the numbers of this picture", async () => {
    const facts = await factsOn(page);
    return facts.size === await sizeOfPicture() && facts.draws === String(plan.draws.length) && facts;
  });
  assert.equal(facts.revision, String(revision));
  const [drawn, all] = facts.triangles.split(" of ").map((number) => Number(number.replaceAll(",", "")));
  assert.equal(all, plan.draws.reduce((sum, { triangles }) => sum + triangles, 0));
  assert.ok(drawn > 0 && drawn <= all, facts.triangles);
  const times = await page.$$eval("#overlay .legend li", (items) => items.map(({ dataset, textContent }) => [dataset.pass, Number(textContent.split(" ").at(-1))]));
  for (const { name } of plan.passes.filter(({ runs }) => runs)) assert.ok(times.some(([pass, ms]) => pass === name && ms >= 0), name);
  await until("as many watchers as the server has", async () =>
    (await factsOn(page)).watchers === String(await server.metric("stream_watchers")));
  await server.ask("PATCH", visit.path, { render: { samples: 1 } });
  await until("the next revision", async () => (await factsOn(page)).revision === String(revision + 1));
});

visiting("the picture of the plan names what runs and what is left out", async (visit) => {
  const { page } = visit;
  await page.$eval("#overlay", (overlay) => { overlay.open = true; });
  await page.click("#open-plan");
  await page.waitForSelector("#plan[open] svg.plan");
  const texts = await page.$$eval("#plan svg.plan text.name", (all) => all.map(({ textContent }) => textContent));
  const plan = await server.json(`${visit.path}/plan`);
  for (const { name } of plan.passes) assert.ok(texts.includes(name), name);
  assert.ok(texts.includes("Lights (2)") && texts.includes("Draws (3)") && texts.includes("Effects (1)"), texts.join());
  const left = () => page.$eval("#plan", ({ textContent }) => textContent);
  await server.ask("PATCH", visit.path, { render: { shadows: false } });
  const { left_out: leftOut } = await server.json(`${visit.path}/plan`);
  assert.notDeepEqual(leftOut, plan.left_out);
  for (const { reason } of leftOut) await until(reason, async () => (await left()).includes(reason));
  await page.click("#plan .close");
  await page.waitForSelector("#plan:not([open])");
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
    // The message that all is well again lies over the picture for a while.
    await until("no message", () => page.$eval("#notices", ({ textContent }) => textContent === ""));
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
