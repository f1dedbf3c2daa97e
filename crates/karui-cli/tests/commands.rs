//! Every command, end to end.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod common;

use common::{Folder, karui};
use serde_json::Value;

fn number(value: &Value, pointer: &str) -> f64 {
    let found = value.pointer(pointer).and_then(Value::as_f64);
    found.unwrap_or_else(|| panic!("{pointer} in {value}"))
}

#[test]
fn lod_into_a_folder() {
    let folder = Folder::new();
    folder.family("family.glb");
    let ran = folder.ok("lod family.glb -o out --ratio 0.5,0.1");
    let expected = [
        "family.glb",
        "family_lod0.glb",
        "family_lod1.glb",
        "family_lod2.glb",
        "report.json",
    ];
    assert_eq!(folder.names("out"), expected);
    assert!(
        ran.out.lines().next().unwrap().contains("triangles"),
        "{ran:?}"
    );
    assert!(
        ran.out.lines().last().unwrap().contains("5 files in out"),
        "{ran:?}"
    );

    let report = folder.json("out/report.json");
    let levels = report["levels"].as_array().unwrap();
    assert_eq!(levels.len(), 3);
    for (k, level) in levels.iter().enumerate() {
        let file = format!("out/family_lod{k}.glb");
        assert_eq!(number(level, "/bytes") as usize, folder.read(&file).len());
        let scene = karui_io::read(folder.path(&file)).unwrap();
        assert_eq!(number(level, "/triangles") as usize, scene.triangle_count());
        let [max, mean, rms] =
            ["max", "mean", "rms"].map(|e| number(level, &format!("/error/{e}")));
        assert!(mean <= rms && rms <= max);
        let relative = number(level, "/relative_error/max") * number(&report, "/diagonal");
        assert!((relative - max).abs() <= 1e-12);
        // 1080 pixels, 60 degrees, 1 pixel: the closed form.
        let distance = max * 1080.0 / (2.0 * 30f64.to_radians().tan());
        assert!((number(level, "/switch_distance") - distance).abs() <= 1e-9 * distance);
    }
    assert!(number(&levels[2], "/triangles") <= 0.11 * number(&levels[0], "/triangles"));
}

#[test]
fn lod_into_one_file() {
    let folder = Folder::new();
    folder.family("family.glb");
    folder.ok("lod family.glb -o all.glb --levels 3");
    assert_eq!(
        folder.names("."),
        ["all.glb", "all.report.json", "family.glb"]
    );
    let scene = karui_io::read(folder.path("all.glb")).unwrap();
    let linked: Vec<_> = scene.nodes.iter().filter_map(|n| n.lods.as_ref()).collect();
    assert_eq!(linked.len(), 3, "three instances");
    for lods in linked {
        assert_eq!(lods.nodes.len(), 3);
        assert_eq!(lods.coverage.len(), 4);
        assert!(lods.coverage.windows(2).all(|w| w[0] >= w[1]));
    }
    // The finest level draws what the input draws.
    let before = karui_io::read(folder.path("family.glb")).unwrap();
    let triangles = |s: karui::Scene| s.into_single_mesh().unwrap().triangles.len();
    assert_eq!(triangles(scene), triangles(before));
}

#[test]
fn lod_separate_and_in_other_formats() {
    let folder = Folder::new();
    folder.terrain("land.ply");
    folder.ok("lod land.ply -o land.glb --separate --triangles 500 -q");
    let files = [
        "land.ply",
        "land.report.json",
        "land_lod0.glb",
        "land_lod1.glb",
    ];
    assert_eq!(folder.names("."), files);
    folder.ok("lod land.ply -o obj/ --separate --format obj --triangles 500,100");
    let names = folder.names("obj");
    assert!(names.contains(&"land_lod2.obj".to_owned()), "{names:?}");
    let coarse = karui_io::read(folder.path("obj/land_lod2.obj")).unwrap();
    assert!(coarse.triangle_count() <= 100);
}

#[test]
fn lod_of_what_is_coarse_already_says_so() {
    let folder = Folder::new();
    folder.scene(
        "cube.ply",
        &karui::Scene::from_mesh(karui::mesh::shapes::cube(1)),
    );
    let ran = folder.ok("lod cube.ply -o cube.glb");
    assert!(ran.err.contains("no level was made"), "{ran:?}");
    let report = folder.json("cube.report.json");
    assert_eq!(report["levels"].as_array().map(Vec::len), Some(1));
}

