//! Line by line through an OBJ file.

use super::error::ObjError;
use super::face::Lists;
use super::numbers::{COORDINATE, FINITE, Numbers};
use super::slots::Slots;
use super::{Library, Obj, ObjOptions};
use crate::import::notes::{Notes, quoted};
use crate::import::text::{Line, keyword_and_rest, name_without_comment, without_comment};
use crate::limits::{MAX_MATERIAL_LIBRARIES, MAX_POLYGON_CORNERS, MAX_POLYGON_TESTS, MAX_TRIANGLES};
use crate::model::normals::unit;
use crate::model::polygon::{Effort, triangulate};
use crate::model::{Corner, Mesh, MeshSource, MeshTooLarge, Part};
use glam::{DVec2, DVec3, Vec3};
use std::collections::HashSet;

/// What is read so far.
pub(super) struct Reader {
    options: ObjOptions,
    notes: Notes,
    lists: Lists,
    source: MeshSource,
    /// Faces of more than three corners wait here for positions that may follow them.
    polygons: Vec<Polygon>,
    polygon_corners: Vec<Corner>,
    slots: Slots,
    libraries: Vec<Library>,
    library_names: HashSet<String>,
}

/// A face of more than three corners, to be split at the end.
struct Polygon {
    line: u64,
    /// Its triangles are `source.triangles[first_triangle..][..corners - 2]`, left empty until then.
    first_triangle: usize,
    corners: usize,
}

/// Fills the place of a triangle that is yet to come.
const PENDING: [Corner; 3] = [Corner { position: 0, uv: 0, normal: 0 }; 3];

impl Reader {
    pub(super) fn new(options: ObjOptions, notes: Notes) -> Self {
        Self {
            options,
            notes,
            lists: Lists::new(),
            source: MeshSource::default(),
            polygons: Vec::new(),
            polygon_corners: Vec::new(),
            slots: Slots::new(options.max_materials),
            libraries: Vec::new(),
            library_names: HashSet::new(),
        }
    }

    /// Takes in one line.
    pub(super) fn line(&mut self, line: &Line<'_>) -> Result<(), ObjError> {
        self.check_memory(line.number)?;
        let (keyword, rest) = keyword_and_rest(&line.text);
        let number = line.number;
        match keyword {
            "v" => self.vertex(rest, number),
            "vt" => self.texture_coordinate(rest, number),
            "vn" => self.normal(rest, number),
            "f" | "fo" => self.face(rest, number),
            "usemtl" => {
                self.slots.select(name_without_comment(rest), number);
                Ok(())
            }
            "mtllib" => {
                self.library(name_without_comment(rest), number);
                Ok(())
            }
            "o" | "g" | "s" | "mg" => Ok(()),
            _ => {
                self.left_out(keyword, line);
                Ok(())
            }
        }
    }

    /// Stops before the lists outgrow their limit; one line adds little.
    fn check_memory(&self, line: u64) -> Result<(), ObjError> {
        let source = &self.source;
        let bytes = source.triangles.len() * size_of::<[Corner; 3]>()
            + self.polygon_corners.len() * size_of::<Corner>()
            + self.polygons.len() * size_of::<Polygon>()
            + self.lists.bytes_ahead()
            + source.positions.len() * size_of::<DVec3>()
            + source.colors.as_ref().map_or(0, |colors| colors.len() * size_of::<Vec3>())
            + source.uvs.len() * size_of::<DVec2>()
            + source.normals.len() * size_of::<Vec3>();
        let limit = self.options.max_bytes;
        if bytes as u64 > limit { Err(ObjError::TooManyBytes { line, limit }) } else { Ok(()) }
    }

    /// `v x y z [w] [r g b]`; w weighs points of curves only.
    fn vertex(&mut self, rest: &str, line: u64) -> Result<(), ObjError> {
        let numbers = Numbers::read(rest, line, COORDINATE)?;
        let color = match numbers.count() {
            3 | 4 => None,
            6 => Some(numbers.from(3)),
            7 => Some(numbers.from(4)),
            found => return Err(count_error(line, "v", found, "3, 4, 6 or 7")),
        };
        self.source.positions.push(DVec3::from_array(numbers.from(0)));
        self.lists.vertices.count += 1;
        self.color(color, line);
        Ok(())
    }

    /// Vertices without a colour are white where others have one.
    fn color(&mut self, color: Option<[f64; 3]>, line: u64) {
        let before = self.source.positions.len() - 1;
        if color.is_none() && self.source.colors.is_none() {
            return;
        }
        let colors = self.source.colors.get_or_insert_with(|| vec![Vec3::ONE; before]);
        let color = color.map_or(DVec3::ONE, DVec3::from_array);
        if color.min_element() < 0.0 {
            self.notes.add(line, "a vertex colour below 0 counts as 0");
        }
        if color.max_element() > 1.0 {
            self.notes.add(line, "a vertex colour above 1 is taken as it is");
        }
        colors.push(color.max(DVec3::ZERO).as_vec3());
    }

    /// `vt u [v [w]]`
    fn texture_coordinate(&mut self, rest: &str, line: u64) -> Result<(), ObjError> {
        let numbers = Numbers::read(rest, line, COORDINATE)?;
        if !(1..=3).contains(&numbers.count()) {
            return Err(count_error(line, "vt", numbers.count(), "1, 2 or 3"));
        }
        self.source.uvs.push(DVec2::from_array(numbers.from(0)));
        self.lists.texture_coordinates.count += 1;
        Ok(())
    }

