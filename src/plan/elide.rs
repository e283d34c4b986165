//! Elisions: work that a frame is spared because its outcome is known to the bit.
//!
//! Each [`Elision`] can be switched off, and then the general path runs: it is slower and gives the same picture.
//! What has no switch, because there is no general path that would mean anything, is listed in
//! `docs/elisions.md` with its reasons.

use super::request::quoted;
use std::fmt::{Display, Formatter};
use std::str::FromStr;

/// One kind of work that a frame can be spared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Elision {
    /// Shadow maps of lights that no receiver in the view looks at.
    UnseenShadows,
    /// Lights that add nothing.
    DarkLights,
    /// Sides of a cube of shadow maps.
    CubeSides,
    /// Instances outside the view.
    OutsideInstances,
    /// Triangles outside the view.
    OutsideTriangles,
    /// Clipping of triangles that no plane cuts.
    Clipping,
    /// Tiles of a triangle's box that its edges pass by.
    TilesPassedBy,
    /// Edge tests of blocks wholly inside or outside a triangle.
    UniformBlocks,
    /// Blocks of a triangle behind what is drawn.
    HiddenBlocks,
    /// Sampling of maps that are not there.
    AbsentMaps,
    /// Sampling of maps of one colour.
    ConstantMaps,
    /// Relief that tilts no normal.
    FlatRelief,
    /// Highlights of no colour.
    BlackSpecular,
    /// Light on surfaces that are turned away from it.
    TurnedAway,
    /// Shadow taps that the depths around them decide.
    DecidedTaps,
    /// Pixel by pixel work in tiles of a single colour.
    PlainTiles,
    /// Sky behind what covers it.
    CoveredSky,
    /// Resolving pixels whose samples all see the same.
    UniformPixels,
    /// Effects that change nothing.
    NeutralEffects,
    /// Passes of effects that need one pixel alone.
    PointwisePasses,
}

/// What an elision spares, and what work is counted in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Unit {
    /// Lights that get shadow maps.
    Shadows,
    /// Lights that surfaces are lit by.
    Lights,
    /// Shadow maps around point lights.
    CubeSides,
    /// Instances whose vertices are transformed.
    Instances,
    /// Triangles that are clipped, culled and set up.
    Triangles,
    /// Triangles that go through the clipper.
    Clipped,
    /// Triangles listed by tiles, each as often as it is listed.
    TileEntries,
    /// Blocks of 8×8 pixels in which edges are tested.
    EdgeBlocks,
    /// Blocks of 8×8 pixels in which depths are computed.
    DepthBlocks,
    /// Texture samples of colours.
    ColorSamples,
    /// Texture samples of normals and heights.
    ReliefSamples,
    /// Highlights: a fragment under a light.
    Highlights,
    /// Light on a fragment.
    LitFragments,
    /// Shadow map taps.
    Taps,
    /// Tiles whose pixels are resolved and written one by one.
    PixelTiles,
    /// Pixels of the sky.
    SkyPixels,
    /// Pixels that are the mean of samples.
    Means,
    /// Effects of `post`.
    Effects,
    /// Passes over the whole picture.
    Passes,
    /// Tiles of the picture.
    Tiles,
    /// Tiles that list no triangle.
    EmptyTiles,
    /// Pixels of which some sample sees an opaque surface.
    CoveredPixels,
    /// Fragments shaded.
    Fragments,
    /// Questions to shadow maps: a fragment and a light.
    Lookups,
    /// Texels of shadow maps.
    ShadowTexels,
}

/// What there is to say of an elision.
struct Facts {
    name: &'static str,
    rule: &'static str,
    unit: Unit,
    exact: &'static str,
}

impl Elision {
    /// Every one, in the order of the passes.
    pub const ALL: [Self; 20] = [
        Self::UnseenShadows,
        Self::DarkLights,
        Self::CubeSides,
        Self::OutsideInstances,
        Self::OutsideTriangles,
        Self::Clipping,
        Self::TilesPassedBy,
        Self::UniformBlocks,
        Self::HiddenBlocks,
        Self::AbsentMaps,
        Self::ConstantMaps,
        Self::FlatRelief,
        Self::BlackSpecular,
        Self::TurnedAway,
        Self::DecidedTaps,
        Self::PlainTiles,
        Self::CoveredSky,
        Self::UniformPixels,
        Self::NeutralEffects,
        Self::PointwisePasses,
    ];

