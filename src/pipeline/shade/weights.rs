//! Perspective weights of a triangle's corners, and what interpolation needs of them.

use crate::pipeline::geometry::setup::Triangle;

/// The factors kᵢ of the edge functions: `lᵢ = kᵢ Eᵢ` is in 0–1 and proportional to the perspective
/// weight of corner i. `w` are the corners' homogeneous coordinates, all the same without perspective;
/// `area` is twice the triangle's.
pub fn perspective_scale(w: [f64; 3], area: f64) -> [f64; 3] {
    let nearest = w[0].min(w[1]).min(w[2]);
    w.map(|w| nearest / w / area)
}

/// What the screen derivatives of an interpolated value are made of, in units per pixel: numerators of
/// ∂/∂x and ∂/∂y at corner 0, and how they change.
///
/// With U = Σ lᵢuᵢ and D = Σ lᵢ linear over the screen, `∂(U/D)/∂x = (Uₓ D − U Dₓ) / D²`, whose
/// numerator is linear in y alone (and that of ∂/∂y in x alone).
pub fn derivative_numerators(t: &Triangle, scale: [f64; 3], value: [f64; 3]) -> [f64; 3] {
    let [e1, e2] = t.edges_from_corner_0();
    let edges = [[0.0 - e1[0] - e2[0], 0.0 - e1[1] - e2[1]], e1, e2];
    let slope =
        |value: [f64; 3], axis: usize| (0..3).map(|i| edges[i][axis] * scale[i] * value[i]).sum::<f64>();
    let at_0 = t.doubled_area() * scale[0];
    let d = [slope([1.0; 3], 0), slope([1.0; 3], 1)];
    let g = [slope(value, 0), slope(value, 1)];
    let along = |axis: usize| (g[axis] - value[0] * d[axis]) * at_0;
    [along(0), along(1), g[0] * d[1] - g[1] * d[0]].map(|n| n * 256.0)
}
