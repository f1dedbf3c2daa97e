//! Tiles of small scenes against what they have to be.

use super::*;
use crate::hlod::proxy::{ChooseOptions, FEATURE_ID};
use crate::mesh::AttributeValues;
use crate::mesh::scenes::{ForestOptions, forest};
use std::collections::BTreeSet;

fn trees(count: usize) -> Scene {
    forest(&ForestOptions {
        count,
        ..ForestOptions::default()
    })
    .unwrap()
}

fn built(scene: &Scene, triangles: usize) -> Hlod<'_> {
    let options = HlodOptions {
        triangles,
        stand_in: triangles / 2,
        choose: ChooseOptions {
            pixels: 32,
            views: 2,
            errors: &[1.0],
            ..ChooseOptions::default()
        },
        ..HlodOptions::default()
    };
    Hlod::build(scene, &[], &options).unwrap()
}

#[test]
fn every_object_is_drawn_once_as_it_is() {
    let scene = trees(120);
    let hlod = built(&scene, 8_000);
    let mut drawn: Vec<u32> = Vec::new();
    for tile in hlod.tiles() {
        if let TileContent::Objects(objects) = &tile.content {
            drawn.extend(objects);
            assert_eq!(tile.error, 0.0);
            // The ground has more by itself.
            assert!(tile.triangles <= 8_000 || objects.len() == 1);
        }
    }
    drawn.sort_unstable();
    assert_eq!(drawn, (0..hlod.object_count() as u32).collect::<Vec<_>>());
    assert_eq!(hlod.object_count(), scene.instance_count());
}

#[test]
fn errors_and_boxes_hold_those_below_and_triangles_become_fewer() {
    let scene = trees(250);
    let hlod = built(&scene, 6_000);
    let tiles = hlod.tiles();
    assert!(tiles.len() > 20);
    assert!(
        tiles
            .iter()
            .any(|t| matches!(t.content, TileContent::Proxy(_)))
    );
    let mut below = vec![0; tiles.len()];
    for (t, tile) in tiles.iter().enumerate() {
        let Some(parent) = tile.parent else {
            assert_eq!(t, 0);
            continue;
        };
        let parent = parent as usize;
        assert!(parent < t);
        below[parent] += tile.triangles;
        assert!(tiles[parent].error >= tile.error);
        assert!(tiles[parent].refine >= tile.refine);
        assert!(tile.refine >= tile.error);
        if matches!(tile.content, TileContent::Proxy(_)) {
            // It was looked at with 256 pixels, where clients allow errors of 16.
            assert!(tile.refine >= tile.bounds.diagonal() * (16.0 / 256.0));
        }
        assert!(tiles[parent].bounds.contains(&tile.bounds));
    }
    for (tile, below) in tiles.iter().zip(below) {
        if !matches!(tile.content, TileContent::Objects(_) | TileContent::Nothing) {
            assert!(2 * tile.triangles <= below, "{} {below}", tile.triangles);
        }
    }
}

#[test]
fn contents_are_scenes_that_know_their_objects() {
    let scene = trees(100);
    let hlod = built(&scene, 5_000);
    for (t, tile) in (0u32..).zip(hlod.tiles()) {
        let origin = tile.bounds.center();
        let Some(content) = hlod.content(t, origin) else {
            continue;
        };
        content.validate().unwrap();
        let bounds = content.bounds();
        let grown = tile.bounds.diagonal() * 0.1 + tile.error;
        let size = 0.5 * tile.bounds.size() + grown;
        assert!(bounds.max.as_dvec3().cmple(size).all());
        assert!(bounds.min.as_dvec3().cmpge(-size).all());
        if let TileContent::Objects(objects) = &tile.content {
            let placements = content.nodes.iter().filter_map(|n| n.placements.as_ref());
            let ids = placements.flat_map(|p| match &p.attributes[0].values {
                AttributeValues::U32(ids) if p.attributes[0].name == FEATURE_ID => ids.clone(),
                other => panic!("{other:?}"),
            });
            let expected: BTreeSet<u32> = objects.iter().copied().collect();
            assert_eq!(ids.collect::<BTreeSet<u32>>(), expected);
        }
    }
}

#[test]
fn the_same_for_any_number_of_threads() {
    let scene = trees(60);
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let made = pool.build().unwrap().install(|| built(&scene, 4_000));
        let contents = (0..made.tiles().len() as u32).map(|t| made.content(t, glam::DVec3::ZERO));
        contents.collect::<Vec<_>>()
    };
    let one = with(1);
    assert_eq!(one, with(2));
    assert_eq!(one, with(8));
}

#[test]
fn a_scene_of_nothing_is_an_error_and_one_object_one_tile() {
    let empty = Scene::default();
    assert!(Hlod::build(&empty, &[], &HlodOptions::default()).is_err());
    let mut cube = crate::mesh::shapes::cube(1);
    cube.triangles.truncate(1);
    let scene = Scene::from_mesh(cube);
    let hlod = built(&scene, 100);
    assert_eq!(hlod.tiles().len(), 1);
    assert!(matches!(&hlod.tiles()[0].content, TileContent::Objects(o) if o == &[0]));
}