#[test]
fn lod_by_error_and_by_pixels() {
    let folder = Folder::new();
    folder.terrain("land.ply");
    folder.ok("lod land.ply -o e.glb --error 0.01,0.05");
    let report = folder.json("e.report.json");
    for (level, wanted) in [(1, 0.01), (2, 0.05)] {
        let max = number(&report, &format!("/levels/{level}/error/max"));
        assert!(max <= wanted, "{max} {wanted}");
        assert!(max > 0.1 * wanted, "{max} is far from using {wanted}");
    }
    folder.ok("lod land.ply -o p.glb --pixels 400,100 --pixel-tolerance 2 --height 720 --fov 45");
    let report = folder.json("p.report.json");
    let diagonal = number(&report, "/diagonal");
    for (level, pixels) in [(1, 400.0), (2, 100.0)] {
        let max = number(&report, &format!("/levels/{level}/error/max"));
        assert!(max <= 2.0 * diagonal / pixels, "{max}");
    }
}

#[test]
fn simplify_says_how_far_off_and_why_it_stopped() {
    let folder = Folder::new();
    folder.terrain("land.ply");
    let ran = folder.ok("simplify land.ply -o small.ply --triangles 300");
    assert!(ran.out.contains("stopped    target reached"), "{ran:?}");
    assert!(ran.out.contains("RMS"), "{ran:?}");
    let small = karui_io::read(folder.path("small.ply")).unwrap();
    assert!((290..=300).contains(&small.triangle_count()));

    let ran = folder.ok("simplify land.ply -o small.ply --error 0.02 --json");
    let report = ran.json();
    assert_eq!(report["stopped"][0]["reason"], "error_bound");
    assert!(report["stopped"][0]["advice"].is_string());
    assert!(number(&report, "/error/max") <= 0.02);
    // What is reported is what `measure` finds.
    let measured = folder.ok("measure land.ply small.ply --json").json();
    let [a, b] = [number(&report, "/error/rms"), number(&measured, "/rms")];
    assert!((a - b).abs() < 0.03 * b, "{a} {b}");
}

#[test]
fn simplify_border_and_weights() {
    let folder = Folder::new();
    folder.terrain("land.ply");
    let ran = folder.ok("simplify land.ply -o locked.ply --ratio 0 --lock-border --json");
    let reason = &ran.json()["stopped"][0]["reason"];
    assert_ne!(reason, "target", "a locked border cannot vanish");
    let border = |name: &str| {
        let mesh = karui_io::read(folder.path(name))
            .unwrap()
            .into_single_mesh()
            .unwrap();
        karui::mesh::diagnose(&mesh).unwrap().boundary_edges
    };
    assert_eq!(border("locked.ply"), border("land.ply"));

    // Weight on one half: more triangles are left there.
    let mesh = karui_io::read(folder.path("land.ply"))
        .unwrap()
        .into_single_mesh()
        .unwrap();
    let middle = mesh.bounds().center().x;
    let weight = |p: &glam::Vec3| if p.x < middle { "100\n" } else { "1\n" };
    folder.write(
        "w.txt",
        mesh.positions.iter().map(weight).collect::<String>(),
    );
    folder.ok("simplify land.ply -o weighted.ply --ratio 0.2 --weights w.txt");
    let coarse = karui_io::read(folder.path("weighted.ply"))
        .unwrap()
        .into_single_mesh()
        .unwrap();
    let left = coarse.positions.iter().filter(|p| p.x < middle).count();
    assert!(
        left > 2 * (coarse.positions.len() - left),
        "{left} of {}",
        coarse.positions.len()
    );
}

/// A hundred loose balls: edge collapse ends at a few triangles a ball.
fn balls() -> karui::TriMesh {
    let ball = karui::mesh::shapes::icosphere(1);
    let mut mesh = karui::TriMesh::default();
    for i in 0..100u8 {
        let first = mesh.positions.len() as u32;
        let size = if i == 0 { 0.01 } else { 0.3 };
        let place = glam::Vec3::new(f32::from(i % 10), f32::from(i / 10), 0.0);
        mesh.positions
            .extend(ball.positions.iter().map(|p| *p * size + place));
        mesh.triangles
            .extend(ball.triangles.iter().map(|t| t.map(|v| v + first)));
    }
    mesh
}

