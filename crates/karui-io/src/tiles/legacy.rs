//! The tile formats of 3D Tiles 1.0: headers and lengths, and the glTF within.

use super::findings::Notes;
use serde_json::Value;

/// What a tile of the old formats holds.
#[derive(Debug, Default)]
pub(super) struct Legacy<'a> {
    /// GLBs with the `RTC_CENTER` of their tile, metres; `None` where the
    /// place of the model is said by instances.
    pub models: Vec<(&'a [u8], Option<[f64; 3]>)>,
}

/// Composite tiles within composite tiles that are read.
const DEPTH: u32 = 16;

/// Whether the bytes begin like a tile of 3D Tiles 1.0.
pub(super) fn is_legacy(bytes: &[u8]) -> bool {
    [b"b3dm", b"i3dm", b"cmpt", b"pnts"]
        .iter()
        .any(|m| bytes.starts_with(*m))
}

/// Takes a tile apart; what is wrong is noted at `place`.
pub(super) fn read<'a>(bytes: &'a [u8], place: &str, notes: &mut Notes<'_>) -> Legacy<'a> {
    let mut found = Legacy::default();
    tile(bytes, place, 0, &mut found, notes);
    found
}

fn tile<'a>(
    bytes: &'a [u8],
    place: &str,
    depth: u32,
    found: &mut Legacy<'a>,
    notes: &mut Notes<'_>,
) {
    let Some([version, length]) = words(bytes, 4) else {
        let size = format!("{} bytes", bytes.len());
        return notes.error(place, "tile-header", "a header of at least 12 bytes", size);
    };
    if version != 1 {
        return notes.error(place, "tile-version", "version 1", version.to_string());
    }
    if length as usize != bytes.len() {
        let size = format!("{} bytes", bytes.len());
        return notes.error(place, "tile-length", format!("{length} bytes"), size);
    }
    match &bytes[..4] {
        b"b3dm" => parts(bytes, place, 28, found, notes),
        b"i3dm" => parts(bytes, place, 32, found, notes),
        b"pnts" => parts(bytes, place, 28, found, notes),
        b"cmpt" => inner_tiles(bytes, place, depth, found, notes),
        other => {
            let other = String::from_utf8_lossy(other).into_owned();
            notes.error(place, "tile-magic", "b3dm, i3dm, pnts or cmpt", other);
        }
    }
}

fn words<const N: usize>(bytes: &[u8], at: usize) -> Option<[u32; N]> {
    let words = bytes.get(at..at + 4 * N)?.as_chunks::<4>().0;
    words
        .iter()
        .map(|w| u32::from_le_bytes(*w))
        .collect::<Vec<_>>()
        .try_into()
        .ok()
}

/// Feature table, batch table and the model behind them.
fn parts<'a>(
    bytes: &'a [u8],
    place: &str,
    header: usize,
    found: &mut Legacy<'a>,
    notes: &mut Notes<'_>,
) {
    let Some(lengths) = words::<4>(bytes, 12).filter(|_| bytes.len() >= header) else {
        let size = format!("{} bytes", bytes.len());
        return notes.error(
            place,
            "tile-header",
            format!("a header of {header} bytes"),
            size,
        );
    };
    let tables: u64 = lengths.iter().map(|l| u64::from(*l)).sum();
    let room = (bytes.len() - header) as u64;
    if tables > room {
        let expected = format!("tables within {room} bytes");
        return notes.error(place, "tile-tables", expected, format!("{tables} bytes"));
    }
    let json = &bytes[header..header + lengths[0] as usize];
    let features: Option<Value> = if json.is_empty() {
        Some(Value::Null)
    } else {
        serde_json::from_slice(json).ok()
    };
    let Some(features) = features else {
        return notes.error(place, "feature-table", "JSON", "something else");
    };
    let required = match &bytes[..4] {
        b"b3dm" => "BATCH_LENGTH",
        b"i3dm" => "INSTANCES_LENGTH",
        _ => "POINTS_LENGTH",
    };
    if features.get(required).is_none() {
        notes.error(place, "feature-table", format!("`{required}`"), "none");
    }
    let model = &bytes[header + tables as usize..];
    if bytes.starts_with(b"pnts") {
        return;
    }
    if model.starts_with(b"glTF") {
        let center = bytes.starts_with(b"b3dm").then(|| rtc_center(&features));
        found.models.push((model, center));
    } else if bytes.starts_with(b"b3dm") || words(bytes, 28) == Some([1]) {
        notes.error(place, "tile-model", "a GLB", "other bytes");
    }
}

