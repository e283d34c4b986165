//! One material, line by line.

use super::{MapRef, MtlMaps, MtlMaterial};
use crate::import::notes::{Notes, quoted, quoted_line};
use crate::import::text::without_comment;
use crate::limits::MAX_COORDINATE;
use crate::model::Material;
use glam::{DVec3, Vec3};

/// The channel that `-imfchan m` names.
const ALPHA: usize = 3;

/// A material as far as its lines are read.
pub(super) struct Draft {
    name: String,
    line: u64,
    ambient: Option<Vec3>,
    diffuse: Option<Vec3>,
    specular: Option<Vec3>,
    emissive: Option<Vec3>,
    shininess: Option<f32>,
    opacity: Option<f32>,
    /// `Tr` and where it stands.
    transparency: Option<(f32, u64)>,
    ambient_map: Option<MapRef>,
    maps: MtlMaps,
}

impl Draft {
    pub(super) fn new(name: &str, line: u64) -> Self {
        Self {
            name: name.to_owned(),
            line,
            ambient: None,
            diffuse: None,
            specular: None,
            emissive: None,
            shininess: None,
            opacity: None,
            transparency: None,
            ambient_map: None,
            maps: MtlMaps::default(),
        }
    }

    /// Takes in one line.
    pub(super) fn line(&mut self, keyword: &str, rest: &str, line: u64, notes: &mut Notes) {
        let values = Values { keyword, rest: without_comment(rest), line };
        match keyword.to_ascii_lowercase().as_str() {
            "ka" => set(&mut self.ambient, values.color(notes)),
            "kd" => set(&mut self.diffuse, values.color(notes)),
            "ks" => set(&mut self.specular, values.color(notes)),
            "ke" => set(&mut self.emissive, values.color(notes)),
            "ns" => set(&mut self.shininess, values.number(f32::MAX, notes)),
            "d" => set(&mut self.opacity, values.opacity(notes)),
            "tr" => set(&mut self.transparency, values.number(1.0, notes).map(|tr| (tr, line))),
            "map_ka" => set(&mut self.ambient_map, MapRef::read(rest, line, notes)),
            "map_kd" => set(&mut self.maps.diffuse, MapRef::read(rest, line, notes)),
            "map_ks" => set(&mut self.maps.specular, MapRef::read(rest, line, notes)),
            "map_ke" => set(&mut self.maps.emissive, MapRef::read(rest, line, notes)),
            "map_d" => set(&mut self.maps.opacity, MapRef::read(rest, line, notes)),
            "bump" | "map_bump" => set(&mut self.maps.bump, MapRef::read(rest, line, notes)),
            "norm" => set(&mut self.maps.normal, MapRef::read(rest, line, notes)),
            "illum" => {}
            _ => notes.add_keyed(line, keyword, || format!("{} is not used", quoted_line(keyword, rest))),
        }
    }

    /// The material that all its lines make.
    pub(super) fn finish(mut self, notes: &mut Notes) -> MtlMaterial {
        self.sort_out_maps(notes);
        let default = Material::default();
        let beside = |map: &Option<MapRef>, absent: Vec3| if map.is_some() { Vec3::ONE } else { absent };
        let diffuse = match self.diffuse {
            Some(Vec3::ZERO) | None => beside(&self.maps.diffuse, self.diffuse.unwrap_or(default.diffuse)),
            Some(diffuse) => diffuse,
        };
        let material = Material {
            diffuse,
            specular: self.specular.unwrap_or(beside(&self.maps.specular, default.specular)),
            emissive: self.emissive.unwrap_or(beside(&self.maps.emissive, default.emissive)),
            shininess: self.shininess.unwrap_or(default.shininess),
            ambient: self.ambient.filter(|ambient| self.is_meant(*ambient, diffuse)),
            opacity: self.settled_opacity(notes),
            bump_scale: self.bump_scale(default.bump_scale),
            ..default
        };
        MtlMaterial { name: self.name, line: self.line, material, maps: self.maps }
    }

    /// Drops and moves maps that are named under the wrong keyword.
    fn sort_out_maps(&mut self, notes: &mut Notes) {
        let maps = &mut self.maps;
        let is_same = |a: &MapRef, b: &Option<MapRef>| b.as_ref().is_some_and(|b| a.file == b.file);
        if let Some(bump) = maps.bump.take_if(|bump| is_normal_map(bump) || is_same(bump, &maps.normal)) {
            notes.add(bump.line, "a bump map that is a normal map by its name is used as one");
            maps.normal.get_or_insert(bump);
        }
        // The alpha of a diffuse map counts as it is. As `map_d` it would count twice.
        let is_alpha = |map: &MapRef| map.channel.is_none_or(|channel| channel == ALPHA);
        if let Some(map) = maps.opacity.take_if(|map| is_alpha(map) && is_same(map, &maps.diffuse))
            && map.channel.is_none()
        {
            notes.add(map.line, "`map_d` with the picture of `map_Kd` is left out: its alpha counts already");
        }
        if let Some(map) = self.ambient_map.as_ref().filter(|map| !is_same(map, &maps.diffuse)) {
            notes.add(map.line, "`map_Ka` is not used; ambient light takes the diffuse map");
        }
        for map in [&maps.diffuse, &maps.specular, &maps.emissive, &maps.normal].into_iter().flatten() {
            if map.channel.is_some() {
                notes.add(map.line, "`-imfchan` is used for opacity and bump maps only");
            }
        }
    }

