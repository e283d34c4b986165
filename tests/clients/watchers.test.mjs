// Many who watch one stream: what it costs, and what one costs who never reads.
//
// A few seconds by default; `RASTERD_WATCH_SECONDS=60 node --test tests/clients/watchers.test.mjs` for the whole minute.

import assert from "node:assert/strict";
import { once } from "node:events";
import { readFile } from "node:fs/promises";
import net from "node:net";
import { after, before, test } from "node:test";
import { Server, until } from "./harness.mjs";

const SECONDS = Number(process.env.RASTERD_WATCH_SECONDS ?? 9);
const WATCHERS = 200;
const SILENT = 20;
/** So few that an unoptimised build draws them all, and that those who read keep up. */
const FPS = 2;
/** What a connection may need of its own: buffers, but never a picture. */
const CONNECTION_BYTES = 64 << 10;
/** Less would not tell a picture from a connection's buffers. */
const LEAST_PICTURE_BYTES = 2 * CONNECTION_BYTES;

/** Fine squares that are not smoothed: from afar nothing but noise, and so a large picture. */
const NOISE = {
  camera: { position: [0, 1, 3], target: [0, 0, 0], fov_y_deg: 60 },
  textures: { squares: { checker: { colors: ["#000000", "#ffffff"], cells: 1024 }, filter: "nearest" } },
  materials: { squares: { diffuse_map: "squares", shading: "unlit" } },
  meshes: { floor: { type: "plane", size: [8, 8] } },
  instances: { floor: { mesh: "floor", material: "squares", spin: { axis: [0, 1, 0], deg_per_s: 20 } } },
  render: { width: 1280, height: 720, samples: 1 },
};

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

const opened = (count, kind) => Promise.all(Array.from({ length: count }, () => watcher(kind)));
const all = (watchers, count) => until(`${count} watchers`, async () => {
  const come = await server.metric("stream_watchers");
  return come === count && watchers.every(({ bytes }) => bytes > LEAST_PICTURE_BYTES);
});

test("200 watchers of a stream cost the rendering of one, in flat memory", { timeout: SECONDS * 4000 + 120_000 }, async (t) => {
  await server.ask("PUT", "/scenes/spinning", NOISE);
  const picture = (await (await server.ask("GET", "/scenes/spinning/frame.jpg")).arrayBuffer()).byteLength;
  assert.ok(picture >= LEAST_PICTURE_BYTES, `${picture} bytes`);

  // What one watcher needs is there before the others come.
  const readers = await opened(1, { reads: true });
  t.after(() => readers.forEach(({ socket }) => socket.destroy()));
  await all(readers, 1);
  await sleep(SECONDS / 6);
  const alone = await residentBytes();

  readers.push(...await opened(WATCHERS - SILENT - 1, { reads: true }));
  await all(readers, WATCHERS - SILENT);
  await sleep(SECONDS / 6);
  const withReaders = await residentBytes();

  const silent = await opened(SILENT, { reads: false });
  t.after(() => silent.forEach(({ socket }) => socket.destroy()));
  await all(readers, WATCHERS);
  assert.equal(await server.metric("streams"), 1);
  const [frames, began] = [await rendered(), performance.now()];
  const read = readers.map(({ bytes }) => bytes);
  await sleep((SECONDS * 2) / 3);
  await until("enough frames to tell a queue of them", async () => (await rendered()) - frames > SILENT / 2);
  const seconds = (performance.now() - began) / 1000;
  const drawn = (await rendered()) - frames;
  const withSilent = await residentBytes();

  const dropped = await server.metric("stream_frames_dropped_total");
  const sent = await server.metric("stream_frames_sent_total");
  const mebibytes = (bytes) => (bytes / 2 ** 20).toFixed(1);
  t.diagnostic(`${drawn} frames of ${(picture / 1000).toFixed(0)} kB in ${seconds.toFixed(1)} s, ${sent} pictures sent, ${dropped} skipped`);
  t.diagnostic(`${mebibytes(alone)} MiB with one watcher, ${mebibytes(withReaders)} with ${readers.length}, ${mebibytes(withSilent)} with ${SILENT} more who never read`);
  assert.ok(drawn <= FPS * seconds + 1, `${drawn} frames in ${seconds} s`);
  assert.ok(drawn > 0 && readers.every(({ bytes }, i) => bytes > read[i]), "all who read go on seeing something");
  const [forReaders, forSilent] = [withReaders - alone, withSilent - withReaders];
  assert.ok(forReaders < readers.length * CONNECTION_BYTES, `${mebibytes(forReaders)} MiB for ${readers.length} who read`);
  // Neither a picture for each of them, nor a queue of all that were drawn meanwhile.
  // Each may hold the one picture that it was being given; a queue would hold all that were drawn since.
  assert.ok(forSilent < SILENT * picture, `${mebibytes(forSilent)} MiB for ${SILENT} who never read`);
});
