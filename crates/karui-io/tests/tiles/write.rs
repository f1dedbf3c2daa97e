//! What the writer writes: held against the checker, which was tried on other
//! people's tilesets, and against closed forms.

use super::base::{cube, files};
use glam::{DMat4, DVec3};
use karui::{
    Scene,
    geom::Vec3,
    mesh::{Attribute, AttributeValues, Node, Transform},
};
use karui_io::{
    Error, FeatureColumn, FeatureTable, FeatureValues,
    tiles::{
        self, Cell, CellTree, Geodetic, Refine, Scheme, Shape, TileContent, TileTree, TilesOptions,
        TilesWritten, TreeNode, Up, VolumeKind,
    },
};
use proptest::prelude::*;
use std::{collections::BTreeMap, path::Path};

/// A balanced tree over a square of `4^levels` cubes a side of 10 m, far from
/// the origin, z up.
fn tree(levels: u32, at: DVec3) -> TileTree {
    let mut nodes = Vec::new();
    let size = 10.0 * f64::from(1u32 << levels);
    let mut open = vec![(None, at, size, levels)];
    while let Some((parent, min, size, level)) = open.pop() {
        let node = nodes.len() as u32;
        nodes.push(TreeNode {
            parent,
            min: min + DVec3::splat(0.01),
            max: min + DVec3::new(size, size, 10.0) - DVec3::splat(0.01),
            error: f64::from(level),
            refine: Refine::Replace,
        });
        if level > 0 {
            let half = size / 2.0;
            for (x, y) in [(0.0, 0.0), (half, 0.0), (0.0, half), (half, half)] {
                open.push((Some(node), min + DVec3::new(x, y, 0.0), half, level - 1));
            }
        }
    }
    TileTree { nodes }
}

/// A box as large as the node, with the id of the node as its feature.
fn content(tree: &TileTree) -> impl Fn(u32, DVec3) -> Result<Option<TileContent>, Error> + Sync {
    |node, origin| {
        let TreeNode { min, max, .. } = tree.nodes[node as usize];
        let local = |p: DVec3| (p - origin).as_vec3().to_array();
        let mut scene = z_up_cube(local(min), local(max));
        let mesh = &mut scene.meshes[0].mesh;
        mesh.attributes.custom.push(Attribute {
            name: "_FEATURE_ID_0".into(),
            components: 1,
            values: AttributeValues::U32(vec![0; mesh.positions.len()]),
        });
        let features = FeatureTable {
            class: "object".into(),
            columns: vec![
                FeatureColumn {
                    name: "name".into(),
                    values: FeatureValues::Text(vec![format!("node {node}")]),
                },
                FeatureColumn {
                    name: "index".into(),
                    values: FeatureValues::U32(vec![node]),
                },
                FeatureColumn {
                    name: "x".into(),
                    values: FeatureValues::F64(vec![min.x]),
                },
            ],
        };
        Ok(Some(TileContent {
            scene,
            features: Some(features),
        }))
    }
}

/// [`cube`] as the input has it that says z is up.
fn z_up_cube(min: [f32; 3], max: [f32; 3]) -> Scene {
    let mut scene = cube(min, max);
    for p in &mut scene.meshes[0].mesh.positions {
        *p = Vec3::new(p.x, -p.z, p.y);
    }
    scene
}

fn options() -> TilesOptions {
    TilesOptions {
        up: Up::Z,
        tiles_per_file: 50,
        ..TilesOptions::default()
    }
}

fn write(folder: &Path, tree: &TileTree, options: &TilesOptions) -> TilesWritten {
    let content = content(tree);
    tiles::write(folder, tree, &content, options).unwrap()
}

/// Nothing at all to say about it.
fn flawless(folder: &Path) -> tiles::Report {
    let options = tiles::CheckOptions {
        tolerance: 1e-9,
        ..Default::default()
    };
    let report = tiles::check_with(folder.join("tileset.json"), &options).unwrap();
    assert_eq!(report.findings, tiles::Findings::default());
    report
}

