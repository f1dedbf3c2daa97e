#![no_main]

use karui_io::Format;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| karui_fuzz::read(Format::Obj, bytes));
