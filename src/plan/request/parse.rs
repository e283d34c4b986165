//! The frame query: text in, [`FrameRequest`] out, or every fault at once.

use super::query::{in_range, integer, not_one_of, numbers, positive};
use super::{BackgroundRequest, Budget, FrameRequest, Knobs, Orbit, Output, Preset, Query, QueryFault};
use crate::limits::Limits;
use crate::math::colour::linear_from_srgb8;
use crate::model::{Filter, Shading};
use crate::scene::document::words::Word;
use crate::scene::document::{MAX_FOV_Y_DEG, MIN_FOV_Y_DEG};
use glam::Vec3;

/// Words of `shading`: those of a document.
const SHADINGS: &[(&str, Shading)] = <Shading as Word>::WORDS;

/// Words of `texture_filter`: those of a document.
const FILTERS: &[(&str, Filter)] = <Filter as Word>::WORDS;

/// Words of `output` for what the scene shows.
const OUTPUTS: [(&str, Output); 6] = [
    ("color", Output::Color),
    ("depth", Output::Depth),
    ("normal", Output::Normal),
    ("albedo", Output::Albedo),
    ("instance", Output::Instance),
    ("wireframe", Output::Wireframe),
];

/// Words of `output` for what the pipeline does on the way.
const STAGES: [(&str, Output); 4] = [
    ("ids", Output::Ids),
    ("shadow_map", Output::ShadowMap),
    ("tiles", Output::Tiles),
    ("shaded", Output::Shaded),
];

fn outputs() -> impl Iterator<Item = (&'static str, Output)> {
    OUTPUTS.into_iter().chain(STAGES)
}

impl FrameRequest {
    /// The words that `shading`, `output`, `texture_filter` and `preset` take; none for another parameter.
    #[must_use]
    pub fn words(parameter: &str) -> Vec<&'static str> {
        match parameter {
            "shading" => SHADINGS.iter().map(|(word, _)| *word).collect(),
            "output" => outputs().map(|(word, _)| word).collect(),
            "texture_filter" => FILTERS.iter().map(|(word, _)| *word).collect(),
            "preset" => Preset::WORDS.iter().map(|(word, _)| *word).collect(),
            _ => Vec::new(),
        }
    }

    /// Reads a frame query of decoded pairs.
    ///
    /// # Errors
    /// Every fault at once: values out of range, contradictions, repeated and unknown names.
    pub fn parse<'a>(pairs: impl IntoIterator<Item = (&'a str, &'a str)>) -> Result<Self, Vec<QueryFault>> {
        let mut query = Query::new(pairs);
        let request = Self::read(&mut query);
        query.finish().map(|()| request)
    }

    /// Reads the frame query's parameters out of a query that may hold others too. What is faulty is
    /// noted there and left at its default.
    pub fn read(query: &mut Query) -> Self {
        let request = Self {
            width: query.parsed("width", side),
            height: query.parsed("height", side),
            samples: query.one_of("samples", &[("1", 1), ("2", 2), ("4", 4), ("8", 8), ("16", 16)]),
            knobs: Knobs::read(query),
            budget: Budget::read(query),
            t: query.number("t").unwrap_or(0.0),
            quality: query.integer_in("quality", 1..=100).and_then(|quality| u8::try_from(quality).ok()),
            output: query.parsed("output", output).unwrap_or_default(),
            shading: query.one_of("shading", SHADINGS),
            eye: query.point("eye"),
            target: query.point("target"),
            fov_y_deg: query.number_in("fov", MIN_FOV_Y_DEG..=MAX_FOV_Y_DEG),
            near: query.positive("near"),
            far: query.positive("far"),
            ortho_height: query.positive("ortho"),
            orbit: query.parsed("orbit", orbit),
            turn_deg: 0.0,
            background: query.parsed("background", background),
            elide: query.parsed("elide", str::parse),
        };
        request.note_contradictions(query);
        request
    }

    fn note_contradictions(&self, query: &mut Query) {
        if self.eye.is_some() && self.orbit.is_some() {
            query.fault("orbit", "cannot be given together with eye: both place the camera");
        }
        if self.fov_y_deg.is_some() && self.ortho_height.is_some() {
            query.fault("ortho", "cannot be given together with fov: both shape the view");
        }
        if self.eye.is_some() && self.eye == self.target {
            query.fault("target", "must differ from eye");
        }
        if let (Some(near), Some(far)) = (self.near, self.far)
            && far <= near
        {
            query.fault("far", format!("must be greater than near ({near}), is {far}"));
        }
    }
}

