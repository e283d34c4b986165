// What was changed can be taken back, and done again.

import assert from "node:assert/strict";
import { changed, visiting } from "./visiting.mjs";

visiting("keys and buttons undo and redo what was changed, and leave the camera", async (visit) => {
  const { page } = visit;
  const box = async () => (await visit.document()).instances.box;
  const start = await box();
  await visit.focusView();
  await page.keyboard.press("2");
  await visit.changes("a moved box", () => page.keyboard.press("d", { delay: 200 }));
  const moved = await box();
  assert.notDeepEqual(moved.translation, start.translation);
  await visit.changes("a drag", () => visit.drag(visit.at(0.1, 0.4), visit.at(0.3, 0.45)));
  const { camera } = await visit.document();

  const press = async (...keys) => {
    await page.keyboard.down("Control");
    for (const key of keys) await page.keyboard.press(key);
    await page.keyboard.up("Control");
  };
  await visit.changes("undo", () => press("z"));
  assert.deepEqual(await box(), start);
  await visit.changes("redo", () => press("y"));
  assert.deepEqual(await box(), moved);
  await visit.changes("the button", () => page.click("#undo"));
  assert.deepEqual(await box(), start);
  assert.ok(await page.$eval("#undo", ({ disabled }) => disabled), "nothing is left to undo");
  assert.deepEqual((await visit.document()).camera, camera);

  await page.click("#selected [data-action=delete]");
  await changed(visit, ({ instances }) => Object.keys(instances).length, 3);
  await visit.changes("undo of the deletion", () => page.click("#undo"));
  assert.deepEqual(await box(), start);
});
