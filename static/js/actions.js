// What buttons and keys do. Each takes the app; the state that a button shows is here too.

import { same } from "./merge.js";
import { translationOf } from "./transform.js";

// ── The view ──

/** Shows the whole scene. */
export async function frameScene(app) {
  await app.instances.read(app.live.frame?.t);
  const bounds = app.instances.bounds();
  if (bounds) app.motion.glide((camera) => app.camera.framed(camera, bounds));
}

/** Shows one instance. */
export async function frameInstance(app, name) {
  await app.instances.read(app.live.frame?.t);
  const bounds = app.instances.named(name)?.bounds;
  if (bounds) app.motion.glide((camera) => app.camera.framed(camera, bounds));
}

export const frameSelected = (app) => frameInstance(app, app.selection.name);

// ── Switches ──

export const areShadowsOn = ({ scene }) => scene.document.render.shadows;

export function toggleShadows(app) {
  app.scene.edit({ render: { shadows: !areShadowsOn(app) } });
}

const SOFT_FILTERS = ["pcf", "pcss"];
/** Of a light whose shadow was never soft. */
const DEFAULT_SOFT_FILTER = "pcss";
/** Light → the soft filter that it had before it was hard. */
const formerFilters = new Map();

export function areShadowsSoft({ scene }) {
  return castingLights(scene).some(([, { shadow }]) => SOFT_FILTERS.includes(shadow.filter));
}

export function toggleSoftShadows(app) {
  const wasSoft = areShadowsSoft(app);
  const lights = {};
  for (const [name, { shadow }] of castingLights(app.scene)) {
    const key = `${app.scene.id}/${name}`;
    if (wasSoft && shadow.filter !== "hard") formerFilters.set(key, shadow.filter);
    const filter = wasSoft ? "hard" : formerFilters.get(key) ?? DEFAULT_SOFT_FILTER;
    lights[name] = { shadow: { filter } };
  }
  app.scene.edit({ lights });
}

export const castShadows = ({ scene }) => castingLights(scene).length > 0;

function castingLights({ document: { lights = {} } }) {
  return Object.entries(lights).filter(([, { shadow }]) => shadow && shadow.filter !== "none");
}

/** What `nextEffect` goes through, one at a time: the scene's own chain, these, nothing. */
const EFFECTS = [
  { name: "Tone map", post: [{ type: "tonemap", operator: "aces" }] },
  { name: "Blur", post: [{ type: "blur", radius: 4 }] },
  { name: "Greys", post: [{ type: "grayscale" }] },
  { name: "Vignette", post: [{ type: "vignette", amount: 0.7 }] },
  { name: "Bloom", post: [{ type: "bloom", threshold: 0.7, intensity: 0.4 }] },
  { name: "Sharpen", post: [{ type: "sharpen", amount: 1 }] },
  { name: "FXAA", post: [{ type: "fxaa" }] },
  {
    name: "Sepia",
    post: [{ type: "color_matrix", matrix: [[0.39, 0.77, 0.19, 0], [0.35, 0.69, 0.17, 0], [0.27, 0.53, 0.13, 0]] }],
  },
  { name: "Edges", post: [{ type: "kernel", kernel: [[-1, -1, -1], [-1, 8, -1], [-1, -1, -1]] }] },
];
/** Scene → the chain that was there before it was switched off. */
const formerChains = new Map();
/** Scene → the last chain that was none of the effects. */
const ownChains = new Map();

export const isPostOn = ({ scene }) => scene.document.post.length > 0;

export function togglePost(app) {
  const { id, document } = app.scene;
  if (isPostOn(app)) formerChains.set(id, document.post);
  app.scene.edit({ post: isPostOn(app) ? [] : formerChains.get(id) ?? EFFECTS[0].post });
}

/** Whether the chain is this one, apart from defaults that the server has filled in. */
function isChain(chain, wanted) {
  return chain.length === wanted.length && wanted.every((effect, i) => same({ ...chain[i], ...effect }, chain[i]));
}

/** The effect that is on alone; `undefined` for none, or for a chain of the scene's own. */
const effectOf = ({ document }) => EFFECTS.find(({ post }) => isChain(document.post, post));

export function effectName(app) {
  return effectOf(app.scene)?.name ?? (isPostOn(app) ? "own" : "none");
}

export function nextEffect(app) {
  const { id, document } = app.scene;
  if (isPostOn(app) && !effectOf(app.scene)) ownChains.set(id, document.post);
  const own = ownChains.has(id) ? [ownChains.get(id)] : [];
  const cycle = [...own, ...EFFECTS.map(({ post }) => post), []];
  const place = cycle.findIndex((chain) => isChain(document.post, chain));
  app.scene.edit({ post: cycle[(place + 1) % cycle.length] });
}

const lightsOf = ({ scene }, type) => Object.entries(scene.document.lights ?? {}).filter(([, light]) => light.type === type);

export const areLightsOn = (app, type) => lightsOf(app, type).some(([, light]) => light.enabled);
export const hasLights = (app, type) => lightsOf(app, type).length > 0;

/** All lights of a type: off if one is on. */
export function toggleLights(app, type) {
  const enabled = !areLightsOn(app, type);
  const lights = Object.fromEntries(lightsOf(app, type).map(([name]) => [name, { enabled }]));
  app.scene.edit({ lights });
}

// ── Instances ──

/** Selects the instance with this place in the sorted names, counted from 1. */
export function selectNth(app, place) {
  const name = Object.keys(app.scene.document.instances ?? {}).sort()[place - 1];
  if (name !== undefined) app.selection.select(name);
}

export function toggleInstance(app, name) {
  app.scene.edit({ instances: { [name]: { visible: !app.scene.document.instances[name].visible } } });
}

/** A copy beside the instance, selected. */
export function duplicateInstance(app, name) {
  const { instances } = app.scene.document;
  const copy = freeName(name, instances);
  const width = widthOf(app, name);
  const [x, y, z] = translationOf(instances[name]);
  app.scene.edit({ instances: { [copy]: { ...instances[name], translation: [x + width, y, z] } } });
  app.selection.select(copy);
}

function widthOf({ instances, scene }, name) {
  const bounds = instances.named(name)?.bounds;
  return bounds ? Number(((bounds.max[0] - bounds.min[0]) / scene.document.render.model_scale).toPrecision(3)) : 1;
}

/** `name`, or `name 2`, `name 3`, … where that is taken. */
export function freeName(name, taken) {
  const stem = name.replace(/ \d+$/, "");
  let free = name;
  for (let count = 2; free in taken; count++) free = `${stem} ${count}`;
  return free;
}

/** Removes the selected instance; for a while it can be had back. */
export function deleteSelected({ scene, selection, notices }) {
  const { name, instance } = selection;
  if (name === null) return;
  scene.edit({ instances: { [name]: null } });
  notices.say(`“${name}” is deleted`, { "Bring it back": () => scene.edit({ instances: { [name]: instance } }) });
}
