//! Whole files, and damaged ones.

use super::*;
use glam::{DVec2, DVec3, Vec3};
use proptest::prelude::*;

fn parse(text: &str) -> Result<Obj, ObjError> {
    read(text.as_bytes(), &ObjOptions::default())
}

fn position(mesh: &Mesh, i: u32) -> DVec3 {
    mesh.origin + mesh.position(i)
}

/// Corners of all triangles in model space.
fn triangles(mesh: &Mesh) -> Vec<[DVec3; 3]> {
    mesh.triangles.iter().map(|t| t.map(|i| position(mesh, i))).collect()
}

fn notes(obj: &Obj) -> Vec<(u64, &str)> {
    obj.notes.iter().map(|note| (note.line.unwrap_or(0), note.detail.as_str())).collect()
}

#[test]
fn a_textured_quad_is_two_triangles_over_four_vertices() {
    let obj = parse(
        "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 9\nf 1/1/1 2/2/1 3/3/1 4/4/1",
    );
    let mesh = obj.unwrap().mesh;
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(mesh.normals, [Vec3::Z; 4]);
    assert_eq!(mesh.uvs.as_ref().unwrap()[2], DVec2::ONE);
    assert_eq!(mesh.slots, [None]);
    assert_eq!(mesh.bounds.unwrap().max, DVec3::new(2., 1., 0.));
}

#[test]
fn encodings_and_line_ends_do_not_matter() {
    let plain = parse("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    let dressed = read(
        b"\xEF\xBB\xBF# C:\\x\\\r\n\tv 0\t0 0 # a\r\nv 1 0 0\r\n v 0 \\\r\n 1 0\r\nf 1 \\\r\n2 3\x1A",
        &ObjOptions::default(),
    );
    assert_eq!(dressed.unwrap(), plain);
}

#[test]
fn negative_indices_count_from_their_line() {
    let obj = parse("v 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 5 5 5\n").unwrap();
    assert_eq!(triangles(&obj.mesh), [[DVec3::ZERO, DVec3::X, DVec3::Y]]);
}

#[test]
fn faces_may_precede_their_vertices() {
    let obj = parse("f 1 2 3 4\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n").unwrap();
    assert_eq!(obj.mesh.triangles.len(), 2);
    let error = parse("v 0 0 0\nf 1 2 3\nf 1 5 2\nv 1 0 0\nv 1 1 0\n").unwrap_err();
    assert_eq!(error, ObjError::IndexOutOfRange { line: 3, list: List::Vertices, index: 5, count: 3 });
    assert_eq!(
        error.in_file("a.obj").to_string(),
        "a.obj, line 3: face refers to vertex 5, but 3 are defined"
    );
}

#[test]
fn faults_name_their_line() {
    let line = |text: &str| parse(text).unwrap_err().line();
    assert_eq!(line("v 0 0 0\n\nv 0 nan 0"), Some(3));
    assert_eq!(line("v 0 0 0\nvt 1e999"), Some(2));
    assert_eq!(line("v 0 0"), Some(1));
    assert_eq!(line("v 0 0 0 1 1"), Some(1));
    assert_eq!(line("v 0 0 0\nvn 0 1"), Some(2));
    assert_eq!(line("v 0 0 0\nf 1 0 1"), Some(2));
    assert_eq!(line("v 0 0 0\nf 1 1/1 1"), Some(2));
    assert_eq!(line("v 0 0 0\nf 1 x 1"), Some(2));
    assert_eq!(parse("# nothing\n"), Err(ObjError::NoVertices));
    assert_eq!(line("v 0 0 0\nf\x01"), Some(2));
}

#[test]
fn a_face_of_too_many_corners_is_refused() {
    let text = format!("v 0 0 0\nf{}", " 1".repeat(100_000));
    assert_eq!(parse(&text), Err(ObjError::TooManyCorners { line: 2, corners: 100_000, limit: 16_384 }));
}

