//! Wireframe: the edges of what is seen, one pixel wide, hidden lines removed.

use crate::math::View;
use crate::pipeline::geometry::Bins;
use crate::pipeline::geometry::bin::Chunk;
use crate::pipeline::geometry::setup::{NOT_CLIPPED, Triangle};
use crate::pipeline::tiles::cover::Region;
use crate::pipeline::tiles::fragments::{Entry, triangle};
use crate::pipeline::work::{Cancelled, Work};

/// Half the width of a line in sub-pixels: so a line covers the centre of at least one pixel in every
/// column or row that it crosses, and of no more than it must.
const HALF_WIDTH: f64 = 128.0;

/// Which triangle the centre of each pixel sees.
pub type Seen = [Option<Entry>];

/// Draws white lines on black: a pixel is white where an edge passes within half a pixel of its centre,
/// of the triangle seen there or of one that is seen beside it and not hidden there.
///
/// # Errors
/// [`Cancelled`].
pub fn draw(
    view: &View,
    bins: &Bins,
    seen: &Seen,
    pixels: &mut [[u8; 4]],
    work: &Work,
) -> Result<(), Cancelled> {
    let width = view.width as usize;
    let rows = pixels.chunks_mut(width).enumerate();
    work.map(rows.collect(), || (), |(), (y, row)| draw_row(view, bins, seen, y, row))?;
    Ok(())
}

fn draw_row(view: &View, bins: &Bins, seen: &Seen, y: usize, row: &mut [[u8; 4]]) {
    let origin = view.viewport().origin();
    let region = Region { origin, size: [view.width as usize, view.height as usize] };
    for (x, pixel) in row.iter_mut().enumerate() {
        let centre = region.centre([x, y]);
        let own = seen[y * view.width as usize + x];
        let lit = candidates(view, seen, [x, y]).into_iter().flatten().any(|entry| {
            let (chunk, t) = triangle(entry, bins);
            edges(t, chunk).any(|edge| {
                let at = nearest_point(t, edge, centre);
                let apart = [at[0] - centre[0], at[1] - centre[1]];
                apart[0] * apart[0] + apart[1] * apart[1] <= HALF_WIDTH * HALF_WIDTH
                    && (own == Some(entry) || !hides(own, t, at, bins))
            })
        });
        *pixel = if lit { [255; 4] } else { [0, 0, 0, 255] };
    }
}

/// What the pixel and its eight neighbours see, each triangle once.
fn candidates(view: &View, seen: &Seen, [x, y]: [usize; 2]) -> [Option<Entry>; 9] {
    let mut found = [None; 9];
    let mut count = 0;
    for row in y.saturating_sub(1)..(y + 2).min(view.height as usize) {
        for column in x.saturating_sub(1)..(x + 2).min(view.width as usize) {
            let entry = seen[row * view.width as usize + column];
            if entry.is_some() && !found[..count].contains(&entry) {
                found[count] = entry;
                count += 1;
            }
        }
    }
    found
}

/// Edges of a triangle, by their first corner, that are edges of its mesh: those of a clipped piece are
/// only where they lie on one, so that one corner has no weight at either end.
fn edges<'a>(t: &Triangle, chunk: &'a Chunk) -> impl Iterator<Item = usize> + 'a {
    let corners = t.corners();
    let weights = (t.clipped != NOT_CLIPPED).then(|| &chunk.clipped[t.clipped as usize]);
    (0..3).filter(move |&i| {
        weights.is_none_or(|weights| {
            let (a, b) = (weights[corners[i]], weights[corners[(i + 1) % 3]]);
            (0..3).any(|corner| a[corner] == 0.0 && b[corner] == 0.0)
        })
    })
}

/// The point of the edge from corner `i` that is nearest to `p`. All in sub-pixels.
fn nearest_point(t: &Triangle, i: usize, p: [f64; 2]) -> [f64; 2] {
    let j = (i + 1) % 3;
    let (a, b) = ([f64::from(t.x[i]), f64::from(t.y[i])], [f64::from(t.x[j]), f64::from(t.y[j])]);
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let squared = dx * dx + dy * dy;
    let along = ((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / squared.max(1.0);
    let along = along.clamp(0.0, 1.0);
    [a[0] + dx * along, a[1] + dy * along]
}

/// Whether what a pixel sees lies before the triangle `t` at a point: by more than both planes rise over
/// a sub-pixel. So far corners are moved when they are snapped, and an edge on a floor stays in sight.
fn hides(own: Option<Entry>, t: &Triangle, at: [f64; 2], bins: &Bins) -> bool {
    own.is_some_and(|own| {
        let own = triangle(own, bins).1;
        own.depth_at(at[0], at[1]) > t.depth_at(at[0], at[1]) + rise(own, at) + rise(t, at)
    })
}

/// How much the depth of a triangle's plane changes over a sub-pixel in x and one in y.
fn rise(t: &Triangle, [x, y]: [f64; 2]) -> f64 {
    let depth = t.depth_at(x, y);
    (t.depth_at(x + 1.0, y) - depth).abs() + (t.depth_at(x, y + 1.0) - depth).abs()
}
