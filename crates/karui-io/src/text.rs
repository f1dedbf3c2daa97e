//! Lines, words and numbers of text formats, with the place of every error.

use crate::{
    error::{Error, ErrorKind, Place, Result},
    number::unflip,
};

/// Longest piece of the file that is quoted in a message, bytes.
const QUOTED: usize = 40;

/// The lines of a text, without their ends (LF or CR LF).
pub(crate) struct Lines<'a> {
    rest: &'a [u8],
    /// Number of the line returned last.
    pub line: u64,
}

impl<'a> Lines<'a> {
    pub fn new(text: &'a [u8]) -> Self {
        Self {
            rest: text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text),
            line: 0,
        }
    }

    /// What follows the line returned last.
    pub fn rest(&self) -> &'a [u8] {
        self.rest
    }

    pub fn fail(&self, kind: ErrorKind) -> Error {
        Error::new(Place::Line(self.line), kind)
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        if self.rest.is_empty() {
            return None;
        }
        let end = memchr::memchr(b'\n', self.rest).unwrap_or(self.rest.len());
        let (line, rest) = self.rest.split_at(end);
        self.rest = rest.get(1..).unwrap_or(&[]);
        self.line += 1;
        Some(line.strip_suffix(b"\r").unwrap_or(line))
    }
}

/// The words of one line.
#[derive(Clone)]
pub(crate) struct Words<'a> {
    rest: &'a [u8],
}

impl<'a> Words<'a> {
    pub fn new(line: &'a [u8]) -> Self {
        Self { rest: line }
    }

    /// What follows the word returned last, trimmed.
    pub fn rest(&self) -> &'a [u8] {
        self.rest.trim_ascii()
    }
}

impl<'a> Iterator for Words<'a> {
    type Item = &'a [u8];

    #[inline]
    fn next(&mut self) -> Option<&'a [u8]> {
        let start = self.rest.iter().position(|b| !is_space(*b))?;
        let rest = &self.rest[start..];
        let end = rest.iter().position(|b| is_space(*b)).unwrap_or(rest.len());
        let (word, rest) = rest.split_at(end);
        self.rest = rest;
        Some(word)
    }
}

#[inline]
fn is_space(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\r' | b'\n' | 0x0b | 0x0c)
}

/// The words of a text that are not in comments (`#` to the end of the line),
/// whatever lines they stand on.
pub(crate) struct Tokens<'a> {
    lines: Lines<'a>,
    words: Words<'a>,
}

impl<'a> Tokens<'a> {
    pub fn new(text: &'a [u8]) -> Self {
        Self {
            lines: Lines::new(text),
            words: Words::new(&[]),
        }
    }

    pub fn fail(&self, kind: ErrorKind) -> Error {
        self.lines.fail(kind)
    }

    /// The next word on the current line.
    pub fn same_line(&mut self) -> Option<&'a [u8]> {
        self.words.next()
    }

    /// What is left of the current line, trimmed; it counts as read.
    pub fn rest_of_line(&mut self) -> &'a [u8] {
        let rest = self.words.rest();
        self.words = Words::new(&[]);
        rest
    }

    /// The next word, or an error that names what was expected.
    pub fn expect(&mut self, what: &str) -> Result<&'a [u8]> {
        let fail = |t: &Self| t.fail(ErrorKind::truncated(what, "the end of the file"));
        self.next().ok_or_else(|| fail(self))
    }

    /// The next word as a finite number.
    pub fn number(&mut self, what: &'static str) -> Result<f32> {
        let word = self.expect(what)?;
        float(word, what).map_err(|kind| self.fail(kind))
    }

    /// The next word as a count.
    pub fn whole(&mut self, what: &'static str) -> Result<usize> {
        let word = self.expect(what)?;
        let count = integer(word).and_then(|n| usize::try_from(n).ok());
        count.ok_or_else(|| self.fail(ErrorKind::syntax(what, quote(word))))
    }

    /// Bytes not yet read; an element takes at least two.
    pub fn bytes_left(&self) -> usize {
        self.words.rest.len() + self.lines.rest.len()
    }
}

impl<'a> Iterator for Tokens<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        loop {
            if let Some(word) = self.words.next() {
                return Some(word);
            }
            let line = self.lines.next()?;
            let end = memchr::memchr(b'#', line).unwrap_or(line.len());
            self.words = Words::new(&line[..end]);
        }
    }
}

