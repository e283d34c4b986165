//! The corners of a face: `v`, `v/vt`, `v//vn`, `v/vt/vn`.

use super::error::{List, ObjError};
use crate::import::notes::quoted;
use crate::model::Corner;
use crate::model::build::NONE;

/// A list that face indices refer to, as far as the file is read.
#[derive(Debug)]
pub(super) struct Referred {
    list: List,
    /// Entries up to the present line.
    pub(super) count: usize,
    /// Indices (from 0) beyond the entries of their line, with that line: growing, so the first of
    /// them that stays out of range is the first of all.
    ahead: Vec<(u32, u64)>,
}

impl Referred {
    pub(super) fn new(list: List) -> Self {
        Self { list, count: 0, ahead: Vec::new() }
    }

    /// The index from 0 of a file's `index`: from 1, or backwards from −1 at the present line. Some
    /// files list their faces first, so an index may lie ahead of the present line.
    fn resolve(&mut self, index: i64, line: u64) -> Result<u32, ObjError> {
        let (list, count) = (self.list, self.count);
        let out_of_range = ObjError::IndexOutOfRange { line, list, index, count };
        let resolved = match index {
            0 => return Err(ObjError::ZeroIndex { line, list }),
            1.. => u32::try_from(index - 1).ok().filter(|resolved| *resolved != NONE),
            _ => usize::try_from(index.unsigned_abs())
                .ok()
                .and_then(|back| count.checked_sub(back))
                .and_then(|resolved| u32::try_from(resolved).ok()),
        };
        let resolved = resolved.ok_or(out_of_range)?;
        if resolved as usize >= count && self.ahead.last().is_none_or(|(last, _)| resolved > *last) {
            self.ahead.push((resolved, line));
        }
        Ok(resolved)
    }

    /// Checks the indices that lay ahead, at the end of the file.
    pub(super) fn check(&self) -> Result<(), ObjError> {
        match self.ahead.iter().find(|(index, _)| *index as usize >= self.count) {
            None => Ok(()),
            Some((index, line)) => Err(ObjError::IndexOutOfRange {
                line: *line,
                list: self.list,
                index: i64::from(*index) + 1,
                count: self.count,
            }),
        }
    }
}

/// The three lists.
#[derive(Debug)]
pub(super) struct Lists {
    pub(super) vertices: Referred,
    pub(super) texture_coordinates: Referred,
    pub(super) normals: Referred,
}

impl Lists {
    pub(super) fn new() -> Self {
        Self {
            vertices: Referred::new(List::Vertices),
            texture_coordinates: Referred::new(List::TextureCoordinates),
            normals: Referred::new(List::Normals),
        }
    }

    /// Bytes kept about indices that lie ahead: a file of faces alone has nothing else.
    pub(super) fn bytes_ahead(&self) -> usize {
        let lists = [&self.vertices, &self.texture_coordinates, &self.normals];
        lists.iter().map(|list| size_of_val(list.ahead.as_slice())).sum()
    }

    /// Reads one corner.
    pub(super) fn corner(&mut self, word: &str, line: u64) -> Result<Corner, ObjError> {
        let indices = indices(word.as_bytes());
        let Some([Some(vertex), texture_coordinate, normal]) = indices else {
            return Err(ObjError::BadCorner { line, text: quoted(word) });
        };
        let optional =
            |list: &mut Referred, index: Option<i64>| index.map_or(Ok(NONE), |i| list.resolve(i, line));
        Ok(Corner {
            position: self.vertices.resolve(vertex, line)?,
            uv: optional(&mut self.texture_coordinates, texture_coordinate)?,
            normal: optional(&mut self.normals, normal)?,
        })
    }

    /// Checks all indices at the end of the file; of several faults the one in the first line.
    pub(super) fn check(&self) -> Result<(), ObjError> {
        let lists = [&self.vertices, &self.texture_coordinates, &self.normals];
        let first = lists.iter().filter_map(|list| list.check().err()).min_by_key(ObjError::line);
        first.map_or(Ok(()), Err)
    }
}

