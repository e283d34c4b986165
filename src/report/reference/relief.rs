//! Relief: what normal and bump maps make of a surface's normal.

use super::point::Point;
use super::texture;
use glam::DVec3;

/// The steepest slope that heights may have, rise over run.
const STEEPEST: f64 = 1e4;

/// Squared sine of the angle to the normal below which a direction says nothing about how the texture
/// lies in the surface.
const LEAST_SINE_SQUARED: f64 = 1e-4;

/// The unit normal of the front with the material's relief. The heights of a bump map lie on the surface
/// that a normal map describes.
pub fn tilted(point: &Point) -> DVec3 {
    let mut normal = point.normal;
    if let Some(map) = point.material.normals() {
        normal = mapped(point, normal, texture::direction(map, point.uv));
    }
    if let Some(map) = point.material.heights().filter(|_| point.has_uvs) {
        let rise = texture::slopes(map, point.uv) * point.uv_per_world * f64::from(point.material.bump_scale);
        normal = raised(point, normal, rise.to_array().map(|rise| rise.clamp(-STEEPEST, STEEPEST)));
    }
    normal
}

/// `along` in the plane of the normal, of unit length, if it is not along the normal.
fn in_plane(along: DVec3, normal: DVec3) -> Option<DVec3> {
    let in_plane = along - normal * normal.dot(along);
    (in_plane.length_squared() > LEAST_SINE_SQUARED).then(|| in_plane.normalize())
}

/// From tangent space: x along u, y along v on its side, z along the normal.
fn mapped(point: &Point, normal: DVec3, direction: DVec3) -> DVec3 {
    let [along_u, along_v] = point.along;
    let tangent = in_plane(along_u, normal).unwrap_or_else(|| any_tangent(normal));
    let is_mirrored = along_u.cross(along_v).dot(normal) < 0.0;
    let bitangent = normal.cross(tangent) * if is_mirrored { -1.0 } else { 1.0 };
    let tilted = tangent * direction.x + bitangent * direction.y + normal * direction.z;
    if tilted.length_squared() < 1e-12 { normal } else { tilted.normalize() }
}

/// A unit vector perpendicular to the unit vector `n`. Source: T. Duff et al., "Building an Orthonormal
/// Basis, Revisited", JCGT 6(1), 2017.
fn any_tangent(n: DVec3) -> DVec3 {
    let sign = 1.0_f64.copysign(n.z);
    let a = -1.0 / (sign + n.z);
    DVec3::new(1.0 + sign * n.x * n.x * a, sign * n.x * n.y * a, -sign * n.x)
}

/// The normal of the surface after it was raised by heights that gain `rise` a world unit along u and
/// along v: `n − ∇h`. Source: J. Blinn, "Simulation of Wrinkled Surfaces", SIGGRAPH 1978.
fn raised(point: &Point, normal: DVec3, rise: [f64; 2]) -> DVec3 {
    let [Some(u), Some(v)] = point.along.map(|along| in_plane(along, normal)) else { return normal };
    let sine = u.cross(v).dot(normal);
    if sine * sine <= LEAST_SINE_SQUARED {
        return normal;
    }
    // The vector in the plane whose products with u and v are the rises.
    let gradient = (v.cross(normal) * rise[0] + normal.cross(u) * rise[1]) / sine;
    (normal - gradient.clamp_length_max(STEEPEST)).normalize()
}
