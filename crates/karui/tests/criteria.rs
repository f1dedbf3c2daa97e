//! The seven tests of view and light, one by one and in their order.

use karui::geom::{Aabb, Camera, DVec3, Light, Projection, Vec3};
use karui::hierarchy::{Bounds, Criteria, Keep, Silhouette, ViewAndLight};

/// An eye at z = 10 that looks at the origin; one unit there is 50 pixels.
fn nothing() -> ViewAndLight {
    ViewAndLight {
        camera: Camera {
            eye: Vec3::new(0.0, 0.0, 10.0),
            target: Vec3::ZERO,
            up: Vec3::Y,
            projection: Projection::Perspective {
                fov_y: 2.0 * 0.5f32.atan(),
            },
            near: None,
            far: None,
        },
        size: [1000, 500],
        lights: Vec::new(),
        frustum: false,
        back_facing: false,
        silhouette: Silhouette::Ignored,
        area: f64::INFINITY,
        flatness: 0.0,
        light_silhouette: Silhouette::Ignored,
        highlight: 0.0,
        highlight_area: 0.0,
        hysteresis: 1.0,
    }
}

fn node(center: [f64; 3], radius: f64, axis: [f64; 3], angle: f64) -> Bounds {
    let (sine, cosine) = angle.to_radians().sin_cos();
    Bounds {
        center: DVec3::from(center),
        radius,
        axis: DVec3::from(axis).normalize(),
        spread: Some([sine, cosine]),
    }
}

fn keeps(criteria: &ViewAndLight, bounds: Bounds) -> bool {
    let all = Aabb {
        min: Vec3::splat(-20.0),
        max: Vec3::splat(20.0),
    };
    criteria.frame(all).expect("in range").keep(&bounds)
}

fn at_angle(degrees: f64) -> [f64; 3] {
    let (s, c) = degrees.to_radians().sin_cos();
    [s, 0.0, c]
}

fn far(direction: [f64; 3]) -> Light {
    Light::Directional {
        direction: -DVec3::from(direction).as_vec3(),
        color: Vec3::ONE,
        intensity: 1.0,
    }
}

#[test]
fn first_outside_the_picture_is_coarse() {
    let criteria = ViewAndLight {
        frustum: true,
        area: 0.0,
        ..nothing()
    };
    let ball = |x, y, z| keeps(&criteria, node([x, y, z], 0.5, [0.0, 0.0, 1.0], 5.0));
    // Half of the picture is 10 x 5 units at the origin.
    assert!(ball(0.0, 0.0, 0.0) && ball(9.9, 4.9, 0.0) && ball(10.3, 5.3, 0.0));
    assert!(!ball(11.0, 0.0, 0.0) && !ball(0.0, -6.0, 0.0) && !ball(0.0, 0.0, 11.0));
    assert!(ball(0.0, 0.0, -1e6));
    let deep = ViewAndLight {
        camera: Camera {
            near: Some(2.0),
            far: Some(20.0),
            ..criteria.camera
        },
        ..criteria.clone()
    };
    let ball = |z| keeps(&deep, node([0.0, 0.0, z], 0.5, [0.0, 0.0, 1.0], 5.0));
    assert!(!ball(9.0) && ball(8.2) && ball(-10.2) && !ball(-11.0));
    // Even where everything else would keep it.
    let all = ViewAndLight {
        silhouette: Silhouette::Kept { area: 0.0 },
        highlight: 180.0,
        lights: vec![far([0.0, 0.0, 1.0])],
        ..criteria
    };
    assert!(!keeps(
        &all,
        node([30.0, 0.0, 0.0], 0.5, [0.0, 0.0, 1.0], 60.0)
    ));
}

#[test]
fn second_facing_away_is_coarse() {
    let criteria = ViewAndLight {
        back_facing: true,
        area: 0.0,
        ..nothing()
    };
    let turned = |degrees| keeps(&criteria, node([0.0; 3], 1e-6, at_angle(degrees), 10.0));
    assert!(turned(0.0) && turned(89.0) && turned(99.9));
    assert!(!turned(100.1) && !turned(180.0));
    // The sphere as it is seen counts as well: its sine is 0.1, 5.74 degrees.
    let turned = |degrees| keeps(&criteria, node([0.0; 3], 1.0, at_angle(degrees), 10.0));
    assert!(turned(105.6) && !turned(105.8));
    let off = nothing();
    assert!(keeps(
        &ViewAndLight { area: 0.0, ..off },
        node([0.0; 3], 1e-6, at_angle(180.0), 10.0)
    ));
}

