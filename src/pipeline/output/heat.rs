//! Numbers as colours: from black over blue, green, yellow and red to white.

/// The scale's stops, in sRGB: 0 is black, 1 dark blue, 16 and more white.
const STOPS: [(f64, [u8; 3]); 7] = [
    (0.0, [0, 0, 0]),
    (1.0, [0, 0, 140]),
    (2.0, [0, 110, 220]),
    (4.0, [0, 170, 80]),
    (8.0, [250, 210, 0]),
    (12.0, [220, 30, 0]),
    (16.0, [255, 255, 255]),
];

/// Places on the scale for each doubling of a tile's triangles: so 1024 of them are white.
const PER_DOUBLING: f64 = 1.5;

/// The colour of as many fragments in a pixel: one is 1 on the scale.
pub fn of_fragments(count: u32) -> [u8; 3] {
    color(f64::from(count))
}

/// The colour of as many triangles in a tile: one is 1 on the scale, and each doubling as much farther.
pub fn of_triangles(count: u32) -> [u8; 3] {
    let place = if count == 0 { 0.0 } else { 1.0 + PER_DOUBLING * libm::log2(f64::from(count)) };
    color(place)
}

/// Mixed from the stops around a place of the scale.
fn color(place: f64) -> [u8; 3] {
    let above = STOPS.iter().position(|(stop, _)| *stop > place).unwrap_or(STOPS.len() - 1).max(1);
    let ((from, low), (to, high)) = (STOPS[above - 1], STOPS[above]);
    let share = ((place - from) / (to - from)).min(1.0);
    std::array::from_fn(|c| mix(low[c], high[c], share))
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between two bytes")]
fn mix(low: u8, high: u8, share: f64) -> u8 {
    (f64::from(low) + (f64::from(high) - f64::from(low)) * share + 0.5).floor() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scale_ends_in_white_and_no_two_counts_on_it_look_alike() {
        let colors: Vec<[u8; 3]> = (0..=16).map(of_fragments).collect();
        assert_eq!((colors[0], colors[1], colors[16]), ([0; 3], [0, 0, 140], [255; 3]));
        assert_eq!(of_fragments(u32::MAX), [255; 3]);
        for (at, color) in colors.iter().enumerate() {
            assert!(!colors[..at].contains(color), "{at}");
        }
    }

    #[test]
    fn triangles_count_by_doublings() {
        assert_eq!((of_triangles(0), of_triangles(1)), ([0; 3], [0, 0, 140]));
        assert_eq!(of_triangles(4), STOPS[3].1);
        assert_eq!((of_triangles(1024), of_triangles(u32::MAX)), ([255; 3], [255; 3]));
        assert_ne!(of_triangles(1000), [255; 3]);
    }
}
