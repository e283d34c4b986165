// Error and time on the page: a report is measured, followed, cancelled and shown; the view keeps to a budget.

import assert from "node:assert/strict";
import { until } from "./harness.mjs";
import { choice, number } from "./fields.mjs";
import { browser, saved, server, visiting } from "./visiting.mjs";

/** A button is there as long as nothing is measured. */
const isIdle = (page) => page.waitForFunction(() => document.querySelector("#measure").textContent === "Measure");

async function begin(page, seconds) {
  await page.click("#overlay > summary");
  await page.click("#open-report");
  await page.select("#report-seconds", String(seconds));
  await page.click("#measure");
}

const progress = (page) => page.$eval("#report-progress", (bar) => (bar.checkVisibility() && bar.position >= 0 ? bar.value : null));

const newTab = () => new Promise((resolve) => browser.once("targetcreated", (target) => resolve(target.page())));

/** The query of the stream on screen. */
async function streamQuery(page) {
  const src = await page.$eval("#view img:not(.coming)", (image) => image.src);
  return Object.fromEntries(new URL(src).searchParams);
}

/** Waits for a stream on screen whose query `matches`. */
const streamsWith = (page, what, matches) => until(what, async () => {
  const image = await page.$('#view img:not(.coming)[src*="/stream.mjpg"]');
  return image && matches(await streamQuery(page));
});

const settled = (page) => page.waitForFunction(() => document.querySelector("#settled").textContent)
  .then((said) => said.jsonValue());

visiting("a report is measured, followed, and shown beside the picture", async (visit) => {
  const { page } = visit;
  await begin(page, 10);
  const first = await until("the begin of the bar", () => progress(page));
  await until("a longer bar", async () => (await progress(page)) > first + 0.1);
  const image = await page.waitForSelector("#report img[src]", { visible: true });
  await page.waitForFunction(() => document.querySelector("#report img").naturalWidth > 0);
  await isIdle(page);
  assert.equal(await page.$eval("#report-progress", (bar) => bar.checkVisibility()), false);

  const [figure, picture] = [await image.boundingBox(), await (await page.$("#view")).boundingBox()];
  assert.ok(picture.width > 200 && picture.x + picture.width <= figure.x, "the picture is beside it");

  const report = JSON.parse(await saved(`${visit.scene}-report.json`, () => page.click("#report-data")));
  assert.equal(report.meta.name, visit.scene);
  assert.ok(Math.abs(report.meta.width / report.meta.height - picture.width / picture.height) < 0.02, "of the same view");
  assert.equal(await page.$eval("#report-partial", (remark) => remark.checkVisibility()), report.unfinished.length > 0);
  const [tab] = await Promise.all([newTab(), page.click("#report-page")]);
  await tab.waitForSelector("body svg");
  assert.match(await tab.$eval("body", ({ innerText }) => innerText), /Time to reach an error/);
  await tab.close();
  await page.bringToFront();

  await page.$eval("#report figure", (box) => box.scrollIntoView());
  const fit = (await image.boundingBox()).width;
  await page.click("#report .zoom");
  assert.ok((await image.boundingBox()).width > fit, "there is a larger size");

  const remark = () => page.$eval("#report-remark", ({ textContent }) => textContent);
  assert.equal(await remark(), "");
  await page.focus("#view");
  await page.keyboard.press("F1");
  await until("a remark on the changed scene", remark);
  await page.keyboard.press("F1");
  await until("no remark", async () => (await remark()) === "");
});

visiting("a measurement is cancelled, also for the server", async (visit) => {
  const { page } = visit;
  await begin(page, 60);
  await until("a report under way", () => progress(page));
  await page.click("#measure");
  await isIdle(page);
  assert.equal(await page.$eval("#report figure", (figure) => figure.checkVisibility()), false);
  assert.equal(await page.$eval("#notices", ({ textContent }) => textContent), "");
  // One is made at a time: that one is soon done tells that the server has left the other.
  const start = Date.now();
  await server.ask("GET", `${visit.path}/report.json?width=64&height=48&budget_s=2`);
  assert.ok(Date.now() - start < 40_000, "the server has its hands free");
});

visiting("what the server has against a report is said", async (visit) => {
  const { page } = visit;
  await page.$eval("#report-seconds", (select) => { select.options[0].value = "0"; });
  await begin(page, 0);
  await page.waitForFunction(() => document.querySelector("#notices .notice[data-kind=bad]")?.textContent.includes("budget_s"));
  await isIdle(page);
  visit.complaints = visit.complaints.filter((text) => !/status of 422/.test(text)); // Chromium names each failed request
});

visiting("a preset and a limit go into the stream's query, and say what they come to", async (visit) => {
  const { page } = visit;
  await visit.openPanel("render");
  assert.equal((await streamQuery(page)).preset, undefined);
  await choice("Draft")(page, "#quality");
  await streamsWith(page, "a draft", ({ preset }) => preset === "draft");
  const draft = await settled(page);
  assert.match(draft, /sample.* ms a frame and an error of /);

  await choice("Reference")(page, "#quality");
  await streamsWith(page, "a reference", ({ preset }) => preset === "reference");
  await until("other settings", async () => ![draft, ""].includes(await settled(page)));

  await choice("At most so many ms")(page, "#quality");
  await number(0, 7)(page, "#limit-max_ms");
  await streamsWith(page, "at most 7 ms", ({ max_ms, preset }) => max_ms === "7" && preset === undefined);

  await choice("At most such an error")(page, "#quality");
  await streamsWith(page, "a bounded error", ({ max_ms, max_error }) => max_error === "0.01" && max_ms === undefined);

  await browser.defaultBrowserContext().overridePermissions(server.url, ["clipboard-read", "clipboard-sanitized-write"]);
  await page.click("#open-save");
  await page.click("#copy-curl");
  const command = await until("a copied command", () => page.evaluate(() => navigator.clipboard.readText()));
  assert.match(command, /max_error=0\.01/);

  await choice("As the scene says")(page, "#quality");
  await streamsWith(page, "no budget", (query) => query.max_error === undefined);
  assert.equal(await page.$eval("#settled", ({ textContent }) => textContent), "");
});
