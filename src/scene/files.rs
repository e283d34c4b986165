//! The files that came with a scene.

use crate::limits::MAX_FILE_NAME_BYTES;
use bytes::Bytes;
use std::collections::BTreeMap;

/// Checks the name of a file, wherever it comes from: one component of a path, printable, and no
/// longer than file systems take.
///
/// # Errors
/// What must hold and what is there, as a sentence.
pub fn check_name(name: &str) -> Result<(), String> {
    let rule = match name {
        "" => "must not be empty".to_owned(),
        "." | ".." => format!("must name a file, is {name:?}"),
        _ if name.contains(['/', '\\']) => "must be one component, without / and \\".to_owned(),
        _ if name.chars().any(char::is_control) => "must not hold control characters".to_owned(),
        _ if name.len() > MAX_FILE_NAME_BYTES => {
            format!("must have at most {MAX_FILE_NAME_BYTES} bytes, has {}", name.len())
        }
        _ => return Ok(()),
    };
    Err(format!("a file's name {rule}"))
}

/// Uploaded files by name. A name is the last component of whatever path the client gave, and passes
/// [`check_name`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Files(BTreeMap<String, Bytes>);

impl Files {
    /// The last component of `path`, where `/` and `\` both separate.
    #[must_use]
    pub fn reduce(path: &str) -> &str {
        path.rsplit(['/', '\\']).next().unwrap_or(path)
    }

    /// Adds or replaces a file; `path` is reduced to its last component.
    ///
    /// # Errors
    /// As [`check_name`], for that component.
    pub fn insert(&mut self, path: &str, bytes: Bytes) -> Result<(), String> {
        let name = Self::reduce(path);
        check_name(name)?;
        self.0.insert(name.to_owned(), bytes);
        Ok(())
    }

    /// Removes the file of exactly this name and returns it.
    pub fn remove(&mut self, name: &str) -> Option<Bytes> {
        self.0.remove(name)
    }

    /// Looks `path`'s last component up: exactly, then without regard to case. Returns the name it
    /// is stored under.
    #[must_use]
    pub fn find(&self, path: &str) -> Option<(&str, &Bytes)> {
        let name = Self::reduce(path);
        self.0
            .get_key_value(name)
            .or_else(|| {
                let folded = name.to_lowercase();
                self.0.iter().find(|(stored, _)| stored.to_lowercase() == folded)
            })
            .map(|(stored, bytes)| (stored.as_str(), bytes))
    }

    /// All files in order of name.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &Bytes)> {
        self.0.iter().map(|(name, bytes)| (name.as_str(), bytes))
    }

    /// Bytes of all files together.
    #[must_use]
    pub fn total_bytes(&self) -> u64 {
        self.0.values().map(|bytes| bytes.len() as u64).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_one_printable_component() {
        let (longest, too_long) = ("ä".repeat(127) + "x", "ä".repeat(128));
        for name in ["a b.obj", "...", "ä", &longest] {
            assert_eq!(check_name(name), Ok(()), "{name:?}");
        }
        for name in ["", ".", "..", "a/b", "a\\b", "a\nb", "\u{85}", &too_long] {
            assert!(check_name(name).is_err(), "{name:?}");
        }
    }

    #[test]
    fn a_path_is_kept_as_its_last_component_or_refused() {
        let mut files = Files::default();
        assert_eq!(files.insert("C:\\models/a\nb\\Bunny.obj", Bytes::new()), Ok(()));
        assert!(files.find("bunny.OBJ").is_some());
        for path in ["models/", "models/..", "a\tb.obj"] {
            assert!(files.insert(path, Bytes::new()).is_err(), "{path}");
        }
        assert_eq!(files.iter().count(), 1);
    }
}
