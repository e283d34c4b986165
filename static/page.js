// The page: shows frames of one scene, turns the camera, takes models.

const byId = (id) => document.getElementById(id);
const view = byId("view");
const canvas = byId("frame");

/** Sharper than two device pixels nobody sees; more than this many nobody waits for. */
const MAX_PIXEL_RATIO = 2;
const MAX_PIXELS = 2_000_000;
/** A frame slower than this is drawn at half the size while the camera moves. */
const SLOW_FRAME_MS = 80;
const MAX_PITCH_DEG = 89;

const state = {
  /** null until a scene is open. */
  scene: null,
  /** Where the scene's own camera stands about its target; distance null where it is not known. */
  home: { yaw: 0, pitch: 0, distance: null },
  /** null while the scene's own camera is used; distance null while it is as the scene has it. */
  orbit: null,
  moving: false,
  lastMs: 0,
  startedAt: 0,
};

// ── Frames: one request at a time, and the newest wish wins ──

let wanted = false;
let busy = false;

async function requestFrame() {
  wanted = true;
  if (busy || state.scene === null) return;
  busy = true;
  while (wanted) {
    wanted = false;
    await drawFrame();
  }
  busy = false;
}

function frameUrl(scale) {
  const box = view.getBoundingClientRect();
  const ratio = Math.min(window.devicePixelRatio || 1, MAX_PIXEL_RATIO);
  const fit = Math.min(ratio, Math.sqrt(MAX_PIXELS / Math.max(box.width * box.height, 1)));
  const side = (length) => Math.max(16, Math.round(length * fit * scale));
  const query = new URLSearchParams({ width: side(box.width), height: side(box.height) });

  if (state.orbit) {
    const { yaw, pitch, distance } = state.orbit;
    const parts = distance === null ? [yaw, pitch] : [yaw, pitch, distance];
    query.set("orbit", parts.map((n) => Number(n.toPrecision(8))).join(","));
  }
  if (byId("output").value !== "color") query.set("output", byId("output").value);
  for (const name of ["shading", "samples"]) {
    if (byId(name).value) query.set(name, byId(name).value);
  }
  if (byId("play").checked) query.set("t", ((performance.now() - state.startedAt) / 1000).toFixed(3));
  return `/scenes/${encodeURIComponent(state.scene)}/frame.png?${query}`.replaceAll("%2C", ",");
}

async function drawFrame() {
  const half = state.moving && state.lastMs > SLOW_FRAME_MS;
  const scene = state.scene;
  const begin = performance.now();
  setStatus("Drawing…", 300);
  try {
    const response = await fetch(frameUrl(half ? 0.5 : 1));
    if (response.status === 503) return await waitAndRetry(response);
    if (!response.ok) throw await problemOf(response);
    const picture = await createImageBitmap(await response.blob());
    if (scene !== state.scene) return; // another scene was chosen meanwhile, and is wanted already
    // At half size a frame takes about a quarter of the time.
    state.lastMs = (performance.now() - begin) * (half ? 4 : 1);
    showFacts(response.headers, picture);
    show(picture);
    byId("note").hidden = byId("output").value !== "instance";
    clearProblem("The picture could not be drawn");
    byId("frame-link").href = frameUrl(1);
    if (byId("play").checked) wanted = true;
  } catch (error) {
    showProblem(error, "The picture could not be drawn");
  } finally {
    setStatus("");
  }
}

async function waitAndRetry(response) {
  const seconds = Math.min(Number(response.headers.get("Retry-After")) || 1, 30);
  setStatus("The server is busy; trying again");
  await new Promise((resolve) => setTimeout(resolve, seconds * 1000));
  wanted = true;
}

function show(picture) {
  canvas.width = picture.width;
  canvas.height = picture.height;
  canvas.getContext("2d").drawImage(picture, 0, 0);
  picture.close();
}

/** Shows `text` after `delayMs`, so that fast frames do not flicker. */
let statusTimer = 0;
function setStatus(text, delayMs = 0) {
  clearTimeout(statusTimer);
  statusTimer = setTimeout(() => { byId("status").textContent = text; }, delayMs);
}