    /// `vn x y z`, of any length; a zero vector is kept as "missing".
    fn normal(&mut self, rest: &str, line: u64) -> Result<(), ObjError> {
        let numbers = Numbers::read(rest, line, FINITE)?;
        if numbers.count() != 3 {
            return Err(count_error(line, "vn", numbers.count(), "3"));
        }
        let normal = unit(DVec3::from_array(numbers.from(0)));
        if normal.is_none() {
            self.notes.add(line, "a normal of length 0 is replaced by a generated one");
        }
        self.source.normals.push(normal.unwrap_or(DVec3::ZERO).as_vec3());
        self.lists.normals.count += 1;
        Ok(())
    }

    /// `f corner corner corner …`
    fn face(&mut self, rest: &str, line: u64) -> Result<(), ObjError> {
        let first_corner = self.polygon_corners.len();
        let mut corners = 0;
        for word in without_comment(rest).split_ascii_whitespace() {
            let corner = self.lists.corner(word, line)?;
            corners += 1;
            if corners <= MAX_POLYGON_CORNERS {
                self.polygon_corners.push(corner);
            }
        }
        match corners {
            0..=2 => {
                self.polygon_corners.truncate(first_corner);
                self.notes.add(line, "a face of fewer than 3 corners is left out");
                return Ok(());
            }
            3 => self.triangle(first_corner, line)?,
            4..=MAX_POLYGON_CORNERS => self.polygon(corners, line)?,
            _ => {
                return Err(ObjError::TooManyCorners { line, corners, limit: MAX_POLYGON_CORNERS });
            }
        }
        Ok(())
    }

    /// A face of three corners, which are the last of `polygon_corners`.
    fn triangle(&mut self, first_corner: usize, line: u64) -> Result<(), ObjError> {
        self.begin_face(1, line)?;
        let triangle = [0, 1, 2].map(|k| self.polygon_corners[first_corner + k]);
        self.polygon_corners.truncate(first_corner);
        self.source.triangles.push(triangle);
        Ok(())
    }

    /// A larger face, whose corners are the last of `polygon_corners`.
    fn polygon(&mut self, corners: usize, line: u64) -> Result<(), ObjError> {
        self.begin_face(corners - 2, line)?;
        let first_triangle = self.source.triangles.len();
        self.polygons.push(Polygon { line, first_triangle, corners });
        self.source.triangles.resize(first_triangle + corners - 2, PENDING);
        Ok(())
    }

    /// Checks that there is room for a face's triangles, and opens a part where the material changes.
    fn begin_face(&mut self, triangles: usize, line: u64) -> Result<(), ObjError> {
        let first = self.source.triangles.len();
        if first + triangles > MAX_TRIANGLES {
            return Err(MeshTooLarge { triangles: first + triangles }.into());
        }
        let slot = self.slots.in_use(line)?;
        if self.source.parts.last().is_none_or(|part| part.slot != slot) {
            let first_triangle = u32::try_from(first).expect("invariant: triangles are counted in u32");
            self.source.parts.push(Part { first_triangle, slot });
        }
        Ok(())
    }

    fn library(&mut self, name: &str, line: u64) {
        if name.is_empty() {
            self.notes.add(line, "`mtllib` names no file");
        } else if self.libraries.len() >= MAX_MATERIAL_LIBRARIES {
            self.notes.add(line, "a further `mtllib` is left out");
        } else if self.library_names.insert(name.to_owned()) {
            self.libraries.push(Library { name: name.to_owned(), line });
        }
    }

    /// Notes a line whose keyword is not used.
    fn left_out(&mut self, keyword: &str, Line { number: line, text }: &Line<'_>) {
        let line = *line;
        match keyword {
            "l" => self.notes.add(line, "lines (`l`) are not drawn"),
            "p" => self.notes.add(line, "points (`p`) are not drawn"),
            "vp" | "cstype" | "deg" | "bmat" | "step" | "curv" | "curv2" | "surf" | "parm" | "trim"
            | "hole" | "scrv" | "sp" | "end" | "con" => {
                self.notes.add(line, "free-form curves and surfaces are not drawn");
            }
            _ => self
                .notes
                .add_keyed(line, keyword, || format!("{} is not understood and left out", quoted(text))),
        }
    }

    /// The material libraries named so far.
    pub(super) fn into_libraries(self) -> Vec<Library> {
        self.libraries
    }

    /// Checks what can only be checked at the end, and builds the mesh.
    pub(super) fn finish(mut self) -> Result<Obj, ObjError> {
        if self.source.positions.is_empty() {
            return Err(ObjError::NoVertices);
        }
        self.lists.check()?;
        self.split_polygons()?;
        if self.source.triangles.is_empty() {
            self.notes.add(1, "the file has no faces");
        }
        self.source.slots = self.slots.names;
        let mesh = Mesh::build(self.source)?;
        let mut slot_lines = self.slots.lines;
        slot_lines.resize(mesh.slots.len(), None);
        Ok(Obj { mesh, slot_lines, libraries: self.libraries, notes: self.notes.finish() })
    }

    fn split_polygons(&mut self) -> Result<(), ObjError> {
        let mut effort = Effort(MAX_POLYGON_TESTS);
        let mut rest = self.polygon_corners.as_slice();
        for polygon in &self.polygons {
            let corners;
            (corners, rest) = rest.split_at(polygon.corners);
            let positions: Vec<DVec3> =
                corners.iter().map(|corner| self.source.positions[corner.position as usize]).collect();
            let triangles = triangulate(&positions, &mut effort)
                .map_err(|_| ObjError::TooComplex { line: polygon.line })?;
            let places = &mut self.source.triangles[polygon.first_triangle..];
            for (place, triangle) in places.iter_mut().zip(triangles) {
                *place = triangle.map(|i| corners[i]);
            }
        }
        Ok(())
    }
}

fn count_error(line: u64, keyword: &'static str, found: usize, expected: &'static str) -> ObjError {
    ObjError::NumberCount { line, keyword, found, expected }
}
