//! Models larger than memory: stopped, killed, damaged and done row by row.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod common;

use common::{Folder, karui};
use std::fs;
use std::process::Stdio;
use std::time::Duration;

const SIMPLIFY: &str = "--ratio 0.1 --memory-limit 20MiB -q -o";

/// A folder with some land of 131,072 triangles.
fn land() -> Folder {
    let folder = Folder::new();
    folder.ok("scene terrain --size 257x257 -o land.ply -q");
    folder
}

fn bytes(folder: &Folder, name: &str) -> Vec<u8> {
    fs::read(folder.path(name)).unwrap()
}

#[test]
fn any_number_of_threads_writes_the_same_and_leaves_nothing() {
    let folder = land();
    folder.ok(&format!("simplify land.ply {SIMPLIFY} one.ply --threads 1"));
    for threads in [2, 4, 8] {
        folder.ok(&format!(
            "simplify land.ply {SIMPLIFY} other.ply --threads {threads}"
        ));
        assert!(
            bytes(&folder, "one.ply") == bytes(&folder, "other.ply"),
            "{threads}"
        );
    }
    assert!(!folder.path("one.ply.karui").exists());
    let info = folder.ok("info one.ply --json").json();
    // One less than asked for: a collapse inside takes two.
    assert_eq!(info[0]["triangles"], 13_106, "{info}");
}

#[test]
fn killed_runs_go_on_and_write_the_same() {
    let folder = land();
    folder.ok(&format!("simplify land.ply {SIMPLIFY} whole.ply"));
    let args = format!("simplify land.ply {SIMPLIFY} killed.ply");
    let mut kills = 0;
    for wait in (20..).step_by(60) {
        let mut command = karui();
        let command = command.current_dir(folder.path("")).args(args.split(' '));
        let mut child = command.stdout(Stdio::null()).spawn().unwrap();
        std::thread::sleep(Duration::from_millis(wait));
        if child.try_wait().unwrap().is_some() {
            break;
        }
        child.kill().unwrap();
        child.wait().unwrap();
        kills += 1;
        assert!(!folder.path("killed.ply").exists());
        if kills == 12 {
            break;
        }
    }
    folder.ok(&args);
    println!("killed {kills} times");
    assert!(bytes(&folder, "whole.ply") == bytes(&folder, "killed.ply"));
    assert!(!folder.path("killed.ply.karui").exists());
}

#[test]
fn plans_are_done_row_by_row_by_programs_of_their_own() {
    let folder = land();
    folder.ok(&format!("simplify land.ply {SIMPLIFY} whole.ply"));
    let made = "plan new land.ply work --ratio 0.1 --memory-limit 20MiB --json";
    let mut step = folder.ok(made).json();
    let mut tasks = 0;
    while step["done"] == false {
        let manifest = step["manifest"].as_str().unwrap().to_owned();
        for row in (0..step["rows"].as_u64().unwrap()).rev() {
            folder.ok(&format!("task run {manifest} --row {row}"));
            tasks += 1;
        }
        let beyond = step["rows"].as_u64().unwrap();
        let ran = folder.run(&format!("task run {manifest} --row {beyond}"));
        assert_eq!(ran.code, Some(2), "{ran:?}");
        step = folder.ok("plan next work --json").json();
    }
    assert!(tasks > 5, "{tasks}");
    let shown = folder.ok("plan show work --json").json();
    let phases = shown["phases"].as_array().unwrap();
    assert!(phases.iter().all(|p| p["closed"] == true), "{shown}");
    folder.ok("plan write work -o rows.ply");
    assert!(bytes(&folder, "whole.ply") == bytes(&folder, "rows.ply"));
}

