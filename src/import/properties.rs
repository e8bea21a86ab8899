//! Properties as Java writes them: `key=value` lines, with comments, escapes and lines that go on.
//!
//! *Based on:* the description of `java.util.Properties.load`.

use std::ops::Range;

use crate::diagnostic::Diagnostic;

/// One key with its value.
#[derive(Debug)]
pub(super) struct Property {
    pub(super) key: String,
    pub(super) value: String,
    /// Where the value stands.
    pub(super) span: Range<usize>,
    /// Whether the file holds the value letter by letter, without escapes.
    is_plain: bool,
}

impl Property {
    /// Where a part of the value stands: all of it if that has escapes.
    pub(super) fn place(&self, part: &Range<usize>) -> Range<usize> {
        match self.is_plain {
            true => self.span.start + part.start..self.span.start + part.end,
            false => self.span.clone(),
        }
    }
}

/// All properties of a text; of those with the same key only the last one counts, which stands last.
pub(super) fn read(text: &str) -> Result<Vec<Property>, Diagnostic> {
    let mut found: Vec<Property> = Vec::new();
    let mut rest = Cursor { text, at: 0 };
    while rest.at < text.len() {
        if let Some(property) = rest.property()? {
            found.retain(|earlier| earlier.key != property.key);
            found.push(property);
        }
    }
    Ok(found)
}

struct Cursor<'a> {
    text: &'a str,
    at: usize,
}

impl Cursor<'_> {
    fn peek(&self) -> Option<char> {
        self.text[self.at..].chars().next()
    }

    fn next(&mut self) -> Option<char> {
        let next = self.peek()?;
        self.at += next.len_utf8();
        Some(next)
    }

    fn skip(&mut self, is_skipped: impl Fn(char) -> bool) {
        while self.peek().is_some_and(&is_skipped) {
            self.next();
        }
    }

    /// The property of the next logical line, unless that is empty or a comment.
    fn property(&mut self) -> Result<Option<Property>, Diagnostic> {
        self.skip(|c| is_blank(c) || is_end(c));
        match self.peek() {
            None => return Ok(None),
            Some('#' | '!') => {
                self.skip(|c| !is_end(c));
                return Ok(None);
            }
            Some(_) => {}
        }
        let (key, _) = self.part(|c| is_blank(c) || matches!(c, '=' | ':'))?;
        self.skip(is_blank);
        if matches!(self.peek(), Some('=' | ':')) {
            self.next();
            self.skip(is_blank);
        }
        let (value, span) = self.part(|_| false)?;
        let is_plain = self.text[span.clone()] == value;
        Ok(Some(Property { key, value, span, is_plain }))
    }

    /// What stands before the end of the logical line, or before a character that ends the part.
    fn part(&mut self, ends: impl Fn(char) -> bool) -> Result<(String, Range<usize>), Diagnostic> {
        let start = self.at;
        let mut part = String::new();
        while let Some(c) = self.peek().filter(|&c| !is_end(c) && !ends(c)) {
            self.next();
            match c {
                '\\' => part.extend(self.escaped()?),
                _ => part.push(c),
            }
        }
        Ok((part, start..self.at))
    }

    /// What a backslash and the next characters mean.
    fn escaped(&mut self) -> Result<Option<char>, Diagnostic> {
        let start = self.at - 1;
        Ok(Some(match self.next() {
            None => return Ok(None),
            Some(c) if is_end(c) => {
                if c == '\r' && self.peek() == Some('\n') {
                    self.next();
                }
                self.skip(is_blank);
                return Ok(None);
            }
            Some('t') => '\t',
            Some('n') => '\n',
            Some('r') => '\r',
            Some('f') => '\u{c}',
            Some('u') => {
                let code = self.text.get(self.at..self.at + 4);
                let code = code.and_then(|code| u32::from_str_radix(code, 16).ok());
                let Some(code) = code else {
                    return Err(Diagnostic::new(start..self.at, "`\\u` stands without its code")
                        .label("four digits from 0 to f are missing")
                        .help("write a backslash as `\\\\`"));
                };
                self.at += 4;
                // Halves of pairs, which stand for rare characters, matter to nobody here.
                char::from_u32(code).unwrap_or(char::REPLACEMENT_CHARACTER)
            }
            Some(c) => c,
        }))
    }
}

fn is_blank(c: char) -> bool {
    matches!(c, ' ' | '\t' | '\u{c}')
}

fn is_end(c: char) -> bool {
    matches!(c, '\n' | '\r')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn properties_are_read_as_java_reads_them() {
        let text = "#a=1\n ! b\r\nc = 2 \n d:3\\\n   4\ne\\=\\u0041 5\n\nf\nc=\\\\\n";
        let read: Vec<_> = read(text).unwrap().into_iter().map(|p| (p.key, p.value)).collect();
        let pairs = [("d", "34"), ("e=A", "5"), ("f", ""), ("c", "\\")];
        assert_eq!(read, pairs.map(|(key, value)| (key.to_owned(), value.to_owned())));
    }

    #[test]
    fn places_are_those_of_the_file() {
        let text = "a=x+y\nb=x\\u002by";
        let [a, b] = read(text).unwrap().try_into().unwrap();
        assert_eq!(&text[a.place(&(1..2))], "+");
        assert_eq!((b.value.as_str(), &text[b.place(&(1..2))]), ("x+y", "x\\u002by"));
    }

    #[test]
    fn codes_have_four_digits() {
        let mistake = read("a=\\u12").unwrap_err();
        assert_eq!(mistake.span, 2..4);
        for text in ["\\", "a=\\", "a=\\u12é4", "\\u+001"] {
            let _ = read(text);
        }
    }
}