    fn facts(self) -> Facts {
        let (name, rule, unit, exact) = match self {
            Self::UnseenShadows => (
                "unseen_shadows",
                "D1",
                Unit::Shadows,
                "no lit surface in the view asks for the shadow, so nothing reads its maps",
            ),
            Self::DarkLights => (
                "dark_lights",
                "D2",
                Unit::Lights,
                "a light that is off or black adds 0 to every sum, and one that falls on nothing is in none",
            ),
            Self::CubeSides => (
                "cube_sides",
                "D1",
                Unit::CubeSides,
                "a side without casters reads as empty, and one without receivers is not read",
            ),
            Self::OutsideInstances => (
                "outside_instances",
                "D14",
                Unit::Instances,
                "a box outside one plane of the view holds no triangle that covers a sample",
            ),
            Self::OutsideTriangles => (
                "outside_triangles",
                "D14",
                Unit::Triangles,
                "three corners outside the same plane of the view span no sample",
            ),
            Self::Clipping => (
                "clipping",
                "D15",
                Unit::Clipped,
                "a triangle on the inner side of every plane leaves the clipper as it came",
            ),
            Self::TilesPassedBy => (
                "tiles_passed_by",
                "D16",
                Unit::TileEntries,
                "a tile outside one edge has no sample inside all three",
            ),
            Self::UniformBlocks => (
                "uniform_blocks",
                "D16",
                Unit::EdgeBlocks,
                "the sign of a linear function at a block's corners is its sign within",
            ),
            Self::HiddenBlocks => (
                "hidden_blocks",
                "D10",
                Unit::DepthBlocks,
                "what is behind the farthest depth of a block loses every depth test in it",
            ),
            Self::AbsentMaps => (
                "absent_maps",
                "D6",
                Unit::ColorSamples,
                "a map that is not there reads as white, and x · 1 is x",
            ),
            Self::ConstantMaps => (
                "constant_maps",
                "D7",
                Unit::ColorSamples,
                "texels that are all the same are a factor wherever they are read",
            ),
            Self::FlatRelief => (
                "flat_relief",
                "D8",
                Unit::ReliefSamples,
                "a normal map that points straight up, and heights without slopes, leave the normal as it is",
            ),
            Self::BlackSpecular => ("black_specular", "D9", Unit::Highlights, "a highlight times 0 adds 0"),
            Self::TurnedAway => (
                "turned_away",
                "D4",
                Unit::LitFragments,
                "where the normal points away from the light its term is 0, lit or in shadow",
            ),
            Self::DecidedTaps => (
                "decided_taps",
                "D5",
                Unit::Taps,
                "where the least or greatest depth around a kernel decides, every tap says the same",
            ),
            Self::PlainTiles => (
                "plain_tiles",
                "D13",
                Unit::PixelTiles,
                "pixels that see the same one colour go through the same effects to the same bytes",
            ),
            Self::CoveredSky => (
                "covered_sky",
                "D12",
                Unit::SkyPixels,
                "a sky whose pixel is covered by surfaces is not read",
            ),
            Self::UniformPixels => (
                "uniform_pixels",
                "D11",
                Unit::Means,
                "the mean of 2ᵐ equal samples, summed as a tree, is the sample",
            ),
            Self::NeutralEffects => {
                ("neutral_effects", "D17", Unit::Effects, "an effect of no strength keeps every colour")
            }
            Self::PointwisePasses => (
                "pointwise_passes",
                "D18",
                Unit::Passes,
                "the same steps in the same order, on pixels that have not left their registers",
            ),
        };
        Facts { name, rule, unit, exact }
    }

    /// What `elide=` calls it.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.facts().name
    }

    /// Its number among the rules: `D1`.
    #[must_use]
    pub fn rule(self) -> &'static str {
        self.facts().rule
    }

    /// What it spares.
    #[must_use]
    pub fn unit(self) -> Unit {
        self.facts().unit
    }

    /// Why the picture is the same without, as the end of a sentence.
    #[must_use]
    pub fn exact(self) -> &'static str {
        self.facts().exact
    }

    fn bit(self) -> u32 {
        1 << self as u32
    }
}

impl Unit {
    /// Every one.
    pub const ALL: [Self; 25] = [
        Self::Shadows,
        Self::Lights,
        Self::CubeSides,
        Self::Instances,
        Self::Triangles,
        Self::Clipped,
        Self::TileEntries,
        Self::EdgeBlocks,
        Self::DepthBlocks,
        Self::ColorSamples,
        Self::ReliefSamples,
        Self::Highlights,
        Self::LitFragments,
        Self::Taps,
        Self::PixelTiles,
        Self::SkyPixels,
        Self::Means,
        Self::Effects,
        Self::Passes,
        Self::Tiles,
        Self::EmptyTiles,
        Self::CoveredPixels,
        Self::Fragments,
        Self::Lookups,
        Self::ShadowTexels,
    ];

    /// The name of its counter.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Shadows => "shadows",
            Self::Lights => "lights",
            Self::CubeSides => "cube_sides",
            Self::Instances => "instances",
            Self::Triangles => "triangles_set_up",
            Self::Clipped => "triangles_clipped",
            Self::TileEntries => "tile_entries",
            Self::EdgeBlocks => "edge_blocks",
            Self::DepthBlocks => "depth_blocks",
            Self::ColorSamples => "color_samples",
            Self::ReliefSamples => "relief_samples",
            Self::Highlights => "highlights",
            Self::LitFragments => "lit_fragments",
            Self::Taps => "taps",
            Self::PixelTiles => "tiles_by_pixel",
            Self::SkyPixels => "sky_pixels",
            Self::Means => "means",
            Self::Effects => "effects",
            Self::Passes => "passes",
            Self::Tiles => "tiles",
            Self::EmptyTiles => "tiles_empty",
            Self::CoveredPixels => "pixels_covered",
            Self::Fragments => "fragments",
            Self::Lookups => "shadow_lookups",
            Self::ShadowTexels => "shadow_texels",
        }
    }
}