function showFacts(headers, picture) {
  const facts = [["size", `${picture.width} × ${picture.height}`]];
  for (const entry of (headers.get("Server-Timing") || "").split(",")) {
    const match = entry.match(/^\s*([\w-]+)\s*;.*dur=([\d.]+)/);
    if (match) facts.push([match[1], `${Number(match[2]).toFixed(1)} ms`]);
  }
  for (const entry of (headers.get("Render-Stats") || "").split(",")) {
    const [name, value] = entry.trim().split("=");
    if (value !== undefined) facts.push([name.replaceAll("_", " "), Number(value).toLocaleString()]);
  }
  const depth = headers.get("Render-Depth-Range");
  if (depth) facts.push(["depth range", depth]);
  byId("facts").replaceChildren(...facts.flatMap(([name, value]) => [element("dt", name), element("dd", value)]));
}

// ── Camera ──

const wrapDeg = (deg) => ((((deg + 180) % 360) + 360) % 360) - 180;
const clamp = (x, low, high) => Math.min(Math.max(x, low), high);

function turn(yawDeg, pitchDeg) {
  const from = state.orbit || { ...state.home, distance: null };
  setOrbit({
    yaw: wrapDeg(from.yaw + yawDeg),
    pitch: clamp(from.pitch + pitchDeg, -MAX_PITCH_DEG, MAX_PITCH_DEG),
    distance: from.distance,
  });
}

function zoom(factor) {
  const from = state.orbit || { ...state.home, distance: null };
  const distance = from.distance ?? state.home.distance;
  if (distance !== null) setOrbit({ ...from, distance: distance * factor });
}

function setOrbit(orbit) {
  state.orbit = orbit;
  const { yaw, pitch } = orbit || state.home;
  for (const [id, value] of [["yaw", yaw], ["pitch", pitch]]) {
    byId(id).value = value;
    byId(`${id}-value`).textContent = `${Math.round(value)}°`;
  }
  requestFrame();
}

/** Where the camera of `document` stands about its target; framed about `bounds` without a position. */
function homeOf({ camera }, bounds) {
  const deg = 180 / Math.PI;
  const position = camera?.position;
  const target = camera?.target ?? [0, 0, 0];
  const offset = position ? position.map((x, i) => x - target[i]) : [1, 0.6, 1.4];
  const length = Math.hypot(...offset);
  if (length === 0) return { yaw: 0, pitch: 0, distance: null };
  return {
    yaw: Math.atan2(offset[0], offset[2]) * deg,
    pitch: Math.asin(offset[1] / length) * deg,
    distance: position ? length : framingDistance(offset.map((x) => x / length), camera, bounds),
  };
}

/** The distance at which the bounds' corners fill 90 % of the tighter side, seen along −`back`. */
function framingDistance(back, camera, bounds) {
  if (!bounds) return null;
  const box = view.getBoundingClientRect();
  const tanY = Math.tan(((camera?.fov_y_deg ?? 45) / 2) * (Math.PI / 180));
  const tanX = tanY * (box.width / box.height);
  const flat = Math.hypot(back[0], back[2]);
  const right = [back[2] / flat, 0, -back[0] / flat];
  const up = [back[1] * right[2], back[2] * right[0] - back[0] * right[2], -back[1] * right[0]];
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const half = bounds.max.map((x, i) => (x - bounds.min[i]) / 2);
  const distances = [0, 1, 2, 3, 4, 5, 6, 7].map((corner) => {
    const p = half.map((h, axis) => ((corner >> axis) & 1 ? h : -h));
    const away = Math.max(Math.abs(dot(p, right)) / (0.9 * tanX), Math.abs(dot(p, up)) / (0.9 * tanY));
    return away + dot(p, back);
  });
  return Math.max(...distances) || null;
}

// ── Mouse, touch, keyboard ──

const pointers = new Map();

function pointerSpread() {
  const [a, b] = [...pointers.values()];
  return Math.hypot(a.x - b.x, a.y - b.y) || 1;
}

view.addEventListener("pointerdown", (event) => {
  if (event.button !== 0) return;
  view.setPointerCapture(event.pointerId);
  pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
  state.moving = true;
  view.classList.add("dragging");
});

view.addEventListener("pointermove", (event) => {
  const last = pointers.get(event.pointerId);
  if (!last) return;
  const spread = pointers.size === 2 ? pointerSpread() : 0;
  pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
  if (spread) zoom(spread / pointerSpread());
  else turn((last.x - event.clientX) * 0.4, (event.clientY - last.y) * 0.4);
});

for (const type of ["pointerup", "pointercancel"]) {
  view.addEventListener(type, (event) => {
    if (!pointers.delete(event.pointerId) || pointers.size > 0) return;
    state.moving = false;
    view.classList.remove("dragging");
    requestFrame(); // once more at full size
  });
}