impl Knobs {
    /// Reads them out of a query that may hold other parameters too.
    pub fn read(query: &mut Query) -> Self {
        let limits = Limits::default();
        Self {
            shadow_resolution: query.integer_in("shadow_resolution", 1..=limits.texture_side),
            pcf_taps: query.integer_in("pcf_taps", 1..=limits.shadow_taps),
            search_taps: query.integer_in("search_taps", 1..=limits.shadow_taps),
            filter_taps: query.integer_in("filter_taps", 1..=limits.shadow_taps),
            texture_filter: query.one_of("texture_filter", FILTERS),
            render_scale: query.number_in("render_scale", Self::SCALES),
        }
    }
}

/// A side of a picture. One that is too long is the plan's matter, which says what moves the limit.
fn side(text: &str) -> Result<u32, String> {
    let pixels = integer(text)?;
    if pixels == 0 { in_range(pixels, &(1..=Limits::default().picture_side)) } else { Ok(pixels) }
}

fn output(text: &str) -> Result<Output, String> {
    match outputs().find(|(word, _)| *word == text) {
        Some((_, output)) => Ok(output),
        None => Err(not_one_of(text, outputs().map(|(word, _)| word))),
    }
}

impl Output {
    /// What a query calls it.
    #[must_use]
    pub fn word(self) -> &'static str {
        outputs().find(|(_, output)| *output == self).map_or("", |(word, _)| word)
    }

    /// Every output that a query can name.
    #[must_use]
    pub fn all() -> Vec<Self> {
        outputs().map(|(_, output)| output).collect()
    }

    /// Those that show the scene, not a stage of the pipeline.
    #[must_use]
    pub fn of_the_scene() -> Vec<Self> {
        OUTPUTS.iter().map(|(_, output)| *output).collect()
    }

    /// A list of words with commas between, none of them twice.
    ///
    /// # Errors
    /// What is wrong with it, for the client.
    pub fn list(text: &str) -> Result<Vec<Self>, String> {
        let mut outputs = Vec::new();
        for word in text.split(',').map(str::trim) {
            let output = output(word)?;
            if outputs.contains(&output) {
                return Err(format!("names {word} more than once"));
            }
            outputs.push(output);
        }
        Ok(outputs)
    }
}

/// `yaw,pitch[,distance]`
fn orbit(text: &str) -> Result<Orbit, String> {
    let (yaw_deg, pitch_deg, distance) = match *numbers(text)?.as_slice() {
        [yaw, pitch] => (yaw, pitch, None),
        [yaw, pitch, distance] => (yaw, pitch, Some(positive(distance)?)),
        _ => {
            return Err(format!("must be yaw,pitch or yaw,pitch,distance, is {text:?}"));
        }
    };
    in_range(pitch_deg, &(-90.0..=90.0)).map_err(|detail| format!("pitch {detail}"))?;
    Ok(Orbit { yaw_deg, pitch_deg, distance })
}

/// `transparent`, `rrggbb`, or a name; a name of six hexadecimal digits reads as a colour.
fn background(text: &str) -> Result<BackgroundRequest, String> {
    match text {
        "" => Err("must be transparent, rrggbb or the name of a background, is empty".to_owned()),
        "transparent" => Ok(BackgroundRequest::Transparent),
        _ => {
            Ok(colour(text)
                .map_or_else(|| BackgroundRequest::Named(text.to_owned()), BackgroundRequest::Color))
        }
    }
}