/// The up to three indices of a corner, some of which may be missing; `None` if it is none.
fn indices(mut word: &[u8]) -> Option<[Option<i64>; 3]> {
    let mut indices = [None; 3];
    for index in &mut indices {
        (*index, word) = leading_integer(word);
        match word {
            [] => return Some(indices),
            [b'/', rest @ ..] => word = rest,
            _ => return None,
        }
    }
    None
}

/// The decimal integer that `word` begins with and what follows it. One that no i64 holds is as good
/// as the largest, which is out of range too.
fn leading_integer(word: &[u8]) -> (Option<i64>, &[u8]) {
    let (sign, digits) = match word {
        [b'-', digits @ ..] => (-1, digits),
        [b'+', digits @ ..] => (1, digits),
        digits => (1, digits),
    };
    let mut value = 0i64;
    let mut rest = digits;
    while let [digit @ b'0'..=b'9', after @ ..] = rest {
        value = value.saturating_mul(10).saturating_add(i64::from(digit - b'0'));
        rest = after;
    }
    if rest.len() == digits.len() { (None, word) } else { (Some(sign * value), rest) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lists(counts: [usize; 3]) -> Lists {
        let mut lists = Lists::new();
        [lists.vertices.count, lists.texture_coordinates.count, lists.normals.count] = counts;
        lists
    }

    #[test]
    fn every_form_is_read() {
        let mut lists = lists([9, 9, 9]);
        let mut corner = |word| lists.corner(word, 1).map(|c| [c.position, c.uv, c.normal]);
        assert_eq!(corner("3"), Ok([2, NONE, NONE]));
        assert_eq!(corner("3/2"), Ok([2, 1, NONE]));
        assert_eq!(corner("3//1"), Ok([2, NONE, 0]));
        assert_eq!(corner("3/2/1"), Ok([2, 1, 0]));
        assert_eq!(corner("3/2/"), Ok([2, 1, NONE]));
        assert_eq!(corner("-1/-9/+2"), Ok([8, 0, 1]));
        for bad in ["", "/", "/1", "x", "1/x", "1.0", "1/2/3/4", "-", "1-2"] {
            assert!(matches!(corner(bad), Err(ObjError::BadCorner { .. })), "{bad}");
        }
    }

    #[test]
    fn zero_and_too_far_back_are_refused_at_once() {
        let mut lists = lists([9, 0, 2]);
        assert_eq!(lists.corner("1//0", 4), Err(ObjError::ZeroIndex { line: 4, list: List::Normals }));
        let error = ObjError::IndexOutOfRange { line: 4, list: List::Vertices, index: -10, count: 9 };
        assert_eq!(lists.corner("-10", 4), Err(error));
        assert!(matches!(lists.corner("99999999999999999999999", 4), Err(ObjError::IndexOutOfRange { .. })));
        assert!(matches!(lists.corner("-99999999999999999999999", 4), Err(ObjError::IndexOutOfRange { .. })));
        assert!(matches!(lists.corner("4294967296", 4), Err(ObjError::IndexOutOfRange { .. })));
    }

    #[test]
    fn an_index_ahead_is_checked_at_the_end() {
        let mut lists = lists([3, 0, 0]);
        for (word, line) in [("5", 10), ("4", 11), ("7", 12), ("6/1", 13), ("8", 14)] {
            lists.corner(word, line).unwrap();
        }
        lists.vertices.count = 6;
        let error = ObjError::IndexOutOfRange { line: 12, list: List::Vertices, index: 7, count: 6 };
        assert_eq!(lists.check(), Err(error));
        lists.vertices.count = 8;
        assert_eq!(lists.check().unwrap_err().line(), Some(13));
        lists.texture_coordinates.count = 1;
        assert_eq!(lists.check(), Ok(()));
    }
}
