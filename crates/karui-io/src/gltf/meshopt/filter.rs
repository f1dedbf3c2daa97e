//! Filters: numbers stored in a form that compresses better, turned in place
//! into the type the accessor has.

/// Undoes the filter `name` on elements of `stride` bytes. `false` if there is
/// no such filter for that stride.
pub(super) fn apply(name: &str, stride: usize, bytes: &mut [u8]) -> bool {
    match (name, stride) {
        ("NONE", _) => {}
        ("OCTAHEDRAL", 4) => each::<4>(bytes, |v| octahedral(v.map(|b| b as i8), 127.0).map(as_u8)),
        ("OCTAHEDRAL", 8) => each::<8>(bytes, |v| join(octahedral(split(v), 32767.0).map(as_i16))),
        ("QUATERNION", 8) => each::<8>(bytes, |v| join(quaternion(split(v)))),
        ("EXPONENTIAL", _) if stride.is_multiple_of(4) => {
            each::<4>(bytes, |v| exponential(i32::from_le_bytes(v)).to_le_bytes());
        }
        ("COLOR", 4) => each::<4>(bytes, |v| {
            let [y, co, cg, a] = v;
            let signed = |b: u8| i32::from(b as i8);
            color([i32::from(y), signed(co), signed(cg), i32::from(a)], 255.0).map(|c| c as u8)
        }),
        ("COLOR", 8) => each::<8>(bytes, |v| {
            let [y, co, cg, a] = split(v);
            let plain = |h: i16| i32::from(h as u16);
            let wide = [plain(y), i32::from(co), i32::from(cg), plain(a)];
            join(color(wide, 65535.0).map(|c| c as u16 as i16))
        }),
        _ => return false,
    }
    true
}

fn each<const N: usize>(bytes: &mut [u8], filter: impl Fn([u8; N]) -> [u8; N]) {
    let (elements, _) = bytes.as_chunks_mut::<N>();
    elements.iter_mut().for_each(|v| *v = filter(*v));
}

fn split(v: [u8; 8]) -> [i16; 4] {
    std::array::from_fn(|i| i16::from_le_bytes([v[2 * i], v[2 * i + 1]]))
}

fn join(v: [i16; 4]) -> [u8; 8] {
    let halves = v.map(i16::to_le_bytes);
    std::array::from_fn(|i| halves[i / 2][i % 2])
}

fn as_u8(v: f32) -> u8 {
    v as i8 as u8
}

fn as_i16(v: f32) -> i16 {
    v as i16
}

/// To the nearest whole number, halves away from zero.
fn rounded(v: f32) -> f32 {
    (v + if v >= 0.0 { 0.5 } else { -0.5 }).trunc()
}

/// A unit vector from its octahedral projection; the third value is what
/// stands for 1. The fourth is left alone.
fn octahedral<T: Into<f32>>([x, y, one, w]: [T; 4], full: f32) -> [f32; 4] {
    let [mut x, mut y, one, w] = [x.into(), y.into(), one.into(), w.into()];
    let z = one - x.abs() - y.abs();
    let fold = z.min(0.0);
    x += if x >= 0.0 { fold } else { -fold };
    y += if y >= 0.0 { fold } else { -fold };
    let length = (x * x + y * y + z * z).sqrt();
    let scale = if length > 0.0 { full / length } else { 0.0 };
    [
        rounded(x * scale),
        rounded(y * scale),
        rounded(z * scale),
        w,
    ]
}

/// A unit quaternion from its three smaller components. The fourth value tells
/// in its low bits which is left out and otherwise what stands for 1.
fn quaternion([x, y, z, w]: [i16; 4]) -> [i16; 4] {
    let scale = std::f32::consts::FRAC_1_SQRT_2 / f32::from(w | 3);
    let small = [x, y, z].map(|v| f32::from(v) * scale);
    let rest = 1.0 - small.iter().map(|v| v * v).sum::<f32>();
    let largest = rest.max(0.0).sqrt();
    let mut out = [0; 4];
    let at = (w & 3) as usize;
    for (i, v) in [largest, small[0], small[1], small[2]]
        .into_iter()
        .enumerate()
    {
        out[(at + i) % 4] = rounded(v * 32767.0) as i16;
    }
    out
}

