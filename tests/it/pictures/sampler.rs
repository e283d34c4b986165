//! Texture sampling as the wire contract and OpenGL 4.6 (8.14) define it, in f64.
#![expect(clippy::cast_possible_truncation, reason = "indices of images of a few dozen texels")]

use crate::closed_form::decode;
use glam::{DVec2, DVec3};

/// An image with its levels, in linear light, rows from the top.
pub struct Reference {
    levels: Vec<(usize, usize, Vec<DVec3>)>,
}

/// How coordinates outside the unit square are read.
#[derive(Clone, Copy, Debug)]
pub enum Wrap {
    Repeat,
    Clamp,
    Mirror,
}

impl Wrap {
    /// Every mode with its name in a document.
    pub const ALL: [(&str, Self); 3] =
        [("repeat", Self::Repeat), ("clamp", Self::Clamp), ("mirror", Self::Mirror)];

    /// The texel that stands for index `i` of `n`.
    fn index(self, i: i64, n: usize) -> usize {
        let n = n as i64;
        let i = match self {
            Self::Repeat => i.rem_euclid(n),
            Self::Clamp => i.clamp(0, n - 1),
            Self::Mirror => {
                let turn = i.rem_euclid(2 * n);
                if turn < n { turn } else { 2 * n - 1 - turn }
            }
        };
        i as usize
    }
}

impl Reference {
    /// `texel` as file bytes; sides are powers of two.
    pub fn new(width: usize, height: usize, texel: impl Fn(u32, u32) -> [u8; 4]) -> Self {
        let linear = |i: usize| {
            let [r, g, b, _] = texel((i % width) as u32, (i / width) as u32);
            DVec3::new(decode(r), decode(g), decode(b))
        };
        let mut levels = vec![(width, height, (0..width * height).map(linear).collect::<Vec<_>>())];
        while let Some((w, h, above)) = levels.last().filter(|(w, h, _)| w * h > 1) {
            let (half_w, half_h) = ((w / 2).max(1), (h / 2).max(1));
            let (across, down) = (w / half_w, h / half_h);
            let mean = |i: usize| {
                let (x, y) = (i % half_w * across, i / half_w * down);
                let area = (0..down).flat_map(|dy| (0..across).map(move |dx| (x + dx, y + dy)));
                area.map(|(x, y)| above[y * w + x]).sum::<DVec3>() / (across * down) as f64
            };
            let level = (half_w, half_h, (0..half_w * half_h).map(mean).collect());
            levels.push(level);
        }
        Self { levels }
    }

    /// The texel of level 0 that holds `uv`.
    pub fn nearest(&self, wrap: Wrap, uv: DVec2) -> DVec3 {
        let (w, h, texels) = &self.levels[0];
        let x = wrap.index((uv.x * *w as f64).floor() as i64, *w);
        let y = wrap.index(((1.0 - uv.y) * *h as f64).floor() as i64, *h);
        texels[y * w + x]
    }

    /// Bilinear in the nearest level.
    pub fn bilinear(&self, level: f64, wrap: Wrap, uv: DVec2) -> DVec3 {
        let last = self.levels.len() - 1;
        self.within((level.round() as usize).min(last), wrap, uv)
    }

    /// Bilinear in one level.
    fn within(&self, level: usize, wrap: Wrap, uv: DVec2) -> DVec3 {
        let (w, h, texels) = &self.levels[level];
        let at = DVec2::new(uv.x * *w as f64, (1.0 - uv.y) * *h as f64) - 0.5;
        let (first, part) = (at.floor(), at - at.floor());
        let texel = |dx: i64, dy: i64| {
            let (x, y) = (wrap.index(first.x as i64 + dx, *w), wrap.index(first.y as i64 + dy, *h));
            texels[y * w + x]
        };
        let row = |dy: i64| texel(0, dy).lerp(texel(1, dy), part.x);
        row(0).lerp(row(1), part.y)
    }

    /// Between the two levels around `level`.
    pub fn trilinear(&self, level: f64, wrap: Wrap, uv: DVec2) -> DVec3 {
        let last = self.levels.len() - 1;
        let low = (level.floor() as usize).min(last);
        self.within(low, wrap, uv).lerp(self.within((low + 1).min(last), wrap, uv), level.fract())
    }
}
