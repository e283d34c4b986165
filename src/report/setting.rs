//! Settings: points in the space of the knobs.

use crate::model::texture::Filter;
use crate::plan::request::Preset;
use crate::plan::{self, FrameRequest, Knobs, Plan};
use crate::scene::document::words::Word;
use serde::Serialize;
use serde::ser::{SerializeMap, Serializer};

/// Every knob turned to some value. `None`: as the scene has it, or the scene lacks what it is for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setting {
    /// Samples a pixel.
    pub samples: u32,
    /// Texels along a side of every shadow map.
    pub shadow_resolution: Option<u32>,
    /// Taps of every PCF.
    pub pcf_taps: Option<u32>,
    /// Taps of every PCSS: of its search for blockers, and of its filter.
    pub pcss_taps: Option<[u32; 2]>,
    /// How textures are sampled.
    pub texture_filter: Option<Filter>,
    /// Drawn pixels along a side of the picture for each of its own.
    pub render_scale: f64,
}

/// What trades error for run time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Knob {
    /// Samples a pixel.
    Samples,
    /// Texels of shadow maps.
    ShadowResolution,
    /// Taps of PCF.
    PcfTaps,
    /// Taps of PCSS.
    PcssTaps,
    /// Pixels drawn for each of the picture.
    RenderScale,
    /// How textures are sampled.
    TextureFilter,
}

/// The largest shadow maps of a sweep hold no more texels than this in one frame.
const MOST_SHADOW_TEXELS: u64 = 1 << 26;

impl Knob {
    /// Every knob, in the order of what they are expected to tell.
    pub const ALL: [Self; 6] = [
        Self::Samples,
        Self::ShadowResolution,
        Self::PcfTaps,
        Self::PcssTaps,
        Self::RenderScale,
        Self::TextureFilter,
    ];

    /// What queries and reports call it.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Samples => "samples",
            Self::ShadowResolution => "shadow_resolution",
            Self::PcfTaps => "pcf_taps",
            Self::PcssTaps => "pcss_taps",
            Self::RenderScale => "render_scale",
            Self::TextureFilter => "texture_filter",
        }
    }

    /// A list of words with commas between.
    ///
    /// # Errors
    /// What is wrong with it, for the client.
    pub fn list(text: &str) -> Result<Vec<Self>, String> {
        let knob = |word: &str| {
            let known = Self::ALL.into_iter().find(|knob| knob.word() == word);
            known.ok_or_else(|| {
                let words = Self::ALL.map(Self::word).join(", ");
                let word: String = word.chars().take(64).collect();
                format!("must be some of {words} with commas between, names {word:?}")
            })
        };
        text.split(',').map(|word| knob(word.trim())).collect()
    }

    /// Why turning it would not change the picture of `plan`, if it would not.
    ///
    /// # Errors
    /// The reason.
    pub fn check(self, plan: &Plan) -> Result<(), &'static str> {
        let filters = || plan.shadows.iter().map(|pass| &pass.filter);
        let maps = || plan.draws.iter().flat_map(|draw| draw.surface.maps());
        let (applies, reason) = match self {
            Self::Samples => (!plan.items.is_empty(), "nothing is in the view"),
            Self::RenderScale => (true, ""),
            Self::ShadowResolution => (!plan.shadows.is_empty(), "no shadow is drawn"),
            Self::PcfTaps => {
                (filters().any(|f| matches!(f, plan::Filter::Pcf { .. })), "no shadow is filtered by PCF")
            }
            Self::PcssTaps => (filters().any(|f| matches!(f, plan::Filter::Pcss(_))), "no shadow is soft"),
            Self::TextureFilter => {
                (maps().any(|map| map.filter != Filter::Nearest), "no texture is filtered")
            }
        };
        if applies { Ok(()) } else { Err(reason) }
    }

    /// `setting` with this knob at each of its values, from the least work to the most.
    #[must_use]
    pub fn turned(self, setting: Setting, plan: &Plan) -> Vec<Setting> {
        let with = |change: &dyn Fn(&mut Setting)| {
            let mut turned = setting;
            change(&mut turned);
            turned
        };
        match self {
            Self::Samples => [1, 2, 4, 8, 16].map(|n| with(&|s| s.samples = n)).to_vec(),
            Self::ShadowResolution => {
                let sides = [256, 512, 1024, 2048, 4096].into_iter();
                let sides = sides.filter(|side| *side <= finest_resolution(plan).max(256));
                sides.map(|side| with(&|s| s.shadow_resolution = Some(side))).collect()
            }
            Self::PcfTaps => [4, 8, 16, 32, 64, 128].map(|n| with(&|s| s.pcf_taps = Some(n))).to_vec(),
            Self::PcssTaps => [[4, 4], [8, 8], [18, 36], [32, 64], [64, 128]]
                .map(|taps| with(&|s| s.pcss_taps = Some(taps)))
                .to_vec(),
            Self::RenderScale => {
                [0.25, 0.5, 0.75, 1.0, 1.5, 2.0].map(|n| with(&|s| s.render_scale = n)).to_vec()
            }
            Self::TextureFilter => [Filter::Nearest, Filter::Bilinear, Filter::Trilinear]
                .map(|filter| with(&|s| s.texture_filter = Some(filter)))
                .to_vec(),
        }
    }

    /// `setting` with this knob turned to where `from` has it.
    #[must_use]
    pub fn taken(self, setting: Setting, from: Setting) -> Setting {
        match self {
            Self::Samples => Setting { samples: from.samples, ..setting },
            Self::ShadowResolution => Setting { shadow_resolution: from.shadow_resolution, ..setting },
            Self::PcfTaps => Setting { pcf_taps: from.pcf_taps, ..setting },
            Self::PcssTaps => Setting { pcss_taps: from.pcss_taps, ..setting },
            Self::RenderScale => Setting { render_scale: from.render_scale, ..setting },
            Self::TextureFilter => Setting { texture_filter: from.texture_filter, ..setting },
        }
    }

    /// What the knob is turned to, as a number that error is expected to be a power of: samples, taps, or the
    /// size of a texel or a pixel.
    #[must_use]
    pub fn number(self, setting: &Setting) -> Option<f64> {
        match self {
            Self::Samples => Some(f64::from(setting.samples)),
            Self::ShadowResolution => setting.shadow_resolution.map(|side| 1.0 / f64::from(side)),
            Self::PcfTaps => setting.pcf_taps.map(f64::from),
            Self::PcssTaps => setting.pcss_taps.map(|[_, filter]| f64::from(filter)),
            Self::RenderScale => Some(1.0 / setting.render_scale),
            Self::TextureFilter => None,
        }
    }
}

