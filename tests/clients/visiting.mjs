// Tests on pages in Chromium: one server and one browser for a file of them.

import assert from "node:assert/strict";
import { mkdtemp, readFile, rm } from "node:fs/promises";
import { tmpdir } from "node:os";
import path from "node:path";
import { after, before, test } from "node:test";
import { Server, chromium, onPage, until } from "./harness.mjs";
import { ROOM, Visit } from "./page.mjs";

export const PATIENT = { timeout: 300_000 };

export let server;
export let browser;
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
export function visiting(name, look, room = ROOM) {
  test(name, PATIENT, () => onPage(browser, name, async (page) => {
    const scene = `room-${(scenes += 1)}`;
    await server.ask("PUT", `/scenes/${scene}`, room);
    const visit = await Visit.begin(page, server, scene);
    await look(visit);
    await visit.streams();
    assert.deepEqual(visit.complaints, [], "nothing to complain about in the console");
  }));
}

/** The file `name` that `act` has the browser save. */
export async function saved(name, act) {
  const folder = await mkdtemp(path.join(tmpdir(), "rasterd-saved-"));
  const session = await browser.target().createCDPSession();
  try {
    await session.send("Browser.setDownloadBehavior", { behavior: "allow", downloadPath: folder, eventsEnabled: true });
    const done = new Promise((resolve) => session.on("Browser.downloadProgress", ({ state }) => { if (state === "completed") resolve(); }));
    await act();
    await done;
    return await readFile(path.join(folder, name));
  } finally {
    await session.detach();
    await rm(folder, { recursive: true });
  }
}

/** What `pick` takes from the scene's document, once it is another than `before`. */
export async function changed(visit, pick, before) {
  const text = JSON.stringify(before);
  const { value } = await until("a changed document", async () => {
    const value = pick(await visit.document());
    return JSON.stringify(value) !== text && { value };
  });
  return value;
}
