//! `karui compare` and `karui bench saliency`, end to end.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod common;

use common::Folder;
use karui::mesh::{Scene, shapes};

/// A torus and one with fewer triangles.
fn two(folder: &Folder) {
    let mesh = shapes::torus(1.0, 0.4, 96, 48);
    folder.scene("fine.ply", &Scene::from_mesh(mesh));
    folder.ok("simplify fine.ply -o coarse.ply --triangles 300 -q");
}

#[test]
fn a_model_is_like_itself() {
    let folder = Folder::new();
    two(&folder);
    let found = folder
        .ok("compare fine.ply fine.ply --views 3 --size 64 --samples 1000 --json")
        .json();
    assert_eq!(found["mean"]["flip"], 0.0);
    assert_eq!(found["mean"]["ssim"], 1.0);
    assert_eq!(found["mean"]["psnr"], serde_json::Value::Null);
    assert!(found["distance"]["max"].as_f64() < Some(1e-6), "{found}");
}

#[test]
fn the_report_holds_its_pictures() {
    let folder = Folder::new();
    two(&folder);
    let args = "compare fine.ply coarse.ply --views 4 --size 64 --samples 1000 --shown 2";
    let ran = folder.ok(&format!("{args} -o seen"));
    assert!(ran.out.contains("mean of 4 views"), "{ran:?}");
    let html = String::from_utf8(folder.read("seen/report.html")).unwrap();
    assert_eq!(html.matches("src=\"data:image/png;base64,").count(), 8);
    assert_eq!(html.matches("<h2>View").count(), 2);
    assert!(!html.contains("http"), "nothing from elsewhere");
    let mut pictures = 0;
    for entry in std::fs::read_dir(folder.path("seen")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|e| e == "png") {
            let picture = karui_io::decode_image(&std::fs::read(&path).unwrap()).unwrap();
            assert_eq!((picture.width(), picture.height()), (64, 64), "{path:?}");
            pictures += 1;
        }
    }
    assert_eq!(pictures, 8);
    // The same bytes for any number of threads.
    folder.ok(&format!("{args} -o one --threads 1"));
    folder.ok(&format!("{args} -o two --threads 2"));
    let [one, two] = ["one", "two"].map(|f| folder.read(&format!("{f}/report.html")));
    assert!(one == two && one == html.into_bytes());
}

#[test]
fn a_bound_that_is_exceeded_is_said() {
    let folder = Folder::new();
    two(&folder);
    let args = "compare fine.ply coarse.ply --views 2 --size 64 --samples 1000 --max-flip";
    assert_eq!(folder.run(&format!("{args} 0.9")).code, Some(0));
    let ran = folder.run(&format!("{args} 0.0001"));
    assert_eq!(ran.code, Some(1), "{ran:?}");
    assert!(ran.err.contains("exceeds"), "{ran:?}");
}

#[test]
fn what_cannot_be_read_leaves_nothing() {
    let folder = Folder::new();
    two(&folder);
    let ran = folder.run("compare fine.ply none.ply -o seen");
    assert_eq!(ran.code, Some(2), "{ran:?}");
    assert!(ran.err.contains("none.ply"), "{ran:?}");
    assert!(!folder.path("seen").exists());
}

#[test]
fn the_trial_compares_with_plain_simplification() {
    let folder = Folder::new();
    two(&folder);
    let found = folder
        .ok("bench saliency fine.ply --triangles 500 --kinds mesh --most 10,30 --power 3 --views 2 --size 64 --json")
        .json();
    let rows = found["rows"].as_array().unwrap();
    let methods: Vec<&str> = rows.iter().filter_map(|r| r["method"].as_str()).collect();
    assert_eq!(methods, ["plain", "mesh x10 ^3", "mesh x30 ^3"]);
    assert!(
        rows.iter()
            .all(|r| r["left"] == 500 && r["whole"].as_f64() > Some(0.0))
    );
}

#[test]
fn fewer_views_are_correlated_with_the_grid() {
    let folder = Folder::new();
    folder.scene(
        "small.ply",
        &Scene::from_mesh(shapes::torus(1.0, 0.4, 8, 6)),
    );
    let rows = folder
        .ok("bench views small.ply --views 2,200 --json")
        .json();
    let of = |i: usize| rows[i]["correlation"][0].as_f64();
    assert_eq!(of(0).map(|c| c > 0.999_999), Some(true), "{rows}");
    assert!(of(2) > of(1), "{rows}");
}

#[test]
fn the_times_of_the_thesis_are_measured_at_each_size() {
    let folder = Folder::new();
    two(&folder);
    let rows = folder
        .ok("bench thesis fine.ply --triangles 100 --json")
        .json();
    assert_eq!(rows.as_array().map(Vec::len), Some(1));
    let seconds = rows[0]["seconds"].as_array().unwrap();
    assert!(seconds.iter().all(|s| s.as_f64() > Some(0.0)), "{rows}");
}
