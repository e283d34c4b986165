// Every field of every panel: what it does to the scene, and that it shows.

import { until } from "./harness.mjs";
import { merged, valueAt } from "../../static/js/merge.js";
import { ball, choice, click, color, number, scrub, slide, turn } from "./fields.mjs";
import { ROOM } from "./page.mjs";
import { changed, server, visiting } from "./visiting.mjs";

/** What a row needs to show what its field does, as a patch of the room. */
const red = (members) => ({ materials: { red: members } });
const sunShadow = (shadow) => ({ lights: { sun: { shadow } } });
const SOFT = sunShadow({ filter: "pcss", light_radius: 0.15 });
const background = (value) => ({ environment: { background: value } });
const post = (...effects) => ({ post: effects });
const UPSIDE_DOWN = { instances: { floor: { rotation_deg: [180, 0, 0] } } };
/** Something that casts with its front faces alone. */
const LID = { meshes: { lid: { type: "plane", size: [1, 1] } }, instances: { box: { mesh: "lid" } } };
const STANDING_SPIN = { instances: { box: { spin: { axis: [0, 1, 0], deg_per_s: 0 } } } };
const REPEATED = { meshes: { floor: { uv_repeat: [3, 3] } } };
const ORTHOGRAPHIC = { camera: { fov_y_deg: null, orthographic: { height: 4 } } };
const SKY = background({ type: "sky", turbidity: 3 });
const OWN_SUN = background({ type: "sky", turbidity: 3, sun_direction: [-0.5, -0.6, -0.3] });
/** Of fields that no picture of the view shows. */
const UNSEEN = { isSeen: false };