#[test]
fn simplify_sloppily_and_as_a_fallback() {
    let folder = Folder::new();
    folder.scene("balls.ply", &karui::Scene::from_mesh(balls()));
    let kept = "--triangles 200 --keep-topology";
    let plain = folder.ok(&format!("simplify balls.ply -o plain.ply {kept} --json"));
    let before = number(&plain.json(), "/triangles/after");
    assert!(before > 200.0, "{before}");
    assert_eq!(plain.json()["clustered"].as_array().map(Vec::len), Some(0));

    let fallback = format!("simplify balls.ply -o fallback.ply {kept} --sloppy-fallback");
    let ran = folder.ok(&fallback);
    assert!(
        ran.out.contains("clustered  instead of edge collapse: "),
        "{ran:?}"
    );
    let after = |name: &str| karui_io::read(folder.path(name)).unwrap().triangle_count();
    assert!((1..=200).contains(&after("fallback.ply")));
    let ran = folder.ok(&format!("{fallback} --json"));
    assert_eq!(
        ran.json()["clustered"][0]["reason"],
        plain.json()["stopped"][0]["reason"]
    );

    // The small one may vanish, the others are larger than any error so far.
    let eased = folder.ok("simplify balls.ply -o eased.ply --triangles 200 --json");
    assert!((200.0..before).contains(&number(&eased.json(), "/triangles/after")));

    folder.ok("simplify balls.ply -o sloppy.ply --triangles 200 --sloppy");
    assert!((1..=200).contains(&after("sloppy.ply")));
    // Where edge collapse gets there, the fallback is not used.
    folder.ok("simplify balls.ply -o a.ply --ratio 0.5 --sloppy-fallback");
    folder.ok("simplify balls.ply -o b.ply --ratio 0.5");
    assert_eq!(folder.read("a.ply"), folder.read("b.ply"));
    folder.fails(
        2,
        "simplify balls.ply -o c.ply --ratio 0.5 --sloppy --pairs 1",
    );
    // An error asked for holds for what is measured.
    let ran = folder.ok("simplify balls.ply -o e.ply --error 0.1 --sloppy --json");
    assert!(number(&ran.json(), "/error/max") <= 0.1);

    folder.ok("lod balls.ply -o lod.glb --triangles 4000,200 --sloppy-fallback");
    let report = folder.json("lod.report.json");
    let levels = &report["meshes"][0]["levels"];
    assert!(levels[0].get("clustered").is_none(), "{levels}");
    assert!(levels[1]["clustered"].is_string(), "{levels}");
}

#[test]
fn simplify_prunes_small_parts() {
    let folder = Folder::new();
    folder.scene("balls.ply", &karui::Scene::from_mesh(balls()));
    let ran = folder.ok("simplify balls.ply -o pruned.ply --ratio 1 --prune 0.04 --json");
    let report = ran.json();
    assert_eq!(number(&report, "/triangles/after"), 99.0 * 80.0);
    assert_eq!(number(&report, "/pruned/parts"), 1.0);
    let size = number(&report, "/pruned/largest");
    assert!((0.02..=0.04).contains(&size), "{size}");
    // All that changed is that a ball is gone, and its size is the error.
    assert_eq!(number(&report, "/error/max"), size);
    let ran = folder.ok("simplify balls.ply -o pruned.ply --ratio 0.5 --prune 0.04");
    assert!(
        ran.out.contains("pruned     1 parts of 80 triangles"),
        "{ran:?}"
    );
    folder.fails(2, "simplify balls.ply -o c.ply --ratio 0.5 --prune=-1");
}