/// A number from an exponent in the high 8 bits and a mantissa below.
fn exponential(v: i32) -> f32 {
    let exponent = v >> 24;
    let mantissa = v << 8 >> 8;
    let power = f64::from_bits(((exponent + 1023) as u64) << 52);
    (power * f64::from(mantissa)) as f32
}

/// RGBA from luma, two chroma differences and alpha, whose highest bit tells
/// how many bits the others have.
fn color([y, co, cg, a]: [i32; 4], full: f32) -> [f32; 4] {
    let one = i32::MAX >> (a as u32 | 1).leading_zeros().saturating_sub(1);
    let (r, g, b) = (y + co - cg, y + cg, y - co - cg);
    let a = ((a << 1) & one) | (a & 1);
    let scale = full / one as f32;
    [r, g, b, a].map(|v| (v as f32 * scale + 0.5).trunc().clamp(0.0, full))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values the reference implementation gives in its own tests.
    #[test]
    fn octahedral_bytes() {
        let mut bytes = [
            0, 1, 127, 0, 0, 187, 127, 1, 255, 1, 127, 0, 14, 130, 127, 1,
        ];
        assert!(apply("OCTAHEDRAL", 4, &mut bytes));
        let expected = [0, 1, 127, 0, 0, 159, 82, 1, 255, 1, 127, 0, 1, 130, 241, 1];
        assert_eq!(bytes, expected);
    }

    #[test]
    fn quaternions() {
        let words = [
            0i16, 1, 0, 0x7fc, 0, 1870, 0, 0x7fd, 2017, 1, 0, 0x7fe, 14, 1300, 0, 0x7ff,
        ];
        let mut bytes: Vec<u8> = words.iter().flat_map(|w| w.to_le_bytes()).collect();
        assert!(apply("QUATERNION", 8, &mut bytes));
        let expected = [
            32767, 0, 11, 0, 0, 25013, 0, 21166, 11, 0, 23504, 22830, 158, 14715, 0, 29277,
        ];
        let expected: Vec<u8> = expected
            .iter()
            .flat_map(|w: &i16| w.to_le_bytes())
            .collect();
        assert_eq!(bytes, expected);
    }

    #[test]
    fn exponentials() {
        let words = [0u32, 0xff00_0003, 0x02ff_fff7, 0xfe7f_ffff];
        let mut bytes: Vec<u8> = words.iter().flat_map(|w| w.to_le_bytes()).collect();
        assert!(apply("EXPONENTIAL", 4, &mut bytes));
        let (words, _) = bytes.as_chunks::<4>();
        let bits: Vec<u32> = words.iter().map(|w| u32::from_le_bytes(*w)).collect();
        assert_eq!(bits, [0, 0x3fc0_0000, 0xc210_0000, 0x49ff_fffe]);
    }

    /// Colours as the reference implementation encodes them, in 8 and 12 bits.
    #[test]
    fn colors() {
        let near = |a: f64, b: f64, step: f64| (a - b).abs() < step;
        let expected = [1.0, 0.5, 0.25, 1.0, 0.0, 1.0, 0.0, 0.5, 0.2, 0.4, 0.6, 0.0];
        let mut narrow = [
            0x90, 0x5f, 0xf1, 0xff, 0x7f, 0, 0x7f, 0xc0, 0x66, 0xcd, 0, 0x80,
        ];
        assert!(apply("COLOR", 4, &mut narrow));
        for (found, expected) in narrow.iter().zip(expected) {
            assert!(
                near(f64::from(*found) / 255.0, expected, 0.01),
                "{narrow:?}"
            );
        }
        let words = [
            0x0900u16, 0x05ff, 0xff01, 0x0fff, 0x07ff, 0x0000, 0x07ff, 0x0c00, 0x0666, 0xfccd,
            0x0000, 0x0800,
        ];
        let mut wide: Vec<u8> = words.iter().flat_map(|w| w.to_le_bytes()).collect();
        assert!(apply("COLOR", 8, &mut wide));
        for (found, expected) in wide.as_chunks::<2>().0.iter().zip(expected) {
            let found = f64::from(u16::from_le_bytes(*found)) / 65535.0;
            assert!(near(found, expected, 0.001), "{found} {expected}");
        }
    }

    #[test]
    fn unknown_filters_are_told() {
        assert!(!apply("OCTAHEDRAL", 12, &mut []));
        assert!(!apply("FUTURE", 4, &mut []));
    }
}
