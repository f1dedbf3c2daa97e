#![no_main]

use karui_io::Format;
use libfuzzer_sys::fuzz_target;

// The JSON and the binary container share everything behind the first bytes.
fuzz_target!(|bytes: &[u8]| {
    let binary = bytes.starts_with(b"glTF");
    karui_fuzz::read(if binary { Format::Glb } else { Format::Gltf }, bytes);
});
