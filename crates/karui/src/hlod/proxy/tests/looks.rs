//! What stand-ins look like.

use super::*;

#[test]
fn baked_colours_are_those_of_the_members() {
    let textured = Textured::new(vec![checks(64), checks(128)]);
    let look = textured.look();
    let blocks = [
        of_material(shapes::cube(4), 0),
        of_material(shapes::cube(4), 1),
    ];
    let members = [
        member(&blocks[0], at(0.0, 0.0, 0.0), &look, 0),
        member(&blocks[1], at(2.0, 0.0, 0.0), &look, 1),
    ];
    let group = Group::new(&members).unwrap();
    let options = MergedOptions {
        stop: Stop::error(1e-3),
        materials: 0,
        ..MergedOptions::default()
    };
    let proxy = merged(&group, &options).unwrap().unwrap();
    proxy.scene.validate().unwrap();
    assert_eq!(proxy.triangles(), 24);
    assert!(proxy.error < 1e-6 && !proxy.coarser, "{}", proxy.error);
    assert_eq!(proxy.scene.images.len(), 1);
    let uvs = &proxy.mesh().attributes.uvs[0];
    assert!(
        uvs.iter()
            .all(|uv| uv.min_element() >= 0.0 && uv.max_element() <= 1.0)
    );
    let flip = flip_at(&group, &proxy, 200.0);
    assert!(flip < 0.03, "{flip}");
}

#[test]
fn baked_textures_hold_nothing_finer_than_their_texels() {
    // Fields of one texel, of which the texture has room for every eighth.
    let textured = Textured::new(vec![checks(1)]);
    let look = textured.look();
    let block = of_material(shapes::cube(4), 0);
    let members = [member(&block, at(0.0, 0.0, 0.0), &look, 0)];
    let group = Group::new(&members).unwrap();
    let options = MergedOptions {
        pixels: 48,
        ..MergedOptions::default()
    };
    let proxy = merged(&group, &options).unwrap().unwrap();
    let picture = proxy.pictures()[0].clone().unwrap();
    assert!(picture.width() <= 128 && picture.height() <= 128);
    // Half of the light, everywhere.
    let grey = |p: &[u8; 4]| p[..3].iter().all(|c| c.abs_diff(188) < 4);
    assert!(picture.pixels().iter().all(grey));
}

#[test]
fn textures_that_are_too_large_are_made_coarser_and_say_so() {
    let textured = Textured::new(vec![checks(64), checks(32)]);
    let look = textured.look();
    let ball = of_material(shapes::textured_sphere(24, 48), 0);
    let block = of_material(shapes::cube(4), 1);
    let mut members = vec![member(&ball, at(0.0, 0.0, 0.0), &look, 0)];
    members.extend((1..30).map(|i| member(&block, at(2.0 * f64::from(i), 0.0, 0.0), &look, i)));
    let group = Group::new(&members).unwrap();
    let baked = |pixels, side| {
        let options = MergedOptions {
            materials: 0,
            pixels,
            side,
            ..MergedOptions::default()
        };
        let proxy = merged(&group, &options).unwrap().unwrap();
        proxy.scene.validate().unwrap();
        let picture = proxy.pictures().into_iter().flatten().next();
        assert!(picture.is_none_or(|p| p.width().max(p.height()) <= side));
        (proxy.coarser, proxy.scene.images.len())
    };
    assert_eq!(baked(64, 1024), (false, 1));
    assert_eq!(baked(u32::MAX, 256), (true, 1));
    // No room even for one texel a chart: the vertices are coloured.
    assert_eq!(baked(64, 32), (true, 0));
}

#[test]
fn colours_without_detail_go_onto_the_vertices() {
    let materials: Vec<Material> = (0..8)
        .map(|i| colored(RED.lerp(BLUE, i as f32 / 7.0)))
        .collect();
    let look = Look::new(&materials, &[], &[]);
    let balls: Vec<TriMesh> = (0..8)
        .map(|i| of_material(shapes::icosphere(3), i))
        .collect();
    let members: Vec<Member> = (0..8)
        .map(|i| {
            member(
                &balls[i as usize],
                at(f64::from(i) * 2.5, 0.0, 0.0),
                &look,
                i,
            )
        })
        .collect();
    let group = Group::new(&members).unwrap();
    let proxy = merged(&group, &MergedOptions::default()).unwrap().unwrap();
    assert_eq!(
        (proxy.scene.materials.len(), proxy.scene.images.len()),
        (1, 0)
    );
    let (colors, ids) = (
        &proxy.mesh().attributes.colors[0],
        ids_of(&proxy.mesh().attributes).unwrap(),
    );
    for (color, &id) in colors.iter().zip(ids) {
        let expected = materials[id as usize].base_color;
        assert!((*color - expected).abs().max_element() < 1e-5);
    }
    let options = MergedOptions {
        materials: 8,
        ..MergedOptions::default()
    };
    let kept = merged(&group, &options).unwrap().unwrap();
    assert_eq!(kept.scene.materials[3].base_color, materials[3].base_color);
    assert_eq!(kept.scene.materials.len(), 8);
}

