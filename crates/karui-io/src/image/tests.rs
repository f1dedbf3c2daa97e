use super::*;
use karui::{
    Scene,
    mesh::{Image, ImageData},
};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// A JPEG of even blocks of 8 x 8 pixels, `columns` in a row, each of a luma and
/// two chromas.
fn jpeg(columns: u16, blocks: &[[u8; 3]]) -> Vec<u8> {
    let segment = |marker: u8, body: &[u8]| {
        let length = (body.len() as u16 + 2).to_be_bytes();
        [&[0xff, marker], &length[..], body].concat()
    };
    let rows = blocks.len() as u16 / columns;
    let [h, w] = [8 * rows, 8 * columns].map(u16::to_be_bytes);
    let frame = [
        8, h[0], h[1], w[0], w[1], 3, 1, 0x11, 0, 2, 0x11, 0, 3, 0x11, 0,
    ];
    // The categories 0 to 11 of a difference, each in 4 bits; and that no more
    // follows in a block, in 1.
    let dc: Vec<u8> = [&[0, 0, 0, 0, 12], &[0; 12][..]].concat();
    let dc: Vec<u8> = dc.into_iter().chain(0..12).collect();
    let ac = [&[0x10, 1], &[0; 16][..]].concat();
    let mut bytes = [
        vec![0xff, 0xd8],
        segment(0xdb, &[&[0][..], &[1; 64]].concat()),
        segment(0xc0, &frame),
        segment(0xc4, &dc),
        segment(0xc4, &ac),
        segment(0xda, &[3, 1, 0, 2, 0, 3, 0, 0, 63, 0]),
    ]
    .concat();
    for bits in coded(blocks).as_bytes().chunks(8) {
        let byte = (0..8).fold(0, |b, i| b << 1 | (bits.get(i) != Some(&b'0')) as u8);
        bytes.push(byte);
        if byte == 0xff {
            bytes.push(0);
        }
    }
    bytes.extend([0xff, 0xd9]);
    bytes
}

/// The digits of all blocks: the difference of each mean to that before.
fn coded(blocks: &[[u8; 3]]) -> String {
    let mut bits = String::new();
    let mut before = [128; 3];
    for (channel, value) in blocks.iter().flat_map(|b| (0..3).zip(b)) {
        let value = i32::from(*value);
        let difference = 8 * (value - before[channel]);
        before[channel] = value;
        let size = (32 - difference.unsigned_abs().leading_zeros()) as usize;
        bits += &format!("{size:04b}");
        if size > 0 {
            let code = difference + if difference < 0 { (1 << size) - 1 } else { 0 };
            bits += &format!("{code:0size$b}");
        }
        bits.push('0');
    }
    bits
}

fn some_jpeg() -> Vec<u8> {
    let block = |i: u8| [40 + 14 * i, 128 + 3 * i, 128 - 4 * i];
    jpeg(3, &(0..12).map(block).collect::<Vec<_>>())
}

fn mixed(alpha: impl Fn(u32) -> u8) -> Picture {
    let pixel = |i: u32| [(i * 7) as u8, (i * i) as u8, 200, alpha(i)];
    Picture::new(13, 9, (0..13 * 9).map(pixel).collect()).unwrap()
}

fn kind(bytes: &[u8]) -> ErrorKind {
    *decode_image(bytes).unwrap_err().kind
}

/// A PNG's beginning: its header and the start of empty image data.
fn png_header(width: u32, height: u32) -> Vec<u8> {
    let mut bytes = encode_png(&Picture::filled(1, 1, [0; 4])).unwrap();
    bytes[16..20].copy_from_slice(&width.to_be_bytes());
    bytes[20..24].copy_from_slice(&height.to_be_bytes());
    let mut crc = flate2::Crc::new();
    crc.update(&bytes[12..29]);
    bytes[29..33].copy_from_slice(&crc.sum().to_be_bytes());
    bytes
}

#[test]
fn what_is_written_is_read_again() {
    for picture in [mixed(|_| 255), mixed(|i| (i * 3) as u8)] {
        let bytes = encode_png(&picture).unwrap();
        assert_eq!(decode_image(&bytes).unwrap(), picture);
        assert_eq!(encode_png(&picture).unwrap(), bytes);
    }
    assert!(encode_png(&Picture::default()).is_err());
}

#[test]
fn grey_palettes_and_16_bits_become_rgba() {
    use ::png::{BitDepth, ColorType, Encoder};
    let encoded = |color, depth, data: &[u8]| {
        let mut bytes = Vec::new();
        let mut encoder = Encoder::new(&mut bytes, 2, 1);
        encoder.set_color(color);
        encoder.set_depth(depth);
        if color == ColorType::Indexed {
            encoder.set_palette(vec![1, 2, 3, 4, 5, 6]);
            encoder.set_trns(vec![7]);
        }
        let mut writer = encoder.write_header().unwrap();
        writer.write_image_data(data).unwrap();
        drop(writer);
        decode_image(&bytes).unwrap().pixels().to_vec()
    };
    let grey = encoded(ColorType::Grayscale, BitDepth::Two, &[0b0110_0000]);
    assert_eq!(grey, [[85, 85, 85, 255], [170, 170, 170, 255]]);
    let palette = encoded(ColorType::Indexed, BitDepth::One, &[0b0100_0000]);
    assert_eq!(palette, [[1, 2, 3, 7], [4, 5, 6, 255]]);
    let deep = encoded(
        ColorType::GrayscaleAlpha,
        BitDepth::Sixteen,
        &[9, 1, 8, 1, 7, 1, 6, 1],
    );
    assert_eq!(deep, [[9, 9, 9, 8], [7, 7, 7, 6]]);
}

