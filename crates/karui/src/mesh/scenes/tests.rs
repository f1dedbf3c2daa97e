use super::*;
use crate::error::Error;
use crate::geom::DVec3;
use crate::mesh::Scene;

fn same_twice(make: impl Fn(u64) -> Scene) {
    assert_eq!(make(3), make(3));
    assert_ne!(make(3), make(4));
}

fn trees(count: usize, seed: u64) -> ForestOptions {
    ForestOptions {
        count,
        seed,
        ground: false,
        ..ForestOptions::default()
    }
}

#[test]
fn triangles_are_those_of_table_2() {
    let count = |mesh: crate::mesh::TriMesh| {
        mesh.validate().unwrap();
        mesh.ranges.iter().map(|r| r.count).collect::<Vec<_>>()
    };
    for red in [false, true] {
        assert_eq!(count(tree_model(TreeKind::Broad, red, 5)), [20, 700]);
        assert_eq!(count(tree_lod(TreeKind::Broad, red)), [6, 12]);
        assert_eq!(
            count(tree_model(TreeKind::Conifer, red, 5))
                .iter()
                .sum::<u32>(),
            105
        );
        assert_eq!(
            count(tree_lod(TreeKind::Conifer, red)).iter().sum::<u32>(),
            12
        );
    }
    for kind in [TreeKind::Broad, TreeKind::Conifer] {
        let bounds = tree_model(kind, false, 9).bounds();
        let reach = [bounds.min.x, bounds.max.x, bounds.min.z, bounds.max.z];
        assert!(
            reach.iter().all(|x| x.abs() <= kind.radius() * 1.25),
            "{bounds:?}"
        );
        // A proxy that is much smaller or larger would not be one.
        let simple = tree_lod(kind, false).bounds();
        assert!((simple.diagonal() / bounds.diagonal() - 1.0).abs() < 0.15);
    }
}

#[test]
fn counts_are_exact_and_scenes_valid() {
    for count in [0, 1, 2, 31, 1000, 12_345] {
        let scene = forest(&trees(count, 2)).unwrap();
        scene.validate().unwrap();
        assert_eq!(scene.instance_count(), count);
        let options = CityOptions {
            count,
            ..CityOptions::default()
        };
        let scene = city(&options, &CityParts::built_in()).unwrap();
        scene.validate().unwrap();
        assert_eq!(scene.instance_count(), count);
        assert!(scene.nodes.len() <= 32);
    }
    let with_ground = ForestOptions {
        ground: true,
        ..trees(10, 1)
    };
    assert_eq!(forest(&with_ground).unwrap().instance_count(), 11);
}

#[test]
fn the_seed_decides() {
    same_twice(|seed| forest(&trees(500, seed)).unwrap());
    let parts = CityParts::built_in();
    same_twice(|seed| {
        city(
            &CityOptions {
                seed,
                ..CityOptions::default()
            },
            &parts,
        )
        .unwrap()
    });
    same_twice(kato1998_wide);
}

#[test]
fn trees_do_not_touch_and_stand_on_the_ground() {
    let options = ForestOptions {
        spacing: 5.0,
        ..trees(3000, 8)
    };
    let scene = forest(&options).unwrap();
    let mut at: Vec<DVec3> = Vec::new();
    scene.for_each_instance(|i| at.push(i.world_from_mesh.w_axis.truncate()));
    at.sort_by(|a, b| a.x.total_cmp(&b.x));
    let mut nearest = f64::INFINITY;
    for (i, a) in at.iter().enumerate() {
        for b in at[i + 1..].iter().take_while(|b| b.x - a.x < 5.0) {
            nearest = nearest.min((b.x - a.x).hypot(b.z - a.z));
        }
    }
    assert!(nearest > 4.5 && nearest < 5.0, "{nearest}");
    let bounds = forest(&ForestOptions {
        ground: true,
        ..options
    })
    .unwrap();
    let ground = bounds.meshes.last().unwrap().mesh.bounds();
    let (low, high) = (f64::from(ground.min.y), f64::from(ground.max.y));
    assert!(at.iter().all(|p| p.y >= low && p.y <= high));
    assert!(high - low > 0.5, "flat");
}

#[test]
fn shares_of_red_and_of_kinds() {
    let options = ForestOptions {
        red: 5.0 / 32.0,
        ..trees(20_000, 1)
    };
    let scene = forest(&options).unwrap();
    let share = |name: &str| {
        let mut found = 0;
        scene.for_each_instance(|i| {
            let named = scene.nodes[i.node as usize].name.as_deref().unwrap();
            found += usize::from(named.contains(name));
        });
        found as f64 / 20_000.0
    };
    assert!((share("red") - 5.0 / 32.0).abs() < 0.01);
    assert!((share("conifer") - 0.5).abs() < 0.02);
    let shown = scene.nodes.iter().filter(|n| n.lods.is_some()).count();
    assert_eq!((shown, scene.roots.len()), (16, 16));
}

