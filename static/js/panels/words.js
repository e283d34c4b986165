// Words of the document that several panels offer, with what people call them.

/** `materials.*.shading` and `render.shading`. */
export const SHADINGS = [
  ["blinn_phong", "Blinn-Phong"],
  ["lambert", "Lambert (matt)"],
  ["unlit", "Unlit"],
  ["vertex_color", "Vertex colours"],
  ["normal", "Normals as colours"],
];

/** Built-in shapes, `meshes.*.type`. */
export const SHAPES = [
  ["box", "Box"],
  ["sphere", "Sphere"],
  ["plane", "Plane"],
  ["cylinder", "Cylinder"],
  ["cone", "Cone"],
  ["torus", "Torus"],
  ["teapot", "Teapot"],
];
