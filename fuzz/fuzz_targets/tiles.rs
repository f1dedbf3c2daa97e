#![no_main]

use karui_io::tiles;
use libfuzzer_sys::fuzz_target;

// A tileset file; what is accepted is written and read back the same. Its
// first byte decides whether it is checked as a whole, next to a subtree made
// of the same bytes.
fuzz_target!(|bytes: &[u8]| {
    let Some((first, text)) = bytes.split_first() else {
        return;
    };
    if let Ok(tileset) = tiles::read_bytes(text, "fuzz") {
        let again = tiles::read_bytes(&tileset.to_json(), "again");
        assert_eq!(again.expect("what was written is read"), tileset);
    }
    if first % 2 == 1 {
        check(text);
    }
});

fn check(text: &[u8]) {
    let folder = std::env::temp_dir().join(format!("karui-fuzz-{}", std::process::id()));
    let tree = b"{\"asset\"";
    let split = text.windows(tree.len()).rposition(|w| w == tree).unwrap_or(0);
    let files = [("tileset.json", &text[split..]), ("0.0.0.subtree", &text[..split])];
    if std::fs::create_dir_all(&folder).is_err() {
        return;
    }
    for (name, bytes) in files {
        if std::fs::write(folder.join(name), bytes).is_err() {
            return;
        }
    }
    let options = tiles::CheckOptions {
        max_tiles: 10_000,
        ..tiles::CheckOptions::default()
    };
    let _ = tiles::check_with(folder.join("tileset.json"), &options);
}
