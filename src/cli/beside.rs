//! Files that a document, a model or a material library names, looked up in its folder.
//!
//! Only there: a name may lead into a sub-folder, but one that leads out (`..`, an absolute path)
//! counts as its last component. What is not found is left to the scene's own words about it. Which
//! files are named is the importers' to say, so that a model brings here what it asks for on a server.

use super::Failure;
use bytes::Bytes;
use rasterd::import::{mtl, obj};
use rasterd::limits::Limits;
use rasterd::scene::Files;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Component, Path, PathBuf};

/// Files for one scene, and where each was found.
#[derive(Debug, Default)]
pub(super) struct Gathered {
    files: Files,
    /// By the name in `files`.
    origins: BTreeMap<String, PathBuf>,
}

impl Gathered {
    /// The files by the names that they are asked for.
    pub(super) fn into_files(self) -> Files {
        self.files
    }

    /// Adds every file that `document` names, and what those name in turn.
    ///
    /// # Errors
    /// Two different files of one name.
    pub(super) fn add_named_by_document(&mut self, document: &Value, folder: &Path) -> Result<(), Failure> {
        match document {
            Value::Object(fields) => fields.iter().try_for_each(|(name, value)| match value {
                Value::String(file) if name == "file" => self.add_beside(file, folder),
                Value::Object(faces) if name == "faces" => {
                    let mut files = faces.values().filter_map(Value::as_str);
                    files.try_for_each(|file| self.add_beside(file, folder))
                }
                // serde_json bounds the depth at 128.
                _ => self.add_named_by_document(value, folder),
            }),
            Value::Array(values) => {
                values.iter().try_for_each(|value| self.add_named_by_document(value, folder))
            }
            _ => Ok(()),
        }
    }

    /// Adds the model at `path` under `name`, with its material libraries and their images.
    ///
    /// # Errors
    /// Two different files of one name.
    pub(super) fn add_model(&mut self, name: &str, path: &Path, bytes: Bytes) -> Result<(), Failure> {
        let folder = path.parent().unwrap_or(Path::new(""));
        for library in obj::libraries(&bytes) {
            self.add_library(&library.name, folder)?;
        }
        // A copy in another folder may have other materials.
        self.refuse_another(name, path, |_| false)?;
        self.add(name, path, bytes)
    }

    /// A file of the document: models bring what they name, the rest comes alone.
    fn add_beside(&mut self, name: &str, folder: &Path) -> Result<(), Failure> {
        let Some((path, bytes)) = read_beside(name, folder) else {
            return Ok(());
        };
        let is_obj = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("obj"));
        if is_obj { self.add_model(name, &path, bytes) } else { self.add_found(name, &path, bytes) }
    }

    /// `mtllib` takes one name with blanks or several without: the whole is tried first.
    fn add_library(&mut self, names: &str, folder: &Path) -> Result<(), Failure> {
        let is_one = find(names, folder).is_some();
        let names = if is_one { vec![names] } else { names.split_whitespace().collect() };
        for name in names {
            let Some((path, bytes)) = read_beside(name, folder) else {
                continue;
            };
            // One that is no text names nothing; the scene says what is wrong with it.
            let materials = mtl::read(&bytes, &Limits::default())
                .map_or_else(|_| Vec::new(), |library| library.materials);
            for map in materials.iter().flat_map(|material| material.maps.iter()) {
                if let Some((image, bytes)) = read_beside(&map.file, path.parent().unwrap_or(folder)) {
                    self.add_found(&map.file, &image, bytes)?;
                }
            }
            self.add_found(name, &path, bytes)?;
        }
        Ok(())
    }

    /// A library or an image: a copy of one in another folder is as good.
    fn add_found(&mut self, name: &str, path: &Path, bytes: Bytes) -> Result<(), Failure> {
        self.refuse_another(name, path, |known| *known == bytes)?;
        self.add(name, path, bytes)
    }

    fn add(&mut self, name: &str, path: &Path, bytes: Bytes) -> Result<(), Failure> {
        self.origins.insert(Files::reduce(name).to_owned(), path.to_owned());
        self.files.insert(name, bytes).map_err(|error| Failure::new(path.display(), error))
    }

    /// Fails if `name` is that of a file at another place, unless `is_as_good` says so of its bytes.
    fn refuse_another(
        &self,
        name: &str,
        path: &Path,
        is_as_good: impl Fn(&Bytes) -> bool,
    ) -> Result<(), Failure> {
        let name = Files::reduce(name);
        let Some(known) = self.origins.get(name).filter(|known| !is_same_place(known, path)) else {
            return Ok(());
        };
        if self.files.find(name).is_some_and(|(_, bytes)| is_as_good(bytes)) {
            return Ok(());
        }
        let (known, path) = (known.display(), path.display());
        Err(Failure(format!(
            "two files are named {name:?}: {known} and {path}; a scene has one of each name"
        )))
    }
}

fn is_same_place(a: &Path, b: &Path) -> bool {
    a == b || matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b)
}

fn read_beside(name: &str, folder: &Path) -> Option<(PathBuf, Bytes)> {
    let path = find(name, folder)?;
    let bytes = fs::read(&path).ok()?;
    Some((path, bytes.into()))
}

/// The named path below `folder`, else its last component there, else that without regard to case.
fn find(name: &str, folder: &Path) -> Option<PathBuf> {
    let last = Files::reduce(name);
    if last.is_empty() || last == ".." {
        return None;
    }
    let below = PathBuf::from(name.replace('\\', "/"));
    let stays = below.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    let exact = [stays.then(|| folder.join(below)), Some(folder.join(last))];
    exact.into_iter().flatten().find(|path| path.is_file()).or_else(|| without_case(last, folder))
}