#[test]
fn textures_without_uvs_are_done_without() {
    let textured = Textured::new(vec![checks(64)]);
    let look = textured.look();
    let bare = of_material(shapes::icosphere(3), 0);
    let with = of_material(shapes::textured_sphere(24, 48), 0);
    let members = [
        member(&bare, at(0.0, 0.0, 0.0), &look, 0),
        member(&with, at(3.0, 0.0, 0.0), &look, 1),
    ];
    let group = Group::new(&members).unwrap();
    assert_eq!(group.slots.len(), 2);
    for proxy in all(&group) {
        proxy.scene.validate().unwrap();
        let flip = flip_at(&group, &proxy, 24.0);
        // A box is no ball.
        let most = match proxy.kind {
            ProxyKind::Box => 0.8,
            ProxyKind::Impostor => 0.5,
            ProxyKind::Merged => 0.25,
        };
        assert!(flip < most, "{:?} {flip}", proxy.kind);
    }
}

#[test]
fn cards_are_off_by_the_depth_they_flatten() {
    let materials = [colored(RED)];
    let look = Look::new(&materials, &[], &[]);
    let ball = of_material(shapes::icosphere(4), 0);
    let group = Group::new(&[member(&ball, at(9.0, 0.0, 0.0), &look, 5)]).unwrap();
    let options = ImpostorOptions {
        cards: 3,
        ..ImpostorOptions::default()
    };
    let proxy = impostor(&group, &options).unwrap().unwrap();
    let texel = group.bounds().diagonal() / 128.0;
    assert!(
        proxy.error > 0.99 && proxy.error < 1.01 + texel,
        "{}",
        proxy.error
    );
    assert_eq!(
        (proxy.triangles(), objects(proxy.mesh())),
        (16, vec![5; 16])
    );
    // Eight discs, one colour everywhere.
    let pictures: Vec<Picture> = proxy.pictures().into_iter().flatten().collect();
    let covered: f64 = pictures[0]
        .pixels()
        .iter()
        .map(|p| f64::from(p[3]) / 255.0)
        .sum();
    let expected = 8.0 * std::f64::consts::PI / (texel * texel);
    assert!(
        (covered / expected - 1.0).abs() < 0.01,
        "{covered} {expected}"
    );
    assert!(pictures[0].pixels().iter().all(|p| p[..3] == [255, 0, 0]));
    // In the middle of a disc the normal points at the viewer.
    let uvs = &proxy.mesh().attributes.uvs[0];
    let middle = (uvs[0] + uvs[2]) * 0.5;
    let size = [pictures[1].width() as f32, pictures[1].height() as f32];
    let normal = pictures[1].get((middle.x * size[0]) as u32, (middle.y * size[1]) as u32);
    let normal = normal.unwrap();
    assert!(normal[0].abs_diff(128) < 6 && normal[1].abs_diff(128) < 6 && normal[2] > 250);
}

#[test]
fn a_card_shows_a_board_as_it_is() {
    let textured = Textured::new(vec![checks(64)]);
    let look = textured.look();
    let board = of_material(shapes::cube(4), 0);
    let thin = DMat4::from_scale(DVec3::new(2.0, 1.0, 1e-3));
    let group = Group::new(&[member(&board, thin, &look, 0)]).unwrap();
    let options = ImpostorOptions {
        cards: 1,
        top: false,
        pixels: 256,
        ..ImpostorOptions::default()
    };
    let proxy = impostor(&group, &options).unwrap().unwrap();
    assert_eq!(proxy.triangles(), 4);
    assert!(proxy.error < 0.01, "{}", proxy.error);
    let flip = flip_at(&group, &proxy, 100.0);
    assert!(flip < 0.1, "{flip}");
}