#[test]
fn simplify_foliage_keeps_its_area() {
    let folder = Folder::new();
    let mut tree = karui::Scene::from_mesh(karui::mesh::shapes::tree(3000, 1));
    tree.materials.resize(2, karui::mesh::Material::default());
    folder.scene("tree.glb", &tree);
    let ran = folder.ok("simplify tree.glb -o thin.glb --ratio 0.1 --foliage --json");
    let report = ran.json();
    let [before, after] = ["before", "after"].map(|k| number(&report, &format!("/area/{k}")));
    assert!((after / before - 1.0).abs() < 0.05, "{before} {after}");
    assert!(number(&report, "/triangles/after") <= 792.0);
    let thin = karui_io::read(folder.path("thin.glb")).unwrap();
    assert_eq!(thin.meshes[0].mesh.ranges.len(), 2);
    let ran = folder.ok("simplify tree.glb -o thin.glb --ratio 0.1 --foliage=1");
    assert!(
        ran.out.contains("area "),
        "no quad is a card of one triangle: {ran:?}"
    );
    let ran = folder.fails(2, "simplify tree.glb -o x.glb --error 0.1 --foliage");
    assert!(ran.err.contains("foliage"), "{ran:?}");
    folder.fails(
        2,
        "simplify tree.glb -o x.glb --ratio 0.1 --foliage --sloppy",
    );

    folder.ok("lod tree.glb -o lod.glb --ratio 0.3,0.1 --foliage");
    let report = folder.json("lod.report.json");
    assert_eq!(report["levels"].as_array().map(Vec::len), Some(3));
}

#[test]
fn measure_and_its_map() {
    let folder = Folder::new();
    // Two parallel squares at a distance of 0.5 are 0.5 apart everywhere.
    let square = |z: f32| format!("OFF\n4 1 0\n0 0 {z}\n1 0 {z}\n1 1 {z}\n0 1 {z}\n4 0 1 2 3\n");
    folder.write("a.off", square(0.0));
    folder.write("b.off", square(0.5));
    let ran = folder.ok("measure a.off b.off --samples 2000 --map map.ply --json");
    let report = ran.json();
    for figure in ["/max", "/mean", "/rms"] {
        assert!((number(&report, figure) - 0.5).abs() < 1e-6);
    }
    let map = karui_io::read(folder.path("map.ply"))
        .unwrap()
        .into_single_mesh()
        .unwrap();
    let attribute = map.attributes.custom.iter().find(|a| a.name == "distance");
    let values = &attribute.expect("distance").values;
    assert_eq!(values, &karui::mesh::AttributeValues::F32(vec![0.5; 4]));
    assert_eq!(map.attributes.colors.len(), 1);
    let ran = folder.ok("measure a.off b.off --max 0.6 --mean 0.6 --rms 0.6");
    assert!(ran.out.contains("two-sided"), "{ran:?}");
    // 0.5 is 0.354 of the diagonal.
    folder.ok("measure a.off b.off --max 0.36 --relative");
    let ran = folder.fails(1, "measure a.off b.off --max 0.35 --relative");
    assert!(ran.err.contains("exceeds"), "{ran:?}");
}

#[test]
fn info_and_validate() {
    let folder = Folder::new();
    folder.family("family.glb");
    folder.terrain("land.ply");
    let ran = folder.ok("info family.glb land.ply");
    assert!(
        ran.out.contains("ball") && ran.out.contains("ring"),
        "{ran:?}"
    );
    let info = folder.ok("info family.glb --json").json();
    assert_eq!(number(&info, "/0/instances"), 3.0);
    assert_eq!(number(&info, "/0/meshes/1/triangles"), 2304.0);
    assert_eq!(info.pointer("/0/meshes/1/closed"), Some(&Value::Bool(true)));
    let drawn = number(&info, "/0/drawn_triangles") - number(&info, "/0/triangles");
    assert_eq!(drawn, 2304.0, "the ring is drawn twice");

    let ran = folder.ok("validate family.glb land.ply");
    assert!(ran.out.contains("open edges"), "{ran:?}");
    folder.ok("validate family.glb --require closed,manifold,oriented");
    folder.ok("validate land.ply --require manifold,oriented,clean");
    let ran = folder.fails(1, "validate family.glb land.ply --require all");
    assert!(ran.out.contains("ok       family.glb"), "{ran:?}");
    assert!(ran.out.contains("fail     land.ply"), "{ran:?}");
    let report = folder
        .run("validate land.ply --require closed --json")
        .json();
    assert_eq!(
        report.pointer("/0/meshes/0/defects/0/failure"),
        Some(&Value::Bool(true))
    );
}