/// A finite number.
#[inline]
pub(crate) fn float(word: &[u8], what: &'static str) -> Result<f32, ErrorKind> {
    match parse::<f32>(word) {
        Some(value) if value.is_finite() => Ok(value),
        Some(_) => Err(ErrorKind::NotFinite { what }),
        None => Err(not_a_number(word, what)),
    }
}

/// The v of a texture coordinate, turned from growing upwards to downwards.
pub(crate) fn turned_v(word: &[u8]) -> Result<f32, ErrorKind> {
    const WHAT: &str = "texture coordinate";
    let v = parse::<f64>(word).ok_or_else(|| not_a_number(word, WHAT))?;
    let turned = unflip(v);
    if !turned.is_finite() {
        return Err(ErrorKind::NotFinite { what: WHAT });
    }
    Ok(turned)
}

/// Any number, also NaN and infinity in all spellings of printf.
pub(crate) fn parse<T: std::str::FromStr>(word: &[u8]) -> Option<T> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// Spellings of NaN and infinity that only some systems print.
#[cold]
fn not_a_number(word: &[u8], what: &'static str) -> ErrorKind {
    let lower = word.to_ascii_lowercase();
    let says = |mark: &[u8]| lower.windows(mark.len()).any(|w| w == mark);
    if says(b"nan") || says(b"#in") || says(b"#qn") || says(b"inf") {
        return ErrorKind::NotFinite { what };
    }
    ErrorKind::syntax(format!("a number ({what})"), quote(word))
}

/// A decimal integer.
#[inline]
pub(crate) fn integer(word: &[u8]) -> Option<i64> {
    let (negative, digits) = match word {
        [b'-', digits @ ..] => (true, digits),
        [b'+', digits @ ..] | digits => (false, digits),
    };
    if digits.is_empty() || digits.len() > 18 {
        return None;
    }
    let mut value = 0;
    for &digit in digits {
        if !digit.is_ascii_digit() {
            return None;
        }
        value = value * 10 + i64::from(digit - b'0');
    }
    Some(if negative { -value } else { value })
}

/// A piece of the file for a message: printable and short.
pub(crate) fn quote(word: &[u8]) -> String {
    let short = &word[..word.len().min(QUOTED)];
    let dots = if word.len() > QUOTED { "..." } else { "" };
    format!("`{}{dots}`", short.escape_ascii())
}

/// A name from the file; bytes that are not UTF-8 are replaced.
pub(crate) fn name(word: &[u8]) -> String {
    String::from_utf8_lossy(word).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_all_kinds() {
        let mut lines = Lines::new(b"\xef\xbb\xbfa\r\n\nb");
        assert_eq!(lines.next(), Some(&b"a"[..]));
        assert_eq!(lines.next(), Some(&b""[..]));
        assert_eq!(lines.next(), Some(&b"b"[..]));
        assert_eq!((lines.next(), lines.line), (None, 3));
    }

    #[test]
    fn tokens_skip_comments() {
        let mut tokens = Tokens::new(b"a # x y\n# z\n  1.5 4 rest of it\nnext");
        assert_eq!(tokens.next(), Some(&b"a"[..]));
        assert_eq!(tokens.same_line(), None);
        assert_eq!(tokens.number("n").unwrap(), 1.5);
        assert_eq!(tokens.whole("n").unwrap(), 4);
        assert_eq!(tokens.rest_of_line(), b"rest of it");
        let error = tokens.number("height").unwrap_err();
        assert_eq!(
            error.to_string(),
            "line 4: expected a number (height), found `next`"
        );
    }

    #[test]
    fn numbers() {
        assert_eq!(integer(b"-12"), Some(-12));
        assert_eq!(integer(b"+3"), Some(3));
        for bad in [&b""[..], b"-", b"1.0", b"9999999999999999999", b"0x1"] {
            assert_eq!(integer(bad), None);
        }
        for bad in ["nan", "-nan(ind)", "1e99", "-inf", "1.#QNAN", "1.#INF"] {
            let error = float(bad.as_bytes(), "x").unwrap_err();
            assert!(matches!(error, ErrorKind::NotFinite { .. }), "{bad}");
        }
        assert!(float(b"1,5", "x").is_err());
        assert!(float(b"\xff", "x").is_err());
    }

    #[test]
    fn quotes_are_short_and_printable() {
        assert_eq!(quote(b"a\x00"), "`a\\x00`");
        assert_eq!(quote(&[b'x'; 100]).len(), 45);
    }
}