/// Linear RGB of `rrggbb`.
fn colour(text: &str) -> Option<Vec3> {
    if text.len() != 6 || !text.bytes().all(|byte| byte.is_ascii_hexdigit()) {
        return None;
    }
    let [_, r, g, b] = u32::from_str_radix(text, 16).ok()?.to_be_bytes();
    #[expect(clippy::cast_possible_truncation, reason = "f64 to f32 rounds; the value lies in 0–1")]
    let linear = |code: u8| linear_from_srgb8(code) as f32;
    Some(Vec3::new(linear(r), linear(g), linear(b)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::Elisions;
    use glam::DVec3;
    use proptest::prelude::*;

    fn faults(pairs: &[(&str, &str)]) -> Vec<String> {
        let faults = FrameRequest::parse(pairs.iter().copied()).expect_err("a fault");
        faults.iter().map(ToString::to_string).collect()
    }

    #[test]
    fn an_empty_query_asks_for_nothing() {
        assert_eq!(FrameRequest::parse([]), Ok(FrameRequest::default()));
    }

    #[test]
    fn every_parameter_is_read() {
        let request = FrameRequest::parse([
            ("width", "320"),
            ("height", "200"),
            ("samples", "8"),
            ("shadow_resolution", "512"),
            ("pcf_taps", "9"),
            ("search_taps", "10"),
            ("filter_taps", "11"),
            ("texture_filter", "bilinear"),
            ("render_scale", "0.5"),
            ("max_ms", "16.5"),
            ("t", "-1.5"),
            ("quality", "90"),
            ("output", "depth"),
            ("shading", "unlit"),
            ("target", "0, 1,2"),
            ("near", "0.5"),
            ("far", "10"),
            ("ortho", "3"),
            ("orbit", "30,20,5"),
            ("background", "ff0000"),
            ("elide", "none"),
        ]);
        let expected = FrameRequest {
            width: Some(320),
            height: Some(200),
            samples: Some(8),
            knobs: Knobs {
                shadow_resolution: Some(512),
                pcf_taps: Some(9),
                search_taps: Some(10),
                filter_taps: Some(11),
                texture_filter: Some(Filter::Bilinear),
                render_scale: Some(0.5),
            },
            budget: Some(Budget::MaxMs(16.5)),
            t: -1.5,
            quality: Some(90),
            output: Output::Depth,
            shading: Some(Shading::Unlit),
            eye: None,
            target: Some(DVec3::new(0.0, 1.0, 2.0)),
            fov_y_deg: None,
            near: Some(0.5),
            far: Some(10.0),
            ortho_height: Some(3.0),
            orbit: Some(Orbit { yaw_deg: 30.0, pitch_deg: 20.0, distance: Some(5.0) }),
            turn_deg: 0.0,
            background: Some(BackgroundRequest::Color(Vec3::X)),
            elide: Some(Elisions::NONE),
        };
        assert_eq!(request, Ok(expected));
    }

    #[test]
    fn all_faults_come_at_once() {
        let faults = faults(&[("width", "0"), ("fov", "200"), ("samples", "3"), ("zoom", "2")]);
        assert_eq!(faults.len(), 4, "{faults:?}");
        assert_eq!(faults[1], "samples: must be one of 1, 2, 4, 8, 16, is \"3\"");
        assert_eq!(faults[2], "fov: must lie in [0.001, 179.9], is 200");
    }

    #[test]
    fn eye_and_orbit_contradict_each_other() {
        let faults = faults(&[("eye", "1,2,3"), ("orbit", "0,0")]);
        assert_eq!(faults, ["orbit: cannot be given together with eye: both place the camera"]);
    }

    #[test]
    fn one_budget_is_enough() {
        let faults = faults(&[("preset", "draft"), ("max_error", "0.1")]);
        assert_eq!(faults, ["max_error: cannot be given together with preset: both choose the settings"]);
        let request = FrameRequest::parse([("preset", "high"), ("samples", "2")]).expect("a good query");
        assert_eq!(request.budget, Some(Budget::Preset(Preset::High)));
    }

    #[test]
    fn a_list_of_outputs_names_each_once() {
        assert_eq!(Output::list("depth, color"), Ok(vec![Output::Depth, Output::Color]));
        assert_eq!(Output::list("depth,depth"), Err("names depth more than once".to_owned()));
        let fault = Output::list("color,").unwrap_err();
        assert_eq!(
            fault,
            "must be one of color, depth, normal, albedo, instance, wireframe, ids, shadow_map, tiles, shaded, is \"\""
        );
        assert!(Output::all().into_iter().all(|output| Output::list(output.word()) == Ok(vec![output])));
    }

    #[test]
    fn a_turn_adds_to_the_yaw_that_is_there() {
        let orbiting = FrameRequest::parse([("orbit", "30,20")]).expect("a query").turned(45.0);
        assert_eq!(orbiting.orbit, Some(Orbit { yaw_deg: 75.0, pitch_deg: 20.0, distance: None }));
        assert_eq!((orbiting.turn_deg, FrameRequest::default().turned(45.0).turn_deg), (0.0, 45.0));
    }

    #[test]
    fn a_side_of_nothing_names_the_largest_picture() {
        let faults = faults(&[("width", "0"), ("height", "0")]);
        assert_eq!(faults, ["width: must lie in [1, 16384], is 0", "height: must lie in [1, 16384], is 0"]);
    }

    #[test]
    fn a_width_beyond_any_picture_is_left_to_the_plan() {
        let request = FrameRequest::parse([("width", "123456789012")]).expect("a query");
        assert_eq!(request.width, Some(u32::MAX));
    }

    #[test]
    fn six_hexadecimal_digits_are_a_colour_and_anything_else_a_name() {
        let read = |text: &str| FrameRequest::parse([("background", text)]).expect("a query").background;
        assert_eq!(read("00FF00"), Some(BackgroundRequest::Color(Vec3::Y)));
        assert_eq!(read("night"), Some(BackgroundRequest::Named("night".to_owned())));
        assert_eq!(read("transparent"), Some(BackgroundRequest::Transparent));
    }

    proptest! {
        #[test]
        fn no_query_panics(name in "width|height|samples|t|quality|output|shading|eye|orbit|background|elide|x", value in ".{0,40}") {
            let _ = FrameRequest::parse([(name.as_str(), value.as_str())]);
        }
    }
}
