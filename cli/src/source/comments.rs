//! Comments in request files. Proto3 JSON has none, and a file that a person edits wants some: `// …` to the end of the line
//! and `/* … */` are read as blanks, outside of texts. What is left is the JSON of the message: there is no second schema.

use std::borrow::Cow;

/// `text` with blanks in place of its comments, so that whatever is said of it names the same line and column.
pub(super) fn without_comments(text: &str) -> Cow<'_, str> {
    if !text.contains("//") && !text.contains("/*") {
        return Cow::Borrowed(text);
    }
    let mut out = String::with_capacity(text.len());
    let mut place = Place::Code;
    let mut chars = text.chars().peekable();
    while let Some(c) = chars.next() {
        let next = chars.peek().copied();
        let (kept, after) = match (place, c) {
            (Place::Code, '"') => (true, Place::Text),
            (Place::Code, '/') if next == Some('/') => (false, Place::Line),
            (Place::Code, '/') if next == Some('*') => {
                // Its star is not the one that closes it.
                blank(&mut out, chars.next().unwrap_or_default());
                (false, Place::Block)
            }
            (Place::Text, '\\') => (true, Place::Escape),
            (Place::Text, '"') | (Place::Line, '\n') => (true, Place::Code),
            (Place::Escape, _) => (true, Place::Text),
            (Place::Block, '*') if next == Some('/') => {
                blank(&mut out, chars.next().unwrap_or_default());
                (false, Place::Code)
            }
            (Place::Line | Place::Block, _) => (false, place),
            (Place::Code | Place::Text, _) => (true, place),
        };
        if kept {
            out.push(c)
        } else {
            blank(&mut out, c)
        }
        place = after;
    }
    Cow::Owned(out)
}

#[derive(Clone, Copy)]
enum Place {
    Code,
    Text,
    Escape,
    Line,
    Block,
}

/// As many bytes as `c` has: the reader of JSON counts bytes.
fn blank(out: &mut String, c: char) {
    if c == '\n' {
        return out.push('\n');
    }
    out.extend(std::iter::repeat_n(' ', c.len_utf8()));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_are_blanks_and_texts_are_not() {
        let rows = [
            (r#"{"a": 1} // one"#, r#"{"a": 1}       "#),
            ("{// µ\n}", "{     \n}"),
            ("[1, /* two\n, */ 3]", "[1,       \n     3]"),
            (r#"{"url": "http://a/*b*/"}"#, r#"{"url": "http://a/*b*/"}"#),
            (r#"{"a": "\"// no"} /*/ yes */"#, r#"{"a": "\"// no"}           "#),
            ("1 / 2", "1 / 2"),
            ("/* never closed", "               "),
        ];
        for (given, wanted) in rows {
            assert_eq!(without_comments(given), wanted, "{given}");
            assert_eq!(without_comments(given).len(), given.len(), "{given}");
        }
    }
}
