//! Whole files, and damaged ones.

use super::*;
use glam::Vec3;
use proptest::prelude::*;

fn parse(text: &str) -> Mtl {
    read(text.as_bytes(), &Limits::default()).unwrap()
}

/// The one material of a file with these lines.
fn material(lines: &str) -> MtlMaterial {
    parse(&format!("newmtl m\n{lines}\n")).materials.remove(0)
}

fn details(lines: &str) -> Vec<String> {
    parse(&format!("newmtl m\n{lines}\n")).notes.into_iter().map(|note| note.detail).collect()
}

#[test]
fn everything_that_is_used_is_read() {
    let mtl = parse(
        "\u{FEFF}# a comment\r\nnewmtl my wood\r\n\tKa 0.1 0.2 0.3\r\n  Kd 0.4 0.5 0.6 # inline\r\nKs\t.7 .8 .9\r\nKe 1 2 3\r\nNs 250\r\n\
         d 0.5\r\nTr 0.9\r\nillum 2\r\nmap_Kd a.png\r\nmap_Ks b.png\r\nmap_Ke c.png\r\nmap_d d.png\r\nmap_Bump -bm 2 e.png\r\nnorm f.png\r\n",
    );
    assert_eq!(mtl.notes, []);
    let [MtlMaterial { name, line, material, maps }] = &mtl.materials[..] else { panic!("one material") };
    assert_eq!((name.as_str(), *line), ("my wood", 2));
    assert_eq!(material.ambient, Some(Vec3::new(0.1, 0.2, 0.3)));
    assert_eq!(material.diffuse, Vec3::new(0.4, 0.5, 0.6));
    assert_eq!(material.specular, Vec3::new(0.7, 0.8, 0.9));
    assert_eq!(material.emissive, Vec3::new(1.0, 2.0, 3.0));
    assert_eq!((material.shininess, material.opacity, material.bump_scale), (250.0, 0.5, 0.04));
    let files = [&maps.diffuse, &maps.specular, &maps.emissive, &maps.opacity, &maps.bump, &maps.normal];
    assert_eq!(
        files.map(|map| map.as_ref().unwrap().file.as_str()),
        ["a.png", "b.png", "c.png", "d.png", "e.png", "f.png"]
    );
}

#[test]
fn keywords_have_no_case() {
    let lower = material("kd 1 0 0\nMAP_KD a.png\nMap_bump b.png\nBUMP c.png");
    assert_eq!(lower.material.diffuse, Vec3::X);
    assert_eq!(lower.maps.bump.unwrap().file, "c.png");
}

#[test]
fn black_or_absent_diffuse_beside_a_map_is_white() {
    assert_eq!(material("Kd 0 0 0\nmap_Kd a.png").material.diffuse, Vec3::ONE);
    assert_eq!(material("map_Kd a.png").material.diffuse, Vec3::ONE);
    assert_eq!(material("Kd 0 0 0").material.diffuse, Vec3::ZERO);
    assert_eq!(material("Kd 0.5").material.diffuse, Vec3::splat(0.5));
    assert_eq!(material("").material, Material::default());
    assert_eq!(material("map_Ks a.png\nmap_Ke b.png").material.specular, Vec3::ONE);
    assert_eq!(material("Ks 0 0 0\nmap_Ks a.png").material.specular, Vec3::ZERO);
}

#[test]
fn placeholder_ambient_is_left_to_the_diffuse_color() {
    for lines in [
        "Ka 0 0 0",
        "Ka 1 1 1",
        "Ka 1",
        "Ka .5 .6 .7\nKd .5 .6 .7",
        "Ka .2 .2 .2\nmap_Kd a.png",
        "Ka 1 0 0\nmap_Ka a.png",
    ] {
        assert_eq!(material(lines).material.ambient, None, "{lines}");
    }
    for lines in ["Ka .2 .2 .2", "Ka .2 .1 .1\nmap_Kd a.png"] {
        assert!(material(lines).material.ambient.is_some(), "{lines}");
    }
}