#[test]
fn every_kind_of_volume_encloses_what_it_should() {
    let folder = tempfile::tempdir().unwrap();
    let place = Some(Geodetic::from_degrees(35.68, 139.77, 40.0));
    for (i, volume) in [VolumeKind::Box, VolumeKind::Sphere, VolumeKind::Region]
        .into_iter()
        .enumerate()
    {
        for (j, place) in [None, place].into_iter().enumerate() {
            if volume == VolumeKind::Region && place.is_none() {
                continue;
            }
            let to = folder.path().join(format!("{i}{j}"));
            let tree = tree(4, DVec3::new(-300.0, 50.0, 5.0));
            let written = write(
                &to,
                &tree,
                &TilesOptions {
                    volume,
                    place,
                    ..options()
                },
            );
            let report = flawless(&to);
            assert_eq!(written.tiles, 341);
            assert_eq!(report.counts.contents, 341);
            // Stubs of external tilesets are tiles, too.
            assert_eq!(report.counts.tiles, 341 + written.tilesets - 1);
            assert!(written.tilesets > 5, "{written:?}");
            assert_eq!(written.bytes, report.counts.bytes);
            assert_eq!(report.counts.triangles, 341 * 12);
        }
    }
}

/// Regions near the poles and on both sides of the antimeridian.
#[test]
fn regions_all_over_the_earth() {
    let folder = tempfile::tempdir().unwrap();
    let tree = tree(2, DVec3::ZERO);
    for (i, (lat, lon)) in [
        (0.0, 180.0),
        (80.0, -180.0),
        (-88.0, 12.0),
        (0.0, 0.0),
        (51.5, -0.0001),
    ]
    .into_iter()
    .enumerate()
    {
        let to = folder.path().join(i.to_string());
        let place = Some(Geodetic::from_degrees(lat, lon, 0.0));
        write(
            &to,
            &tree,
            &TilesOptions {
                volume: VolumeKind::Region,
                place,
                ..options()
            },
        );
        flawless(&to);
    }
    let place = Some(Geodetic::from_degrees(90.0, 0.0, 0.0));
    let at_pole = TilesOptions {
        volume: VolumeKind::Region,
        place,
        ..options()
    };
    let content = content(&tree);
    let to = folder.path().join("pole");
    assert!(tiles::write(&to, &tree, &content, &at_pole).is_err());
    assert!(!to.exists());
}

/// The root's transform takes the origin of the scene to its place.
#[test]
fn the_place_on_the_earth() {
    let folder = tempfile::tempdir().unwrap();
    let to = folder.path().join("t");
    let tree = tree(0, DVec3::ZERO);
    let place = Some(Geodetic::from_degrees(0.0, 90.0, 7.0));
    write(&to, &tree, &TilesOptions { place, ..options() });
    let tileset = tiles::read(to.join("tileset.json")).unwrap();
    let matrix = tileset.tiles[0].transform.unwrap();
    let middle = DVec3::new(5.0, 5.0, 5.0);
    // East is -x, north is z and up is y at longitude 90 on the equator.
    let expected = DVec3::new(-5.0, 6_378_137.0 + 7.0 + 5.0, 5.0);
    let found = matrix.transform_point3(DVec3::ZERO);
    assert!((found - expected).length() < 1e-8, "{found}");
    assert!(
        matches!(tileset.tiles[0].bounding_volume.shape, Some(Shape::Box { center, .. })
        if (center + middle - middle).length() < 1e-6)
    );
}

/// At 1e9 m, where 32 bits are 64 m apart, a millimetre is kept.
#[test]
fn far_from_the_origin() {
    let folder = tempfile::tempdir().unwrap();
    let to = folder.path().join("t");
    let at = DVec3::new(1e9, -2e9, 3e8);
    let tree = tree(3, at);
    write(&to, &tree, &options());
    flawless(&to);
    let tileset = tiles::read(to.join("tileset.json")).unwrap();
    let mut moved = DMat4::IDENTITY;
    let mut tile = &tileset.tiles[0];
    loop {
        moved *= tile.transform.unwrap_or(DMat4::IDENTITY);
        let Some(&first) = tile.children.first() else {
            break;
        };
        tile = &tileset.tiles[first as usize];
    }
    let middle = moved.transform_point3(DVec3::ZERO);
    // Middles of tiles of 10 m, or of stubs for several of them.
    let cells = (middle - at) / 5.0;
    assert!(
        (cells - cells.round()).abs().max_element() < 1e-4,
        "{cells}"
    );
}

