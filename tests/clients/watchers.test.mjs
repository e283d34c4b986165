// Many who watch one stream: what it costs, and what one costs who never reads.
//
// A few seconds by default; `RASTERD_WATCH_SECONDS=60 node --test tests/clients/watchers.test.mjs` for the whole minute.

import assert from "node:assert/strict";
import { once } from "node:events";
import { readFile } from "node:fs/promises";
import net from "node:net";
import { after, before, test } from "node:test";
import { Server, until } from "./harness.mjs";

const SECONDS = Number(process.env.RASTERD_WATCH_SECONDS ?? 6);
const WATCHERS = 200;
const SILENT = 20;
const FPS = 30;
/** What the allocator may keep for later; one picture for each watcher would be many times that. */
const SLACK_BYTES = 8 << 20;

let server;
before(async () => { server = await Server.start(); });
after(() => server.stop());

const sleep = (seconds) => new Promise((resolve) => setTimeout(resolve, seconds * 1000));

/** A client on a socket of its own; without `reads` it takes nothing, for ever. */
async function watcher({ reads }) {
  const [host, port] = server.address.split(":");
  const socket = net.connect({ host, port: Number(port), noDelay: true });
  const client = { socket, bytes: 0 };
  if (reads) socket.on("data", (some) => { client.bytes += some.length; });
  else socket.pause();
  socket.on("error", () => {});
  await once(socket, "connect");
  socket.write(`GET /scenes/spinning/stream.mjpg?fps=${FPS} HTTP/1.1\r\nHost: localhost\r\n\r\n`);
  return client;
}

async function residentBytes() {
  const status = await readFile(`/proc/${server.process.pid}/status`, "utf8");
  return Number(/VmRSS:\s+(\d+) kB/.exec(status)[1]) * 1024;
}

const rendered = () => server.metric('frames_rendered_total{kind="stream"}');

test("200 watchers of a stream cost the rendering of one, in flat memory", { timeout: SECONDS * 4000 + 60_000 }, async (t) => {
  await server.ask("PUT", "/scenes/spinning", {
    meshes: { box: { type: "box" } },
    instances: { box: { mesh: "box", spin: { axis: [0, 1, 0], deg_per_s: 20 } } },
    render: { width: 320, height: 240, samples: 1 },
  });
  const silent = await Promise.all(Array.from({ length: SILENT }, () => watcher({ reads: false })));
  const watchers = await Promise.all(Array.from({ length: WATCHERS - SILENT }, () => watcher({ reads: true })));
  t.after(() => [...silent, ...watchers].forEach(({ socket }) => socket.destroy()));
  await until("all watch", async () => (await server.metric("stream_watchers")) === WATCHERS);
  await until("all who read have seen something", () => watchers.every(({ bytes }) => bytes > 0));
  assert.equal(await server.metric("streams"), 1);
  await sleep(SECONDS / 3);

  const [frames, memory, began] = [await rendered(), await residentBytes(), performance.now()];
  const read = watchers.map(({ bytes }) => bytes);
  await sleep((SECONDS * 2) / 3);
  const seconds = (performance.now() - began) / 1000;
  const [drawn, grown] = [(await rendered()) - frames, (await residentBytes()) - memory];

  const dropped = await server.metric("stream_frames_dropped_total");
  const sent = await server.metric("stream_frames_sent_total");
  t.diagnostic(`${drawn} frames in ${seconds.toFixed(1)} s, ${sent} pictures sent, ${dropped} skipped; ${(memory / 2 ** 20).toFixed(1)} MiB, ${(grown / 1024).toFixed(0)} KiB more after it`);
  assert.ok(drawn <= FPS * seconds + 1, `${drawn} frames in ${seconds} s`);
  assert.ok(drawn > 0 && watchers.every(({ bytes }, i) => bytes > read[i]), "all who read go on seeing something");
  assert.ok(grown < SLACK_BYTES, `${grown} bytes more`);
});
