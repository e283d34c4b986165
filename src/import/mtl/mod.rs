//! MTL → material descriptions.
//!
//! Source: "Material Library File (.mtl)", Wavefront Advanced Visualizer manual, appendix B2; and
//! what exporters write beyond it (`Ke`, `norm`, `map_Ke`).

mod map;
mod material;

pub use map::MapRef;

use super::notes::{Notes, quoted, quoted_line};
use super::text::{self, Lines, keyword_and_rest, name_without_comment};
use super::{Note, TextError};
use crate::limits::Limits;
use crate::model::Material;
use material::Draft;
use std::collections::HashSet;

/// What an MTL file holds.
#[derive(Debug, Clone, PartialEq)]
pub struct Mtl {
    /// Its materials in order, each name once.
    pub materials: Vec<MtlMaterial>,
    /// What was not used as its author may have meant it.
    pub notes: Vec<Note>,
}

/// A material of an MTL file, its maps not yet looked up.
#[derive(Debug, Clone, PartialEq)]
pub struct MtlMaterial {
    /// As `newmtl` names it.
    pub name: String,
    /// Where, from 1.
    pub line: u64,
    /// Everything but the maps, all of which are `None`.
    pub material: Material,
    /// The maps it names.
    pub maps: MtlMaps,
}

/// The maps of a material, one for each of [`Material`]'s.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MtlMaps {
    /// `map_Kd`
    pub diffuse: Option<MapRef>,
    /// `map_Ks`
    pub specular: Option<MapRef>,
    /// `map_Ke`
    pub emissive: Option<MapRef>,
    /// `norm`
    pub normal: Option<MapRef>,
    /// `bump`, `map_Bump`
    pub bump: Option<MapRef>,
    /// `map_d`
    pub opacity: Option<MapRef>,
}

impl MtlMaps {
    /// All that are there.
    pub fn iter(&self) -> impl Iterator<Item = &MapRef> {
        let Self { diffuse, specular, emissive, normal, bump, opacity } = self;
        [diffuse, specular, emissive, normal, bump, opacity].into_iter().flatten()
    }
}

/// Reads an MTL file. Keywords are read without regard to case.
///
/// A material library never breaks a model: a line that makes no sense is noted and left out, and
/// what a material does not say it has from [`Material::default`]. Where the format says less than
/// its users mean:
///
/// - **`Kd`** counts as 1 when it is black or absent beside a `map_Kd`; **`Ks`** and **`Ke`** count
///   as 1 when they are absent beside their maps.
/// - **`Ka`** is a placeholder in most files: exporters write 0, 1, or `Kd` again, which would take
///   all ambient light, wash out every texture, or say nothing. Those three, any grey beside a
///   `map_Kd` (a texture must not go flat in the shade), and any `Ka` with a `map_Ka` leave
///   [`Material::ambient`] absent: the diffuse colour with its map.
/// - **`d`** wins over **`Tr`** = 1 − d. `Tr 1` alone is read as opaque, as MeshLab writes it.
/// - **`map_Bump`** with a picture that is also the `norm`, or has “normal” in its name, is a normal
///   map under the wrong keyword. `-bm` multiplies the default height of a bump map.
/// - **`map_d`** with the picture of `map_Kd` is left out: its alpha counts already.
///
/// Materials beyond [`Limits::entries`] are left out, with a note.
///
/// # Errors
/// Only when it is no text.
pub fn read(bytes: &[u8], limits: &Limits) -> Result<Mtl, TextError> {
    let mut notes = Notes::default();
    let text = text::decode(bytes, &mut notes)?;
    let mut reader = Reader { notes, limit: limits.entries, ..Reader::default() };
    for line in Lines::new(&text) {
        let (keyword, rest) = keyword_and_rest(&line.text);
        if keyword.eq_ignore_ascii_case("newmtl") {
            reader.begin(name_without_comment(rest), line.number);
        } else {
            reader.line(keyword, rest, line.number);
        }
    }
    reader.finish_material();
    Ok(Mtl { materials: reader.materials, notes: reader.notes.finish() })
}

/// What is read so far.
#[derive(Default)]
struct Reader {
    notes: Notes,
    materials: Vec<MtlMaterial>,
    names: HashSet<String>,
    /// Materials there may be.
    limit: usize,
    /// The material that lines belong to.
    draft: Option<Draft>,
}

impl Reader {
    /// Takes in a `newmtl`.
    fn begin(&mut self, name: &str, line: u64) {
        self.finish_material();
        let limit = self.limit;
        if self.names.contains(name) {
            self.notes
                .add_keyed(line, name, || format!("{} is there already; the first one counts", quoted(name)));
        } else if self.names.len() >= limit {
            self.notes.add(line, &format!("materials beyond the first {limit} are left out"));
        } else {
            self.names.insert(name.to_owned());
            self.draft = Some(Draft::new(name, line));
        }
    }

    /// Takes in any other line.
    fn line(&mut self, keyword: &str, rest: &str, line: u64) {
        match &mut self.draft {
            Some(draft) => draft.line(keyword, rest, line, &mut self.notes),
            None if self.names.is_empty() => {
                self.notes.add_keyed(line, "before the first `newmtl`", || {
                    format!("{} before the first `newmtl` is left out", quoted_line(keyword, rest))
                });
            }
            None => {} // of a material that is left out
        }
    }

    fn finish_material(&mut self) {
        let material = self.draft.take().map(|draft| draft.finish(&mut self.notes));
        self.materials.extend(material);
    }
}

#[cfg(test)]
mod tests;
