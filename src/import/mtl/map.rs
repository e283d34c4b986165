//! `map_… -options name -options`.

use crate::import::notes::{Notes, quoted};
use crate::import::text::name_without_comment;
use crate::limits::MAX_MAP_NAME_BYTES;

/// A texture that a material names, and how it is laid on.
#[derive(Debug, Clone, PartialEq)]
pub struct MapRef {
    /// As the file has it, path and all.
    pub file: String,
    /// Where, from 1.
    pub line: u64,
    /// `-s`: texture coordinates are scaled by this,
    pub scale: [f64; 2],
    /// `-o`: and then moved by this.
    pub offset: [f64; 2],
    /// `-clamp on`: the picture does not repeat.
    pub clamp: bool,
    /// `-imfchan`: the one channel that is used, 0–3 for r, g, b and m (alpha).
    pub channel: Option<usize>,
    /// `-bm`: multiplies the height of a bump map.
    pub bump_multiplier: Option<f64>,
}

impl MapRef {
    /// Reads what stands behind the keyword; `None`, noted, when it names no file.
    pub(super) fn read(rest: &str, line: u64, notes: &mut Notes) -> Option<Self> {
        let mut map = Self {
            file: String::new(),
            line,
            scale: [1.0; 2],
            offset: [0.0; 2],
            clamp: false,
            channel: None,
            bump_multiplier: None,
        };
        let rest = map.take_options(name_without_comment(rest), notes);
        if rest.len() > MAX_MAP_NAME_BYTES {
            notes.add(line, "a file name is too long");
            return None;
        }
        let (name, options) = split_trailing_options(rest);
        map.take_options(options, notes);
        map.file = unquoted(name).to_owned();
        if map.file.is_empty() {
            notes.add(line, "a map names no file");
            return None;
        }
        Some(map)
    }

    /// Applies the options that `text` begins with and returns what follows them.
    fn take_options<'a>(&mut self, mut text: &'a str, notes: &mut Notes) -> &'a str {
        while let Some((setting, rest)) = Setting::read(text) {
            self.apply(setting, notes);
            text = rest;
        }
        text
    }

    fn apply(&mut self, setting: Setting, notes: &mut Notes) {
        match setting {
            Setting::Scale(scale) => self.scale = scale,
            Setting::Offset(offset) => self.offset = offset,
            Setting::Clamp(clamp) => self.clamp = clamp,
            Setting::Channel(channel) => self.channel = Some(channel),
            Setting::BumpMultiplier(multiplier) => self.bump_multiplier = Some(multiplier),
            Setting::Unused(option) => {
                notes.add(self.line, &format!("the map option {} is not used", quoted(&option)))
            }
        }
    }
}

/// What an option says.
#[derive(Debug, Clone, PartialEq)]
enum Setting {
    Scale([f64; 2]),
    Offset([f64; 2]),
    Clamp(bool),
    Channel(usize),
    BumpMultiplier(f64),
    /// One that changes nothing here, or has no valid value.
    Unused(String),
}

impl Setting {
    /// The option that `text` begins with and what follows it; `None`: it begins with none.
    fn read(text: &str) -> Option<(Self, &str)> {
        let (option, rest) = word(text)?;
        let unused = || Self::Unused(option.to_owned());
        let one_word = || word(rest).unwrap_or(("", rest));
        match option {
            "-s" => Some(numbers(rest, 1.0, Self::Scale, unused)),
            "-o" => Some(numbers(rest, 0.0, Self::Offset, unused)),
            "-t" => Some(numbers(rest, 0.0, |_| unused(), unused)),
            "-mm" => {
                let (_, rest) = take_numbers::<2>(rest);
                Some((unused(), rest))
            }
            "-bm" => {
                let (taken, rest) = take_numbers::<1>(rest);
                Some((taken[0].map_or_else(unused, Self::BumpMultiplier), rest))
            }
            "-clamp" => {
                let (value, rest) = one_word();
                Some((Self::Clamp(value.eq_ignore_ascii_case("on")), rest))
            }
            "-imfchan" => {
                let (value, rest) = one_word();
                let channel = ["r", "g", "b", "m"].iter().position(|name| value.eq_ignore_ascii_case(name));
                Some((channel.map_or_else(unused, Self::Channel), rest))
            }
            "-blendu" | "-blendv" | "-cc" | "-texres" | "-boost" | "-type" => Some((unused(), one_word().1)),
            _ => None,
        }
    }
}

