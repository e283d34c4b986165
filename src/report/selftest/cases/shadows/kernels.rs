//! Filters with a kernel: PCF and PCSS.

use super::{SLOPES, lit_plane, setting, visible};
use crate::pipeline::shadow::render_maps;
use crate::plan::{Elisions, FrameRequest};
use crate::report::selftest::Ledger;
use crate::report::selftest::instruments::box_on_floor::BoxOnFloor;
use crate::report::selftest::instruments::draw::{Picture, plan, scene, work};
use glam::DVec3;
use serde_json::{Value, json};

/// Pixels of a document that its shadows change.
fn changed_by_shadows(document: &Value) -> (usize, usize) {
    let mut without = document.clone();
    without["render"]["shadows"] = json!(false);
    let (with, without) = (Picture::of(document), Picture::of(&without));
    let changed = with.pixels.iter().zip(&without.pixels).filter(|(a, b)| a != b).count();
    (changed, with.pixels.len())
}

/// B33, k = 1, 2, 4, and the kernels of soft shadows.
pub fn a_lit_plane_does_not_shadow_itself_under_any_kernel(ledger: &mut Ledger) {
    let filters = [
        ("PCF k = 1", json!({ "filter": "pcf", "radius": 1 })),
        ("PCF k = 2", json!({ "filter": "pcf", "radius": 2 })),
        ("PCF k = 4", json!({ "filter": "pcf", "radius": 4 })),
        ("PCF k = 40", json!({ "filter": "pcf", "radius": 40 })),
        ("PCSS 0.01", json!({ "filter": "pcss" })),
        ("PCSS 0.3", json!({ "filter": "pcss", "light_radius": 0.3 })),
        ("PCSS 0.01, search 9", json!({ "filter": "pcss", "search_radius": 9 })),
    ];
    for (name, filter) in filters {
        for resolution in [64, 257, 1024] {
            let (mut shadowed, mut pixels) = (0, 0);
            for slope in SLOPES {
                for azimuth in [0.0, 0.7, 4.0] {
                    let mut document = lit_plane(slope, azimuth, resolution, &[]);
                    let mut shadow = filter.clone();
                    shadow["resolution"] = json!(resolution);
                    document["lights"]["sun"]["shadow"] = shadow;
                    let (changed, of) = changed_by_shadows(&document);
                    (shadowed, pixels) = (shadowed + changed, pixels + of);
                }
            }
            ledger.none_of(
                &format!("{name}, slopes 0–89.9°, map {resolution}"),
                "shadowed pixels",
                shadowed,
                pixels,
            );
        }
    }
}

/// The control of B33.
pub fn without_an_offset_a_plane_shadows_itself_under_a_kernel(ledger: &mut Ledger) {
    for (bias, expected) in [(0.0, true), (0.5, true), (1.0, false)] {
        let mut document = lit_plane(60.0, 0.7, 64, &[]);
        document["lights"]["sun"]["shadow"] = json!({ "filter": "pcf", "resolution": 64, "bias": bias });
        let acne = changed_by_shadows(&document).0 > 0;
        ledger.holds(&format!("bias {bias}"), "control: acne other than expected", acne == expected);
    }
}

/// B39: a light without size throws a hard shadow, to the byte.
pub fn a_kernel_without_size_is_the_hard_shadow(ledger: &mut Ledger) {
    let of = |shadow: Value| {
        let mut document = setting().document();
        document["lights"]["sun"]["shadow"] = shadow;
        document["lights"]["lamp"] = json!({ "type": "point", "position": [-1, 2, 1], "intensity": 3,
            "shadow": document["lights"]["sun"]["shadow"] });
        Picture::of(&document)
    };
    let hard = of(json!({ "filter": "hard", "resolution": 200 }));
    for (shadow, is_hard) in [
        (json!({ "filter": "pcf", "resolution": 200 }), false),
        (json!({ "filter": "pcf", "resolution": 200, "radius": 0 }), true),
        (json!({ "filter": "pcss", "resolution": 200, "light_radius": 0.1 }), false),
        (json!({ "filter": "pcss", "resolution": 200, "light_radius": 0 }), true),
        // One next to nothing is no different.
        (json!({ "filter": "pcss", "resolution": 200, "light_radius": 1e-9 }), true),
    ] {
        let setting = shadow.to_string();
        ledger.holds(&setting, "hard or soft against what is asked", (of(shadow) == hard) == is_hard);
    }
}

