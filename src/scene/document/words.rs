//! The words a document may use, each with what it means.

use crate::model::texture::ColorSpace;
use crate::model::{Filter, Shading, Wrap};
use crate::scene::{Cull, ShadowCull, ShadowFilter};

/// A value that documents and queries write as one word of a fixed list.
pub trait Word: Copy + PartialEq + 'static {
    /// Every word with its value.
    const WORDS: &'static [(&'static str, Self)];

    /// The value of `word`.
    #[must_use]
    fn from_word(word: &str) -> Option<Self> {
        Self::WORDS.iter().find(|(known, _)| *known == word).map(|(_, value)| *value)
    }

    /// The word for this value.
    #[must_use]
    fn word(self) -> &'static str {
        Self::WORDS.iter().find(|(_, value)| *value == self).map_or("", |(word, _)| *word)
    }
}

/// `"a", "b", "c"`: the words of `W`, for messages.
#[must_use]
pub fn word_list<W: Word>() -> String {
    let words: Vec<_> = W::WORDS.iter().map(|(word, _)| format!("{word:?}")).collect();
    words.join(", ")
}

impl Word for Shading {
    const WORDS: &'static [(&'static str, Self)] = &[
        ("blinn_phong", Self::BlinnPhong),
        ("lambert", Self::Lambert),
        ("unlit", Self::Unlit),
        ("vertex_color", Self::VertexColor),
        ("normal", Self::Normal),
    ];
}

impl Word for Filter {
    const WORDS: &'static [(&'static str, Self)] =
        &[("nearest", Self::Nearest), ("bilinear", Self::Bilinear), ("trilinear", Self::Trilinear)];
}

impl Word for Wrap {
    const WORDS: &'static [(&'static str, Self)] =
        &[("repeat", Self::Repeat), ("clamp", Self::Clamp), ("mirror", Self::Mirror)];
}

impl Word for ColorSpace {
    const WORDS: &'static [(&'static str, Self)] = &[("srgb", Self::Srgb), ("linear", Self::Linear)];
}

impl Word for Cull {
    const WORDS: &'static [(&'static str, Self)] =
        &[("back", Self::Back), ("front", Self::Front), ("none", Self::None)];
}

impl Word for ShadowCull {
    const WORDS: &'static [(&'static str, Self)] =
        &[("none", Self::None), ("front", Self::Front), ("back", Self::Back)];
}

/// `None` is the word `none`: the light casts no shadow.
impl Word for Option<ShadowFilter> {
    const WORDS: &'static [(&'static str, Self)] = &[
        ("none", None),
        ("hard", Some(ShadowFilter::Hard)),
        ("pcf", Some(ShadowFilter::Pcf)),
        ("pcss", Some(ShadowFilter::Pcss)),
    ];
}