#[test]
fn a_larger_city_is_the_same_and_more() {
    let parts = CityParts::built_in();
    let of = |count| {
        let scene = city(
            &CityOptions {
                count,
                ..CityOptions::default()
            },
            &parts,
        )
        .unwrap();
        let mut found = Vec::new();
        scene.for_each_instance(|i| found.push((i.mesh, i.world_from_mesh.to_cols_array())));
        found
    };
    let (small, large) = (of(500), of(2000));
    assert!(small.iter().all(|object| large.contains(object)));
}

#[test]
fn tiles_lie_side_by_side() {
    let options = CityOptions {
        count: 3000,
        ..CityOptions::default()
    };
    let parts = CityParts::built_in();
    let scene = city(&options, &parts).unwrap();
    let tiles = [
        CityRole::Building,
        CityRole::Plot,
        CityRole::Road,
        CityRole::Junction,
    ];
    let mut at = Vec::new();
    scene.for_each_instance(|i| {
        if tiles.contains(&parts.roles[i.mesh as usize]) {
            let place = i.world_from_mesh.w_axis / 2.0;
            at.push((place.x as i64, place.z as i64));
            assert_eq!((place.x.fract(), place.z.fract()), (0.0, 0.0));
        }
    });
    let tiles = at.len();
    at.sort_unstable();
    at.dedup();
    assert_eq!(at.len(), tiles);
}

#[test]
fn the_scenes_of_the_paper() {
    for mixed in [false, true] {
        let scene = kato1998_32_trees(mixed);
        scene.validate().unwrap();
        let (mut triangles, mut red) = (0, 0);
        scene.for_each_instance(|i| {
            let mesh = &scene.meshes[i.mesh as usize].mesh;
            triangles += mesh.triangles.len();
            red += usize::from(mesh.ranges.iter().any(|r| r.material == Some(trees::RED)));
        });
        assert_eq!((scene.instance_count(), triangles), (32, 3360));
        assert_eq!(red, if mixed { 5 } else { 0 });
        for node in scene.nodes.iter().filter_map(|n| n.lods.as_ref()) {
            let simple = scene.nodes[node.nodes[0] as usize].mesh.unwrap();
            assert_eq!(scene.meshes[simple as usize].mesh.triangles.len(), 12);
        }
    }
    let wide = kato1998_wide(1);
    wide.validate().unwrap();
    assert_eq!(wide.instance_count(), 2 * 24 + 400);
    assert_eq!(wide.unfolded()[1], 24 * 720 + 400 * 105);
}

#[test]
fn parts_share_what_is_the_same() {
    let mut parts = CityParts::default();
    let tree = |red| {
        let mut scene = Scene::from_mesh(tree_model(TreeKind::Conifer, red, 1));
        scene.materials = trees::materials();
        scene
    };
    parts.add("a", CityRole::Plot, tree(false)).unwrap();
    parts.add("b", CityRole::Bush, tree(true)).unwrap();
    assert_eq!(parts.scene.materials, trees::materials());
    assert_eq!(
        parts.scene.meshes[1].mesh,
        tree_model(TreeKind::Conifer, true, 1)
    );
    assert!(city(&CityOptions::default(), &parts).is_ok());
    assert_eq!(CityRole::of_name("building_A"), Some(CityRole::Building));
    assert_eq!(CityRole::of_name("building_A_withoutBase"), None);
}

#[test]
fn nonsense_is_refused() {
    let bad = [
        ForestOptions {
            kinds: vec![],
            ..trees(1, 1)
        },
        ForestOptions {
            variants: 0,
            ..trees(1, 1)
        },
        ForestOptions {
            red: f32::NAN,
            ..trees(1, 1)
        },
        ForestOptions {
            spacing: 0.0,
            ..trees(1, 1)
        },
        ForestOptions {
            spacing: f32::INFINITY,
            ..trees(1, 1)
        },
        ForestOptions {
            count: 1 << 32,
            ..trees(1, 1)
        },
    ];
    for options in bad {
        let error = forest(&options).unwrap_err();
        assert!(matches!(error, Error::BadOption { .. }), "{error}");
    }
    let parts = CityParts::built_in();
    let bad = [
        CityOptions {
            block: 0,
            ..CityOptions::default()
        },
        CityOptions {
            traffic: -1.0,
            ..CityOptions::default()
        },
        CityOptions {
            count: 1 << 32,
            ..CityOptions::default()
        },
    ];
    for options in bad {
        assert!(matches!(
            city(&options, &parts),
            Err(Error::BadOption { .. })
        ));
    }
    let nothing = city(&CityOptions::default(), &CityParts::default());
    assert!(matches!(nothing, Err(Error::Empty { .. })));
}