fn rtc_center(features: &Value) -> [f64; 3] {
    let number = |i: usize| {
        features
            .pointer(&format!("/RTC_CENTER/{i}"))
            .and_then(Value::as_f64)
    };
    [0, 1, 2].map(|i| number(i).unwrap_or(0.0))
}

fn inner_tiles<'a>(
    bytes: &'a [u8],
    place: &str,
    depth: u32,
    found: &mut Legacy<'a>,
    notes: &mut Notes<'_>,
) {
    let Some([count]) = words(bytes, 12) else {
        let size = format!("{} bytes", bytes.len());
        return notes.error(place, "tile-header", "a header of 16 bytes", size);
    };
    if depth >= DEPTH {
        let expected = format!("at most {DEPTH} composite tiles within each other");
        return notes.error(place, "tile-depth", expected, "more");
    }
    let mut at = 16;
    for i in 0..count {
        let place = format!("{place}/{i}");
        let length = words(bytes, at + 8).map_or(0, |[l]: [u32; 1]| l as usize);
        match bytes.get(at..at + length).filter(|_| length >= 12) {
            Some(inner) => tile(inner, &place, depth + 1, found, notes),
            None => {
                let expected = format!("{count} tiles");
                return notes.error(&place, "tile-count", expected, format!("{i}"));
            }
        }
        at += length;
    }
    if at != bytes.len() {
        let found = format!("{} bytes behind the last", bytes.len() - at);
        notes.error(
            place,
            "tile-count",
            format!("{count} tiles and nothing else"),
            found,
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tiles::Findings;
    use std::path::Path;

    fn rules(bytes: &[u8]) -> Vec<&'static str> {
        let mut findings = Findings::default();
        let mut notes = Notes {
            file: Path::new("t"),
            findings: &mut findings,
        };
        read(bytes, "", &mut notes);
        findings.errors.iter().map(|f| f.rule).collect()
    }

    fn b3dm(model: &[u8]) -> Vec<u8> {
        let json = b"{\"BATCH_LENGTH\":0}  ";
        let length = 28 + json.len() + model.len();
        let mut bytes = b"b3dm".to_vec();
        for word in [1, length as u32, json.len() as u32, 0, 0, 0] {
            bytes.extend(u32::to_le_bytes(word));
        }
        [bytes, json.to_vec(), model.to_vec()].concat()
    }

    fn cmpt(tiles: &[Vec<u8>]) -> Vec<u8> {
        let inner = tiles.concat();
        let mut bytes = b"cmpt".to_vec();
        for word in [1, 16 + inner.len() as u32, tiles.len() as u32] {
            bytes.extend(u32::to_le_bytes(word));
        }
        [bytes, inner].concat()
    }

    #[test]
    fn models_are_found_in_composites() {
        let one = b3dm(b"glTF");
        let both = cmpt(&[one.clone(), cmpt(&[one])]);
        let mut findings = Findings::default();
        let mut notes = Notes {
            file: Path::new("t"),
            findings: &mut findings,
        };
        assert_eq!(read(&both, "", &mut notes).models.len(), 2);
        assert_eq!(findings, Findings::default());
    }

    #[test]
    fn what_is_broken_is_told() {
        let good = b3dm(b"glTF");
        assert_eq!(rules(&good[..10]), ["tile-header"]);
        assert_eq!(rules(&good[..good.len() - 1]), ["tile-length"]);
        assert_eq!(rules(&b3dm(b"no model")), ["tile-model"]);
        let change = |at: usize, byte| {
            let mut bytes = good.clone();
            bytes[at] = byte;
            rules(&bytes)
        };
        assert_eq!(change(4, 2), ["tile-version"]);
        assert_eq!(change(15, 255), ["tile-tables"]);
        assert_eq!(change(28, b'['), ["feature-table"]);
        assert_eq!(change(30, b'X'), ["feature-table"]);
        let mut more = cmpt(std::slice::from_ref(&good));
        more[12] = 2;
        assert_eq!(rules(&more), ["tile-count"]);
        let mut deep = good;
        for _ in 0..20 {
            deep = cmpt(&[deep]);
        }
        assert_eq!(rules(&deep), ["tile-depth"]);
    }
}