/// Kernels: of a radius in texels, or as wide as a light makes them, given by the tangent of its half-angle.
#[derive(Clone, Copy, Debug)]
enum Kernel {
    Pcf(f64),
    Pcss(f64),
}

impl Kernel {
    const ALL: [Self; 5] =
        [Self::Pcf(1.0), Self::Pcf(2.0), Self::Pcf(4.0), Self::Pcss(0.02), Self::Pcss(0.08)];

    fn shadow(self, resolution: u32) -> Value {
        match self {
            Self::Pcf(radius) => json!({ "filter": "pcf", "resolution": resolution, "radius": radius }),
            Self::Pcss(light) => json!({ "filter": "pcss", "resolution": resolution, "light_radius": light }),
        }
    }

    /// Across the light, how far from its border a shadow may be anything between light and dark: the
    /// bound on a displacement, 2√2 (k + ½) texels; and the penumbra of what is `highest` above a floor.
    ///
    /// A point that lies `r` beyond the border lies `r tan θ` farther down the slanted floor, and the
    /// penumbra there is as much wider: `r = tangent (d + r tan θ)`.
    fn reach(self, texel: f64, highest: f64, light: DVec3) -> f64 {
        let displaced = |k: f64| 2.0 * std::f64::consts::SQRT_2 * (k + 0.5) * texel;
        match self {
            Self::Pcf(radius) => displaced(radius),
            Self::Pcss(tangent) => {
                let cosine = light.normalize().y.abs();
                let slope = (1.0 - cosine * cosine).sqrt() / cosine;
                displaced(0.0) + tangent * highest / cosine / (1.0 - tangent * slope)
            }
        }
    }
}

/// Beyond the border of any shadow, what is lit is wholly lit and what is dark wholly dark.
fn compare_as_cast(ledger: &mut Ledger, case: &str, setting: &BoxOnFloor, kernel: Kernel) {
    let mut document = setting.document();
    let sun = &mut document["lights"]["sun"];
    sun["intensity"] = json!(0.9);
    sun["shadow"] = kernel.shadow(setting.resolution);
    let mut without = document.clone();
    without["render"]["shadows"] = json!(false);
    let apart = kernel.reach(BoxOnFloor::texel(&document), setting.max.y, setting.light);
    let (with, without) = (Picture::of(&document), Picture::of(&without));
    let (mut acne, mut leaks, mut lit, mut dark) = (0, 0, 0, 0);
    for (x, y, reached) in setting.beyond_doubt(apart) {
        if reached {
            lit += 1;
            acne += usize::from(with.at(x, y) != without.at(x, y));
        } else {
            dark += 1;
            leaks += usize::from(with.at(x, y)[0] != 0);
        }
    }
    let case = format!("{case}, {kernel:?}");
    ledger.none_of(&case, "pixels in the light that are not wholly lit", acne, lit);
    ledger.none_of(&case, "pixels in the shadow that are not wholly dark", leaks, dark);
}

