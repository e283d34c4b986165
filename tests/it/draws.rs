//! Draw calls: programs, render targets and the state between them.

use crate::measure::{Worst, at_most};
use rasterd::math::round_to_f32;
use rasterd::math::simd::Level;
use rasterd::pipeline::draw::{DrawCall, Rect, State, Targets};
use rasterd::pipeline::program::{Block, Program};
use rasterd::pipeline::shade::BLOCK;
use rasterd::pipeline::shader::Outputs;
use rasterd::pipeline::{Order, Work};
use rasterd::scene::Cull;
use std::sync::atomic::AtomicBool;

/// Vertices as they are, each with one varying, which becomes red; the instance becomes green.
struct Plain {
    vertices: Vec<([f64; 4], f32)>,
    /// Fragments of less are discarded.
    cutoff: Option<f32>,
}

impl Program for Plain {
    fn varyings(&self) -> usize {
        1
    }

    fn differentiated(&self) -> usize {
        1
    }

    fn discards(&self) -> bool {
        self.cutoff.is_some()
    }

    fn vertex(&self, vertex: u32, instance: u32, varyings: &mut [f32]) -> [f64; 4] {
        let ([x, y, z, w], value) = self.vertices[vertex as usize];
        varyings[0] = value;
        [x + f64::from(instance) * w, y, z, w]
    }

    fn pixels(&self, _: Level, block: &Block, out: &mut Outputs) {
        for i in 0..block.len() {
            let value = block.varyings[0][i];
            if self.cutoff.is_some_and(|cutoff| value < cutoff) {
                out.discarded |= 1 << i;
            }
            out.colors[0][0][i] = value;
            out.colors[0][1][i] = block.instance as f32;
            out.colors[0][3][i] = 1.0;
            let [along_x, along_y] = block.derivatives[0];
            out.colors[1][0][i] = along_x[i];
            out.colors[1][1][i] = along_y[i];
            out.colors[1][2][i] = (block.back >> i & 1) as f32;
        }
    }
}

const SIDE: u32 = 80;

/// A rectangle that faces the viewer, at one depth, all of one value.
fn card([left, bottom, right, top]: [f64; 4], depth: f64, value: f32) -> Plain {
    let corners = [[left, bottom], [right, bottom], [right, top], [left, top]];
    Plain { vertices: corners.map(|[x, y]| ([x, y, depth, 1.0], value)).to_vec(), cutoff: None }
}

const QUAD: [[u32; 3]; 2] = [[0, 1, 2], [0, 2, 3]];
const WHOLE: Rect = Rect { x: 0, y: 0, width: SIDE, height: SIDE };

fn targets() -> Targets {
    Targets::new(SIDE, SIDE, 2)
}

fn draw(targets: &mut Targets, state: &State, program: &dyn Program, triangles: &[[u32; 3]], instances: u32) {
    for threads in [1, 3] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads start");
        let work =
            Work { pool: &pool, cancel: &AtomicBool::new(false), level: Level::new(), order: Order::Rows };
        let mut drawn = targets.clone();
        let call = DrawCall { program, vertices: 4, triangles, instances, first_id: 7 };
        call.draw(&mut drawn, state, &work).expect("nothing cancels");
        if threads == 3 {
            *targets = drawn;
        }
    }
}

fn draw_card(targets: &mut Targets, state: &State, card: &Plain) {
    draw(targets, state, card, &QUAD, 1);
}

fn red(targets: &Targets, x: u32, y: u32) -> f32 {
    targets.color(0)[(y * SIDE + x) as usize][0]
}

const EVERYWHERE: [f64; 4] = [-1.0, -1.0, 1.0, 1.0];

#[test]
fn the_nearer_card_is_seen_whatever_the_order_of_calls() {
    for order in [[0.25, 0.5], [0.5, 0.25]] {
        let mut targets = targets();
        for depth in order {
            draw_card(&mut targets, &State::new(WHOLE), &card(EVERYWHERE, depth, round_to_f32(depth)));
        }
        assert!(targets.color(0).iter().all(|color| (color[0] - 0.5).abs() < 1e-6));
        assert!(targets.depth().iter().all(|&depth| depth == 0.5));
        assert!(targets.ids().iter().all(|&id| id == 7));
    }
}

#[test]
fn without_the_depth_test_the_last_call_is_seen_and_no_depth_kept() {
    let mut targets = targets();
    let state = State { depth_test: false, ..State::new(WHOLE) };
    for depth in [0.5, 0.25] {
        draw_card(&mut targets, &state, &card(EVERYWHERE, depth, round_to_f32(depth)));
    }
    assert_eq!(red(&targets, 40, 40), 0.25);
    assert_eq!(targets.depth()[0], 0.0);
}