fn without_case(name: &str, folder: &Path) -> Option<PathBuf> {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let folded = name.to_lowercase();
    let mut matching: Vec<PathBuf> = fs::read_dir(folder)
        .ok()?
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.file_name().is_some_and(|file| file.to_string_lossy().to_lowercase() == folded))
        .filter(|path| path.is_file())
        .collect();
    matching.sort(); // the order of a folder's entries is anyone's guess
    matching.into_iter().next()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A folder that is gone after the test.
    struct Folder(PathBuf);

    impl Folder {
        fn new(name: &str, files: &[(&str, &str)]) -> Self {
            let path = std::env::temp_dir().join(format!("rasterd-beside-{name}-{}", std::process::id()));
            for (file, text) in files {
                let file = path.join(file);
                fs::create_dir_all(file.parent().expect("a folder")).expect("a folder");
                fs::write(file, text).expect("a file");
            }
            Self(path)
        }
    }

    impl Drop for Folder {
        fn drop(&mut self) {
            let _ = fs::remove_dir_all(&self.0);
        }
    }

    fn names(gathered: &Gathered) -> Vec<&str> {
        gathered.files.iter().map(|(name, _)| name).collect()
    }

    /// What `m.obj` of these bytes brings.
    fn model(folder: &Folder, bytes: &'static [u8]) -> Gathered {
        let mut gathered = Gathered::default();
        let path = folder.0.join("m.obj");
        gathered.add_model("m.obj", &path, Bytes::from_static(bytes)).expect("one of each name");
        gathered
    }

    #[test]
    fn a_model_brings_its_libraries_and_their_images() {
        let mtl = "newmtl a\nmap_Kd -s 1 1 1 tex/red brick.png\n map_Bump ..\\..\\Rough.PNG -bm 2\nmap_d gone.png\n";
        let folder =
            Folder::new("model", &[("a b.mtl", mtl), ("tex/red brick.png", "1"), ("rough.png", "2")]);
        let gathered = model(&folder, b"mtllib a b.mtl\r\nv 0 0 0\n");
        assert_eq!(names(&gathered), ["Rough.PNG", "a b.mtl", "m.obj", "red brick.png"]);
    }

    #[test]
    fn names_are_read_as_the_importers_read_them() {
        let mtl =
            "\u{feff}newmtl a\nmap_Kd \"tiles 1.png\"\nmap_d \\\n leaf.png\nmap_Ks -clamp on a -s.png -s 2\n";
        let folder = Folder::new(
            "as-read",
            &[("Würfel.mtl", mtl), ("tiles 1.png", ""), ("leaf.png", ""), ("a -s.png", "")],
        );
        for text in [
            b"\xEF\xBB\xBFmtllib W\xC3\xBCrfel.mtl".as_slice(), // a byte order mark
            b"mtllib W\xFCrfel.mtl",                            // Latin-1
            b"v 0 0 0\rmtllib \\\rW\xC3\xBCrfel.mtl # its colours\r", // a continuation
        ] {
            let expected = ["Würfel.mtl", "a -s.png", "leaf.png", "m.obj", "tiles 1.png"];
            assert_eq!(names(&model(&folder, text)), expected, "{}", text.escape_ascii());
        }
    }

    #[test]
    fn two_files_of_one_name_are_refused() {
        let folder = Folder::new(
            "twice",
            &[
                ("a/m.obj", ""),
                ("a/m.mtl", "newmtl a\nmap_Kd t.png"),
                ("a/t.png", "one"),
                ("b/n.mtl", "newmtl b\nmap_Kd t.png"),
                ("b/t.png", "another"),
                ("c/n.mtl", "newmtl b\nmap_Kd t.png"),
                ("c/t.png", "one"),
            ],
        );
        let mut gathered = Gathered::default();
        let mut add = |path: &str, library: &'static str| {
            let path = folder.0.join(path);
            let name = path.file_name().expect("a name").to_string_lossy().into_owned();
            gathered.add_model(&name, &path, Bytes::from_static(library.as_bytes()))
        };
        add("a/m.obj", "mtllib m.mtl").expect("the first");
        add("a/../a/m.obj", "mtllib m.mtl").expect("the same");
        let refused = add("b/n.obj", "mtllib n.mtl").expect_err("another texture").to_string();
        assert!(refused.contains("\"t.png\"") && refused.contains("a/t.png"), "{refused}");
        add("c/n.obj", "mtllib n.mtl").expect("a copy of the texture");
        add("b/m.obj", "").expect_err("another model");
    }

    #[test]
    fn a_document_brings_its_files() {
        let folder = Folder::new(
            "document",
            &[("m.obj", "mtllib m.mtl"), ("m.mtl", ""), ("t.png", ""), ("px.png", "")],
        );
        let document = serde_json::json!({
            "meshes": { "m": { "type": "obj", "file": "m.obj" } },
            "textures": { "t": { "file": "t.png" }, "u": { "file": "missing.png" } },
            "environment": { "background": { "type": "cubemap", "faces": { "px": "px.png" } } },
        });
        let mut gathered = Gathered::default();
        gathered.add_named_by_document(&document, &folder.0).expect("one of each name");
        assert_eq!(names(&gathered), ["m.mtl", "m.obj", "px.png", "t.png"]);
    }

    #[test]
    fn nothing_outside_the_folder_is_read() {
        let folder = Folder::new("outside", &[("secret.png", "outside"), ("in/model.obj", "")]);
        let inside = folder.0.join("in");
        let absolute = folder.0.join("secret.png");
        for name in ["../secret.png", "..\\secret.png", "..", "", absolute.to_str().expect("a path")] {
            assert!(find(name, &inside).is_none(), "{name}");
        }
    }
}