/// A set of elisions: what may be left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Elisions(u32);

impl Elisions {
    /// Everything that can be.
    pub const ALL: Self = Self((1 << Elision::ALL.len()) - 1);
    /// Nothing: every step runs.
    pub const NONE: Self = Self(0);

    /// Whether `elision` is among them.
    #[must_use]
    pub fn contains(self, elision: Elision) -> bool {
        self.0 & elision.bit() != 0
    }

    /// These and `elision`.
    #[must_use]
    pub fn with(self, elision: Elision) -> Self {
        Self(self.0 | elision.bit())
    }

    /// These but for `elision`.
    #[must_use]
    pub fn without(self, elision: Elision) -> Self {
        Self(self.0 & !elision.bit())
    }

    /// Them, in the order of the passes.
    pub fn iter(self) -> impl Iterator<Item = Elision> {
        Elision::ALL.into_iter().filter(move |elision| self.contains(*elision))
    }
}

impl Default for Elisions {
    fn default() -> Self {
        Self::ALL
    }
}

/// `all`, `none`, or names with commas between.
impl Display for Elisions {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        match *self {
            Self::ALL => f.write_str("all"),
            Self::NONE => f.write_str("none"),
            some => f.write_str(&some.iter().map(Elision::name).collect::<Vec<_>>().join(",")),
        }
    }
}

impl FromStr for Elisions {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "all" => Ok(Self::ALL),
            "none" => Ok(Self::NONE),
            _ => text.split(',').try_fold(Self::NONE, |set, name| Ok(set.with(named(name.trim())?))),
        }
    }
}

fn named(name: &str) -> Result<Elision, String> {
    Elision::ALL.into_iter().find(|elision| elision.name() == name).ok_or_else(|| {
        let names = Elision::ALL.map(Elision::name).join(", ");
        format!("must be all, none, or names with commas between ({names}), is {}", quoted(name))
    })
}

/// Work of a frame: how much was done, and how much each elision spared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    done: [u64; Unit::ALL.len()],
    spared: [u64; Elision::ALL.len()],
}

impl Tally {
    /// Counts work that was done.
    #[inline(always)]
    pub fn count(&mut self, unit: Unit, amount: u64) {
        self.done[unit as usize] += amount;
    }

    /// Counts work, in the elision's unit, that was not.
    #[inline(always)]
    pub fn spare(&mut self, elision: Elision, amount: u64) {
        self.spared[elision as usize] += amount;
    }

    /// How much was done.
    #[must_use]
    pub fn done(&self, unit: Unit) -> u64 {
        self.done[unit as usize]
    }

    /// How much an elision spared, in its unit.
    #[must_use]
    pub fn spared(&self, elision: Elision) -> u64 {
        self.spared[elision as usize]
    }

    /// All that was done, by the names of its units; what was none is absent.
    pub fn work(&self) -> impl Iterator<Item = (&'static str, u64)> {
        Unit::ALL.map(|unit| (unit.name(), self.done(unit))).into_iter().filter(|(_, amount)| *amount > 0)
    }

    /// All that was spared, by the names of the elisions; what was none is absent.
    pub fn savings(&self) -> impl Iterator<Item = (&'static str, u64)> {
        let all = Elision::ALL.map(|elision| (elision.name(), self.spared(elision)));
        all.into_iter().filter(|(_, amount)| *amount > 0)
    }

    /// Adds another's counts.
    pub fn add(&mut self, o: &Self) {
        self.done.iter_mut().zip(o.done).for_each(|(sum, more)| *sum += more);
        self.spared.iter_mut().zip(o.spared).for_each(|(sum, more)| *sum += more);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_are_in_the_order_of_their_enums() {
        assert!(Elision::ALL.iter().enumerate().all(|(i, elision)| *elision as usize == i));
        assert!(Unit::ALL.iter().enumerate().all(|(i, unit)| *unit as usize == i));
    }

    #[test]
    fn a_set_reads_as_it_is_written() {
        let some = Elisions::NONE.with(Elision::Clipping).with(Elision::DecidedTaps);
        for set in [Elisions::ALL, Elisions::NONE, some, Elisions::ALL.without(Elision::Clipping)] {
            assert_eq!(set.to_string().parse(), Ok(set));
        }
        assert_eq!(some.to_string(), "clipping,decided_taps");
        assert_eq!("decided_taps, clipping".parse(), Ok(some));
    }

    #[test]
    fn what_is_no_elision_is_answered_with_all_names() {
        for text in ["shadow", "all,none", "", "All"] {
            let fault = text.parse::<Elisions>().expect_err("a fault");
            assert!(fault.contains("(unseen_shadows, dark_lights, ") && fault.contains("is \""), "{fault}");
        }
    }
}