/// Against the formula of JFIF.
#[test]
fn a_jpeg_shows_what_it_was_made_of() {
    let blocks = [
        [128, 128, 128],
        [76, 85, 255],
        [200, 100, 140],
        [29, 255, 107],
    ];
    let picture = decode_image(&jpeg(2, &blocks)).unwrap();
    assert_eq!((picture.width(), picture.height()), (16, 16));
    for (i, block) in (0..).zip(blocks) {
        let [y, cb, cr] = block.map(f64::from);
        let (cb, cr) = (cb - 128.0, cr - 128.0);
        let rgb = [
            y + 1.402 * cr,
            y - 0.344136 * cb - 0.714136 * cr,
            y + 1.772 * cb,
        ];
        for (x, y) in [(0, 0), (7, 0), (3, 7)] {
            let shown = picture.get(i % 2 * 8 + x, i / 2 * 8 + y).unwrap();
            for (shown, expected) in shown.into_iter().zip(rgb) {
                let off = f64::from(shown) - expected.clamp(0.0, 255.0);
                assert!(off.abs() <= 2.0, "{block:?}: {shown} for {expected}");
            }
        }
    }
}

#[test]
fn nothing_cut_off_is_taken_for_whole() {
    let png = encode_png(&mixed(|i| i as u8)).unwrap();
    let jpeg = some_jpeg();
    // A PNG's last 12 bytes only say that it is over.
    for (bytes, whole) in [(&png[..], png.len() - 12), (&jpeg[..], jpeg.len())] {
        for end in 0..whole {
            assert!(decode_image(&bytes[..end]).is_err(), "{end} of {whole}");
        }
        let cut = kind(&bytes[..whole / 2]);
        assert!(matches!(cut, ErrorKind::Truncated { .. }), "{cut}");
    }
}

#[test]
fn damage_is_no_panic() {
    let png = encode_png(&mixed(|i| i as u8)).unwrap();
    for bytes in [png, some_jpeg()] {
        for at in 0..bytes.len() {
            for flip in [0x01, 0x80, 0xff] {
                let mut damaged = bytes.clone();
                damaged[at] ^= flip;
                let _ = decode_image(&damaged);
            }
        }
    }
}

#[test]
fn headers_are_not_believed() {
    let start = Instant::now();
    let large = kind(&png_header(60_000, 60_000));
    assert!(
        matches!(
            large,
            ErrorKind::TooLarge {
                found: 60_000,
                limit: 16_384,
                ..
            }
        ),
        "{large}"
    );
    let empty = kind(&png_header(16_384, 16_384));
    assert!(matches!(empty, ErrorKind::Truncated { .. }), "{empty}");
    let mut jpeg = some_jpeg();
    let frame = jpeg.windows(2).position(|w| w == [0xff, 0xc0]).unwrap();
    jpeg[frame + 5..frame + 9].copy_from_slice(&[0x3f, 0xff, 0x3f, 0xff]);
    let empty = kind(&jpeg);
    assert!(matches!(empty, ErrorKind::Truncated { .. }), "{empty}");
    jpeg[frame + 5..frame + 9].fill(0xff);
    let large = kind(&jpeg);
    assert!(
        matches!(large, ErrorKind::TooLarge { found: 65_535, .. }),
        "{large}"
    );
    assert!(start.elapsed() < Duration::from_secs(1));
}

#[test]
fn other_formats_are_named_unknown() {
    for bytes in [&b""[..], b"GIF89a", b"RIFF....WEBP"] {
        let error = decode_image(bytes).unwrap_err().to_string();
        assert_eq!(error, "unknown format; known are PNG and JPEG");
    }
}

#[test]
fn pixels_are_written_as_pngs() {
    use karui::mesh::{Material, Texture, TextureRef, Wrap, shapes};
    let image = |width| Image {
        name: None,
        mime: String::new(),
        data: ImageData::Pixels {
            width,
            pixels: Arc::from([[1, 2, 3, 255], [4, 5, 6, 128], [7, 8, 9, 0], [0; 4]]),
        },
    };
    let mut scene = Scene::from_mesh(shapes::cube(1));
    scene.meshes[0].mesh.ranges = scene.meshes[0].mesh.ranges_or_whole();
    scene.meshes[0].mesh.ranges[0].material = Some(0);
    scene.materials = vec![Material {
        base_color_texture: Some(TextureRef {
            texture: 0,
            uv_set: 0,
            transform: None,
        }),
        ..Material::default()
    }];
    scene.textures = vec![Texture {
        image: Some(0),
        wrap: [Wrap::Clamp; 2],
        nearest: false,
    }];
    let folder = tempfile::tempdir().unwrap();
    for file in ["a.glb", "b.gltf", "c.obj"] {
        scene.images = vec![image(2)];
        let path = folder.path().join(file);
        crate::write(&path, &scene).unwrap();
        let back = crate::read(&path).unwrap();
        let pictures = [&scene, &back].map(|s| picture_of(&s.images[0]).unwrap());
        assert!(
            pictures[0].is_some() && pictures[0] == pictures[1],
            "{file}"
        );
        for width in [0, 3] {
            scene.images = vec![image(width)];
            assert!(crate::write(folder.path().join("bad.glb"), &scene).is_err());
        }
    }
    assert!(!folder.path().join("bad.glb").exists());
}