/// Contents with y up, in a folder of one tile: the picture that a client
/// makes of a glTF and its tile.
#[test]
fn y_up_and_z_up_are_the_same_place() {
    let folder = tempfile::tempdir().unwrap();
    let y_up = TileTree {
        nodes: vec![TreeNode {
            parent: None,
            min: DVec3::new(1.0, 2.0, -9.0),
            max: DVec3::new(4.0, 8.0, -1.0),
            error: 0.0,
            refine: Refine::Add,
        }],
    };
    let content = |_: u32, origin: DVec3| {
        let mut scene = cube([1.0, 1.0, 2.0], [4.0, 9.0, 8.0]);
        for p in &mut scene.meshes[0].mesh.positions {
            *p -= origin.as_vec3();
        }
        Ok(Some(TileContent {
            scene,
            features: None,
        }))
    };
    let to = folder.path().join("y");
    tiles::write(&to, &y_up, &content, &TilesOptions::default()).unwrap();
    flawless(&to);
    let tileset = tiles::read(to.join("tileset.json")).unwrap();
    let root = &tileset.tiles[0];
    let moved = root.transform.unwrap().transform_point3(DVec3::ZERO);
    assert!(
        (moved - DVec3::new(2.5, 5.0, 5.0)).length() < 1e-9,
        "{moved}"
    );
    let Some(Shape::Box {
        half_axes: [x, y, z],
        ..
    }) = root.bounding_volume.shape
    else {
        panic!("{root:?}");
    };
    let half = DVec3::new(x.x, y.y, z.z);
    assert!((half - DVec3::new(1.5, 4.0, 3.0)).length() < 1e-6, "{half}");
}

#[test]
fn errors_are_raised_and_volumes_grown() {
    let folder = tempfile::tempdir().unwrap();
    let to = folder.path().join("t");
    let mut tree = tree(2, DVec3::ZERO);
    let last = tree.nodes.len() - 1;
    tree.nodes[last].error = 100.0;
    // Bounds that know nothing of what is below.
    tree.nodes[0].max = tree.nodes[0].min + DVec3::splat(0.5);
    let written = write(&to, &tree, &options());
    assert_eq!(written.raised_errors, 2);
    let report = flawless(&to);
    assert_eq!(report.levels[0].max_error, 100.0);
}

fn bytes(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let name = |p: &Path| {
        p.strip_prefix(folder)
            .unwrap()
            .to_string_lossy()
            .into_owned()
    };
    files(folder)
        .into_iter()
        .map(|p| (name(&p), std::fs::read(&p).unwrap()))
        .collect()
}

#[test]
fn the_same_bytes_for_any_number_of_threads() {
    let folder = tempfile::tempdir().unwrap();
    let tree = tree(4, DVec3::ZERO);
    let mut all = Vec::new();
    for threads in [1, 2, 8] {
        let to = folder.path().join(threads.to_string());
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| write(&to, &tree, &options()));
        all.push(bytes(&to));
    }
    assert_eq!(
        all[0].len(),
        341 + all[0].keys().filter(|k| k.ends_with("json")).count()
    );
    assert!(all[0] == all[1] && all[1] == all[2]);
}

#[test]
fn only_empty_folders_and_own_tilesets_are_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let to = folder.path().join("t");
    let tree = tree(1, DVec3::ZERO);
    let content = content(&tree);
    let again = TilesOptions {
        overwrite: true,
        ..options()
    };
    std::fs::create_dir(&to).unwrap();
    write(&to, &tree, &options());
    assert!(tiles::write(&to, &tree, &content, &options()).is_err());
    std::fs::write(to.join("left.over"), "x").unwrap();
    write(&to, &tree, &again);
    assert!(!to.join("left.over").exists());
    let other = folder.path().join("other");
    std::fs::create_dir(&other).unwrap();
    std::fs::write(other.join("photo.jpg"), "x").unwrap();
    assert!(tiles::write(&other, &tree, &content, &again).is_err());
    assert!(tiles::write(other.join("photo.jpg"), &tree, &content, &again).is_err());
    assert!(other.join("photo.jpg").exists());
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
}

