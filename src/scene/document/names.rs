//! Names of entries. How long they may be is for the limits to say.

use crate::limits::MAX_NAME_CHARS;

/// What is wrong with a name, to follow "the name".
#[must_use]
pub(crate) fn problem(name: &str) -> Option<&'static str> {
    if name.is_empty() {
        Some("must not be empty")
    } else if name.chars().any(char::is_control) {
        Some("must not hold control characters")
    } else {
        None
    }
}

/// `text` as a name, with room for a number behind it.
#[must_use]
pub(crate) fn cleaned(text: &str) -> String {
    let name: String = text.chars().filter(|c| !c.is_control()).take(MAX_NAME_CHARS - 24).collect();
    if name.is_empty() { "model".to_owned() } else { name }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cleaned_names_are_names() {
        for text in ["", "\u{7}", "a\nb", &"x".repeat(1000), "bunny"] {
            let name = cleaned(text);
            assert_eq!(problem(&name), None);
            assert!(name.chars().count() <= MAX_NAME_CHARS);
        }
    }
}