    /// Whether a `Ka` says something; [`read`](super::read) tells why most do not.
    fn is_meant(&self, ambient: Vec3, diffuse: Vec3) -> bool {
        let is_grey = ambient.x == ambient.y && ambient.y == ambient.z;
        let is_placeholder = ambient == Vec3::ZERO || ambient == Vec3::ONE || ambient == diffuse;
        !is_placeholder && self.ambient_map.is_none() && !(is_grey && self.maps.diffuse.is_some())
    }

    fn settled_opacity(&self, notes: &mut Notes) -> f32 {
        match (self.opacity, self.transparency) {
            (Some(opacity), _) => {
                if opacity == 0.0 {
                    notes.add(self.line, &format!("{} is invisible (`d 0`)", quoted(&self.name)));
                }
                opacity
            }
            (None, Some((1.0, line))) => {
                notes.add(line, "`Tr 1` without `d` is read as opaque");
                1.0
            }
            (None, Some((transparency, _))) => 1.0 - transparency,
            (None, None) => 1.0,
        }
    }

    fn bump_scale(&self, default: f32) -> f32 {
        let multiplier = self.maps.bump.as_ref().and_then(|map| map.bump_multiplier).unwrap_or(1.0);
        #[expect(clippy::cast_possible_truncation, reason = "rounding to f32 is meant; clamped to its range")]
        let multiplier = multiplier.clamp(-MAX_COORDINATE, MAX_COORDINATE) as f32;
        default * multiplier
    }
}

/// A later line wins, unless it makes no sense.
fn set<T>(slot: &mut Option<T>, value: Option<T>) {
    if value.is_some() {
        *slot = value;
    }
}

/// Exporters that know no `norm` write `map_Bump` for normal maps too.
fn is_normal_map(map: &MapRef) -> bool {
    let name = map.file.rsplit(['/', '\\']).next().unwrap_or(&map.file);
    map.channel.is_none() && name.to_ascii_lowercase().contains("normal")
}

/// The numbers of a line.
struct Values<'a> {
    keyword: &'a str,
    rest: &'a str,
    line: u64,
}

impl Values<'_> {
    /// One number for grey, or three; negative ones count as 0.
    fn color(&self, notes: &mut Notes) -> Option<Vec3> {
        let mut words = self.rest.split_ascii_whitespace().map(number);
        let color = match (words.next(), words.next(), words.next(), words.next()) {
            (Some(Some(grey)), None, ..) => DVec3::splat(grey),
            (Some(Some(r)), Some(Some(g)), Some(Some(b)), None) => DVec3::new(r, g, b),
            _ => {
                self.note(notes, "takes one number or three");
                return None;
            }
        };
        if color.min_element() < 0.0 {
            self.note(notes, "counts as 0 where it is below");
        }
        Some(color.max(DVec3::ZERO).as_vec3())
    }

    /// One number from 0 to `most`, clamped.
    fn number(&self, most: f32, notes: &mut Notes) -> Option<f32> {
        self.number_in(self.rest, most, notes)
    }

    /// `[-halo] opacity`
    fn opacity(&self, notes: &mut Notes) -> Option<f32> {
        match self.rest.strip_prefix("-halo") {
            Some(rest) => {
                notes.add(self.line, "`-halo` is not used");
                self.number_in(rest, 1.0, notes)
            }
            None => self.number(1.0, notes),
        }
    }

    fn number_in(&self, text: &str, most: f32, notes: &mut Notes) -> Option<f32> {
        let mut words = text.split_ascii_whitespace().map(number);
        let (Some(Some(value)), None) = (words.next(), words.next()) else {
            self.note(notes, "takes one number");
            return None;
        };
        let clamped = value.clamp(0.0, f64::from(most));
        if value != clamped {
            self.note(notes, &format!("counts as {clamped}"));
        }
        #[expect(clippy::cast_possible_truncation, reason = "rounding to f32 is meant; clamped to its range")]
        Some(clamped as f32)
    }

    /// Notes what becomes of this line.
    fn note(&self, notes: &mut Notes, what: &str) {
        notes.add(self.line, &format!("{} {what}", quoted_line(self.keyword, self.rest)));
    }
}

/// A number in the range of coordinates.
fn number(word: &str) -> Option<f64> {
    word.parse().ok().filter(|value: &f64| value.abs() <= MAX_COORDINATE)
}