view.addEventListener("wheel", (event) => {
  event.preventDefault();
  const lines = event.deltaMode === WheelEvent.DOM_DELTA_LINE;
  zoom(Math.exp(clamp(event.deltaY * (lines ? 16 : 1), -400, 400) * 0.0015));
}, { passive: false });

view.addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.altKey || event.metaKey) return;
  const keys = {
    ArrowLeft: () => turn(-5, 0),
    ArrowRight: () => turn(5, 0),
    ArrowUp: () => turn(0, 5),
    ArrowDown: () => turn(0, -5),
    "+": () => zoom(0.9),
    "=": () => zoom(0.9),
    "-": () => zoom(1 / 0.9),
    0: () => setOrbit(null),
  };
  if (!Object.hasOwn(keys, event.key)) return;
  event.preventDefault();
  keys[event.key]();
});

for (const id of ["yaw", "pitch"]) {
  byId(id).addEventListener("input", (event) => {
    const from = state.orbit || { ...state.home, distance: null };
    setOrbit({ ...from, [id]: event.target.valueAsNumber });
  });
}
for (const id of ["output", "shading", "samples"]) byId(id).addEventListener("change", requestFrame);
byId("play").addEventListener("change", () => {
  state.startedAt = performance.now();
  requestFrame();
});
byId("reset").addEventListener("click", () => setOrbit(null));
for (const form of document.forms) form.addEventListener("submit", (event) => event.preventDefault());
new ResizeObserver(requestFrame).observe(view);

// ── Scenes and uploads ──

async function openScene(id) {
  const path = `/scenes/${encodeURIComponent(id)}`;
  try {
    const [document_, summaries] = await Promise.all([getJson(path), getJson("/scenes")]);
    const list = Array.isArray(summaries) ? summaries : (summaries.scenes ?? []);
    const summary = list.find((entry) => entry.id === id);
    state.scene = id;
    state.home = homeOf(document_, summary?.framed_bounds);
    byId("scene-name").textContent = document_.name || id;
    canvas.setAttribute("aria-label", document_.name || id);
    byId("scene-link").href = path;
    byId("frame-link").download = `${id}.png`;
    byId("show-demo").hidden = id === "demo";
    history.replaceState(null, "", id === "demo" ? location.pathname : `#${encodeURIComponent(id)}`);
    showWarnings(summary?.warnings ?? []);
    markOpenPiece();
    clearProblem();
    setOrbit(null);
  } catch (error) {
    byId("show-demo").hidden = id === "demo";
    showProblem(error, "The scene could not be opened");
  }
}

/** Posts files as one scene: a `.json` is its document, everything else goes along as it is. */
async function upload(files) {
  if (files.length === 0) return;
  const form = new FormData();
  for (const file of files) {
    if (/\.json$/i.test(file.name)) form.append("scene", new Blob([file], { type: "application/json" }));
    else form.append("file", file, file.name);
  }
  setStatus("Uploading…");
  try {
    const response = await fetch(`/scenes?up=${byId("z-up").checked ? "z" : "y"}`, { method: "POST", body: form });
    if (!response.ok) throw await problemOf(response);
    await openScene((await response.json()).id);
  } catch (error) {
    showProblem(error, "The files make no scene");
  } finally {
    setStatus("");
    byId("files").value = "";
  }
}

// ── Gallery ──

/** What the server offers to open, each with a picture. */
async function listGallery() {
  try {
    const pieces = await getJson("/gallery");
    byId("gallery").querySelector("ul").replaceChildren(...pieces.map((piece) => element("li", galleryButton(piece))));
    byId("gallery").hidden = pieces.length === 0;
    markOpenPiece();
  } catch {
    // The page does without.
  }
}

function galleryButton({ name, title, description, picture }) {
  const image = element("img");
  // Lazy before there is a source: a closed list loads no pictures.
  Object.assign(image, { loading: "lazy", alt: "", width: 480, height: 360, src: picture });
  const button = element("button", image, element("span", title));
  Object.assign(button, { type: "button", title: description });
  button.dataset.scene = `gallery-${name}`;
  button.addEventListener("click", () => openPiece(name));
  return button;
}

/** Every piece is one scene: who opens it first creates it, and changes to it stay. */
async function openPiece(name) {
  const id = `gallery-${name}`;
  setStatus("Opening…", 300);
  try {
    const query = new URLSearchParams({ from: name });
    const response = await fetch(`/scenes/${id}?${query}`, { method: "PUT", headers: { "If-None-Match": "*" } });
    if (!response.ok && response.status !== 412) throw await problemOf(response);
    await openScene(id);
    // On a small screen the picture is above the list.
    view.scrollIntoView({ block: "nearest" });
  } catch (error) {
    showProblem(error, "The scene could not be opened");
  } finally {
    setStatus("");
  }
}

