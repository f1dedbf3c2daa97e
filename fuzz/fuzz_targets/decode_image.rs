#![no_main]

use libfuzzer_sys::fuzz_target;

// Whatever is decoded can be encoded, and is then the same.
fuzz_target!(|bytes: &[u8]| {
    if let Ok(picture) = karui_io::decode_image(bytes) {
        let png = karui_io::encode_png(&picture).expect("a picture can be encoded");
        let again = karui_io::decode_image(&png).expect("what was encoded can be decoded");
        assert_eq!(picture, again);
    }
});