/** Panel, what to choose in it, pointer, what to do with its field, what the room needs for it, whether it shows. */
const CONTROLS = [
  ["instances", "box", "/instances/box/translation", number(1, 1.1)],
  ["instances", "box", "/instances/box/rotation_deg", number(0, 40)],
  ["instances", "box", "/instances/box/scale", number(0, 0.5)],
  ["instances", "box", "/instances/box/scale", scrub(-10)],
  ["instances", "box", "/instances/box/mesh", choice("ball")],
  ["instances", "box", "/instances/box/material", choice("red")],
  ["instances", "box", "/instances/box/casts_shadow", click()],
  ["instances", "floor", "/instances/floor/receives_shadow", click()],
  ["instances", "box", "/instances/box/visible", click()],
  ["instances", "box", "/instances/box/framed", click(), {}, UNSEEN],
  ["instances", "box", "/instances/box/spin/axis", number(0, 1), STANDING_SPIN, UNSEEN],
  ["instances", "box", "/instances/box/spin/deg_per_s", number(0, 90), STANDING_SPIN],
  ["materials", "red", "/materials/red/diffuse", color("#20a040")],
  ["materials", "red", "/materials/red/specular", color("#ffffff")],
  ["materials", "red", "/materials/red/shininess", number(0, 4)],
  ["materials", "red", "/materials/red/ambient", color("#4040ff")],
  ["materials", "red", "/materials/red/emissive", color("#301000")],
  ["materials", "red", "/materials/red/opacity", number(0, 0.5)],
  ["materials", "red", "/materials/red/diffuse_map", choice("tiles")],
  ["materials", "red", "/materials/red/specular_map", choice("tiles")],
  ["materials", "red", "/materials/red/emissive_map", choice("tiles"), red({ emissive: "#804000" })],
  ["materials", "red", "/materials/red/normal_map", choice("tiles")],
  ["materials", "red", "/materials/red/bump_map", choice("tiles")],
  ["materials", "red", "/materials/red/bump_scale", number(0, 0.2), red({ bump_map: "tiles" })],
  ["materials", "red", "/materials/red/opacity_map", choice("tiles")],
  ["materials", "red", "/materials/red/alpha_cutoff", number(0, 0.6), red({ opacity: 0.5 })],
  ["materials", "floor", "/materials/floor/double_sided", click(), UPSIDE_DOWN],
  ["materials", "red", "/materials/red/shading", choice("Unlit")],
  ["textures", "tiles", "/textures/tiles/checker/cells", number(0, 3)],
  ["textures", "tiles", "/textures/tiles/checker/colors/0", color("#204080")],
  ["textures", "tiles", "/textures/tiles/checker/colors/1", color("#c0ffc0")],
  ["textures", "tiles", "/textures/tiles/filter", choice("Nearest texel")],
  ["textures", "tiles", "/textures/tiles/wrap", choice("Its border goes on"), REPEATED],
  ["textures", "tiles", "/textures/tiles/color_space", choice("Linear (data)")],
  ["meshes", "box", "/meshes/box/size", number(1, 0.4)],
  ["meshes", "floor", "/meshes/floor/size", number(0, 3)],
  ["meshes", "floor", "/meshes/floor/uv_repeat", number(1, 3)],
  ["meshes", "ball", "/meshes/ball/radius", number(0, 0.3)],
  ["meshes", "ball", "/meshes/ball/segments", number(0, 5)],
  ["meshes", "ball", "/meshes/ball/rings", number(0, 3)],
  ...shape("torus", { radius: 0.2, tube: 0.05, segments: 5, sides: 3 }),
  ...shape("cylinder", { radius: 0.2, height: 0.3, segments: 5 }),
  ...shape("cone", { radius: 0.2, height: 0.3, segments: 5 }),
  ...shape("teapot", { height: 0.3, segments: 1 }),
  ["lights", "sun", "/lights/sun/color", color("#ff8080")],
  ["lights", "sun", "/lights/sun/intensity", number(0, 0.6)],
  ["lights", "sun", "/lights/sun/intensity", slide()],
  ["lights", "sun", "/lights/sun/enabled", click()],
  ["lights", "sun", "/lights/sun/direction", ball(20, -5)],
  ["lights", "sun", "/lights/sun/direction", turn("ArrowRight")],
  ["lights", "sun", "/lights/sun/direction", turn("ArrowDown")],
  ["lights", "sun", "/lights/sun/direction", number(0, 0.7)],
  ["lights", "lamp", "/lights/lamp/color", color("#ff80ff")],
  ["lights", "lamp", "/lights/lamp/intensity", number(0, 8)],
  ["lights", "lamp", "/lights/lamp/enabled", click()],
  ["lights", "lamp", "/lights/lamp/position", number(0, -1)],
  ["lights", "lamp", "/lights/lamp/attenuation/constant", number(0, 3)],
  ["lights", "lamp", "/lights/lamp/attenuation/linear", number(0, 2)],
  ["lights", "lamp", "/lights/lamp/attenuation/quadratic", number(0, 0.2)],
  ["sky", null, "/environment/background", choice("One colour")],
  ["sky", null, "/environment/background", choice("Gradient"), SKY],
  ["sky", null, "/environment/background", choice("Sky with a sun")],
  ["sky", null, "/environment/background", choice("Transparent")],
  ["sky", null, "/environment/background/color", color("#804080"), background({ type: "color", color: "#6ea8e8" })],
  ["sky", null, "/environment/background/top", color("#804080"), background({ type: "gradient", top: "#6ea8e8", bottom: "#dfe9f5" })],
  ["sky", null, "/environment/background/bottom", color("#804080"), background({ type: "gradient", top: "#6ea8e8", bottom: "#dfe9f5" })],
  ["sky", null, "/environment/background/turbidity", number(0, 10), SKY],
  ["sky", null, "/environment/background/sun_direction", ball(25, 0), OWN_SUN],
  ["sky", null, "/environment/background/sun_direction", turn("ArrowLeft"), OWN_SUN],
  ["sky", null, "/environment/background/sun_direction", number(0, 0.9), OWN_SUN],
  ["sky", null, "/environment/ambient", color("#808080")],
  ["shadow", "sun", "/lights/sun/shadow/resolution", number(0, 48)],
  ["shadow", "sun", "/lights/sun/shadow/radius", number(0, 6)],
  ["shadow", "sun", "/lights/sun/shadow/filter", choice("Soft (PCSS)")],
  ["shadow", "lamp", "/lights/lamp/shadow/filter", choice("Hard")],
  ["shadow", "sun", "/lights/sun/shadow/bias", number(0, 200)],
  ["shadow", "sun", "/lights/sun/shadow/cull", choice("All but front faces"), LID],
  ["shadow", "sun", "/lights/sun/shadow/light_radius", number(0, 0.01), SOFT],
  ["shadow", "sun", "/lights/sun/shadow/search_radius", number(0, 1), SOFT],
  ["shadow", "sun", "/lights/sun/shadow/search_taps", number(0, 1), SOFT],
  ["shadow", "sun", "/lights/sun/shadow/filter_taps", number(0, 1), SOFT],
  ["shadow", "sun", "/render/shadows", click()],
  ["post", null, "/post/0/operator", choice("Reinhard")],
  ["post", null, "/post/0/exposure", number(0, 2)],
  ["post", null, "/post/0/radius", number(0, 12), post({ type: "blur", radius: 2 })],
  ["post", null, "/post/0/threshold", number(0, 2), post({ type: "bloom", threshold: 0.2, intensity: 1 })],
  ["post", null, "/post/0/intensity", number(0, 2), post({ type: "bloom", threshold: 0.2, intensity: 0.5 })],
  ["post", null, "/post/0/radius", number(0, 20), post({ type: "bloom", threshold: 0.2, intensity: 0.5, radius: 3 })],
  ["post", null, "/post/0/amount", number(0, 2), post({ type: "sharpen", amount: 0.5 })],
  ["post", null, "/post/0/amount", number(0, 0.3), post({ type: "grayscale" })],
  ["post", null, "/post/0/amount", number(0, 0.9), post({ type: "vignette", amount: 0.4 })],
  ["post", null, "/post/0/matrix", number(1, 0.5), post({ type: "color_matrix", matrix: [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]] })],
  ["post", null, "/post/0/kernel", number(3, 0.5), post({ type: "kernel", kernel: [[0, 0, 0], [0, 0.5, 0], [0, 0, 0]] })],
  ["render", null, "/render/width", number(0, 320), {}, UNSEEN],
  ["render", null, "/render/height", number(0, 240), {}, UNSEEN],
  ["render", null, "/render/samples", choice("1")],
  ["render", null, "/render/cull", choice("Front faces")],
  ["render", null, "/render/shading", choice("Normals as colours")],
  ["render", null, "/render/model_scale", number(0, 0.7)],
  ["render", null, "/camera/fov_y_deg", number(0, 60)],
  ["render", null, "/camera/near", number(0, 4.8)],
  ["render", null, "/camera/far", number(0, 5)],
  ["render", null, "/camera/orbit_deg_per_s", number(0, 30)],
  ["render", null, "/camera/orthographic", choice("Orthographic")],
  ["render", null, "/camera/orthographic", choice("Perspective"), ORTHOGRAPHIC],
  ["render", null, "/camera/orthographic/height", number(0, 6), ORTHOGRAPHIC],
];