#[test]
fn convert_there_and_back() {
    let folder = Folder::new();
    folder.terrain("land.ply");
    let before = folder.ok("info land.ply --json").json();
    let mut from = "land.ply".to_owned();
    for to in ["a.obj", "b.off", "c.stl", "d.glb", "e.gltf", "f.ply.gz"] {
        let ran = folder.ok(&format!("convert {from} {to} --json"));
        assert_eq!(number(&ran.json(), "/triangles"), 2400.0, "{to}");
        from = to.to_owned();
    }
    let after = folder.ok("info f.ply.gz --json").json();
    for figure in [
        "/0/triangles",
        "/0/meshes/0/positions",
        "/0/meshes/0/components",
    ] {
        assert_eq!(number(&before, figure), number(&after, figure), "{figure}");
    }
    let ran = folder.ok("measure land.ply f.ply.gz --samples 5000 --json");
    assert!(number(&ran.json(), "/max") < 1e-5 * number(&ran.json(), "/diagonal"));
}

#[test]
fn compressed_and_quantized_files_are_smaller_and_say_the_same() {
    let folder = Folder::new();
    folder.terrain("land.ply");
    folder.ok("convert land.ply plain.glb");
    folder.ok("convert land.ply small.glb --compress --quantize");
    let [plain, small] = ["plain.glb", "small.glb"].map(|f| folder.read(f).len());
    assert!(small * 2 < plain, "{small} {plain}");
    let far = folder
        .ok("measure plain.glb small.glb --samples 5000 --json")
        .json();
    // Half a step of 16 bits over the largest extent, along three axes.
    let step = number(&far, "/diagonal") / 65535.0;
    assert!(number(&far, "/max") < step, "{far}");
    folder.ok("convert land.ply text.stl --ascii");
    assert!(folder.read("text.stl").starts_with(b"solid"));
}

#[test]
fn completions_and_man_pages() {
    let folder = Folder::new();
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let ran = folder.ok(&format!("completions {shell}"));
        assert!(ran.out.contains("pixel-tolerance"), "{shell}");
    }
    let page = folder.ok("man").out;
    assert!(
        page.starts_with(".ie") && page.contains(".TH karui 1"),
        "{page}"
    );
    folder.ok("man -o pages");
    let names = folder.names("pages");
    assert!(
        names.contains(&"karui.1".into()) && names.contains(&"karui-lod.1".into()),
        "{names:?}"
    );
    for name in names {
        let page = String::from_utf8(folder.read(&format!("pages/{name}"))).unwrap();
        assert!(page.contains(".SH NAME") && page.len() > 500, "{name}");
    }
}

#[test]
fn bench_tabulates_a_folder_and_lists_what_is_refused() {
    let folder = Folder::new();
    std::fs::create_dir_all(folder.path("models/more")).unwrap();
    folder.terrain("models/more/land.ply");
    folder.family("models/family.glb");
    folder.write(
        "models/broken.stl",
        "solid x\nfacet normal 0 0 1\n outer loop\n vertex 0 0",
    );
    folder.write("models/notes.txt", "not a model");
    folder.ok("bench models --models models --ratio 0.5,0.1 -o measured.md -q");
    let text = String::from_utf8(folder.read("measured.md")).unwrap();
    let row = text
        .lines()
        .find(|l| l.contains("`more/land.ply`"))
        .expect("a row");
    let cells: Vec<&str> = row.split('|').map(str::trim).collect();
    assert_eq!(cells[2], "2,400");
    let half: usize = cells[3].replace(',', "").parse().unwrap();
    assert!((1190..=1200).contains(&half), "{row}");
    assert!(text.contains("- `broken.stl`: "), "{text}");
    assert!(!text.contains("notes.txt"));
    assert!(text.contains("## Failed\nNone."), "{text}");
}

