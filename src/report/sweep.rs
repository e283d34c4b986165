//! What is measured: which knobs a scene has, and at which settings.

use super::setting::{Knob, Setting};
use crate::model::texture::Filter;
use crate::plan::Plan;
use crate::plan::request::Preset;
use serde::Serialize;

/// A setting to measure, and why.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidate {
    /// The setting.
    pub setting: Setting,
    /// Every family that it belongs to.
    pub families: Vec<Family>,
}

/// Why a setting is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Family {
    /// As the scene has it.
    Default,
    /// The default once more, under another name: what two of the same differ by is what nothing can be told
    /// from.
    Control,
    /// A preset.
    Preset(Preset),
    /// The default with one knob turned.
    Knob(Knob),
    /// Several knobs together.
    Mixed,
}

/// A knob that is not turned.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct LeftOut {
    /// Which.
    pub knob: Knob,
    /// Why.
    pub reason: &'static str,
}

/// The settings of a report, in the order in which they matter.
#[derive(Clone, Debug, Default)]
pub struct Sweep {
    /// The default first, its control second.
    pub candidates: Vec<Candidate>,
    /// Knobs that are turned.
    pub knobs: Vec<Knob>,
    /// The others, each with its reason.
    pub left_out: Vec<LeftOut>,
}

impl Sweep {
    /// Of the frame that `plan` draws, with the knobs of `asked`; of none: with all.
    #[must_use]
    pub fn of(plan: &Plan, asked: &[Knob]) -> Self {
        let mut sweep = Self::default();
        for knob in Knob::ALL {
            let wanted = asked.is_empty() || asked.contains(&knob);
            match knob.check(plan) {
                Ok(()) if wanted => sweep.knobs.push(knob),
                Ok(()) => sweep.left_out.push(LeftOut { knob, reason: "it was not asked for" }),
                Err(reason) => sweep.left_out.push(LeftOut { knob, reason }),
            }
        }
        let default = Setting::of(plan);
        sweep.candidates.push(Candidate { setting: default, families: vec![Family::Default] });
        sweep.candidates.push(Candidate { setting: default, families: vec![Family::Control] });
        for (_, preset) in Preset::WORDS {
            sweep.add(Setting::of_preset(preset, plan), Family::Preset(preset));
        }
        for knob in sweep.knobs.clone() {
            for setting in knob.turned(default, plan) {
                sweep.add(setting, Family::Knob(knob));
            }
        }
        for setting in mixed(plan, &sweep.knobs) {
            sweep.add(setting, Family::Mixed);
        }
        sweep
    }

    /// Adds a setting, or to the families of the one that it is.
    fn add(&mut self, setting: Setting, family: Family) {
        let known = self.candidates.iter_mut().find(|known| known.setting == setting);
        match known {
            Some(known) => known.families.push(family),
            None => self.candidates.push(Candidate { setting, families: vec![family] }),
        }
    }
}

/// Settings between the presets: what is coarse in one way is coarse in the others too.
#[must_use]
pub fn mixed(plan: &Plan, knobs: &[Knob]) -> Vec<Setting> {
    let fine = Setting::of_preset(Preset::Normal, plan);
    let coarse_taps = Setting {
        pcf_taps: fine.pcf_taps.map(|_| 8),
        pcss_taps: fine.pcss_taps.map(|_| [8, 16]),
        texture_filter: fine.texture_filter.map(|_| Filter::Bilinear),
        ..fine
    };
    let scales: &[f64] = if knobs.contains(&Knob::RenderScale) { &[0.5, 0.75, 1.0, 1.5] } else { &[1.0] };
    let samples: &[u32] = if knobs.contains(&Knob::Samples) { &[1, 2, 4, 8] } else { &[4] };
    let mut settings = Vec::new();
    for &render_scale in scales {
        for &samples in samples {
            for (taps, resolution) in [(coarse_taps, 512), (fine, 1024)] {
                let shadow_resolution = taps.shadow_resolution.map(|_| resolution);
                settings.push(Setting { samples, render_scale, shadow_resolution, ..taps });
            }
        }
    }
    settings
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::limits::Limits;
    use crate::plan::FrameRequest;
    use crate::scene::NewScene;
    use serde_json::{Value, json};
    use std::sync::Arc;

    fn plan(document: Value) -> Plan {
        let new = NewScene { document: Some(document), ..NewScene::default() };
        let scene = Arc::new(new.compile(&Limits::default()).expect("a sound scene"));
        Plan::new(&scene, &FrameRequest::default(), &Limits::default()).expect("a plan")
    }

    fn flat() -> Value {
        json!({
            "lights": {}, "materials": { "m": { "shading": "unlit" } },
            "meshes": { "t": { "type": "triangles", "positions": [[0, 0, 0], [1, 0, 0], [0, 1, 0]] } },
            "instances": { "t": { "mesh": "t", "material": "m" } },
        })
    }

    #[test]
    fn a_flat_triangle_has_no_knob_of_shadows_or_textures() {
        let sweep = Sweep::of(&plan(flat()), &[]);
        assert_eq!(sweep.knobs, [Knob::Samples, Knob::RenderScale]);
        assert_eq!(sweep.left_out.len(), 4);
        let none =
            |c: &Candidate| c.setting.shadow_resolution.is_none() && c.setting.texture_filter.is_none();
        assert!(sweep.candidates.iter().all(none));
    }

    #[test]
    fn no_setting_is_measured_twice_but_the_control() {
        let sweep = Sweep::of(&plan(flat()), &[]);
        let settings = || sweep.candidates.iter().map(|candidate| candidate.setting);
        for (at, setting) in settings().enumerate() {
            let same = settings().skip(at + 1).filter(|other| *other == setting).count();
            assert_eq!(same, usize::from(at == 0), "{setting:?}");
        }
        let default = &sweep.candidates[0];
        assert!(default.families.contains(&Family::Knob(Knob::Samples)), "{default:?}");
        assert!(default.families.contains(&Family::Preset(Preset::Normal)), "{default:?}");
    }

    #[test]
    fn only_what_is_asked_for_is_turned() {
        let sweep = Sweep::of(&plan(flat()), &[Knob::Samples]);
        assert_eq!(sweep.knobs, [Knob::Samples]);
        assert!(sweep.left_out.iter().any(|left| left.knob == Knob::RenderScale));
    }
}
