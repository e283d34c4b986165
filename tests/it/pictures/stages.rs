//! Pictures of what the pipeline does on its way: ids, tiles, shaded fragments, shadow maps.

use crate::draw::{Picture, frame, output, samples, scene, values};
use rasterd::plan::{FrameRequest, Output};
use serde_json::{Value, json};

const BLACK: [u8; 4] = [0, 0, 0, 255];

fn picture(document: &Value, what: Output) -> Picture {
    Picture::new(frame(&scene(document), &output(what)))
}

/// A wall that fills the left half of the picture, with as many panes of glass before it.
fn panes(count: usize) -> Value {
    let mut document = json!({
        "camera": { "position": [0, 0, 10], "target": [0, 0, 0], "orthographic": { "height": 2 } },
        "materials": { "glass": { "opacity": 0.5 } },
        "meshes": { "wall": { "type": "triangles", "positions": [[-2, -2, 0], [0, -2, 0], [0, 2, 0], [-2, 2, 0]],
                              "indices": [[0, 1, 2], [0, 2, 3]] } },
        "instances": { "wall": { "mesh": "wall" } },
        "render": { "width": 96, "height": 80, "samples": 1 },
    });
    for pane in 1..=count {
        document["instances"][format!("pane {pane:02}")] =
            json!({ "mesh": "wall", "material": "glass", "translation": [0, 0, pane as f64 * 0.1] });
    }
    document
}

#[test]
fn ids_are_the_colours_of_the_instances_values() {
    let document = panes(3);
    let ids = values(frame(&scene(&document), &output(Output::Instance)));
    let colours = picture(&document, Output::Ids);
    assert!(ids.contains(&0) && ids.iter().any(|id| *id > 0));
    for (id, colour) in ids.into_iter().zip(colours.pixels) {
        let [r, g, b, _] = u32::from(id).wrapping_mul(0x9E37_79B1).to_be_bytes();
        assert_eq!(colour, [r, g, b, 255]);
    }
}

/// The documented scale: its stops and what lies between.
fn heat(place: f64) -> [u8; 4] {
    let stops: [(f64, [f64; 3]); 7] = [
        (0.0, [0.0; 3]),
        (1.0, [0.0, 0.0, 140.0]),
        (2.0, [0.0, 110.0, 220.0]),
        (4.0, [0.0, 170.0, 80.0]),
        (8.0, [250.0, 210.0, 0.0]),
        (12.0, [220.0, 30.0, 0.0]),
        (16.0, [255.0; 3]),
    ];
    let place = place.min(16.0);
    let [low, high] = *stops.windows(2).find(|pair| place <= pair[1].0).expect("within") else {
        unreachable!()
    };
    let share = (place - low.0) / (high.0 - low.0);
    #[expect(clippy::cast_possible_truncation, reason = "between two bytes")]
    let code = |c: usize| (low.1[c] + (high.1[c] - low.1[c]) * share).round() as u8;
    [code(0), code(1), code(2), 255]
}

#[test]
fn a_pixel_counts_its_opaque_fragment_and_every_layer_before_it() {
    for panes_before in [0, 1, 3, 6, 14, 20] {
        let drawn = picture(&panes(panes_before), Output::Shaded);
        assert_eq!(drawn.at(10, 40), heat(1.0 + panes_before as f64), "{panes_before} panes");
        assert_eq!(drawn.at(90, 40), BLACK);
    }
}

/// The counts of all pixels are what the picture itself says that it has shaded.
#[test]
fn no_fragment_is_counted_twice_or_missed() {
    let mut document = panes(3);
    document["meshes"]["ball"] = json!({ "type": "sphere", "segments": 24, "rings": 12 });
    document["instances"]["ball"] =
        json!({ "mesh": "ball", "translation": [0.3, 0.2, 1], "material": "glass" });
    document["instances"]["solid"] = json!({ "mesh": "ball", "translation": [0.7, -0.4, 0] });
    let scene = scene(&document);
    for count in [1, 4, 8] {
        let shaded = FrameRequest { output: Output::Shaded, ..samples(count) };
        let counts = Picture::new(frame(&scene, &shaded));
        let number = |pixel: &[u8; 4]| (0u32..16).find(|n| heat(f64::from(*n)) == *pixel).expect("below 16");
        let sum: u64 = counts.pixels.iter().map(number).map(u64::from).sum();
        assert_eq!(sum, frame(&scene, &samples(count)).stats.shaded(), "{count} samples");
    }
}