#[test]
fn third_a_silhouette_is_kept() {
    let criteria = ViewAndLight {
        silhouette: Silhouette::Kept { area: 0.0 },
        ..nothing()
    };
    let turned = |degrees| keeps(&criteria, node([0.0; 3], 1e-6, at_angle(degrees), 10.0));
    assert!(!turned(79.9) && turned(80.1) && turned(99.9) && !turned(100.1));
    // Down to an area: a sphere of 0.1 units covers 78.5 square pixels.
    for (area, kept) in [(78.0, true), (79.0, false)] {
        let criteria = ViewAndLight {
            silhouette: Silhouette::Kept { area },
            ..nothing()
        };
        assert_eq!(
            keeps(&criteria, node([0.0; 3], 0.1, at_angle(90.0), 10.0)),
            kept
        );
    }
}

#[test]
fn fourth_what_is_small_is_coarse() {
    for (area, kept) in [(78.0, true), (79.0, false)] {
        let criteria = ViewAndLight { area, ..nothing() };
        assert_eq!(
            keeps(&criteria, node([0.0; 3], 0.1, at_angle(0.0), 10.0)),
            kept
        );
        let flat = ViewAndLight {
            camera: criteria.camera.without_perspective(),
            ..criteria
        };
        for z in [0.0, -40.0] {
            assert_eq!(
                keeps(&flat, node([0.0, 0.0, z], 0.1, at_angle(0.0), 10.0)),
                kept
            );
        }
    }
}

#[test]
fn fifth_what_is_flat_is_coarse() {
    let criteria = ViewAndLight {
        area: 0.0,
        flatness: 10.0,
        ..nothing()
    };
    let spread = |angle| keeps(&criteria, node([0.0; 3], 0.1, at_angle(0.0), angle));
    assert!(!spread(9.9) && spread(10.1));
}

#[test]
fn sixth_a_silhouette_of_a_light_is_kept() {
    let criteria = ViewAndLight {
        light_silhouette: Silhouette::Kept { area: 0.0 },
        lights: vec![far([1.0, 0.0, 0.0])],
        ..nothing()
    };
    let turned =
        |criteria: &_, degrees| keeps(criteria, node([0.0; 3], 1e-6, at_angle(degrees), 10.0));
    // The light is at 90 degrees, so what faces the eye is its silhouette.
    for (degrees, kept) in [
        (0.0, true),
        (9.9, true),
        (10.1, false),
        (90.0, false),
        (-9.9, true),
        (-10.1, false),
    ] {
        assert_eq!(turned(&criteria, degrees), kept, "{degrees}");
        let near = Light::Point {
            position: Vec3::X * 1e6,
            color: Vec3::ONE,
            intensity: 1.0,
        };
        let by_point = ViewAndLight {
            lights: vec![near],
            ..criteria.clone()
        };
        assert_eq!(turned(&by_point, degrees), kept, "{degrees}");
    }
    // Any light will do.
    let two = ViewAndLight {
        lights: vec![far([0.0, 0.0, 1.0]), far([1.0, 0.0, 0.0])],
        ..criteria
    };
    assert!(turned(&two, 0.0) && turned(&two, 90.0));
}

#[test]
fn seventh_a_highlight_is_kept() {
    let criteria = ViewAndLight {
        highlight: 20.0,
        lights: vec![far(at_angle(60.0))],
        ..nothing()
    };
    // The eye is at 0, the light at 60, so a mirror would have to be at 30; it may
    // be off by (20 + 2 * 5) / 2.
    for (degrees, kept) in [
        (14.9, false),
        (15.1, true),
        (30.0, true),
        (44.9, true),
        (45.1, false),
    ] {
        assert_eq!(
            keeps(&criteria, node([0.0; 3], 1e-6, at_angle(degrees), 5.0)),
            kept,
            "{degrees}"
        );
    }
    // Down to an area: a sphere of 0.1 units covers 78.5 square pixels.
    for (highlight_area, kept) in [(78.0, true), (79.0, false)] {
        let criteria = ViewAndLight {
            highlight_area,
            ..criteria.clone()
        };
        assert_eq!(
            keeps(&criteria, node([0.0; 3], 0.1, at_angle(30.0), 5.0)),
            kept
        );
    }
    // What faces away from the light has none.
    let low = ViewAndLight {
        lights: vec![far(at_angle(170.0))],
        ..criteria
    };
    assert!(!keeps(&low, node([0.0; 3], 1e-6, at_angle(0.0), 5.0)));
    assert!(keeps(&low, node([0.0; 3], 1e-6, at_angle(85.0), 5.0)));
}