function markOpenPiece() {
  for (const button of byId("gallery").querySelectorAll("button")) {
    if (button.dataset.scene === state.scene) button.setAttribute("aria-current", "true");
    else button.removeAttribute("aria-current");
  }
}

byId("files").addEventListener("change", (event) => upload([...event.target.files]));
byId("show-demo").addEventListener("click", () => openScene("demo"));
window.addEventListener("hashchange", openAddressed);

/** The scene that the address names; one of the gallery need not be there yet. */
function openAddressed() {
  const id = sceneOfAddress();
  if (id.startsWith("gallery-")) openPiece(id.slice("gallery-".length));
  else openScene(id);
}

function sceneOfAddress() {
  try {
    return decodeURIComponent(location.hash.slice(1)) || "demo";
  } catch {
    return "demo"; // a broken escape
  }
}

const carriesFiles = (event) => event.dataTransfer?.types.includes("Files");
document.addEventListener("dragover", (event) => {
  if (!carriesFiles(event)) return;
  event.preventDefault();
  document.body.classList.add("file-over");
});
document.addEventListener("dragleave", (event) => {
  if (!event.relatedTarget) document.body.classList.remove("file-over");
});
document.addEventListener("drop", async (event) => {
  if (!carriesFiles(event)) return;
  event.preventDefault();
  document.body.classList.remove("file-over");
  // Entries must be taken before the first await: afterwards the list is empty.
  const entries = [...event.dataTransfer.items].map((item) => item.webkitGetAsEntry()).filter(Boolean);
  try {
    upload((await Promise.all(entries.map(filesUnder))).flat());
  } catch (error) {
    showProblem(error, "The files could not be read");
  }
});

/** The files of a dropped file or folder, however deep. */
async function filesUnder(entry) {
  if (entry.isFile) return [await new Promise((resolve, reject) => entry.file(resolve, reject))];
  const reader = entry.createReader();
  const found = [];
  for (;;) {
    // A reader hands over some entries at a time, and none at the end.
    const some = await new Promise((resolve, reject) => reader.readEntries(resolve, reject));
    if (some.length === 0) return found;
    found.push(...(await Promise.all(some.map(filesUnder))).flat());
  }
}

// ── Problems and warnings ──

async function getJson(path) {
  const response = await fetch(path);
  if (!response.ok) throw await problemOf(response);
  return response.json();
}

/** The problem document (RFC 9457) of a response, or what can be said without one. */
async function problemOf(response) {
  try {
    return { ...(await response.json()), isProblem: true };
  } catch {
    return { isProblem: true, title: `The server answered ${response.status}`, detail: response.statusText };
  }
}

/** What the page could not do: a frame that succeeds takes away only a frame's problem. */
let failure = "";

function showProblem(error, title) {
  const items = (error.errors ?? []).map((entry) => withPlace(entry, entry.pointer ?? entry.parameter));
  const parts = [element("h2", title), element("p", detailOf(error))];
  if (items.length > 0) parts.push(element("ul", ...items));
  failure = title;
  byId("problem").replaceChildren(...parts);
  byId("problem").hidden = false;
}

/** `fetch` fails with a TypeError when there is no answer at all. */
function detailOf(error) {
  if (error.isProblem) return error.detail || error.title;
  return error instanceof TypeError ? "The server cannot be reached." : error.message;
}

function clearProblem(title = failure) {
  if (title === failure) byId("problem").hidden = true;
}

function showWarnings(warnings) {
  const count = warnings.length;
  byId("warnings").hidden = count === 0;
  byId("warnings").querySelector("summary").textContent = count === 1 ? "1 warning" : `${count} warnings`;
  byId("warnings").querySelector("ul").replaceChildren(...warnings.map((entry) => withPlace(entry)));
}

/** A list item: pointer, file and line, as far as they are there, and the detail. */
function withPlace(entry, pointer) {
  const line = entry.line === undefined ? "" : `line ${entry.line}`;
  const place = [pointer, entry.file, line].filter(Boolean).join(", ");
  return place ? element("li", element("code", place), ` ${entry.detail}`) : element("li", entry.detail);
}

function element(name, ...children) {
  const made = document.createElement(name);
  made.append(...children);
  return made;
}

listGallery();
openAddressed();
