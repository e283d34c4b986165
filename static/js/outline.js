// The selected instance's outline: its box while things move, its silhouette when the picture stands still.

import { projectSegment } from "./camera.js";
import { svg } from "./dom.js";
import { silhouette } from "./silhouette.js";
import { worldFromMesh } from "./transform.js";
import { corners } from "./vec.js";

/** So long the picture must have stood still. */
const STILL_MS = 200;

/** Pairs of a box's corners that differ in one bit: its edges. */
const EDGES = [0, 1, 2, 3, 4, 5, 6, 7].flatMap((from) =>
  [1, 2, 4].filter((bit) => !(from & bit)).map((bit) => [from, from | bit]));

export class Outline {
  #app;
  #group;
  #paths;
  #timer = 0;
  /** What the silhouette on screen, or the one being made, belongs to. */
  #outlined = null;

  constructor(app, marks) {
    this.#app = app;
    // The dark line under the bright one shows on any ground.
    this.#paths = ["under", "over"].map((layer) => svg("path", { class: `outline ${layer}` }));
    this.#group = svg("g", { id: "outline" }, ...this.#paths);
    marks.append(this.#group);
  }

  /** Draws the outline of what is selected in the picture; `shown: null` draws none. */
  draw(shown) {
    const bounds = shown && this.#app.instances.named(this.#app.selection.name)?.mesh_bounds;
    const { selection: { name } } = this.#app;
    const key = shown && JSON.stringify([name, bounds, shown.revision, shown.size, shown.camera, shown.instance]);
    if (key !== null && key === this.#outlined && !isMoving(shown)) return;
    clearTimeout(this.#timer);
    this.#outlined = key;
    this.#show(bounds ? boxPath(shown, bounds) : "", "box");
    if (bounds && !isMoving(shown)) this.#timer = setTimeout(() => this.#refine(key), STILL_MS);
  }

  async #refine(key) {
    const { instances, live, selection } = this.#app;
    const path = await silhouette(live, this.#app.scene, instances.named(selection.name)?.id);
    if (path && key === this.#outlined) this.#show(path, "silhouette");
  }

  #show(path, kind) {
    this.#group.dataset.kind = path ? kind : "none";
    this.#group.dataset.instance = path ? this.#app.selection.name : "";
    for (const element of this.#paths) element.setAttribute("d", path);
  }
}

/** Whether the selected instance moves in the picture by itself. */
function isMoving({ document, instance }) {
  return Boolean(document.camera?.orbit_deg_per_s || instance.spin?.deg_per_s);
}

function boxPath({ document, instance, camera, size, t }, bounds) {
  const toWorld = worldFromMesh(instance, document.render.model_scale, t);
  const points = corners(bounds).map(toWorld);
  const segments = EDGES.map(([from, to]) => projectSegment(camera, points[from], points[to], size)).filter(Boolean);
  return segments.map(([a, b]) => `M${at(a)}L${at(b)}`).join("");
}

const at = ({ x, y }) => `${x.toFixed(1)} ${y.toFixed(1)}`;