#[test]
fn opacity_comes_from_d_or_tr() {
    let opacity = |lines| material(lines).material.opacity;
    assert_eq!(opacity("Tr 0.25"), 0.75);
    assert_eq!(opacity("Tr 1"), 1.0);
    assert_eq!(opacity("Tr 1\nd 0.5"), 0.5);
    assert_eq!(opacity("d -halo 0.5"), 0.5);
    assert_eq!(opacity("d 7"), 1.0);
    assert_eq!(details("d 0"), ["“m” is invisible (`d 0`)"]);
}

#[test]
fn maps_under_the_wrong_keyword_are_sorted_out() {
    let maps = material("map_Bump tex\\wall_Normal.png").maps;
    assert_eq!((maps.bump, maps.normal.unwrap().file.as_str()), (None, "tex\\wall_Normal.png"));
    let maps = material("norm a.png\nmap_Bump a.png").maps;
    assert_eq!((maps.bump, maps.normal.unwrap().line), (None, 2));
    let maps = material("norm a.png\nmap_Bump heights.png").maps;
    assert!(maps.bump.is_some() && maps.normal.is_some());
    assert_eq!(material("map_Kd a.png\nmap_d a.png").maps.opacity, None);
    assert_eq!(material("map_Kd a.png\nmap_d -imfchan m a.png").maps.opacity, None);
    assert!(material("map_Kd a.png\nmap_d -imfchan r a.png").maps.opacity.is_some());
    assert!(material("map_Kd a.png\nmap_d -imfchan m b.png").maps.opacity.is_some());
}

#[test]
fn what_makes_no_sense_is_noted_with_its_line() {
    let mtl = parse(
        "Kd 1 1 1\nnewmtl a\nKd 1 2\nKs x y z\nNs nan\nKd spectral a.rfl\nPr 1\nPr 1\nmap_Ns a.png\nKd -1 0 0\nnewmtl a\nKd nothing\n",
    );
    let notes: Vec<_> = mtl.notes.iter().map(|note| (note.line.unwrap(), note.detail.as_str())).collect();
    let expected = [
        (1, "“Kd 1 1 1” before the first `newmtl` is left out"),
        (3, "“Kd 1 2” takes one number or three"),
        (4, "“Ks x y z” takes one number or three"),
        (5, "“Ns nan” takes one number"),
        (6, "“Kd spectral a.rfl” takes one number or three"),
        (7, "“Pr 1” is not used (2 times, first here)"),
        (9, "“map_Ns a.png” is not used"),
        (10, "“Kd -1 0 0” counts as 0 where it is below"),
        (11, "“a” is there already; the first one counts"),
    ];
    assert_eq!(notes, expected);
    assert_eq!(mtl.materials.len(), 1);
}

#[test]
fn the_number_of_materials_is_bounded() {
    let text: String = (0..70_000).map(|i| format!("newmtl {i}\nKd 1\n")).collect();
    let mtl = parse(&text);
    assert_eq!(mtl.materials.len(), 65_536);
    assert_eq!(mtl.notes.len(), 1);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn random_words_give_finite_materials(
        words in prop::collection::vec(prop::sample::select(vec![
            "newmtl", "Ka", "Kd", "Ks", "Ns", "Ke", "d", "Tr", "map_Kd", "map_d", "bump", "norm", "-s", "-o", "-bm", "-clamp", "-imfchan",
            "-halo", "on", "m", "\n", "\n", "\n", "\n", "0", "1", "-1", "0.5", "1e30", "1e300", "nan", "a.png", "normal", "#", "\\\n", "é", "\"",
        ]), 0..80),
    ) {
        for material in parse(&words.join(" ")).materials {
            let Material { diffuse, specular, emissive, ambient, shininess, opacity, bump_scale, .. } = material.material;
            for color in [diffuse, specular, emissive, ambient.unwrap_or_default()] {
                prop_assert!(color.is_finite() && color.min_element() >= 0.0);
            }
            prop_assert!(shininess.is_finite() && shininess >= 0.0 && bump_scale.is_finite() && (0.0..=1.0).contains(&opacity));
            let maps = material.maps;
            for map in [maps.diffuse, maps.bump, maps.opacity, maps.normal].into_iter().flatten() {
                prop_assert!(!map.file.is_empty() && map.scale.iter().chain(&map.offset).all(|n| n.is_finite()));
            }
        }
    }

    #[test]
    fn random_bytes_never_panic(bytes: Vec<u8>) {
        let _ = read(&bytes, &Limits::default());
    }
}