/// An option with one to three numbers, the third of which (depth) has no use on a surface; missing
/// ones are `default`.
fn numbers(
    rest: &str,
    default: f64,
    setting: impl FnOnce([f64; 2]) -> Setting,
    without: impl FnOnce() -> Setting,
) -> (Setting, &str) {
    let ([u, v, _], rest) = take_numbers::<3>(rest);
    match u {
        None => (without(), rest),
        Some(u) => (setting([u, v.unwrap_or(default)]), rest),
    }
}

/// Up to N finite numbers that `text` begins with, and what follows them.
fn take_numbers<const N: usize>(mut text: &str) -> ([Option<f64>; N], &str) {
    let mut taken = [None; N];
    for slot in &mut taken {
        let Some((first, rest)) = word(text) else {
            break;
        };
        *slot = first.parse().ok().filter(|value: &f64| value.is_finite());
        if slot.is_none() {
            break;
        }
        text = rest;
    }
    (taken, text)
}

/// The first word of `text` and the rest of it.
fn word(text: &str) -> Option<(&str, &str)> {
    let text = text.trim_start();
    let end = text.find(|c: char| c.is_ascii_whitespace()).unwrap_or(text.len());
    (end > 0).then(|| (&text[..end], text[end..].trim_start()))
}

/// A name with blanks, and the options behind it: from the first blank on behind which there is
/// nothing but options.
fn split_trailing_options(text: &str) -> (&str, &str) {
    let blanks = text.match_indices(|c: char| c.is_ascii_whitespace()).map(|(at, _)| at);
    let only_options = |at: &usize| {
        let mut tail = text[*at..].trim_start();
        while let Some((_, rest)) = Setting::read(tail) {
            tail = rest;
        }
        tail.is_empty()
    };
    let (name, options) = text.split_at(blanks.clone().find(only_options).unwrap_or(text.len()));
    (name.trim_end(), options)
}

/// Without the quotes that some exporters put around names.
fn unquoted(name: &str) -> &str {
    name.strip_prefix('"').and_then(|name| name.strip_suffix('"')).unwrap_or(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> MapRef {
        MapRef::read(text, 1, &mut Notes::default()).unwrap()
    }

    #[test]
    fn names_keep_their_blanks_and_paths() {
        for name in [
            "a.png",
            "my wood.png",
            r"..\..\tex 1.png",
            r"C:\x\y.png",
            "a -s.png",
            "a - b.png",
            "-x.png",
            "2.png",
        ] {
            assert_eq!(read(name).file, name);
        }
        assert_eq!(read("\"my wood.png\"").file, "my wood.png");
        assert_eq!(read("wood#2.png # the best").file, "wood#2.png");
    }

    #[test]
    fn options_stand_before_and_behind_the_name() {
        let expected = MapRef {
            file: "my wood.png".to_owned(),
            line: 1,
            scale: [2.0, 3.0],
            offset: [0.5, 0.0],
            clamp: true,
            channel: Some(3),
            bump_multiplier: Some(0.25),
        };
        assert_eq!(read("-s 2 3 1 -o 0.5 -clamp on -bm 0.25 -imfchan m my wood.png"), expected);
        assert_eq!(read("my wood.png -s 2 3 1 -o 0.5 -clamp on -bm 0.25 -imfchan m"), expected);
        assert_eq!(read("-s 2 3 -clamp on\tmy wood.png -o 0.5 0 0 -imfchan m -bm 0.25"), expected);
    }

    #[test]
    fn options_without_use_are_noted() {
        let mut notes = Notes::default();
        let map =
            MapRef::read("-blendu on -mm 0 1 -texres 512 -t 1 1 1 -bm nan -imfchan l a.png", 1, &mut notes);
        assert_eq!(map.unwrap().file, "nan -imfchan l a.png");
        assert_eq!(notes.finish().len(), 5);
    }

    #[test]
    fn a_map_without_a_name_is_noted() {
        for text in ["", "-s 1 1 1", "\"\"", "# x"] {
            let mut notes = Notes::default();
            assert_eq!(MapRef::read(text, 1, &mut notes), None, "{text}");
            assert_eq!(notes.finish().len(), 1);
        }
        assert_eq!(MapRef::read(&"a -bm 1 ".repeat(1 << 20), 1, &mut Notes::default()), None);
    }
}