/// B34.
pub fn filtered_shadows_begin_where_a_box_stands_and_walls_do_not_leak(ledger: &mut Ledger) {
    for (name, min, max) in [
        ("box", [-0.5, 0.0, -0.4], [0.4, 1.0, 0.5]),
        ("thin wall", [-1.5, 0.0, -0.03], [1.0, 0.8, 0.03]),
        ("slab that floats", [-0.6, 0.3, -0.5], [0.5, 0.34, 0.6]),
    ] {
        for (i, light) in [[-0.5, -1.0, -0.3], [0.7, -0.5, -0.6], [0.3, -1.0, 0.4]].into_iter().enumerate() {
            for kernel in Kernel::ALL {
                let setting = BoxOnFloor {
                    min: min.into(),
                    max: max.into(),
                    light: DVec3::from(light),
                    resolution: 1024,
                    ..setting()
                };
                compare_as_cast(ledger, &format!("{name}, light {i}"), &setting, kernel);
            }
        }
    }
}

/// B35: the axes of a kernel come from the same basis as those of its map.
pub fn light_along_every_axis_gives_the_same_filtered_shadow(ledger: &mut Ledger) {
    for turn in super::TURNS {
        for light in [[0.0, -1.0, 0.0], [-1e-9, -1.0, 1e-9]] {
            for kernel in [Kernel::Pcf(3.0), Kernel::Pcss(0.1)] {
                let min = DVec3::new(-0.5, 0.4, -0.4);
                let turn = DVec3::from_array(turn.map(f64::from));
                let setting = BoxOnFloor { turn, light: light.into(), min, ..setting() };
                compare_as_cast(ledger, &format!("turned by {turn}, light {light:?}"), &setting, kernel);
            }
        }
    }
}

/// B36.
pub fn casters_far_before_the_receivers_throw_filtered_shadows(ledger: &mut Ledger) {
    for height in [10.0, 1e3, 1e5] {
        let light = DVec3::new(-0.3 / height, -1.0, 0.2 / height);
        let (min, max) = (DVec3::new(-0.5, height, -0.4), DVec3::new(0.4, height + 1.0, 0.5));
        let setting = BoxOnFloor { min, max, light, ..setting() };
        // The penumbra is a tenth of a unit wide.
        for kernel in [Kernel::Pcf(3.0), Kernel::Pcss(0.1 / height)] {
            compare_as_cast(ledger, &format!("caster {height:e} above"), &setting, kernel);
        }
    }
}

/// B39: lights of every size, and blockers from next to the light to the receiver itself.
pub fn soft_shadows_lie_between_light_and_dark_whatever_blocks(ledger: &mut Ledger) {
    let depths = [-1e30, -1.0, 0.0, 0.1, 0.5, 0.9, 1.0, 1.0 + f32::EPSILON, 5.0, 1e30, f32::NAN];
    let across = [-1e30, -90.0, -50.0, -20.0, -0.5, 0.0, 0.5, 20.0, 49.999, 1e30, f32::INFINITY];
    for light in [0.0, 1e-30, 0.05, 1.0, 1e3, 1e30] {
        for search in [Value::Null, json!(0), json!(9), json!(1000)] {
            let mut document = BoxOnFloor { resolution: 100, ..setting() }.document();
            let mut shadow = json!({ "filter": "pcss", "resolution": 100, "light_radius": light });
            if !search.is_null() {
                shadow["search_radius"] = search.clone();
            }
            document["lights"]["sun"]["shadow"] = shadow;
            let plan = plan(&scene(&document), &FrameRequest::default());
            let maps = render_maps(&plan.shadows, Elisions::ALL, &work()).expect("nobody cancels");
            let (mut beyond, mut looked) = (0, 0);
            for place in across.iter().flat_map(|&x| across.iter().map(move |&y| [x, y])) {
                for depth in depths {
                    let seen = visible(&maps[0], [place[0], place[1], depth]);
                    looked += 1;
                    beyond += usize::from(!(0.0..=1.0).contains(&seen));
                }
            }
            let setting = format!("light {light:e}, search {search}");
            ledger.none_of(&setting, "visibilities that are not in 0 to 1", beyond, looked);
            // Before all casters nothing blocks.
            let is_lit = across.iter().all(|&x| visible(&maps[0], [x, 0.0, 1.0]) == 1.0);
            ledger.holds(&setting, "less than wholly lit without a blocker", is_lit);
        }
    }
}
