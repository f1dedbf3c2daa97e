//! URIs of buffers and images: data or the name of a file beside the model.

use crate::error::ErrorKind;
use base64::{
    Engine, alphabet,
    engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig},
};

/// Padding at the end is optional: writers disagree about it.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &alphabet::STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

/// What a URI stands for.
#[derive(Debug, PartialEq)]
pub(crate) enum Uri<'a> {
    /// A data URI.
    Data {
        /// Media type; may be empty.
        mime: &'a str,
        /// The content.
        bytes: Vec<u8>,
    },
    /// A path, percent-decoded; not yet checked to be a safe one.
    Path(String),
}

/// Whether it is a data URI.
pub(crate) fn is_data(uri: &str) -> bool {
    uri.get(..5)
        .is_some_and(|s| s.eq_ignore_ascii_case("data:"))
}

/// Decodes a URI.
///
/// # Errors
/// [`ErrorKind::Syntax`] for a data URI that cannot be decoded.
pub(crate) fn decode(uri: &str) -> Result<Uri<'_>, ErrorKind> {
    if is_data(uri) {
        return decode_data(&uri[5..]);
    }
    String::from_utf8(percent_decode(uri))
        .map(Uri::Path)
        .map_err(|_| ErrorKind::syntax("a URI in UTF-8", "other bytes"))
}

fn decode_data(rest: &str) -> Result<Uri<'_>, ErrorKind> {
    let Some((head, content)) = rest.split_once(',') else {
        return Err(ErrorKind::syntax("a comma in the data URI", "none"));
    };
    let mime = head.split(';').next().unwrap_or_default();
    let bytes = if head.ends_with(";base64") {
        BASE64
            .decode(content)
            .map_err(|e| ErrorKind::syntax("base64", e.to_string()))?
    } else {
        percent_decode(content)
    };
    Ok(Uri::Data { mime, bytes })
}

fn percent_decode(text: &str) -> Vec<u8> {
    let mut rest = text.as_bytes();
    let mut bytes = Vec::with_capacity(rest.len());
    while let Some((&first, tail)) = rest.split_first() {
        let escaped = (first == b'%').then(|| hex_pair(tail)).flatten();
        bytes.push(escaped.unwrap_or(first));
        rest = if escaped.is_some() { &tail[2..] } else { tail };
    }
    bytes
}

fn hex_pair(tail: &[u8]) -> Option<u8> {
    let digit = |i: usize| char::from(*tail.get(i)?).to_digit(16);
    Some((digit(0)? * 16 + digit(1)?) as u8)
}

/// A relative path as a URI.
pub(crate) fn encode_path(path: &str) -> String {
    let mut uri = String::with_capacity(path.len());
    for byte in path.bytes() {
        if byte.is_ascii_alphanumeric() || b"-_.~/!$&'()*+,;=@".contains(&byte) {
            uri.push(char::from(byte));
        } else {
            uri.push_str(&format!("%{byte:02X}"));
        }
    }
    uri
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn data_uris() {
        let data = |uri| match decode(uri) {
            Ok(Uri::Data { mime, bytes }) => Some((mime.to_owned(), bytes)),
            _ => None,
        };
        let expected = Some(("image/png".to_owned(), b"abc".to_vec()));
        assert_eq!(data("data:image/png;base64,YWJj"), expected);
        assert_eq!(data("DATA:image/png,ab%63"), expected);
        assert_eq!(
            data("data:;base64,YQ"),
            Some((String::new(), b"a".to_vec()))
        );
        assert_eq!(data("data:;base64,Y*Q="), None);
        assert_eq!(data("data:nothing"), None);
    }

    #[test]
    fn paths_round_trip() {
        for path in ["a b/c#d.png", "100%.bin", "größe.png", "plain.bin"] {
            assert_eq!(decode(&encode_path(path)).unwrap(), Uri::Path(path.into()));
        }
        assert_eq!(decode("%2e%2E/x").unwrap(), Uri::Path("../x".into()));
        assert_eq!(decode("50%zz%4").unwrap(), Uri::Path("50%zz%4".into()));
        assert!(decode("%ff").is_err());
    }
}
