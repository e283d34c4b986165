// How pictures are drawn: size, quality, and the camera's lens.

import { distanceOf } from "../camera.js";
import { element } from "../dom.js";
import { field } from "./field.js";
import { degrees, radians } from "../vec.js";
import { group, panel } from "./parts.js";
import { choiceControl, choiceField } from "./fields/choice.js";
import { numberField } from "./fields/number.js";
import { rebuilt } from "./follow.js";
import { budgetGroup } from "./budget.js";
import { SHADINGS } from "./words.js";

const SAMPLES = [1, 2, 4, 8, 16].map((samples) => [samples, String(samples)]);
const CULLS = [["back", "Back faces"], ["front", "Front faces"], ["none", "None"]];
const LENSES = [["perspective", "Perspective"], ["orthographic", "Orthographic"]];
/** Until the server has told where its automatic framing puts the camera. */
const UNKNOWN_DISTANCE = 5;

/** What the view may cost, `render`, and the camera's lens. */
export function renderPanel(app) {
  const { scene, camera } = app;
  return panel("render", "Render", budgetGroup(app), group("Picture", ...pictureFields(scene)),
    group("Camera", ...cameraFields(scene, camera)));
}

function pictureFields(scene) {
  const side = {
    unit: "px", step: 16, min: 1, max: 16384,
    hint: "Of pictures that are saved where nobody says otherwise; the view here has its own size",
  };
  return [
    numberField(scene, "/render/width", { label: "Width", ...side }),
    numberField(scene, "/render/height", { label: "Height", ...side }),
    choiceField(scene, "/render/samples", { label: "Samples a pixel", hint: "More make smoother edges" }, SAMPLES),
    choiceField(scene, "/render/cull", {
      label: "Faces left out", hint: "Closed bodies look the same without their back faces, and draw faster",
    }, CULLS),
    choiceField(scene, "/render/shading", { label: "Shading" }, [[null, "As the materials have it"], ...SHADINGS]),
    numberField(scene, "/render/model_scale", {
      label: "Scale of all", step: 0.05, range: [0.1, 4], hint: "Scales all instances about the world's origin",
    }),
  ];
}

function cameraFields(scene, camera) {
  const lens = rebuilt(scene, element("div", { className: "editor" }), ({ camera }) => lensOf(camera), ({ camera }) => [
    lensOf(camera) === "perspective"
      ? numberField(scene, "/camera/fov_y_deg", {
        label: "Field of view", unit: "°", step: 1, min: 0.001, max: 179.9, range: [5, 120],
        hint: "From the lower to the upper edge",
      })
      : numberField(scene, "/camera/orthographic/height", {
        label: "Height of the view", unit: "world units", step: 0.1, min: 0.001, range: [0.1, 20],
      }),
  ]);
  return [
    lensField(scene, camera),
    lens.element,
    numberField(scene, "/camera/near", {
      label: "Near", unit: "world units", absent: "automatic", step: 0.05, min: 0.000001,
      hint: "Nothing nearer is drawn",
    }),
    numberField(scene, "/camera/far", {
      label: "Far", unit: "world units", absent: "infinite", step: 1, min: 0.000001,
      hint: "Nothing farther is drawn",
    }),
    numberField(scene, "/camera/orbit_deg_per_s", {
      label: "Turns by itself", unit: "°/s", step: 1, range: [-90, 90], hint: "About what it looks at",
    }),
  ];
}

const lensOf = (camera) => (camera.orthographic ? "orthographic" : "perspective");

function lensField(scene, camera) {
  const change = (lens) => scene.edit({ camera: lensPatch(scene.document.camera, camera.current, lens) });
  const control = choiceControl(() => LENSES, change);
  return field(scene, "/camera/orthographic", { label: "Lens" }, {
    ...control,
    show: (_, { camera }) => control.show(lensOf(camera)),
  });
}

/** What the camera looks at keeps its size in the picture. */
function lensPatch({ fov_y_deg: fov, orthographic }, current, lens) {
  const distance = current ? distanceOf(current) : UNKNOWN_DISTANCE;
  if (lens === "orthographic") {
    const height = 2 * distance * Math.tan(radians(fov / 2));
    return { fov_y_deg: null, orthographic: { height: rounded(height) } };
  }
  const angle = degrees(2 * Math.atan(orthographic.height / 2 / distance));
  return { orthographic: null, fov_y_deg: rounded(angle) };
}

const rounded = (number) => Number(number.toPrecision(5));
