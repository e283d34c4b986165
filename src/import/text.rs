//! Text files of unknown origin: encodings, line ends, continuations.

use super::notes::Notes;
use std::borrow::Cow;

/// Why bytes were refused as text.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum TextError {
    /// UTF-16, as some Windows editors write it.
    #[error("the file is UTF-16; save it as UTF-8")]
    Utf16,
    /// Control characters that no text has.
    #[error("this is not text (byte {byte:#04x})")]
    Binary {
        /// Line of the first such byte, from 1.
        line: u64,
        /// That byte.
        byte: u8,
    },
}

impl TextError {
    /// Where it is, from 1.
    #[must_use]
    pub fn line(&self) -> u64 {
        match self {
            Self::Utf16 => 1,
            Self::Binary { line, .. } => *line,
        }
    }
}

/// The text of a file, without a byte order mark.
///
/// What is not UTF-8 is read as Latin-1, as older exporters write it, with a note: names then still
/// match between OBJ and MTL, and mostly those of the files too.
///
/// # Errors
/// UTF-16, and bytes that are no text at all.
pub(super) fn decode<'a>(bytes: &'a [u8], notes: &mut Notes) -> Result<Cow<'a, str>, TextError> {
    if looks_like_utf16(bytes) {
        return Err(TextError::Utf16);
    }
    if let Some(at) = first_binary(bytes) {
        return Err(TextError::Binary { line: line_at(bytes, at), byte: bytes[at] });
    }
    let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    match std::str::from_utf8(bytes) {
        Ok(text) => Ok(Cow::Borrowed(text)),
        Err(error) => {
            notes.add(line_at(bytes, error.valid_up_to()), "not UTF-8: the file is read as Latin-1");
            Ok(Cow::Owned(bytes.iter().copied().map(char::from).collect()))
        }
    }
}

/// A byte order mark, or an ASCII character in 16 bits to begin with.
fn looks_like_utf16(bytes: &[u8]) -> bool {
    matches!(bytes, [0xFF, 0xFE, ..] | [0xFE, 0xFF, ..] | [0, 1..=0x7F, ..] | [1..=0x7F, 0, ..])
}

/// Control characters but tab, line feed, vertical tab, form feed, carriage return, and the end mark
/// of DOS (0x1A).
fn is_binary(byte: u8) -> bool {
    matches!(byte, 0..=8 | 14..=25 | 27..=31)
}

/// Where the first such byte is. Blocks are checked as a whole, which compiles to SIMD; byte by byte
/// this would cost as much as all the rest of the scan.
fn first_binary(bytes: &[u8]) -> Option<usize> {
    let holds_any = |block: &[u8]| block.iter().fold(false, |any, byte| any | is_binary(*byte));
    let block = bytes.chunks(BLOCK).position(holds_any)?;
    let start = block * BLOCK;
    let within = bytes[start..].iter().position(|byte| is_binary(*byte))?;
    Some(start + within)
}

/// Bytes that [`first_binary`] checks at once.
const BLOCK: usize = 4096;

/// Line of the byte at `at`, from 1.
fn line_at(bytes: &[u8], at: usize) -> u64 {
    let line_feeds = bytes[..at].iter().filter(|byte| **byte == b'\n').count();
    1 + line_feeds as u64
}

/// A line after its continuations are joined.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Line<'a> {
    /// Number of its first physical line, from 1.
    pub number: u64,
    /// Without blanks at either end.
    pub text: Cow<'a, str>,
}

/// Logical lines of a text: LF, CRLF or CR end a line, a `\` before the end continues it.
///
/// Empty lines and comment lines are left out; a comment never continues, or one that ends in a
/// Windows path would swallow the line below it.
pub(super) struct Lines<'a> {
    rest: &'a str,
    number: u64,
    /// Whether a CR without LF ends lines here; searching for one character is faster.
    lone_cr: bool,
}

impl<'a> Lines<'a> {
    pub(super) fn new(text: &'a str) -> Self {
        let is_lone = |(at, _): (usize, &str)| text.as_bytes().get(at + 1) != Some(&b'\n');
        let lone_cr = text.match_indices('\r').any(is_lone);
        Self { rest: text, number: 0, lone_cr }
    }

    /// The next physical line, of whose end a CR may be left.
    fn physical(&mut self) -> Option<&'a str> {
        if self.rest.is_empty() {
            return None;
        }
        self.number += 1;
        let end = if self.lone_cr { self.rest.find(['\n', '\r']) } else { self.rest.find('\n') };
        let (line, rest) = self.rest.split_at(end.unwrap_or(self.rest.len()));
        self.rest = rest.strip_prefix("\r\n").or_else(|| rest.get(1..)).unwrap_or("");
        Some(line)
    }

    /// The lines that continue one which ends in `\`, appended to it.
    fn joined(&mut self, first: &'a str) -> String {
        let mut text = first.to_owned();
        while let Some(next) = self.physical() {
            text.push(' ');
            match next.trim_end().strip_suffix('\\') {
                Some(part) => text.push_str(part),
                None => {
                    text.push_str(next);
                    break;
                }
            }
        }
        text
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = Line<'a>;

    fn next(&mut self) -> Option<Line<'a>> {
        loop {
            let line = trim(self.physical()?);
            let number = self.number;
            if line.is_empty() || line.starts_with('#') {
                continue;
            }
            let text = match line.strip_suffix('\\') {
                None => Cow::Borrowed(line),
                Some(first) => Cow::Owned(trim(&self.joined(first)).to_owned()),
            };
            return Some(Line { number, text });
        }
    }
}