#[test]
fn the_cheapest_that_looks_alike_is_chosen() {
    let look = Look::default();
    let (block, ball) = (shapes::cube(8), shapes::icosphere(4));
    let chosen = |mesh: &TriMesh, options: &ChooseOptions<'_>| {
        let group = Group::new(&[member(mesh, DMat4::IDENTITY, &look, 0)]).unwrap();
        choose(&group, options).unwrap()
    };
    let plain = ChooseOptions::default();
    // Of a cube the box is all there is.
    let choice = chosen(&block, &plain);
    assert_eq!(choice.proxy.as_ref().map(|p| p.kind), Some(ProxyKind::Box));
    assert!(choice.within && choice.candidates.len() == 1);
    let choice = chosen(&ball, &plain);
    assert!(
        choice.within && choice.proxy.as_ref().unwrap().kind != ProxyKind::Box,
        "{choice:?}"
    );
    // The one chosen is the first that is good enough, and the last that was made.
    let (last, before) = choice.candidates.split_last().unwrap();
    assert_eq!(Some(last.kind), choice.proxy.as_ref().map(|p| p.kind));
    assert!(last.image_error.unwrap() <= 0.15);
    assert!(before.iter().all(|c| c.image_error.unwrap() > 0.15));
    assert!(choice.candidates.is_sorted_by_key(|c| c.kind));
    // A bound that only the box keeps to, and one that nothing does.
    let few = ChooseOptions {
        triangles: Some(12),
        cards: None,
        merged: None,
        ..plain
    };
    let choice = chosen(&ball, &few);
    assert!(!choice.within && choice.proxy.unwrap().kind == ProxyKind::Box);
    let none = ChooseOptions {
        bytes: Some(10),
        ..plain
    };
    assert_eq!(chosen(&ball, &none).proxy, None);
    // What must not differ at all is never within.
    let strict = ChooseOptions {
        tolerance: 0.0,
        ..plain
    };
    let choice = chosen(&ball, &strict);
    let least = choice
        .candidates
        .iter()
        .filter_map(|c| c.image_error)
        .fold(1.0, f64::min);
    assert_eq!(choice.proxy.unwrap().image_error, Some(least));
    assert!(!choice.within);
    let empty = Group::new(&[]).unwrap();
    assert_eq!(choose(&empty, &plain).unwrap(), Choice::default());
    for bad in [
        ChooseOptions {
            tolerance: 2.0,
            ..plain
        },
        ChooseOptions { pixels: 0, ..plain },
        ChooseOptions { views: 0, ..plain },
        ChooseOptions {
            error: f64::NAN,
            ..plain
        },
        ChooseOptions {
            errors: &[-1.0],
            ..plain
        },
    ] {
        assert!(choose(&empty, &bad).is_err());
    }
}

#[test]
fn what_is_too_far_off_is_not_chosen_unless_there_is_nothing_else() {
    let (ball, look) = (shapes::icosphere(4), Look::default());
    let group = Group::new(&[member(&ball, DMat4::IDENTITY, &look, 0)]).unwrap();
    let plain = ChooseOptions {
        tolerance: 1.0,
        ..ChooseOptions::default()
    };
    // However it looks, the box is off by the corners it adds, 13.5 of 64 pixels.
    let pixel = group.bounds().diagonal() / 64.0;
    let with = |error| choose(&group, &ChooseOptions { error, ..plain }).unwrap();
    let choice = with(14.0);
    assert_eq!(choice.proxy.map(|p| p.kind), Some(ProxyKind::Box));
    let choice = with(13.0);
    assert!(choice.within && choice.candidates.len() == 1, "{choice:?}");
    let proxy = choice.proxy.unwrap();
    assert_eq!(proxy.kind, ProxyKind::Merged);
    assert!(proxy.error <= 13.0 * pixel);
    // Nothing keeps to it: the least of what was made, which nobody looked at.
    let choice = with(0.0);
    let least = choice
        .candidates
        .iter()
        .map(|c| c.error)
        .fold(9.0, f64::min);
    let proxy = choice.proxy.unwrap();
    assert!(!choice.within && proxy.image_error.is_none());
    assert_eq!((proxy.error, proxy.kind), (least, ProxyKind::Merged));
    let rough = ChooseOptions {
        error: 0.0,
        merged: None,
        ..plain
    };
    let choice = choose(&group, &rough).unwrap();
    assert_eq!(choice.proxy.map(|p| p.kind), Some(ProxyKind::Box));
}