#[test]
fn damage_is_told_and_mended() {
    let folder = land();
    folder.ok("plan new land.ply work --ratio 0.1 --memory-limit 20MiB");
    folder.ok("plan run work -o first.ply -q");
    folder.ok("plan verify work");
    let block = folder.path("work/03-simplify-000001.block");
    let mut damaged = fs::read(&block).unwrap();
    let middle = damaged.len() / 2;
    damaged[middle] ^= 1;
    fs::write(&block, &damaged).unwrap();
    fs::remove_file(folder.path("work/01-read-000000.block")).unwrap();
    let ran = folder.run("plan verify work");
    assert_eq!(ran.code, Some(1), "{ran:?}");
    assert_eq!(ran.out, "01-read-000000.block\n03-simplify-000001.block\n");
    // From the third phase on all is to be done again.
    for entry in fs::read_dir(folder.path("work")).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap();
        if name >= "04" && name != "plan.json" {
            fs::remove_file(&path).unwrap();
        }
    }
    folder.ok("plan resume work -o second.ply -q");
    folder.ok("plan verify work");
    assert!(bytes(&folder, "first.ply") == bytes(&folder, "second.ply"));
    // Of a plan that is done, too.
    let names = fs::read_dir(folder.path("work")).unwrap();
    let names = names.map(|entry| entry.unwrap().path());
    let blocks = names.filter(|path| path.extension().is_some_and(|e| e == "block"));
    let last = blocks.max().unwrap();
    let mut damaged = fs::read(&last).unwrap();
    let middle = damaged.len() / 2;
    damaged[middle] ^= 1;
    fs::write(&last, &damaged).unwrap();
    folder.ok("plan resume work -o third.ply -q");
    assert!(bytes(&folder, "first.ply") == bytes(&folder, "third.ply"));
}

#[cfg(unix)]
#[test]
fn an_interrupted_run_says_how_to_go_on() {
    let folder = Folder::new();
    folder.ok("scene terrain --size 513x513 -o land.ply -q");
    let args = "simplify land.ply --ratio 0.1 --memory-limit 20MiB -o out.ply --threads 1";
    let mut command = karui();
    let command = command.current_dir(folder.path("")).args(args.split(' '));
    let child = command
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    std::thread::sleep(Duration::from_millis(250));
    let pid = child.id().to_string();
    std::process::Command::new("kill")
        .args(["-INT", &pid])
        .status()
        .unwrap();
    let ran = common::Ran::from(child.wait_with_output().unwrap());
    assert_eq!(ran.code, Some(130), "{ran:?}");
    assert!(
        ran.err.contains("karui plan resume out.ply.karui"),
        "{ran:?}"
    );
    folder.ok("plan resume out.ply.karui -o out.ply -q");
}

#[test]
fn bad_input_is_told() {
    let folder = land();
    let lying = [
        (
            "more vertices",
            "element vertex 66049",
            "element vertex 99999",
        ),
        ("more faces", "element face 131072", "element face 999999"),
    ];
    for (what, from, to) in lying {
        let good = bytes(&folder, "land.ply");
        let header = String::from_utf8_lossy(&good[..400]).into_owned();
        assert!(header.contains(from), "{header}");
        let at = header.find(from).unwrap();
        let mut bad = good[..at].to_vec();
        bad.extend(to.as_bytes());
        bad.extend(&good[at + from.len()..]);
        fs::write(folder.path("lie.ply"), bad).unwrap();
        let ran = folder.run(&format!("simplify lie.ply {SIMPLIFY} out.ply"));
        assert_eq!(ran.code, Some(2), "{what}: {ran:?}");
        assert!(ran.err.contains("lie.ply"), "{what}: {ran:?}");
        assert!(!folder.path("out.ply").exists());
    }
    for args in [
        "simplify land.ply --ratio 0.1 --memory-limit much -o out.ply",
        "simplify land.ply --ratio 0.1 --memory-limit 1GiB -o out.glb",
        "simplify land.ply --ratio 2 --memory-limit 1GiB -o out.ply",
        "simplify land.ply --ratio 0.1 --cut slabs -o out.ply",
        "simplify land.ply --ratio 0.1 --memory-limit 1GiB --quality fast -o out.ply",
        "plan show nothing",
        "plan run nothing",
    ] {
        folder.fails(2, args);
    }
}

#[cfg(not(feature = "cloud"))]
#[test]
fn urls_are_no_folders() {
    let folder = Folder::new();
    folder.terrain("land.ply");
    for args in [
        "plan new land.ply s3://bucket/work --ratio 0.1",
        "simplify land.ply --ratio 0.1 --memory-limit 20MiB --work gs://bucket/work -o out.ply",
        "plan show az://bucket/work",
        "task run s3://bucket/work/01-read.tasks --row 0",
        "tiles land.ply --memory-limit 20MiB -o s3://bucket/tiles",
    ] {
        let ran = folder.fails(2, args);
        assert!(ran.err.contains("--features cloud"), "{ran:?}");
    }
}