/// Without blanks, and the end mark of DOS, at either end.
fn trim(line: &str) -> &str {
    line.trim_matches(|c: char| c.is_ascii_whitespace() || matches!(c, '\u{B}' | '\u{1A}'))
}

/// The first word of a line and the rest of it, trimmed.
pub(super) fn keyword_and_rest(line: &str) -> (&str, &str) {
    match line.split_once(|c: char| c.is_ascii_whitespace()) {
        Some((keyword, rest)) => (keyword, trim(rest)),
        None => (line, ""),
    }
}

/// Up to the first `#`: what a line of numbers says.
pub(super) fn without_comment(rest: &str) -> &str {
    rest.split('#').next().unwrap_or(rest)
}

/// A name that may hold blanks: up to a `#` that stands alone, so that “Material #25” stays whole.
pub(super) fn name_without_comment(rest: &str) -> &str {
    let is_comment = |at: usize| {
        let after = rest[at + 1..].chars().next();
        (at == 0 || rest[..at].ends_with([' ', '\t']))
            && after.is_none_or(|c| c.is_ascii_whitespace() || c == '#')
    };
    let end = rest.match_indices('#').map(|(at, _)| at).find(|at| is_comment(*at)).unwrap_or(rest.len());
    trim(&rest[..end])
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn lines(text: &str) -> Vec<(u64, String)> {
        Lines::new(text).map(|line| (line.number, line.text.into_owned())).collect()
    }

    #[test]
    fn every_line_end_counts_once() {
        let expected: Vec<_> = [(1, "a"), (2, "b"), (4, "c")].map(|(n, s)| (n, s.to_owned())).into();
        for text in
            ["a\nb\n\nc", "a\r\nb\r\n\r\nc\r\n", "a\rb\r\rc\r", "a\rb\r\n\nc\r\n", "  a\t\n b\n \t \nc\n"]
        {
            assert_eq!(lines(text), expected, "{text:?}");
        }
    }

    #[test]
    fn a_backslash_continues_the_line() {
        assert_eq!(lines("f 1 \\\r\n 2\\\n3\nv"), [(1, "f 1   2 3".to_owned()), (4, "v".to_owned())]);
        assert_eq!(lines("f 1 \\"), [(1, "f 1".to_owned())]);
    }

    #[test]
    fn a_comment_does_not_continue() {
        assert_eq!(lines("# C:\\models\\\nv 1"), [(2, "v 1".to_owned())]);
    }

    #[test]
    fn utf16_and_binaries_are_refused() {
        let refused = |bytes: &[u8]| decode(bytes, &mut Notes::default()).unwrap_err();
        assert_eq!(refused(b"\xFF\xFEv\0"), TextError::Utf16);
        assert_eq!(refused(b"v\0 \0"), TextError::Utf16);
        assert_eq!(refused(b"\0v\0 "), TextError::Utf16);
        assert_eq!(refused(b"v 1\nv \x07"), TextError::Binary { line: 2, byte: 7 });
        let late = [vec![b'\n'; 3 * BLOCK + 5], vec![0x1F]].concat();
        assert_eq!(refused(&late).line(), 3 * BLOCK as u64 + 6);
    }

    #[test]
    fn a_byte_order_mark_is_skipped_and_latin1_is_noted() {
        let mut notes = Notes::default();
        assert_eq!(decode(b"\xEF\xBB\xBFv", &mut notes).unwrap(), "v");
        assert_eq!(decode(b"\ng W\xFCrfel", &mut notes).unwrap(), "\ng Würfel");
        assert_eq!(notes.finish()[0].line, Some(2));
    }

    #[test]
    fn a_hash_in_a_name_is_no_comment() {
        assert_eq!(name_without_comment("Material #25"), "Material #25");
        assert_eq!(name_without_comment("red # the red one"), "red");
        assert_eq!(name_without_comment("a#b ## c"), "a#b");
        assert_eq!(name_without_comment("# c"), "");
        assert_eq!(name_without_comment("#1"), "#1");
    }

    proptest! {
        #[test]
        fn any_bytes_give_lines_or_an_error(bytes: Vec<u8>) {
            if let Ok(text) = decode(&bytes, &mut Notes::default()) {
                let count = Lines::new(&text).count();
                prop_assert!(count <= bytes.len());
            }
        }
    }
}
