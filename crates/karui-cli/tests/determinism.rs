//! The same input and options give the same bytes.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod common;

use common::Folder;

#[test]
fn runs_and_threads_change_no_byte() {
    let folder = Folder::new();
    folder.family("family.glb");
    folder.terrain("land.ply");
    for (name, args) in [
        ("lod", "lod family.glb -o {} --ratio 0.5,0.1"),
        ("pixels", "lod land.ply -o {} --pixels 300,100"),
        (
            "simplify",
            "simplify family.glb -o {}.glb --ratio 0.3 --json",
        ),
        (
            "log",
            "simplify land.ply -o {}.ply --ratio 0.2 --log {}.karuilog --json",
        ),
        (
            "sloppy",
            "simplify family.glb -o {}.glb --ratio 0.1 --sloppy --prune 0.1 --json",
        ),
        (
            "measure",
            "measure family.glb land.ply --samples 20000 --map {}.ply --json",
        ),
        ("convert", "convert family.glb {}.gltf"),
    ] {
        let run = |threads: u32| {
            let fresh = Folder::new();
            for input in ["family.glb", "land.ply"] {
                std::fs::copy(folder.path(input), fresh.path(input)).unwrap();
            }
            let args = args.replace("{}", "out");
            let ran = fresh.ok(&format!("{args} --threads {threads}"));
            let root = fresh.path("");
            let relative = |(path, content): (std::path::PathBuf, Vec<u8>)| {
                (path.strip_prefix(&root).unwrap().to_owned(), content)
            };
            let files: Vec<_> = fresh.files().into_iter().map(relative).collect();
            let out = if args.contains("--json") {
                ran.out
            } else {
                String::new()
            };
            (files, out)
        };
        let first = run(1);
        assert!(first == run(1), "{name}: two runs differ");
        assert!(first == run(2), "{name}: one thread and two differ");
    }
}