#[test]
fn without_depth_writes_a_card_is_tested_but_hides_nothing() {
    let mut targets = targets();
    draw_card(&mut targets, &State::new(WHOLE), &card([-1.0, -1.0, 0.0, 1.0], 0.5, 0.5));
    let state = State { depth_write: false, ..State::new(WHOLE) };
    draw_card(&mut targets, &state, &card(EVERYWHERE, 0.25, 0.75));
    assert_eq!((red(&targets, 10, 40), red(&targets, 70, 40)), (0.5, 0.75));
    assert_eq!(targets.depth()[40 * SIDE as usize + 70], 0.0);
}

#[test]
fn within_one_call_without_depth_writes_the_last_of_the_nearer_wins() {
    let vertices =
        [0.5, 0.25, 0.125].map(|depth| card(EVERYWHERE, depth, round_to_f32(depth)).vertices).concat();
    let both = Plain { vertices, cutoff: None };
    let triangles: Vec<[u32; 3]> = (0..3).flat_map(|n| QUAD.map(|t| t.map(|v| v + 4 * n))).collect();
    let mut targets = targets();
    draw_card(&mut targets, &State::new(WHOLE), &card(EVERYWHERE, 0.2, 0.0));
    let state = State { depth_write: false, ..State::new(WHOLE) };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("threads start");
    let work = Work { pool: &pool, cancel: &AtomicBool::new(false), level: Level::new(), order: Order::Rows };
    let call = DrawCall { program: &both, vertices: 12, triangles: &triangles, instances: 1, first_id: 1 };
    call.draw(&mut targets, &state, &work).expect("nothing cancels");
    assert_eq!(red(&targets, 40, 40), 0.25);
}

#[test]
fn without_colour_writes_depths_and_ids_alone_change() {
    let mut targets = targets();
    let state = State { color_write: false, ..State::new(WHOLE) };
    draw_card(&mut targets, &state, &card(EVERYWHERE, 0.5, 0.5));
    assert_eq!((red(&targets, 40, 40), targets.depth()[0], targets.ids()[0]), (0.0, 0.5, 7));
}

#[test]
fn nothing_is_drawn_outside_the_viewport() {
    let mut targets = targets();
    let viewport = Rect { x: 5, y: 9, width: 70, height: 30 };
    let state = State::new(viewport);
    draw_card(&mut targets, &state, &card([-3.0, -3.0, 3.0, 3.0], 0.5, 1.0));
    for (i, id) in (0..).zip(targets.ids()) {
        let (x, y) = (i % SIDE, i / SIDE);
        let inside = (5..75).contains(&x) && (9..39).contains(&y);
        assert_eq!(*id, if inside { 7 } else { 0 }, "({x}, {y})");
    }
}

#[test]
fn faces_are_culled_as_the_state_says() {
    let back: [[u32; 3]; 2] = QUAD.map(|[a, b, c]| [c, b, a]);
    for (triangles, cull, seen) in [
        (QUAD, Cull::Back, true),
        (QUAD, Cull::Front, false),
        (back, Cull::Back, false),
        (back, Cull::Front, true),
        (back, Cull::None, true),
    ] {
        let mut targets = targets();
        let state = State { cull, ..State::new(WHOLE) };
        draw(&mut targets, &state, &card(EVERYWHERE, 0.5, 1.0), &triangles, 1);
        assert_eq!(targets.ids()[0] == 7, seen, "{triangles:?} {cull:?}");
        if seen {
            assert_eq!(targets.color(1)[0][2], if triangles == back { 1.0 } else { 0.0 });
        }
    }
}

#[test]
fn instances_are_told_apart() {
    let mut targets = targets();
    draw(&mut targets, &State::new(WHOLE), &card([-1.0, -1.0, 0.0, 1.0], 0.5, 1.0), &QUAD, 2);
    let at = |x: u32| (targets.ids()[x as usize], targets.color(0)[x as usize][1]);
    assert_eq!((at(0), at(SIDE - 1)), ((7, 0.0), (8, 1.0)));
}

#[test]
fn what_is_discarded_hides_nothing() {
    // A ramp from 0 to 1 before a card: its darker half is discarded.
    let mut ramp = card(EVERYWHERE, 0.5, 0.0);
    ramp.vertices[1].1 = 1.0;
    ramp.vertices[2].1 = 1.0;
    ramp.cutoff = Some(0.5);
    let mut targets = targets();
    draw_card(&mut targets, &State::new(WHOLE), &ramp);
    assert_eq!(targets.ids()[10], 0);
    draw_card(&mut targets, &State::new(WHOLE), &card(EVERYWHERE, 0.25, 0.125));
    assert_eq!(red(&targets, 10, 40), 0.125);
    assert!(red(&targets, 70, 40) > 0.8);
}