#[test]
fn a_tile_shows_how_many_triangles_it_lists() {
    for (count, side) in [(1, 64), (8, 32)] {
        let mut document = panes(3);
        document["render"]["samples"] = json!(count);
        let drawn = picture(&document, Output::Tiles);
        // Lower right in the tile, away from the digits. The wall and its panes have two triangles each.
        assert_eq!(drawn.at(side - 2, side - 2), heat(1.0 + 1.5 * 8f64.log2()), "{count} samples");
        assert_eq!([drawn.at(side, 5), drawn.at(5, side)], [[90, 90, 90, 255]; 2]);
        let digits = (0..side).flat_map(|x| (0..side).map(move |y| (x, y)));
        let ink: u32 = digits.map(|(x, y)| u32::from(drawn.at(x, y) == BLACK)).sum();
        // An 8 has 13 dots of 15: all but the two holes in it.
        assert_eq!(ink, 13 * (side / 32) * (side / 32));
    }
}

/// A box over a floor, under a light.
fn under(light: Value) -> Value {
    json!({
        "camera": { "position": [0, 3, 6], "target": [0, 0, 0] },
        "lights": { "light": light },
        "meshes": { "box": { "type": "box" }, "floor": { "type": "plane", "size": [6, 6] } },
        "instances": { "box": { "mesh": "box", "translation": [0, 1, 0] }, "floor": { "mesh": "floor" } },
        "render": { "width": 96, "height": 64, "samples": 4 },
    })
}

#[test]
fn the_map_of_parallel_light_is_one_square_with_its_casters_in_it() {
    let drawn = picture(
        &under(json!({ "type": "directional", "direction": [0, -1, 0], "shadow": { "resolution": 256 } })),
        Output::ShadowMap,
    );
    // The box alone casts, and the map is fitted to it: all of it is equally near.
    assert_eq!(drawn.at(48, 32), [255; 4]);
    assert_eq!([drawn.at(16, 0), drawn.at(79, 63)], [[48, 48, 48, 255]; 2]);
    assert_eq!([drawn.at(15, 32), drawn.at(80, 32)], [BLACK; 2]);
}

#[test]
fn a_lamp_has_six_maps_of_which_only_those_with_a_shadow_hold_anything() {
    let drawn = picture(
        &under(json!({ "type": "point", "position": [0, 3, 0], "shadow": { "resolution": 256 } })),
        Output::ShadowMap,
    );
    // Three columns of 32 pixels: below the lamp is the fourth.
    assert_eq!(drawn.at(16, 48), [255; 4]);
    for centre in [[16, 16], [48, 16], [80, 16], [48, 48], [80, 48]] {
        assert_eq!(drawn.at(centre[0], centre[1]), BLACK, "{centre:?}");
    }
}

#[test]
fn nearer_to_the_light_is_brighter() {
    let mut document = under(json!({ "type": "directional", "direction": [0, -1, 0], "shadow": {} }));
    document["instances"]["high"] = json!({ "mesh": "box", "translation": [3, 2, 0] });
    document["instances"]["box"]["translation"] = json!([0, 1, 0]);
    let drawn = picture(&document, Output::ShadowMap);
    let mut greys: Vec<u8> = drawn.pixels.iter().map(|pixel| pixel[0]).collect();
    greys.sort_unstable();
    greys.dedup();
    assert!(greys.contains(&255) && greys.contains(&64) && greys.contains(&0), "{greys:?}");
}

#[test]
fn without_shadows_there_is_nothing_to_see() {
    let without = [
        under(json!({ "type": "directional", "direction": [0, -1, 0] })),
        under(json!({ "type": "directional", "direction": [0, -1, 0], "enabled": false, "shadow": {} })),
    ];
    for document in without {
        assert!(picture(&document, Output::ShadowMap).pixels.iter().all(|pixel| *pixel == BLACK));
    }
}
