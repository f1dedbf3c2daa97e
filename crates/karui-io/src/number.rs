//! Numbers as text: the shortest that reads back to the same value.

use std::io::{self, Write};

/// Writes a finite number without a needless `.0`.
pub(crate) fn write_float(sink: &mut (impl Write + ?Sized), value: f32) -> io::Result<()> {
    let mut buffer = zmij::Buffer::new();
    let text = buffer.format(value);
    sink.write_all(text.strip_suffix(".0").unwrap_or(text).as_bytes())
}

/// Writes a finite number in double precision without a needless `.0`.
pub(crate) fn write_double(sink: &mut (impl Write + ?Sized), value: f64) -> io::Result<()> {
    let mut buffer = zmij::Buffer::new();
    let text = buffer.format(value);
    sink.write_all(text.strip_suffix(".0").unwrap_or(text).as_bytes())
}

/// Writes an integer.
pub(crate) fn write_integer(
    sink: &mut (impl Write + ?Sized),
    value: impl itoa::Integer,
) -> io::Result<()> {
    sink.write_all(itoa::Buffer::new().format(value).as_bytes())
}

/// Writes numbers, each after a space.
pub(crate) fn write_floats(sink: &mut (impl Write + ?Sized), values: &[f32]) -> io::Result<()> {
    values.iter().try_for_each(|&value| {
        sink.write_all(b" ")?;
        write_float(sink, value)
    })
}

/// The v of a texture coordinate seen from the other edge of the image, in
/// double precision so that turning it back gives the same `f32`.
pub(crate) fn flip(v: f32) -> f64 {
    1.0 - f64::from(v)
}

/// The inverse of [`flip`].
pub(crate) fn unflip(v: f64) -> f32 {
    (1.0 - v) as f32
}

/// Writes [`flip`]`(v)` with as few decimals as turn back to `v`.
pub(crate) fn write_flipped(sink: &mut (impl Write + ?Sized), v: f32) -> io::Result<()> {
    let exact = flip(v);
    for decimals in [3, 6, 7, 8, 9] {
        let scale = 10f64.powi(decimals);
        let rounded = (exact * scale).round() / scale;
        if unflip(rounded) == v {
            return write_double(sink, rounded);
        }
    }
    write_double(sink, exact)
}

/// `value` in 255ths, rounded and within 0..=255.
pub(crate) fn to_byte(value: f32) -> u8 {
    (value * 255.0).round() as u8
}

/// `value` as a byte of 0..=255 if it is exactly a 255th.
pub(crate) fn byte_of(value: f32) -> Option<u8> {
    let byte = to_byte(value);
    (f32::from(byte) / 255.0 == value).then_some(byte)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(write: impl Fn(&mut Vec<u8>) -> io::Result<()>) -> String {
        let mut bytes = Vec::new();
        write(&mut bytes).unwrap();
        String::from_utf8(bytes).unwrap()
    }

    #[test]
    fn floats_are_short_and_exact() {
        for (value, expected) in [(1.0, "1"), (-0.5, "-0.5"), (0.1, "0.1"), (0.0, "0")] {
            assert_eq!(text(|s| write_float(s, value)), expected);
        }
        for value in [
            f32::MIN_POSITIVE,
            1e-45,
            f32::MAX,
            0.1 + 0.2,
            1e20,
            16777216.0,
        ] {
            let back: f32 = text(|s| write_float(s, value)).parse().unwrap();
            assert_eq!(back, value);
        }
    }

    #[test]
    fn flipping_twice_changes_nothing() {
        let values =
            (0..100_000u32).map(|i| i.wrapping_mul(2_654_435_761) as f32 / u32::MAX as f32);
        for v in values.chain([0.0, 1.0, 0.5, 1e-9, -3.25, 7.1, 1e-20]) {
            let back: f64 = text(|s| write_flipped(s, v)).parse().unwrap();
            let tolerance = 1e-16;
            assert!(
                (f64::from(unflip(back)) - f64::from(v)).abs() <= tolerance,
                "{v}"
            );
        }
        assert_eq!(text(|s| write_flipped(s, unflip(0.1))), "0.1");
        assert_eq!(text(|s| write_flipped(s, unflip(0.890955))), "0.890955");
    }

    #[test]
    fn bytes_of_colours() {
        for byte in 0..=255u8 {
            assert_eq!(byte_of(f32::from(byte) / 255.0), Some(byte));
        }
        assert_eq!(byte_of(0.3), None);
        assert_eq!(byte_of(-0.1), None);
        assert_eq!(byte_of(f32::NAN), None);
    }
}