/** Rows for each measure of a built-in shape, in the place of the ball's. */
function shape(type, measures) {
  const given = { meshes: { ball: { type } } };
  return Object.entries(measures).map(([member, value]) => ["meshes", "ball", `/meshes/ball/${member}`, number(0, value), given]);
}

/** Puts the room as a row needs it, and waits until the page has it. */
async function furnish(visit, name, given) {
  await server.ask("PUT", visit.path, merged(merged(ROOM, given), { name }));
  await visit.page.waitForFunction((name) => document.querySelector("#scene-name").textContent === name, {}, name);
}

async function choose(page, panel, entry) {
  if (panel === "shadow") return page.select("#shadow-light", entry);
  if (entry) await page.click(`#panel-${panel} .entry[data-name="${entry}"]`);
}

for (const panel of new Set(CONTROLS.map(([panel]) => panel))) {
  visiting(`every field of the panel ${panel} changes scene and picture`, async (visit) => {
    const { page } = visit;
    await visit.openPanel(panel);
    const rows = CONTROLS.filter(([of]) => of === panel);
    for (const [i, [, entry, pointer, act, given = {}, { isSeen } = { isSeen: true }]] of rows.entries()) {
      await furnish(visit, `${panel} ${i}`, given);
      await choose(page, panel, entry);
      const field = `#panel-${panel} .field[data-pointer="${pointer}"]`;
      await page.waitForSelector(field);
      const before = valueAt(await visit.document(), pointer);
      const looked = await visit.stands();
      await act(page, field);
      await changed(visit, (document) => valueAt(document, pointer), before);
      if (isSeen) await until(`another picture after ${pointer}`, async () => (await visit.looks()) !== looked);
    }
  });
}