/// A floor seen in perspective: its varying is the distance along it.
#[test]
fn varyings_and_their_derivatives_are_perspective_correct() {
    // x = ±1, y = −1 below the eye, from w = 1 to w = 50; z is the near distance.
    let corner = |x: f64, w: f64| ([x * w, -1.0, 0.5, w], round_to_f32(w));
    let floor = Plain {
        vertices: vec![corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, 50.0), corner(-1.0, 50.0)],
        cutoff: None,
    };
    let mut targets = targets();
    draw_card(&mut targets, &State::new(WHOLE), &floor);
    let (mut value, mut slope) = (Worst::default(), Worst::default());
    for y in 42..SIDE {
        // The pixel's centre is at y/w = −1/w.
        let ndc = 1.0 - (f64::from(y) + 0.5) * 2.0 / f64::from(SIDE);
        let w = -1.0 / ndc;
        let per_pixel = -2.0 / f64::from(SIDE) * w * w;
        let at = (y * SIDE + 33) as usize;
        value.note((f64::from(targets.color(0)[at][0]) / w - 1.0).abs());
        slope.note((f64::from(targets.color(1)[at][1]) / per_pixel - 1.0).abs());
        assert!(targets.color(1)[at][0].abs() < 1e-4);
    }
    // The corners are snapped to 1/256 px; at the far end a pixel is 1/40 of y/w = 1/50.
    at_most("varying", "relative error", value.largest(), 2e-3);
    at_most("varying", "relative error of its derivative", slope.largest(), 4e-3);
}

#[test]
fn a_triangle_through_the_eye_is_cut_at_the_near_plane() {
    // Half of it lies behind the eye.
    let corner = |x: f64, w: f64| ([x, -0.5, 0.125, w], round_to_f32(w));
    let floor = Plain {
        vertices: vec![corner(-4.0, -3.0), corner(4.0, -3.0), corner(4.0, 5.0), corner(-4.0, 5.0)],
        cutoff: None,
    };
    let mut targets = targets();
    let state = State { cull: Cull::None, ..State::new(WHOLE) };
    draw_card(&mut targets, &state, &floor);
    assert_eq!(targets.ids()[(10 * SIDE + 40) as usize], 0);
    let below = ((SIDE - 1) * SIDE + 40) as usize;
    assert_eq!(targets.ids()[below], 7);
    assert!((targets.color(0)[below][0] - 0.506).abs() < 0.01, "{}", targets.color(0)[below][0]);
}

/// Writes its second target only in blocks that begin in the left half.
struct LeftAlone(Plain);

impl Program for LeftAlone {
    fn varyings(&self) -> usize {
        1
    }

    fn vertex(&self, vertex: u32, instance: u32, varyings: &mut [f32]) -> [f64; 4] {
        self.0.vertex(vertex, instance, varyings)
    }

    fn pixels(&self, _: Level, block: &Block, out: &mut Outputs) {
        if block.varyings[0][0] < 0.5 {
            out.colors[1] = [[1.0; BLOCK]; 4];
        }
    }
}

#[test]
fn what_a_pixel_part_leaves_alone_is_transparent_black() {
    let mut ramp = card(EVERYWHERE, 0.5, 0.0);
    ramp.vertices[1].1 = 1.0;
    ramp.vertices[2].1 = 1.0;
    // The lower half again, all of it beyond the middle: its blocks follow others in the same tile.
    let beyond = card([-1.0, -1.0, 1.0, 0.0], 0.75, 0.75);
    let vertices = [ramp.vertices, beyond.vertices].concat();
    let program = LeftAlone(Plain { vertices, cutoff: None });
    let triangles: Vec<[u32; 3]> = (0..2).flat_map(|n| QUAD.map(|t| t.map(|v| v + 4 * n))).collect();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread starts");
    let work = Work { pool: &pool, cancel: &AtomicBool::new(false), level: Level::new(), order: Order::Rows };
    let call = DrawCall { program: &program, vertices: 8, triangles: &triangles, instances: 1, first_id: 1 };
    let mut targets = targets();
    call.draw(&mut targets, &State::new(WHOLE), &work).expect("nothing cancels");
    let at = |x: u32, y: u32| targets.color(1)[(y * SIDE + x) as usize];
    assert!(targets.color(1)[..(40 * SIDE) as usize].contains(&[1.0; 4]));
    assert_eq!(at(5, 60), [0.0; 4]);
    assert_eq!(at(5, 75), [0.0; 4]);
}