#[test]
fn many_expensive_faces_are_given_up() {
    let n = 4000;
    let star: String = (0..n)
        .map(|i| {
            let (sin, cos) = (f64::from(i) * std::f64::consts::TAU / f64::from(n)).sin_cos();
            let radius = if i % 2 == 0 { 1.0 } else { 0.999 };
            format!("v {} {} 0\n", cos * radius, sin * radius)
        })
        .collect();
    let face: String = std::iter::once("f".to_owned()).chain((1..=n).map(|i| format!(" {i}"))).collect();
    assert!(parse(&format!("{star}{face}\n")).is_ok());
    let many = vec![face; 200].join("\n");
    assert!(matches!(parse(&format!("{star}{many}\n")), Err(ObjError::TooComplex { .. })));
}

#[test]
fn materials_become_slots_in_order_of_first_use() {
    let obj = parse(
        "mtllib a b.mtl\nmtllib a b.mtl\nmtllib c.mtl # second\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl unused\nf 1 2 3\nusemtl\tMaterial #25\n\
         f 1 2 3\nf 1 2 3\nusemtl unused\nusemtl Material #25\nf 1 2 3\nusemtl unused\nf 1 2 3\nusemtl never\n",
    );
    let obj = obj.unwrap();
    assert_eq!(obj.mesh.slots, [Some("unused".to_owned()), Some("Material #25".to_owned())]);
    assert_eq!(obj.slot_lines, [Some(7), Some(9)]);
    let parts: Vec<_> = obj.mesh.parts.iter().map(|part| (part.first_triangle, part.slot)).collect();
    assert_eq!(parts, [(0, 0), (1, 1), (4, 0)]);
    let libraries: Vec<_> =
        obj.libraries.iter().map(|library| (library.name.as_str(), library.line)).collect();
    assert_eq!(libraries, [("a b.mtl", 1), ("c.mtl", 3)]);
}

#[test]
fn vertex_colors_are_linear_and_default_to_white() {
    let obj = parse("v 0 0 0\nv 1 0 0 0.5 -1 2\nv 0 1 0 1 0.25 0.5 0.75\nf 1 2 3\n").unwrap();
    let expected = [Vec3::ONE, Vec3::new(0.5, 0.0, 2.0), Vec3::new(0.25, 0.5, 0.75)];
    assert_eq!(obj.mesh.colors.as_deref(), Some(&expected[..]));
    assert_eq!(notes(&obj).len(), 2);
}

#[test]
fn what_is_not_drawn_is_noted_once_a_kind() {
    let obj = parse(
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nl 1 2\nf 1 2 3\nl 2 3\np 1\nf 1 2\nspline 4\nvp 1 2\ncurv 1\no x\ng a b\ns 1\ns off\n",
    );
    let obj = obj.unwrap();
    let expected = [
        (4, "lines (`l`) are not drawn (2 times, first here)"),
        (7, "points (`p`) are not drawn"),
        (8, "a face of fewer than 3 corners is left out"),
        (9, "“spline 4” is not understood and left out"),
        (10, "free-form curves and surfaces are not drawn (2 times, first here)"),
    ];
    assert_eq!(notes(&obj), expected);
    assert_eq!(obj.mesh.triangles.len(), 1);
}

#[test]
fn a_line_that_is_not_understood_is_quoted_short() {
    let obj = parse(&format!("v 0 0 0\nspline {}\nspline 2\n", "7".repeat(1000))).unwrap();
    let quote = format!("“spline {}…”", "7".repeat(33));
    let expected = format!("{quote} is not understood and left out (2 times, first here)");
    assert_eq!(notes(&obj)[1], (2, expected.as_str()));
}

#[test]
fn normals_of_any_length_become_units_and_zero_is_generated() {
    let obj =
        parse("v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 1e-30 0 0\nvn 0 1e300 0\nvn 0 0 0\nf 1//1 2//2 3//3\n").unwrap();
    assert_eq!(obj.mesh.normals, [Vec3::X, Vec3::Y, Vec3::Z]);
    assert_eq!(notes(&obj), [(6, "a normal of length 0 is replaced by a generated one")]);
}

#[test]
fn degenerate_faces_keep_their_count() {
    let obj = parse("v 0 0 0\nv 1 0 0\nf 1 1 2\nf 1 2 1 2 1\n").unwrap();
    assert_eq!(obj.mesh.triangles.len(), 4);
}