#[test]
fn bench_simplify_compares_modes_and_keeps_the_page_around_it() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("models")).unwrap();
    folder.terrain("models/land.ply");
    folder.write("page.md", "# Figures\n");
    let few = "bench simplify --models models --targets 0.5 --runs 1 --samples 1000 --sizes 500";
    let page = format!("{few} --more-than 100 -o page.md -q");
    folder.ok(&page);
    let written = String::from_utf8(folder.read("page.md")).unwrap();
    assert!(written.starts_with("# Figures\n"), "{written}");
    for (title, row) in [
        ("### Geometry", "| `land.ply`"),
        ("### Size", "| balanced "),
    ] {
        let section = written.split(title).nth(1).expect(title);
        let row = section.lines().find(|l| l.starts_with(row)).expect(row);
        assert!(
            row.contains(" fast ") || row.contains(" balanced "),
            "{row}"
        );
    }
    folder.ok(&page);
    let again = String::from_utf8(folder.read("page.md")).unwrap();
    assert_eq!(again.matches("## Simplification compared").count(), 1);

    let json = folder
        .ok(&format!("{few} --more-than 100 --workers 1,3 --json -q"))
        .json();
    let rows = json["geometry"].as_array().unwrap();
    assert_eq!(rows.len() % 2, 0);
    for pair in rows.chunks(2) {
        // The number of threads changes the time only.
        assert_eq!(pair[0]["errors"], pair[1]["errors"]);
        let left = pair[0]["errors"]["triangles"].as_u64().unwrap();
        assert!((1150..=1200).contains(&left), "{left}");
        assert!(pair[0]["errors"]["rms"].as_f64().unwrap() < 0.01);
        assert!(pair[0]["costs"]["wall"]["least"].as_f64().unwrap() > 0.0);
    }
    let ran = folder.fails(2, &format!("{few} --more-than 1000000"));
    assert!(ran.err.contains("no model with more than"), "{ran:?}");
}

#[test]
fn bench_simplify_has_peers_or_says_how_to_get_them() {
    let folder = Folder::new();
    folder.terrain("land.ply");
    let args = "bench simplify land.ply --peers --more-than 100 --targets 0.1 --runs 1";
    let args = format!("{args} --parts geometry --samples 1000 --json -q");
    if !cfg!(feature = "peers") {
        let ran = folder.fails(2, &args);
        assert!(ran.err.contains("--features peers"), "{ran:?}");
        return;
    }
    let json = folder.ok(&args).json();
    let named = |name: &str| {
        let rows = json["geometry"].as_array().unwrap().iter();
        rows.filter(|r| r["name"] == name).count()
    };
    assert_eq!(named("meshopt update"), 1, "{json}");
    assert_eq!(named("meshopt sloppy"), 1, "{json}");
}

#[test]
fn bench_judge_measures_results_of_others() {
    let folder = Folder::new();
    folder.family("family.glb");
    folder.ok("bench judge family.glb --prepare bare.ply");
    folder.ok("simplify bare.ply -o coarse.ply --ratio 0.5 -q");
    let args = "bench judge family.glb bare.ply coarse.ply --samples 5000 --json -q";
    let judged = folder.ok(args).json();
    let [same, coarse] = [0, 1].map(|i| judged["results"][i].clone());
    assert_eq!(same["triangles"], judged["triangles"]);
    assert!(same["max"].as_f64().unwrap() < 1e-9, "{same}");
    let measured = folder
        .ok("measure bare.ply coarse.ply --samples 5000 --json")
        .json();
    let [judged, measured] = [&coarse["rms"], &measured["rms_of_diagonal"]].map(|x| x.as_f64());
    let (judged, measured) = (judged.unwrap(), measured.unwrap());
    assert!(
        (judged / measured - 1.0).abs() < 0.05,
        "{judged} {measured}"
    );
}

#[test]
fn quiet_is_quiet_and_json_is_json() {
    let folder = Folder::new();
    folder.terrain("land.ply");
    for args in [
        "lod land.ply -o q --ratio 0.5",
        "simplify land.ply -o q.ply --ratio 0.5",
        "convert land.ply q.obj",
        "man -o pages",
    ] {
        let ran = folder.ok(&format!("{args} --quiet"));
        assert_eq!((ran.out.as_str(), ran.err.as_str()), ("", ""), "{args}");
    }
    for args in [
        "lod land.ply -o j --ratio 0.5",
        "simplify land.ply -o j.ply --ratio 0.5",
        "convert land.ply j.obj",
        "info land.ply",
        "validate land.ply",
        "measure land.ply land.ply --samples 100",
    ] {
        folder.ok(&format!("{args} --json")).json();
    }
}

