#![no_main]

use libfuzzer_sys::fuzz_target;
use std::{env, fs, process};

// Inflating happens on the way in from a file, hence one on disk; put
// TMPDIR on a memory file system.
fuzz_target!(|bytes: &[u8]| {
    let path = env::temp_dir().join(format!("karui-fuzz-{}.off.gz", process::id()));
    fs::write(&path, bytes).expect("writable TMPDIR");
    if let Ok(scene) = karui_io::read(&path) {
        karui_fuzz::check(&scene);
    }
});
