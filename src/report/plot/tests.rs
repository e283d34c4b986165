use super::*;

#[test]
fn numbers_are_short() {
    for (value, text) in [
        (0.0, "0"),
        (1.0, "1"),
        (0.05, "0.05"),
        (2.5, "2.5"),
        (1500.0, "1500"),
        (2e-4, "2e-4"),
        (-0.65, "-0.65"),
    ] {
        assert_eq!(short(value), text);
    }
}

#[test]
fn names_are_words_and_no_markup() {
    assert_eq!(svg::escaped("<a href=\"x\">&\u{1}"), "&lt;a href=&quot;x&quot;&gt;&amp;\u{fffd}");
}