#[test]
fn lights_come_before_area_and_after_what_cannot_be_seen() {
    let lit = |back_facing, area| ViewAndLight {
        back_facing,
        area,
        light_silhouette: Silhouette::Kept { area: 0.0 },
        lights: vec![far([1.0, 0.0, 0.0])],
        ..nothing()
    };
    let front = node([0.0; 3], 1e-6, at_angle(0.0), 5.0);
    let back = node([0.0; 3], 1e-6, at_angle(180.0), 5.0);
    assert!(keeps(&lit(true, f64::INFINITY), front));
    assert!(!keeps(&lit(true, 0.0), back));
    assert!(keeps(&lit(false, f64::INFINITY), back));
}

#[test]
fn an_eye_or_a_light_inside_keeps_all() {
    let inside = node([0.0, 0.0, 9.5], 1.0, at_angle(180.0), 1.0);
    assert!(keeps(
        &ViewAndLight {
            back_facing: true,
            frustum: true,
            ..nothing()
        },
        inside
    ));
    let light = Light::Point {
        position: Vec3::X * 0.1,
        color: Vec3::ONE,
        intensity: 1.0,
    };
    let criteria = ViewAndLight {
        lights: vec![light],
        highlight: 1.0,
        ..nothing()
    };
    assert!(keeps(&criteria, node([0.0; 3], 0.2, at_angle(0.0), 1.0)));
    assert!(!keeps(&criteria, node([0.0; 3], 0.05, at_angle(0.0), 1.0)));
}

#[test]
fn all_directions_are_silhouettes() {
    let any = Bounds {
        spread: None,
        ..node([0.0; 3], 1e-3, at_angle(180.0), 0.0)
    };
    assert!(keeps(
        &ViewAndLight {
            silhouette: Silhouette::Kept { area: 0.0 },
            ..nothing()
        },
        any
    ));
    assert!(!keeps(
        &ViewAndLight {
            back_facing: true,
            area: f64::INFINITY,
            ..nothing()
        },
        any
    ));
}

#[test]
fn what_holds_another_is_kept_with_it() {
    let eyes = [
        nothing().camera,
        Camera {
            eye: Vec3::new(0.3, 0.2, 1.4),
            ..nothing().camera
        },
    ];
    let mut kept = 0;
    for (i, camera) in (0..200_000).zip(eyes.iter().cycle()) {
        let random = |k: u32| (f64::from(i) * 0.618_033_988 * f64::from(k)).fract() - 0.5;
        let inner = node(
            [random(1), random(2), random(3)],
            0.1 * (random(4) + 0.5),
            [random(5), random(6), random(7)],
            30.0 * (random(8) + 0.5),
        );
        let offset = DVec3::new(random(9), random(10), random(11)) * 0.1;
        let tilt = node([0.0; 3], 0.0, (inner.axis + offset).to_array(), 0.0).axis;
        let angle = inner.axis.angle_between(tilt) + inner.spread.unwrap()[0].asin();
        let outer = Bounds {
            center: inner.center + offset,
            radius: inner.radius + offset.length() * (1.0 + 1e-9),
            axis: tilt,
            spread: Some([(angle + 1e-9).sin(), (angle + 1e-9).cos()]),
        };
        let criteria = ViewAndLight {
            camera: *camera,
            frustum: true,
            back_facing: true,
            silhouette: Silhouette::Kept { area: 50.0 },
            area: 500.0,
            flatness: 12.0,
            light_silhouette: Silhouette::Kept { area: 80.0 },
            highlight: 10.0,
            lights: vec![
                far([0.3, 1.0, 0.2]),
                Light::Point {
                    position: Vec3::new(0.5, 0.1, 1.0),
                    color: Vec3::ONE,
                    intensity: 1.0,
                },
            ],
            ..nothing()
        };
        if i % 50 == 0 && keeps(&criteria, inner) {
            kept += 1;
            assert!(keeps(&criteria, outer), "{inner:?} {outer:?}");
        }
    }
    assert!(kept > 300, "{kept}");
}
