//! What a reader has to say about a file that it could read.

use crate::limits::MAX_NOTES;

/// Something in a file that is not used as its author may have meant it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note {
    /// Where it is first met, from 1; `None`: it is about the whole file.
    pub line: Option<u64>,
    /// What was found and what happens instead.
    pub detail: String,
}

/// Notes as they are taken: one for each cause, however often it comes.
#[derive(Debug, Default)]
pub(super) struct Notes {
    causes: Vec<Cause>,
    /// Notes of further causes when [`MAX_NOTES`] are there.
    more: u64,
}

#[derive(Debug)]
struct Cause {
    line: u64,
    /// What tells it from the others.
    key: String,
    detail: String,
    times: u64,
}

impl Notes {
    /// Notes `detail` at `line`, or counts it when the same detail is there already.
    pub(super) fn add(&mut self, line: u64, detail: &str) {
        self.add_keyed(line, detail, || detail.to_owned());
    }

    /// Notes what `detail` gives at `line`, or counts it when a note of this key is there already.
    /// Only what becomes a note is put into words: a file may have millions of such lines.
    pub(super) fn add_keyed(&mut self, line: u64, key: &str, detail: impl FnOnce() -> String) {
        if let Some(known) = self.causes.iter_mut().find(|cause| cause.key == key) {
            known.times += 1;
        } else if self.causes.len() < MAX_NOTES {
            self.causes.push(Cause { line, key: key.to_owned(), detail: detail(), times: 1 });
        } else {
            self.more += 1;
        }
    }

    /// All notes in order of line.
    pub(super) fn finish(self) -> Vec<Note> {
        let mut causes = self.causes;
        causes.sort_by_key(|cause| cause.line);
        let mut notes: Vec<Note> = causes.into_iter().map(Cause::into_note).collect();
        if self.more > 0 {
            notes.push(Note { line: None, detail: format!("and {} more", self.more) });
        }
        notes
    }
}

impl Cause {
    fn into_note(self) -> Note {
        let detail = match self.times {
            1 => self.detail,
            times => format!("{} ({times} times, first here)", self.detail),
        };
        Note { line: Some(self.line), detail }
    }
}

/// `text` for a message: quoted, cut to 40 characters, without control characters.
pub(super) fn quoted(text: &str) -> String {
    let mut shown: String =
        text.chars().take(40).map(|c| if c.is_control() { '\u{FFFD}' } else { c }).collect();
    if text.chars().nth(40).is_some() {
        shown.push('…');
    }
    format!("“{shown}”")
}

/// A line for a message, [`quoted`].
pub(super) fn quoted_line(keyword: &str, rest: &str) -> String {
    quoted(format!("{keyword} {rest}").trim_end())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_cause_is_one_note() {
        let mut notes = Notes::default();
        notes.add(7, "b");
        notes.add(3, "a");
        notes.add(9, "b");
        let expected = [(3, "a"), (7, "b (2 times, first here)")];
        let expected = expected.map(|(line, detail)| Note { line: Some(line), detail: detail.to_owned() });
        assert_eq!(notes.finish(), expected);
    }

    #[test]
    fn notes_are_bounded() {
        let mut notes = Notes::default();
        for line in 0..1000 {
            notes.add(line, &format!("cause {line}"));
        }
        let notes = notes.finish();
        assert_eq!(notes.len(), MAX_NOTES + 1);
        assert_eq!(notes[MAX_NOTES].detail, "and 936 more");
    }

    #[test]
    fn quotes_are_short_and_clean() {
        assert_eq!(quoted("a\u{7}b"), "“a\u{FFFD}b”");
        assert_eq!(quoted(&"x".repeat(1000)).chars().count(), 43);
    }
}
