// The sky: what is drawn where nothing else is, and the light that comes from everywhere.

import { attempt, field } from "./field.js";
import { pointerOf } from "../merge.js";
import { Problem } from "../server.js";
import { button, element } from "../dom.js";
import { note, panel } from "./parts.js";
import { setAt } from "./edit.js";
import { rebuilt } from "./follow.js";
import { choiceControl } from "./fields/choice.js";
import { colorField } from "./fields/color.js";
import { directionField } from "./fields/direction.js";
import { IMAGE_TYPES, fileChooser, fileField, takesDrop, upload } from "./fields/file.js";
import { numberField } from "./fields/number.js";

const HERE = "/environment/background";

const TYPES = [
  ["color", "One colour"],
  ["gradient", "Gradient"],
  ["sky", "Sky with a sun"],
  ["cubemap", "Cube map: six images"],
  ["equirect", "Panorama: one image"],
  ["transparent", "Transparent"],
];

/** What a background of each type begins as. Those of images begin once the images are there. */
const BEGINNINGS = {
  color: { color: "#6ea8e8" },
  gradient: { top: "#6ea8e8", bottom: "#dfe9f5" },
  sky: { turbidity: 3 },
  transparent: {},
};

/** Faces of a cube map: seen looking along each axis. */
const FACES = [["px", "+x"], ["nx", "−x"], ["py", "+y (up)"], ["ny", "−y (down)"], ["pz", "+z"], ["nz", "−z"]];

/** Kind of background, its fields, and ambient light. */
export function skyPanel({ scene, camera }) {
  // The type that was chosen and still waits for its images.
  const wish = { type: null };
  const editor = rebuilt(scene, element("div", { className: "editor" }),
    (document) => [wish.type, placeOf(document), shapeOf(chosenBackground(document))],
    (document) => (wish.type ? imagesWanted(scene, wish) : fieldsOf(scene, camera, document)));
  scene.addEventListener("open", () => { wish.type = null; editor.refresh(); });
  return panel("sky", "Sky",
    kindField(scene, wish, editor.refresh),
    editor.element,
    colorField(scene, "/environment/ambient", {
      label: "Ambient light", hint: "Reaches every surface from everywhere",
    }));
}

/** What decides which fields a background has. */
const shapeOf = (background) => [background?.type, background?.sun_direction !== undefined];

/** The pointer of the background in use. */
function placeOf({ environment: { background } }) {
  return typeof background === "string" ? pointerOf("environment", "backgrounds", background) : HERE;
}

function chosenBackground({ environment: { background, backgrounds } }) {
  return typeof background === "string" ? backgrounds[background] : background;
}

function kindField(scene, wish, refresh) {
  const control = choiceControl(kinds, (kind) => {
    wish.type = null;
    if (kind.startsWith("name ")) setAt(scene, HERE, kind.slice(5));
    else if (kind in BEGINNINGS) setAt(scene, HERE, { type: kind, ...BEGINNINGS[kind] });
    else wish.type = kind;
    refresh();
  });
  const kindOf = (background) => wish.type ?? background.type ?? `name ${background}`;
  return field(scene, HERE, { label: "Background" }, {
    ...control,
    show: (background, document) => control.show(kindOf(background), document),
  });
}

function kinds({ environment }) {
  const named = Object.keys(environment.backgrounds).map((name) => [`name ${name}`, `“${name}” of the scene`]);
  return [...TYPES, ...named];
}

function fieldsOf(scene, camera, document) {
  const at = placeOf(document);
  const { type, sun_direction: sun } = chosenBackground(document) ?? {};
  const fields = {
    color: () => [colorField(scene, `${at}/color`, { label: "Colour" })],
    gradient: () => [
      colorField(scene, `${at}/top`, { label: "Straight up" }),
      colorField(scene, `${at}/bottom`, { label: "Straight down" }),
    ],
    sky: () => skyFields(scene, camera, at, sun),
    cubemap: () => FACES.map(([face, label]) => fileField(scene, `${at}/faces/${face}`, {
      label: `Looking along ${label}`, accept: IMAGE_TYPES,
    })),
    equirect: () => [fileField(scene, `${at}/file`, { label: "Panorama", accept: IMAGE_TYPES })],
    transparent: () => [note("Saved PNG and WebP pictures have alpha; here it shows as white.")],
  };
  return fields[type]?.() ?? [];
}

function skyFields(scene, camera, at, sun) {
  const haze = numberField(scene, `${at}/turbidity`, {
    label: "Haze", unit: "turbidity", step: 0.1, min: 1, max: 20, range: [1, 12], hint: "2 is clear, 10 is hazy",
  });
  if (sun === undefined) {
    return [
      haze,
      note("The sun stands where the first directional light comes from."),
      button("Give the sky's sun a place of its own", () => setAt(scene, `${at}/sun_direction`, [-0.5, -0.6, -0.3]),
        { className: "link", "data-action": "own-sun" }),
    ];
  }
  return [
    haze,
    directionField(scene, `${at}/sun_direction`, {
      label: "Sun of the sky", hint: "The way its light travels",
    }, camera),
    button("Let the sun follow the light", () => setAt(scene, `${at}/sun_direction`, null),
      { className: "link", "data-action": "own-sun" }),
  ];
}

function imagesWanted(scene, wish) {
  const done = (background) => {
    wish.type = null;
    setAt(scene, HERE, background);
  };
  if (wish.type === "cubemap") return facesFields(scene, done);
  return [fileField(scene, `${HERE}/file`, {
    label: "Panorama", accept: IMAGE_TYPES, hint: "Twice as wide as high; .hdr as well",
  },
    (file) => done({ type: "equirect", file }))];
}

/** Six images at once. */
function facesFields(scene, done) {
  const take = (files) => attempt(made, async () => {
    const byFace = {};
    for (const [face, file] of facesOf(files)) byFace[face] = await upload(scene, file);
    done({ type: "cubemap", faces: byFace });
  });
  const chooser = fileChooser("Choose six images…", IMAGE_TYPES, take, { multiple: true });
  const control = { element: chooser, inputs: [chooser], show: () => {} };
  const made = field(scene, `${HERE}/faces`, { label: "Faces" }, control);
  takesDrop(made, take);
  return [made, note("Named by their faces (px, nx, py, ny, pz, nz), or in that order by name.")];
}

/** Pairs of face and file: by the end of their names, else in order. */
function facesOf(files) {
  const ordered = [...files].sort((a, b) => a.name.localeCompare(b.name));
  const named = FACES.map(([face]) => ordered.find(({ name }) => stem(name).endsWith(face)));
  const chosen = named.every(Boolean) ? named : ordered;
  if (chosen.length < FACES.length) throw new Problem(`A cube map needs six images; these are ${chosen.length}.`);
  return FACES.map(([face], i) => [face, chosen[i]]);
}

const stem = (name) => name.replace(/\.[^.]*$/, "").toLowerCase();