#[test]
fn points_without_faces_are_an_empty_mesh() {
    let obj = parse("v 0 0 0\n").unwrap();
    assert_eq!(obj.mesh.bounds, None);
    assert_eq!(notes(&obj), [(1, "the file has no faces")]);
}

#[test]
fn memory_is_bounded_while_reading() {
    let text = format!("v 0 0 0\n{}", format!("f{}\n", " 1".repeat(1000)).repeat(100));
    let error =
        read(text.as_bytes(), &ObjOptions { max_bytes: 1_000_000, ..ObjOptions::default() }).unwrap_err();
    assert!(matches!(error, ObjError::TooManyBytes { line: 20..30, limit: 1_000_000 }), "{error:?}");
    assert!(matches!(error.in_file("a.obj"), crate::import::ImportError::TooLarge { .. }));
}

#[test]
fn faces_without_vertices_are_counted_too() {
    let text: String = (1..).step_by(3).take(1000).map(|i| format!("f {i} {} {}\n", i + 1, i + 2)).collect();
    let options = ObjOptions { max_bytes: 40_000, ..ObjOptions::default() };
    // 36 bytes of each triangle alone would fit, but not what is kept about its corners.
    let error = read(text.as_bytes(), &options).unwrap_err();
    assert!(matches!(error, ObjError::TooManyBytes { line: 400..600, .. }), "{error:?}");
}

#[test]
fn the_limits_in_force_bound_a_file() {
    let limits = Limits { scene_bytes: 4000, entries: 2, ..Limits::default() };
    assert_eq!(ObjOptions::within(&limits), ObjOptions { max_bytes: 1000, max_materials: 2 });
    let text = "v 0 0 0\nusemtl a\nf 1 1 1\nusemtl b\nf 1 1 1\nusemtl c\nf 1 1 1\n";
    let error = read(text.as_bytes(), &ObjOptions::within(&limits)).unwrap_err();
    assert_eq!(error, ObjError::TooManyMaterials { line: 7, limit: 2 });
}

