//! Rays and triangles: a tree of boxes, so that a ray meets a few triangles and not all of them.

use crate::math::Bounds;
use glam::DVec3;

/// A part of a line: `origin + direction · t` for t from `nearest` to `farthest`.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Where t is 0.
    pub origin: DVec3,
    /// What t is counted in; not zero, of any length.
    pub direction: DVec3,
    /// The least t.
    pub nearest: f64,
    /// The greatest t; may be infinite.
    pub farthest: f64,
}

/// Where a ray meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Index of the triangle.
    pub triangle: u32,
    /// The ray's t.
    pub distance: f64,
    /// Barycentric weights of the triangle's corners.
    pub weights: [f64; 3],
}

/// Triangles, and a tree of boxes around them.
pub struct Bvh {
    triangles: Vec<[DVec3; 3]>,
    /// Indices of triangles; each leaf has a run of them.
    order: Vec<u32>,
    /// The root comes first. Empty without triangles.
    nodes: Vec<Node>,
}

struct Node {
    bounds: Bounds,
    content: Content,
}

enum Content {
    /// Where its run of `order` begins and ends.
    Leaf([usize; 2]),
    /// Two nodes.
    Split([usize; 2]),
}

/// Triangles that a leaf may hold.
const LEAF: usize = 4;

/// Memory of a triangle's place in the order, and of its share of the tree: leaves hold two triangles or more, and
/// there are fewer splits than leaves.
pub const TRIANGLE_BYTES: u64 = (size_of::<u32>() + 2 * size_of::<Node>()) as u64;

/// Levels of the tree, and more: each halves the triangles, which are counted in 32 bits.
const DEPTH: usize = 40;

/// How far roundings may take a ray past a box: three of each of its two distances, and of one more.
const SLACK: f64 = 1.0 + 8.0 * f64::EPSILON;

impl Bvh {
    /// Splits the triangles in two by the median of their middles along the longest side, and so on.
    pub fn new(triangles: Vec<[DVec3; 3]>) -> Self {
        let count = u32::try_from(triangles.len()).expect("invariant: a frame's memory holds fewer than 2³²");
        let mut bvh = Self { triangles, order: (0..count).collect(), nodes: Vec::new() };
        if count > 0 {
            bvh.split([0, count as usize]);
        }
        bvh
    }

    /// The corners of a triangle.
    pub fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.triangles[triangle as usize]
    }

    /// Adds the node of a run of triangles, with all below it; gives back its index.
    fn split(&mut self, [first, end]: [usize; 2]) -> usize {
        let at = self.nodes.len();
        let bounds = self.bounds([first, end]);
        self.nodes.push(Node { bounds, content: Content::Leaf([first, end]) });
        if end - first > LEAF {
            let middle = first.midpoint(end);
            let axis = longest_side(bounds);
            let Self { triangles, order, .. } = self;
            let place = |&i: &u32| triangles[i as usize].iter().map(|corner| corner[axis]).sum::<f64>();
            order[first..end]
                .select_nth_unstable_by(middle - first, |a, b| place(a).total_cmp(&place(b)).then(a.cmp(b)));
            let halves = [self.split([first, middle]), self.split([middle, end])];
            self.nodes[at].content = Content::Split(halves);
        }
        at
    }

    fn bounds(&self, [first, end]: [usize; 2]) -> Bounds {
        let corners = self.order[first..end].iter().flat_map(|&i| self.triangles[i as usize]);
        Bounds::around(corners).expect("a run has a triangle")
    }

    /// Calls `visit` for what the ray meets, in no order. It says how far the ray goes on: `ray.farthest`
    /// to see all, less once something hides the rest, and less than `ray.nearest` to stop.
    pub fn walk(&self, ray: &Ray, mut visit: impl FnMut(Hit) -> f64) {
        let (sheared, mut farthest) = (Sheared::new(ray), ray.farthest);
        let mut waiting = [0; DEPTH];
        let mut count = usize::from(!self.nodes.is_empty());
        while count > 0 {
            count -= 1;
            let node = &self.nodes[waiting[count]];
            if ray.enters(node.bounds, farthest).is_none() {
                continue;
            }
            match node.content {
                Content::Leaf([first, end]) => {
                    for &triangle in &self.order[first..end] {
                        let hit = sheared.hit(triangle, self.corners(triangle));
                        if let Some(hit) = hit.filter(|h| h.distance >= ray.nearest && h.distance <= farthest)
                        {
                            farthest = visit(hit);
                        }
                    }
                }
                Content::Split(halves) => {
                    let enters = halves.map(|half| ray.enters(self.nodes[half].bounds, farthest));
                    // The nearer one is looked at first: what it holds may hide the other.
                    let [near, far] = if enters[0] <= enters[1] { [1, 0] } else { [0, 1] };
                    for half in [near, far].into_iter().filter(|&half| enters[half].is_some()) {
                        waiting[count] = halves[half];
                        count += 1;
                    }
                }
            }
        }
    }
}

fn longest_side(bounds: Bounds) -> usize {
    let size = bounds.max - bounds.min;
    (0..3).fold(0, |longest, axis| if size[axis] > size[longest] { axis } else { longest })
}

impl Ray {
    /// Where the ray enters a box, if it does before `farthest`.
    fn enters(&self, bounds: Bounds, farthest: f64) -> Option<f64> {
        let (mut enter, mut leave) = (self.nearest, farthest);
        for axis in 0..3 {
            let (origin, direction) = (self.origin[axis], self.direction[axis]);
            let [low, high] = [bounds.min[axis] - origin, bounds.max[axis] - origin];
            if direction == 0.0 {
                if low > 0.0 || high < 0.0 {
                    return None;
                }
                continue;
            }
            let [a, b] = [low / direction, high / direction];
            enter = enter.max(a.min(b));
            leave = leave.min(a.max(b));
        }
        (enter <= leave * SLACK).then_some(enter)
    }
}

