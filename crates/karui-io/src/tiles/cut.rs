//! The text of a tileset cut into tiles.
//!
//! A JSON parser descends as deep as the text is nested, and a tree of tiles
//! may be deeper than any stack. So the text is first cut, without recursion,
//! into one small object a tile; each is then parsed by itself.

use crate::error::{Error, ErrorKind, Place, Result};
use serde::de::IgnoredAny;
use serde_json::{Map, Value};

/// A tileset in pieces.
#[derive(Debug)]
pub(super) struct Pieces {
    /// The document with `null` for `root`.
    pub document: Map<String, Value>,
    /// Tiles, parents before children.
    pub tiles: Vec<Piece>,
    /// Children that are no objects: parent and index.
    pub strangers: Vec<(u32, usize)>,
}

/// A tile in pieces.
#[derive(Debug, Default)]
pub(super) struct Piece {
    pub parent: Option<u32>,
    /// `None` if there is no such array.
    pub children: Option<Vec<u32>>,
    /// The other properties.
    pub json: Map<String, Value>,
}

/// What the scanner is in the middle of.
enum Open {
    /// An object that is copied: the document or a tile.
    Object {
        tile: Option<u32>,
        copy: Vec<u8>,
        /// Where what is not yet copied begins.
        from: usize,
    },
    /// The children of a tile.
    Children { parent: u32, count: usize },
}

struct Scanner<'t> {
    text: &'t [u8],
    at: usize,
    open: Vec<Open>,
    pieces: Pieces,
}

/// The scanner does not understand the text.
struct Lost;

/// Cuts a tileset into its tiles.
///
/// # Errors
/// [`ErrorKind::Syntax`] if the text is no JSON object.
pub(super) fn cut(text: &[u8]) -> Result<Pieces> {
    let mut scanner = Scanner {
        text,
        at: 0,
        open: Vec::new(),
        pieces: Pieces {
            document: Map::new(),
            tiles: Vec::new(),
            strangers: Vec::new(),
        },
    };
    match scanner.run() {
        Ok(()) => Ok(scanner.pieces),
        Err(Lost) => Err(not_json(text, scanner.at)),
    }
}

/// The parser's words about what the scanner does not understand.
fn not_json(text: &[u8], at: usize) -> Error {
    let said = serde_json::from_slice::<IgnoredAny>(text).err();
    let found = said.map_or_else(|| "something else".to_owned(), |e| e.to_string());
    Error::new(
        Place::Byte(at as u64),
        ErrorKind::syntax("a JSON object", found),
    )
}