#[test]
fn a_very_long_line_is_read_in_linear_time() {
    let text =
        format!("v 0 0 0{}\nv 1 0 0\nv 0 1 0\nf 1 2 3\n# {}\n", " ".repeat(10 << 20), "\\".repeat(10 << 20));
    assert_eq!(parse(&text).unwrap().mesh.triangles.len(), 1);
    let text = format!("v 0 \\\n{}0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "\\\n".repeat(1 << 20));
    assert_eq!(parse(&text).unwrap().mesh.triangles.len(), 1);
}

/// A file that holds most of what there is, to be damaged.
const RICH: &str = "mtllib a.mtl\no x\nv 0 0 0\nv 1 0 0 1 0 0\nv 1 1 0\nv 0 1 0 1 1 1 1\nv 2 2 \\\n 2\nvt 0 0\nvt 1 0.5\nvt 1 1 0\nvn 0 0 1\n\
    vn 0 0 0\ng a b\nusemtl m n\ns 1\nf 1/1/1 2/2/1 3/3/1 4/1/2\nf -3//-1 -2//-2 -1\nf 1 2 3\nl 1 2\nusemtl k\nf 1/1 2/2 3/3 5 4\n# end\n";

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn damaged_files_never_panic(
        edits in prop::collection::vec((any::<prop::sample::Index>(), prop::sample::select(b" \n\\/-.0123456789evtfn#\x00\xFF".to_vec()), 0u8..3), 0..12),
        keep: prop::sample::Index,
    ) {
        let mut bytes = RICH.as_bytes().to_vec();
        for (at, byte, edit) in edits {
            let at = at.index(bytes.len());
            match edit {
                0 => bytes[at] = byte,
                1 => bytes.insert(at, byte),
                _ => { bytes.remove(at); }
            }
        }
        bytes.truncate(bytes.len() - keep.index(bytes.len()) / 4);
        check_sound(&bytes)?;
    }

    #[test]
    fn random_words_never_panic(
        words in prop::collection::vec(prop::sample::select(vec![
            "v", "vt", "vn", "f", "usemtl", "mtllib", "l", "\n", "\n", "\n", "1", "2", "-1", "-2", "1/1", "1//1", "1/1/1", "0", "0.5",
            "1e37", "1e-320", "-0", "nan", "x", "#", "\\\n", "\r", "é", "-9223372036854775808",
        ]), 0..80),
    ) {
        check_sound(words.join(" ").as_bytes())?;
    }

    #[test]
    fn random_bytes_never_panic(bytes: Vec<u8>) {
        check_sound(&bytes)?;
    }

    #[test]
    fn tobj_reads_the_same_triangles(
        positions in prop::collection::vec((-99i32..99, -99i32..99, -99i32..99), 3..20),
        faces in prop::collection::vec((any::<[prop::sample::Index; 3]>(), any::<bool>()), 1..40),
    ) {
        let mut text: String = positions.iter().map(|(x, y, z)| format!("v {}.5 {y}e-1 {z}\n", x)).collect();
        let n = positions.len();
        for (corners, from_the_end) in &faces {
            let signed = |i: usize| if *from_the_end { format!("-{}", n - i) } else { (i + 1).to_string() };
            let [a, b, c] = corners.map(|corner| signed(corner.index(n)));
            text.push_str(&format!("f {a} {b} {c}\n"));
        }
        let ours = triangles(&parse(&text).unwrap().mesh);
        let options = tobj::LoadOptions { triangulate: true, ..tobj::LoadOptions::default() };
        let (models, _) = tobj::load_obj_buf(&mut text.as_bytes(), &options, |_| tobj::MTLLoadResult::Ok(Default::default())).unwrap();
        let mesh = &models[0].mesh;
        let theirs: Vec<DVec3> = mesh.indices.iter().map(|i| {
            let at = |axis: usize| f64::from(mesh.positions[*i as usize * 3 + axis]);
            DVec3::new(at(0), at(1), at(2))
        }).collect();
        prop_assert_eq!(ours.len() * 3, theirs.len());
        for (a, b) in ours.as_flattened().iter().zip(&theirs) {
            prop_assert!((*a - *b).length() < 1e-4, "{} {}", a, b);
        }
    }
}

/// Whatever is accepted is a mesh that holds together.
fn check_sound(bytes: &[u8]) -> Result<(), TestCaseError> {
    let Ok(obj) = read(bytes, &ObjOptions::default()) else {
        return Ok(());
    };
    let mesh = &obj.mesh;
    let count = mesh.vertex_count();
    prop_assert!(mesh.positions.iter().all(|axis| axis.len() == count && axis.iter().all(|p| p.is_finite())));
    prop_assert!(mesh.triangles.as_flattened().iter().all(|i| (*i as usize) < count));
    prop_assert!(mesh.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-6));
    prop_assert!(mesh.uvs.iter().flatten().all(|uv| uv.is_finite()));
    prop_assert!(mesh.colors.iter().flatten().all(|color| color.is_finite() && color.min_element() >= 0.0));
    prop_assert!(mesh.parts.iter().all(|part| (part.slot as usize) < mesh.slots.len()));
    prop_assert!(mesh.bytes() <= 200 * (bytes.len() as u64 + 1));
    prop_assert_eq!(obj.slot_lines.len(), mesh.slots.len());
    Ok(())
}

#[test]
fn libraries_alone_are_those_of_the_whole_file() {
    let text = b"\xEF\xBB\xBFmtllib a b.mtl # the first\r\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nmtllib W\xFCrfel.mtl \\\n c.mtl\n# mtllib no\nmtllib a b.mtl\n";
    let listed = libraries(text);
    assert_eq!(listed, read(text, &ObjOptions::default()).unwrap().libraries);
    let names: Vec<&str> = listed.iter().map(|library| library.name.as_str()).collect();
    assert!(names.len() == 2 && names[0] == "a b.mtl", "{names:?}");
    assert_eq!(libraries(b"mtllib a.mtl\nf 1 2 9"), [Library { name: "a.mtl".to_owned(), line: 1 }]);
    assert_eq!(libraries(b"\xFF\xFEm\0"), []);
}