/// A content that cannot be had, or is not valid: nothing is left.
#[test]
fn nothing_is_left_behind() {
    let folder = tempfile::tempdir().unwrap();
    let to = folder.path().join("t");
    let tree = tree(2, DVec3::ZERO);
    let good = content(&tree);
    let failing = |node: u32, origin: DVec3| match node {
        13 => Err(Error::file(
            "x",
            karui_io::ErrorKind::Unsupported("this".into()),
        )),
        _ => good(node, origin),
    };
    assert!(tiles::write(&to, &tree, &failing, &options()).is_err());
    let broken = |node: u32, origin: DVec3| {
        let mut content = good(node, origin)?;
        if let Some(content) = content.as_mut().filter(|_| node == 13) {
            content.scene.meshes[0].mesh.positions[0].x = f32::NAN;
        }
        Ok(content)
    };
    assert!(tiles::write(&to, &tree, &broken, &options()).is_err());
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn trees_that_are_none() {
    let folder = tempfile::tempdir().unwrap();
    let to = folder.path().join("t");
    let good = tree(1, DVec3::ZERO);
    let content = content(&good);
    let refused = |change: &dyn Fn(&mut TileTree, &mut TilesOptions)| {
        let (mut tree, mut options) = (good.clone(), options());
        change(&mut tree, &mut options);
        assert!(tiles::write(&to, &tree, &content, &options).is_err());
        assert!(!to.exists());
    };
    refused(&|t, _| t.nodes.clear());
    refused(&|t, _| t.nodes[0].parent = Some(0));
    refused(&|t, _| t.nodes[1].parent = None);
    refused(&|t, _| t.nodes[1].parent = Some(1));
    refused(&|t, _| t.nodes[1].error = f64::NAN);
    refused(&|t, _| t.nodes[1].error = -1.0);
    refused(&|t, _| t.nodes[1].min.x = f64::NAN);
    refused(&|t, _| t.nodes[1].min.x = 1e9);
    refused(&|t, _| t.nodes[1].max.x = 1e300);
    refused(&|_, o| o.tiles_per_file = 1);
    refused(&|_, o| o.volume = VolumeKind::Region);
    refused(&|_, o| o.place = Some(Geodetic::from_degrees(91.0, 0.0, 0.0)));
}

/// A chain as deep as a tree of a million near objects may become.
#[test]
fn a_chain_of_tiles() {
    let folder = tempfile::tempdir().unwrap();
    let to = folder.path().join("t");
    let node = |i: u32| TreeNode {
        parent: i.checked_sub(1),
        min: DVec3::ZERO,
        max: DVec3::ONE,
        error: f64::from(3000 - i),
        refine: Refine::Add,
    };
    let tree = TileTree {
        nodes: (0..3000).map(node).collect(),
    };
    let none = |_: u32, _: DVec3| Ok(None);
    let written = tiles::write(&to, &tree, &none, &options()).unwrap();
    assert_eq!(written.contents, 0);
    assert_eq!(
        flawless(&to).counts.depth as u64,
        3000 + written.tilesets - 1
    );
}

#[test]
fn features_come_back() {
    let folder = tempfile::tempdir().unwrap();
    let to = folder.path().join("t");
    let tree = tree(1, DVec3::ZERO);
    write(&to, &tree, &options());
    flawless(&to);
    let path = to.join("content/0/3.glb");
    let scene = karui_io::read(&path).unwrap();
    let ids = &scene.meshes[0].mesh.attributes.custom[0];
    assert_eq!(ids.name, "_FEATURE_ID_0");
    assert!(matches!(&ids.values, AttributeValues::U8(v) if v.iter().all(|i| *i == 0)));
    // Written again, the metadata is still there.
    let again = folder.path().join("again.gltf");
    karui_io::write(&again, &scene).unwrap();
    let json: serde_json::Value = serde_json::from_slice(&std::fs::read(&again).unwrap()).unwrap();
    let table = &json["extensions"]["EXT_structural_metadata"]["propertyTables"][0];
    assert_eq!(table["count"], 1);
    let set =
        &json["meshes"][0]["primitives"][0]["extensions"]["EXT_mesh_features"]["featureIds"][0];
    assert_eq!(
        (&set["featureCount"], &set["attribute"]),
        (&1.into(), &0.into())
    );
    let view = table["properties"]["name"]["values"].as_u64().unwrap() as usize;
    let view = &json["bufferViews"][view];
    let bin = std::fs::read(folder.path().join("again.bin")).unwrap();
    let number = |key: &str| view[key].as_u64().unwrap_or(0) as usize;
    assert_eq!(
        &bin[number("byteOffset")..][..number("byteLength")],
        b"node 3"
    );
}

/// Ids without a row, columns of different length, names that are none.
#[test]
fn features_that_do_not_fit() {
    let folder = tempfile::tempdir().unwrap();
    let column = |name: &str, rows: usize| FeatureColumn {
        name: name.into(),
        values: FeatureValues::U32(vec![0; rows]),
    };
    let write = |class: &str, columns: Vec<FeatureColumn>, id: u32| {
        let mut scene = cube([0.0; 3], [1.0; 3]);
        let mesh = &mut scene.meshes[0].mesh;
        mesh.attributes.custom.push(Attribute {
            name: "_FEATURE_ID_0".into(),
            components: 1,
            values: AttributeValues::U32(vec![id; mesh.positions.len()]),
        });
        let table = FeatureTable {
            class: class.into(),
            columns,
        };
        let mut options = karui_io::WriteOptions::default();
        options.gltf.features = Some(std::sync::Arc::new(table));
        karui_io::write_with(folder.path().join("a.glb"), &scene, &options)
    };
    write("a", vec![column("x", 300), column("y", 300)], 299).unwrap();
    assert!(write("a", vec![column("x", 2)], 2).is_err());
    assert!(write("a", vec![column("x", 2), column("y", 3)], 0).is_err());
    assert!(write("a", vec![column("x", 2), column("x", 2)], 0).is_err());
    assert!(write("a", vec![column("1x", 2)], 0).is_err());
    assert!(write("a b", vec![column("x", 2)], 0).is_err());
    assert!(write("a", vec![], 0).is_err());
    assert!(write("a", vec![column("x", 0)], 0).is_err());
}

/// Cells filled with boxes of their own size.
fn cells(scheme: Scheme, cells: Vec<Cell>) -> CellTree {
    CellTree {
        scheme,
        min: DVec3::new(100.0, 200.0, 0.0),
        max: DVec3::new(164.0, 232.0, 16.0),
        error: 32.0,
        refine: Refine::Add,
        cells,
        subtree_levels: 2,
    }
}

fn cell_content(
    tree: &CellTree,
) -> impl Fn(u32, DVec3) -> Result<Option<TileContent>, Error> + Sync {
    |i, origin| {
        let cell = tree.cells[i as usize];
        let cells = f64::from(1u32 << cell.level);
        let mut size = (tree.max - tree.min) / cells;
        let at = DVec3::new(cell.x.into(), cell.y.into(), cell.z.into());
        let min = tree.min + at * size - origin;
        if tree.scheme == Scheme::Quadtree {
            size.z = tree.max.z - tree.min.z;
        }
        let scene = z_up_cube(min.as_vec3().to_array(), (min + size).as_vec3().to_array());
        Ok(Some(TileContent {
            scene,
            features: None,
        }))
    }
}

#[test]
fn implicit_tilesets() {
    let folder = tempfile::tempdir().unwrap();
    let cell = |level, x, y, z| Cell { level, x, y, z };
    let flat = vec![
        cell(4, 15, 0, 0),
        cell(4, 0, 15, 0),
        cell(3, 5, 2, 0),
        cell(0, 0, 0, 0),
    ];
    let deep = vec![cell(3, 7, 0, 5), cell(1, 0, 1, 1), cell(2, 3, 3, 3)];
    for (i, (scheme, list)) in [(Scheme::Quadtree, flat), (Scheme::Octree, deep)]
        .into_iter()
        .enumerate()
    {
        let tree = cells(scheme, list);
        let to = folder.path().join(i.to_string());
        let content = cell_content(&tree);
        let place = Some(Geodetic::from_degrees(40.0, -75.0, 10.0));
        let with = TilesOptions { place, ..options() };
        let written = tiles::write_implicit(&to, &tree, &content, &with).unwrap();
        let options = tiles::CheckOptions {
            tolerance: 1e-6,
            ..Default::default()
        };
        let report = tiles::check_with(to.join("tileset.json"), &options).unwrap();
        assert_eq!(report.findings, tiles::Findings::default());
        assert_eq!(report.counts.contents as usize, tree.cells.len());
        assert_eq!(
            (report.counts.tiles, report.counts.subtrees),
            (written.tiles, written.subtrees)
        );
        assert_eq!(written.bytes, report.counts.bytes);
    }
    // Content in the wrong cell is refused.
    let tree = cells(Scheme::Quadtree, vec![cell(2, 1, 1, 0)]);
    let mut other = tree.clone();
    other.cells[0].x = 2;
    let content = cell_content(&other);
    let to = folder.path().join("wrong");
    assert!(tiles::write_implicit(&to, &tree, &content, &options()).is_err());
    assert!(!to.exists());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Any set of cells, any subtree height.
    #[test]
    fn any_cells(
        seeds in prop::collection::btree_set((0..6u32, any::<[u32; 3]>()), 1..20),
        subtree_levels in 1..5u32,
        octree in any::<bool>(),
    ) {
        let scheme = if octree { Scheme::Octree } else { Scheme::Quadtree };
        let cell = |(level, [x, y, z]): (u32, [u32; 3])| {
            let low = |c: u32| c & ((1 << level) - 1);
            Cell { level, x: low(x), y: low(y), z: if octree { low(z) } else { 0 } }
        };
        let mut list: Vec<Cell> = seeds.into_iter().map(cell).collect();
        list.sort();
        list.dedup();
        let tree = CellTree { subtree_levels, ..cells(scheme, list) };
        let folder = tempfile::tempdir().unwrap();
        let to = folder.path().join("t");
        let content = cell_content(&tree);
        tiles::write_implicit(&to, &tree, &content, &options()).unwrap();
        let options = tiles::CheckOptions { tolerance: 1e-6, ..Default::default() };
        let report = tiles::check_with(to.join("tileset.json"), &options).unwrap();
        prop_assert_eq!(&report.findings, &tiles::Findings::default());
        prop_assert_eq!(report.counts.contents as usize, tree.cells.len());
    }

    /// Any tree, any place, any kind of volume: nothing to complain about.
    #[test]
    fn any_tree(
        nodes in prop::collection::vec((any::<u32>(), prop::array::uniform3(-1e6..1e6f64), prop::array::uniform3(0.01..50f64), 0.0..100f64), 1..60),
        lat in -80.0..80f64,
        lon in -180.0..180f64,
        volume in prop::sample::select(vec![VolumeKind::Box, VolumeKind::Sphere]),
        tiles_per_file in 2..30usize,
    ) {
        let node = |(i, (seed, min, size, error)): (usize, (u32, [f64; 3], [f64; 3], f64))| TreeNode {
            parent: (i > 0).then(|| seed % i.max(1) as u32),
            min: DVec3::from(min),
            max: DVec3::from(min) + DVec3::from(size),
            error,
            refine: if seed % 2 == 0 { Refine::Add } else { Refine::Replace },
        };
        let tree = TileTree { nodes: nodes.into_iter().enumerate().map(node).collect() };
        let folder = tempfile::tempdir().unwrap();
        let to = folder.path().join("t");
        let place = Some(Geodetic::from_degrees(lat, lon, 0.0));
        write(&to, &tree, &TilesOptions { volume, place, tiles_per_file, ..options() });
        let report = tiles::check(to.join("tileset.json")).unwrap();
        prop_assert_eq!(report.findings, tiles::Findings::default());
    }
}

/// Node transforms of the content count, too.
#[test]
fn contents_with_nodes() {
    let folder = tempfile::tempdir().unwrap();
    let to = folder.path().join("t");
    let tree = tree(0, DVec3::ZERO);
    let content = |_: u32, _: DVec3| {
        let mut scene = z_up_cube([-1.0; 3], [1.0; 3]);
        scene.nodes.push(Node {
            transform: Transform::Trs {
                translation: Vec3::new(30.0, 0.0, 0.0),
                rotation: glam::Quat::from_rotation_z(0.3),
                scale: Vec3::new(-2.0, 1.0, 1.0),
            },
            children: vec![0],
            ..Node::default()
        });
        scene.roots = vec![1];
        Ok(Some(TileContent {
            scene,
            features: None,
        }))
    };
    tiles::write(&to, &tree, &content, &options()).unwrap();
    flawless(&to);
}