impl Scanner<'_> {
    fn run(&mut self) -> Result<(), Lost> {
        self.space();
        self.enter_object(None)?;
        while let Some(open) = self.open.last() {
            match *open {
                Open::Object { tile, .. } => self.member(tile)?,
                Open::Children { parent, count } => self.child(parent, count)?,
            }
        }
        self.space();
        if self.at < self.text.len() {
            return Err(Lost);
        }
        Ok(())
    }

    /// The next member of an object, or its end.
    fn member(&mut self, tile: Option<u32>) -> Result<(), Lost> {
        self.space();
        if self.take(b'}') {
            return self.leave_object();
        }
        self.take(b',');
        self.space();
        let key = self.string()?;
        let key = &self.text[key.0..key.1];
        self.space();
        self.expect(b':')?;
        self.space();
        match (tile, key, self.text.get(self.at)) {
            (None, b"root", Some(b'{')) if self.pieces.tiles.is_empty() => {
                self.replace();
                self.pieces.tiles.push(Piece::default());
                self.enter_object(Some(0))
            }
            (Some(parent), b"children", Some(b'[')) => {
                self.replace();
                self.at += 1;
                let list = &mut self.pieces.tiles[parent as usize].children;
                list.get_or_insert_default();
                self.open.push(Open::Children { parent, count: 0 });
                Ok(())
            }
            _ => self.skip_value(),
        }
    }

    /// The next child, or the end of the children.
    fn child(&mut self, parent: u32, count: usize) -> Result<(), Lost> {
        self.space();
        if self.take(b']') {
            self.open.pop();
            return self.resume();
        }
        if count > 0 {
            self.expect(b',')?;
            self.space();
        }
        if let Some(Open::Children { count, .. }) = self.open.last_mut() {
            *count += 1;
        }
        if self.text.get(self.at) != Some(&b'{') {
            self.pieces.strangers.push((parent, count));
            return self.skip_value();
        }
        let tile = u32::try_from(self.pieces.tiles.len()).map_err(|_| Lost)?;
        self.pieces.tiles.push(Piece {
            parent: Some(parent),
            ..Piece::default()
        });
        let siblings = &mut self.pieces.tiles[parent as usize].children;
        siblings.get_or_insert_default().push(tile);
        self.enter_object(Some(tile))
    }

    fn enter_object(&mut self, tile: Option<u32>) -> Result<(), Lost> {
        let from = self.at;
        self.expect(b'{')?;
        self.open.push(Open::Object {
            tile,
            copy: Vec::new(),
            from,
        });
        Ok(())
    }

    fn leave_object(&mut self) -> Result<(), Lost> {
        let Some(Open::Object {
            tile,
            mut copy,
            from,
        }) = self.open.pop()
        else {
            return Err(Lost);
        };
        copy.extend(&self.text[from..self.at]);
        let mut json: Map<String, Value> = serde_json::from_slice(&copy).map_err(|_| Lost)?;
        match tile {
            Some(tile) => {
                // The placeholder of the children that were cut out.
                if self.pieces.tiles[tile as usize].children.is_some() {
                    json.shift_remove("children");
                }
                self.pieces.tiles[tile as usize].json = json;
            }
            None => self.pieces.document = json,
        }
        if tile == Some(0) {
            return self.resume();
        }
        Ok(())
    }

    /// Copies what lies before a value and puts `null` for the value.
    fn replace(&mut self) {
        let (text, at) = (self.text, self.at);
        if let Some(Open::Object { copy, from, .. }) = self.open.last_mut() {
            copy.extend(&text[*from..at]);
            copy.extend(b"null");
        }
    }

    /// Goes on copying behind a value that was replaced.
    fn resume(&mut self) -> Result<(), Lost> {
        let at = self.at;
        match self.open.last_mut() {
            Some(Open::Object { from, .. }) => *from = at,
            _ => return Err(Lost),
        }
        Ok(())
    }

    /// Passes over a value, however deep; that it is one is found out when
    /// the copy is parsed, or here for what is never copied.
    fn skip_value(&mut self) -> Result<(), Lost> {
        let (start, mut depth) = (self.at, 0usize);
        while let Some(&byte) = self.text.get(self.at) {
            match byte {
                b'"' => {
                    self.string()?;
                    continue;
                }
                b'{' | b'[' => depth += 1,
                b'}' | b']' if depth == 0 => break,
                b'}' | b']' => depth -= 1,
                b',' if depth == 0 => break,
                _ => {}
            }
            self.at += 1;
        }
        if self.at == start || depth > 0 {
            return Err(Lost);
        }
        Ok(())
    }

    /// The inside of a string.
    fn string(&mut self) -> Result<(usize, usize), Lost> {
        self.expect(b'"')?;
        let start = self.at;
        while let Some(&byte) = self.text.get(self.at) {
            match byte {
                b'"' => {
                    self.at += 1;
                    return Ok((start, self.at - 1));
                }
                b'\\' => self.at += 2,
                _ => self.at += 1,
            }
        }
        Err(Lost)
    }

    fn space(&mut self) {
        while self.text.get(self.at).is_some_and(u8::is_ascii_whitespace) {
            self.at += 1;
        }
    }

    fn take(&mut self, byte: u8) -> bool {
        let there = self.text.get(self.at) == Some(&byte);
        self.at += usize::from(there);
        there
    }

    fn expect(&mut self, byte: u8) -> Result<(), Lost> {
        self.take(byte).then_some(()).ok_or(Lost)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn count(text: &str) -> Option<usize> {
        cut(text.as_bytes()).ok().map(|p| p.tiles.len())
    }

    #[test]
    fn tiles_are_found_wherever_their_children_stand() {
        let text = r#" {"root" : {"children":[{"a":"}]"} , {"children":[{}]}],"b":{"children":[{}]}},"x":[{}]} "#;
        let pieces = cut(text.as_bytes()).unwrap();
        let parents: Vec<_> = pieces.tiles.iter().map(|t| t.parent).collect();
        assert_eq!(parents, [None, Some(0), Some(0), Some(2)]);
        assert_eq!(pieces.tiles[1].json["a"], "}]");
        assert_eq!(
            pieces.tiles[0].json["b"]["children"][0],
            Value::Object(Map::new())
        );
        assert_eq!(pieces.document["x"][0], Value::Object(Map::new()));
    }

    #[test]
    fn strangers_among_children_are_told() {
        let pieces = cut(br#"{"root":{"children":[{},7,[1,2]]}}"#).unwrap();
        assert_eq!(pieces.strangers, [(0, 1), (0, 2)]);
    }

    #[test]
    fn a_hundred_thousand_levels() {
        let levels = 100_000;
        let text = format!(
            "{{\"root\":{}{{}}{}}}",
            "{\"children\":[".repeat(levels),
            "]}".repeat(levels)
        );
        assert_eq!(count(&text), Some(levels + 1));
    }

    #[test]
    fn what_is_no_json_is_refused() {
        for text in [
            "",
            "[]",
            "{",
            "{}}",
            r#"{"root":{}"#,
            r#"{"root":{"children":[{} {}]}}"#,
            r#"{"root":{"children":[{},]}}"#,
            r#"{"root":{"children":[{}]]}}"#,
            r#"{"root":{"a":1 "b":2}}"#,
            r#"{"root":{"a":NaN}}"#,
            r#"{"root":{,"a":1}}"#,
            r#"{"a"}"#,
        ] {
            assert_eq!(count(text), None, "{text}");
        }
        let deep = format!(
            "{{\"extras\":{}{}}}",
            "[".repeat(100_000),
            "]".repeat(100_000)
        );
        assert_eq!(count(&deep), None);
    }
}