/// The finest shadow maps of a sweep: the largest power of two with which those of `plan` stay within bounds.
fn finest_resolution(plan: &Plan) -> u32 {
    let maps: u64 = plan.shadows.iter().map(|pass| pass.faces().len() as u64).sum();
    let fits = |side: &u32| maps * u64::from(*side) * u64::from(*side) <= MOST_SHADOW_TEXELS;
    [4096, 2048, 1024, 512].into_iter().find(fits).unwrap_or(256)
}

impl Setting {
    /// That of `preset` for `plan`, as long as nothing is measured.
    #[must_use]
    pub fn of_preset(preset: Preset, plan: &Plan) -> Self {
        let finest = finest_resolution(plan);
        let (samples, resolution, pcf, pcss, filter, render_scale) = match preset {
            Preset::Draft => (1, 512, 4, [8, 8], Filter::Bilinear, 0.5),
            Preset::Normal => (4, 2048, 16, [18, 36], Filter::Trilinear, 1.0),
            Preset::High => (8, 4096, 32, [32, 64], Filter::Trilinear, 1.0),
            Preset::Reference => (16, 4096, 128, [64, 128], Filter::Trilinear, 2.0),
        };
        let with = |knob: Knob| knob.check(plan).is_ok();
        Self {
            samples,
            shadow_resolution: with(Knob::ShadowResolution).then_some(resolution.min(finest)),
            pcf_taps: with(Knob::PcfTaps).then_some(pcf),
            pcss_taps: with(Knob::PcssTaps).then_some(pcss),
            texture_filter: with(Knob::TextureFilter).then_some(filter),
            render_scale,
        }
    }

    /// As the scene and the request of `plan` have it.
    #[must_use]
    pub fn of(plan: &Plan) -> Self {
        let knobs = plan.knobs();
        Self {
            samples: plan.samples,
            shadow_resolution: knobs.shadow_resolution,
            pcf_taps: knobs.pcf_taps,
            pcss_taps: knobs.search_taps.zip(knobs.filter_taps).map(|(search, filter)| [search, filter]),
            texture_filter: knobs.texture_filter,
            render_scale: knobs.render_scale.unwrap_or(1.0),
        }
    }

    /// `request` with these settings in place of its own.
    #[must_use]
    pub fn of_request(&self, request: &FrameRequest) -> FrameRequest {
        let knobs = Knobs {
            shadow_resolution: self.shadow_resolution,
            pcf_taps: self.pcf_taps,
            search_taps: self.pcss_taps.map(|[search, _]| search),
            filter_taps: self.pcss_taps.map(|[_, filter]| filter),
            texture_filter: self.texture_filter,
            render_scale: Some(self.render_scale),
        };
        FrameRequest { samples: Some(self.samples), knobs, ..request.clone() }
    }

    /// It as parameters of a frame query.
    #[must_use]
    pub fn parameters(&self) -> Vec<(&'static str, String)> {
        let number = |name: &'static str, value: Option<u32>| value.map(|value| (name, value.to_string()));
        let filter = self.texture_filter.map(|filter| ("texture_filter", filter.word().to_owned()));
        let own = [
            number("samples", Some(self.samples)),
            number("shadow_resolution", self.shadow_resolution),
            number("pcf_taps", self.pcf_taps),
            number("search_taps", self.pcss_taps.map(|[search, _]| search)),
            number("filter_taps", self.pcss_taps.map(|[_, filter]| filter)),
            filter,
            Some(("render_scale", self.render_scale.to_string())),
        ];
        own.into_iter().flatten().collect()
    }
}

/// Its parameters, numbers as numbers.
impl Serialize for Setting {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let parameters = self.parameters();
        let mut map = serializer.serialize_map(Some(parameters.len()))?;
        for (name, value) in parameters {
            // A number, whole or not, stays as it is written.
            match serde_json::from_str::<serde_json::Number>(&value) {
                Ok(number) => map.serialize_entry(name, &number)?,
                Err(_) => map.serialize_entry(name, &value)?,
            }
        }
        map.end()
    }
}