/// A ray that has been sheared to run along one axis from zero.
///
/// Neighbours compute the sign on a shared edge from the same numbers, so no ray falls between them.
/// Source: S. Woop, C. Benthin, I. Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013.
struct Sheared {
    origin: DVec3,
    /// The axis along which the ray runs most comes last.
    axes: [usize; 3],
    shear: DVec3,
}

impl Sheared {
    fn new(ray: &Ray) -> Self {
        let size = ray.direction.abs();
        let z = (0..3).fold(0, |z, axis| if size[axis] > size[z] { axis } else { z });
        let (x, y) = ((z + 1) % 3, (z + 2) % 3);
        let d = ray.direction;
        Self { origin: ray.origin, axes: [x, y, z], shear: DVec3::new(d[x], d[y], 1.0) / d[z] }
    }

    fn hit(&self, triangle: u32, corners: [DVec3; 3]) -> Option<Hit> {
        let [a, b, c] = corners.map(|corner| self.shear(corner));
        let edges = [c.x * b.y - c.y * b.x, a.x * c.y - a.y * c.x, b.x * a.y - b.y * a.x];
        let inside = edges.iter().all(|&e| e >= 0.0) || edges.iter().all(|&e| e <= 0.0);
        let area = edges[0] + edges[1] + edges[2];
        if !inside || area == 0.0 {
            return None;
        }
        let weights = edges.map(|edge| edge / area);
        let distance = weights[0] * a.z + weights[1] * b.z + weights[2] * c.z;
        Some(Hit { triangle, distance, weights })
    }

    fn shear(&self, corner: DVec3) -> DVec3 {
        let from = corner - self.origin;
        let [x, y, z] = self.axes.map(|axis| from[axis]);
        DVec3::new(x - self.shear.x * z, y - self.shear.y * z, self.shear.z * z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// SplitMix64, as a number from −1 to 1.
    struct Random(u64);

    impl Random {
        fn number(&mut self) -> f64 {
            self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        }

        fn point(&mut self) -> DVec3 {
            DVec3::new(self.number(), self.number(), self.number())
        }
    }

    fn nearest(bvh: &Bvh, ray: &Ray) -> Option<Hit> {
        let mut found: Option<Hit> = None;
        bvh.walk(ray, |hit| {
            found = Some(hit);
            hit.distance
        });
        found
    }

    #[test]
    fn it_finds_what_looking_at_every_triangle_finds() {
        let seed = 0x005e_ed0f_b0c5;
        println!("seed {seed:#x}");
        let mut random = Random(seed);
        let triangles: Vec<[DVec3; 3]> = (0..500)
            .map(|_| {
                let (at, size) = (random.point() * 4.0, 0.1 + random.number().abs());
                [(); 3].map(|()| at + random.point() * size)
            })
            .collect();
        let bvh = Bvh::new(triangles.clone());
        let mut hits = 0;
        for _ in 0..4000 {
            let (origin, direction) = (random.point() * 6.0, random.point());
            let ray = Ray { origin, direction, nearest: 0.0, farthest: f64::INFINITY };
            let sheared = Sheared::new(&ray);
            let each = (0..).zip(&triangles).filter_map(|(i, corners)| sheared.hit(i, *corners));
            let expected =
                each.filter(|hit| hit.distance >= 0.0).min_by(|a, b| a.distance.total_cmp(&b.distance));
            assert_eq!(nearest(&bvh, &ray), expected);
            hits += usize::from(expected.is_some());
        }
        assert!(hits > 500 && hits < 3900, "{hits}");
    }

    #[test]
    fn a_hit_is_where_its_weights_say() {
        let mut random = Random(7);
        let mut hits = 0;
        for _ in 0..2000 {
            let corners = [(); 3].map(|()| random.point());
            let ray = Ray { origin: random.point(), direction: random.point(), nearest: -1e9, farthest: 1e9 };
            if let Some(hit) = Sheared::new(&ray).hit(0, corners) {
                let along = ray.origin + ray.direction * hit.distance;
                let within = (0..3).map(|i| corners[i] * hit.weights[i]).sum::<DVec3>();
                assert!(along.distance(within) < 1e-11 * (1.0 + along.length()), "{along} {within}");
                hits += 1;
            }
        }
        assert!(hits > 100, "{hits}");
    }

    #[test]
    fn flat_boxes_along_the_axes_are_hit() {
        let quad = |z: f64| {
            let [a, b, c, d] =
                [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, y]| DVec3::new(x, y, z));
            [[a, b, c], [a, c, d]]
        };
        let bvh = Bvh::new([quad(0.0), quad(-1.0), quad(-2.0)].concat());
        for x in [-0.9, -0.3, 0.0, 0.5] {
            let origin = DVec3::new(x, 0.25, 3.0);
            let ray = Ray { origin, direction: DVec3::NEG_Z, nearest: 0.0, farthest: f64::INFINITY };
            assert_eq!(nearest(&bvh, &ray).map(|hit| hit.distance), Some(3.0));
            let beyond = Ray { nearest: 3.5, ..ray };
            assert_eq!(nearest(&bvh, &beyond).map(|hit| hit.distance), Some(4.0));
        }
    }
}