#[test]
fn a_closed_pipe_is_no_failure() {
    let folder = Folder::new();
    let mut child = karui()
        .args(["completions", "bash"])
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .current_dir(folder.path("."))
        .spawn()
        .unwrap();
    // More is written than a pipe holds, so this cannot be outrun.
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0));
    assert!(
        output.stderr.is_empty(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
}

#[test]
fn replay_any_level_of_a_log_and_of_a_pose() {
    let folder = Folder::new();
    folder.family("family.glb");
    folder.ok("simplify family.glb -o coarse.glb --ratio 0.1 --log family.karuilog");
    let ran = folder.ok("replay family.glb family.karuilog -o again.glb --map map.csv --json");
    let scene = |name: &str| karui_io::read(folder.path(name)).unwrap();
    let (coarse, again) = (scene("coarse.glb"), scene("again.glb"));
    for (a, b) in coarse.meshes.iter().zip(&again.meshes) {
        assert!(a.mesh == b.mesh);
    }
    assert_eq!(
        number(&ran.json(), "/triangles/after") as usize,
        coarse.triangle_count()
    );
    // Every old vertex of the first mesh leads to a new one.
    let map = String::from_utf8(folder.read("map.csv")).unwrap();
    let old = scene("family.glb");
    let of_ball = map.lines().filter(|line| line.starts_with("0,"));
    let new = of_ball.map(|line| line.rsplit(',').next().unwrap().parse::<usize>());
    let new: Vec<usize> = new.map(Result::unwrap).collect();
    assert_eq!(new.len(), old.meshes[0].mesh.positions.len());
    let count = again.meshes[0].mesh.positions.len();
    assert!((0..count).all(|v| new.contains(&v)) && new.iter().all(|&v| v < count));

    let all = old.triangle_count();
    folder.ok(&format!(
        "replay family.glb family.karuilog -o half.glb --triangles {}",
        all / 2
    ));
    assert!(scene("half.glb").triangle_count().abs_diff(all / 2) <= 2);

    // Another pose: the same triangles.
    let mut pose = old;
    for named in &mut pose.meshes {
        named
            .mesh
            .positions
            .iter_mut()
            .for_each(|p| p.y += 0.3 * p.x * p.x);
    }
    folder.scene("pose.glb", &pose);
    folder.ok("replay pose.glb family.karuilog -o posed.glb");
    for (a, b) in again.meshes.iter().zip(&scene("posed.glb").meshes) {
        assert_eq!(a.mesh.triangles, b.mesh.triangles);
        assert_ne!(a.mesh.positions, b.mesh.positions);
    }
}

#[test]
fn replay_refuses_what_does_not_belong_together() {
    let folder = Folder::new();
    folder.family("family.glb");
    folder.scene(
        "ball.glb",
        &karui::Scene::from_mesh(karui::mesh::shapes::icosphere(2)),
    );
    folder.ok("simplify family.glb -o coarse.glb --ratio 0.1 --log family.karuilog");
    let ran = folder.fails(2, "replay ball.glb family.karuilog -o out.glb");
    assert!(ran.err.contains("2 meshes"), "{ran:?}");
    let ran = folder.fails(2, "replay coarse.glb family.karuilog -o out.glb");
    assert!(ran.err.contains("number of vertices differs"), "{ran:?}");
    folder.write("cut.karuilog", &folder.read("family.karuilog")[..99]);
    let ran = folder.fails(2, "replay family.glb cut.karuilog -o out.glb");
    assert!(ran.err.contains("collapse log, "), "{ran:?}");
    folder.fails(2, "replay family.glb coarse.glb -o out.glb");
    folder.fails(2, "replay family.glb missing.karuilog -o out.glb");
    folder.fails(2, "replay family.glb family.karuilog -o out.glb --ratio 2");
    folder.fails(
        2,
        "simplify family.glb -o out.glb --ratio 0.1 --prune 1 --log out.karuilog",
    );
    folder.fails(
        3,
        "simplify family.glb -o out.glb --ratio 0.1 --log missing/out.karuilog",
    );
    folder.fails(
        3,
        "replay family.glb family.karuilog -o out.glb --map missing/map.csv",
    );
}
