//! `karui lod --metric flip`, end to end.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod common;

use common::Folder;
use serde_json::Value;

/// The cloth that Karui is shipped with, textures and all.
fn cloth() -> String {
    concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/sheen_cloth.glb").into()
}

fn numbers(report: &Value, key: &str) -> Vec<f64> {
    let levels = report["levels"].as_array().unwrap().iter();
    levels.map(|l| l[key].as_f64().unwrap()).collect()
}

#[test]
fn levels_are_switched_where_pictures_look_alike() {
    let folder = Folder::new();
    let chain = format!(
        "lod {} --ratio 0.1,0.01 --samples 5000 --height 270",
        cloth()
    );
    let ran = folder.ok(&format!("{chain} -o seen.glb --metric flip --flip-views 4"));
    assert!(
        ran.out.lines().next().unwrap().ends_with("FLIP there"),
        "{ran:?}"
    );
    let report = folder.json("seen.report.json");
    assert_eq!(report["flip"]["bound"].as_f64(), Some(0.05));
    assert_eq!(report["flip"]["views"].as_u64(), Some(4));
    let (flip, distances) = (
        numbers(&report, "flip"),
        numbers(&report, "switch_distance"),
    );
    assert_eq!((flip.len(), flip[0], distances[0]), (3, 0.0, 0.0));
    assert!(flip.iter().all(|&f| f <= 0.05), "{flip:?}");
    assert!(distances.is_sorted(), "{distances:?}");
    for level in report["levels"].as_array().unwrap() {
        assert_eq!(
            (&level["metric"], &level["bound_kept"]),
            (&"flip".into(), &true.into())
        );
    }
    // No nearer than where the box's sphere fits the screen: a diagonal at 60 degrees.
    let diagonal = report["diagonal"].as_f64().unwrap();
    assert!(distances[1] >= 0.999 * diagonal, "{distances:?} {diagonal}");
    for (k, &distance) in distances.iter().enumerate().skip(1) {
        let of_mesh = &report["meshes"][0]["levels"][k - 1]["switch_distance"];
        assert_eq!(of_mesh.as_f64(), Some(distance));
    }

    // The file says the same, as shares of the screen.
    let scene = karui_io::read(folder.path("seen.glb")).unwrap();
    let lods = scene.nodes.iter().find_map(|n| n.lods.as_ref()).unwrap();
    let shares = f64::from(lods.coverage[0]) / f64::from(lods.coverage[1]);
    assert!(
        (shares / (distances[2] / distances[1]) - 1.0).abs() < 1e-4,
        "{lods:?}"
    );

    // Levels are those of the other metric; a strict bound is kept from farther on.
    folder.ok(&format!(
        "{chain} -o strict.glb --metric flip --flip 0.02 --flip-views 4"
    ));
    let strict = folder.json("strict.report.json");
    assert!(numbers(&strict, "flip").iter().all(|&f| f <= 0.02));
    assert!(numbers(&strict, "switch_distance")[2] >= distances[2]);
    folder.ok(&format!("{chain} -o surface.glb"));
    let surface = folder.json("surface.report.json");
    assert_eq!(
        numbers(&surface, "triangles"),
        numbers(&report, "triangles")
    );
    assert_eq!(surface["levels"][1]["metric"], "surface");
    assert!(surface["levels"][1].get("flip").is_none() && surface.get("flip").is_none());
}

#[test]
fn what_is_never_alike_is_said() {
    let folder = Folder::new();
    folder.family("family.glb");
    let ran = folder.ok(
        "lod family.glb -o out --ratio 0.02 --height 16000 --metric flip --flip 0 --flip-views 2",
    );
    assert!(ran.err.contains("warning: level 1: FLIP is"), "{ran:?}");
    let report = folder.json("out/report.json");
    assert_eq!(report["levels"][1]["bound_kept"], false);
    let away = numbers(&report, "switch_distance")[1] / report["diagonal"].as_f64().unwrap();
    assert!((away - 4096.0).abs() < 1.0, "{away}");
}

#[test]
fn nonsense_is_refused_before_any_work() {
    let folder = Folder::new();
    folder.family("family.glb");
    for (args, said) in [
        ("--flip 0.1", "add --metric flip"),
        ("--metric surface --flip-views 3", "add --metric flip"),
        ("--metric flip --flip 2", "0 (no difference seen) to 1"),
        ("--metric flip --flip NaN", "0 (no difference seen) to 1"),
        ("--metric flip --flip-views 0", "--flip-views"),
        ("--metric looks", "possible values: surface, flip"),
    ] {
        let ran = folder.fails(2, &format!("lod family.glb -o out {args}"));
        assert!(ran.err.contains(said), "{args}: {ran:?}");
    }
}
