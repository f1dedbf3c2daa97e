//! The experiments of Kato, Kanoh and Nishihara 1998, chapter 4.

use super::chart::{Curve, svg};
use super::crowd::Crowd;
use super::stage::{Stage, StandIns, camera, original};
use crate::commands::bench::page::machine;
use crate::output::Staged;
use crate::sheet::Layout;
use crate::table::{count, table};
use anyhow::Result;
use karui::geom::Vec3;
use karui::hlod::proxy::Look;
use karui::hlod::{Item, OmegaOptions, Thresholds, Tree, TreeOptions, View};
use karui::mesh::scenes::{kato1998_32_trees, kato1998_wide};
use karui::metrics::image::{PIXELS_PER_DEGREE, flip};
use karui::render::Picture;
use serde::Serialize;
use serde_json::{Value, json};

/// The paper's scene units in one metre, taken to be centimetres: it does not tell.
const UNITS: f64 = 100.0;
/// How far the stand is from the eye, metres.
const DISTANCES: [f32; 2] = [300.0, 1000.0];
/// Values of Omega_t by thousandths in the curve, and which of them the table has.
const STEPS: u32 = 100;
const ROWS: [u32; 14] = [0, 2, 4, 6, 8, 10, 15, 20, 25, 30, 40, 60, 80, 100];
/// Values of Omega_t for the wide scene; at 0 nothing is grouped.
const WIDE: [f64; 6] = [0.0, 0.03, 0.06, 0.08, 0.1, 0.15];
/// Of which there is a picture.
const SHOWN: f64 = 0.1;
/// Width and height of the pictures.
const SIZE: [u32; 2] = [640, 360];

/// The paper's weights in metres; thresholds go on where the paper's end, so that
/// stands that are less dense than its own come together at all.
fn options() -> TreeOptions<'static> {
    let kato = OmegaOptions::kato1998();
    TreeOptions {
        omega: OmegaOptions {
            shape: kato.shape / UNITS,
            color: kato.color / UNITS,
            distance: kato.distance / UNITS,
            ..kato
        },
        thresholds: Thresholds::Arithmetic {
            first: 0.001,
            last: 2.0,
            step: 0.001,
        },
        ..TreeOptions::kato1998()
    }
}

/// A frame of the wide scene.
#[derive(Debug, Serialize)]
struct Frame {
    threshold: f64,
    objects: usize,
    groups: usize,
    triangles: u64,
    flip: f64,
}

/// What is found of the 32 trees.
#[derive(Debug, Serialize)]
struct Stand {
    mixed: bool,
    /// From the eye to the first row, metres.
    distance: f32,
    /// Least and greatest Omega0 of a group.
    omega0: [f64; 2],
    /// Groups that have both red and green trees, of all.
    mixing: [usize; 2],
    /// By thousandths of Omega_t.
    triangles: Vec<u64>,
}

/// Runs both experiments; as Markdown and rows.
pub fn run(pictures: Option<&Staged>) -> Result<(String, Value)> {
    let mut stands = Vec::new();
    for distance in DISTANCES {
        for mixed in [false, true] {
            stands.push(stand(mixed, distance)?);
        }
    }
    let (wide, sheet) = wide()?;
    if let Some(staged) = pictures {
        staged.bytes("hlod-curve.svg", curves(&stands).as_bytes())?;
        staged.bytes("hlod-wide.png", &karui_io::encode_png(&sheet)?)?;
    }
    let text = markdown(&stands, &wide);
    Ok((text, json!({ "stands": stands, "wide": wide })))
}

fn stand(mixed: bool, distance: f32) -> Result<Stand> {
    let crowd = Crowd::new(kato1998_32_trees(mixed), Vec::new(), "", false)?;
    let tree = Tree::build(crowd.objects.clone(), &options())?;
    let look = Look::of_scene(&crowd.scene, &crowd.images);
    let mut stage = Stage::new(&crowd, &tree, &look, StandIns::Boxes);
    let eye = Vec3::new(0.0, 0.1 * distance, distance);
    let camera = camera(eye, Vec3::new(0.0, 3.0, -28.0));
    let mut triangles = Vec::new();
    for step in 0..=STEPS {
        let list = stage.list(&View {
            threshold: f64::from(step) * 1e-3,
            ..View::new(camera)
        })?;
        triangles.push(list.counts.triangles);
    }
    let groups = tree.bottom_up();
    let groups: Vec<_> = groups.iter().filter_map(|&id| tree.group(id)).collect();
    let omegas = || groups.iter().map(|g| g.omega0());
    let is_red = |id: u32| crowd.objects[id as usize].color.x > crowd.objects[id as usize].color.y;
    let mixing = groups.iter().filter(|group| {
        let reds = group.objects().filter(|&o| is_red(o)).count();
        reds > 0 && reds < group.object_count()
    });
    Ok(Stand {
        mixed,
        distance,
        omega0: [
            omegas().fold(f64::INFINITY, f64::min),
            omegas().fold(0.0, f64::max),
        ],
        mixing: [mixing.count(), groups.len()],
        triangles,
    })
}

/// The wide scene at all thresholds, and pictures side by side.
fn wide() -> Result<(Vec<Frame>, Picture)> {
    let crowd = Crowd::new(kato1998_wide(1), Vec::new(), "", false)?;
    let tree = Tree::build(crowd.objects.clone(), &options())?;
    let look = Look::of_scene(&crowd.scene, &crowd.images);
    let mut stage = Stage::new(&crowd, &tree, &look, StandIns::Boxes);
    let camera = camera(Vec3::new(0.0, 2.0, 20.0), Vec3::new(0.0, 2.0, 0.0));
    let (mut frames, mut tiles) = (Vec::new(), Vec::new());
    let mut full = Picture::default();
    for threshold in WIDE {
        let list = stage.list(&View {
            threshold,
            ..View::new(camera)
        })?;
        if threshold == 0.0 {
            full = original(&crowd, &list, &camera, SIZE)?;
            tiles.push((
                full.clone(),
                format!("original, {} triangles", of_all(&crowd, &list.items)),
            ));
        }
        let picture = stage.picture(&list, &camera, SIZE)?;
        let flip = flip(&full, &picture, PIXELS_PER_DEGREE)?.mean;
        let frame = Frame {
            threshold,
            objects: list.counts.objects,
            groups: list.counts.groups,
            triangles: list.counts.triangles,
            flip,
        };
        if threshold == 0.0 || threshold == SHOWN {
            tiles.push((picture, caption(&frame)));
        }
        frames.push(frame);
    }
    let sheet = Layout::new(tiles.len(), (SIZE[0], SIZE[1])).draw(&tiles, [255; 4]);
    Ok((frames, sheet))
}

fn of_all(crowd: &Crowd, items: &[Item]) -> String {
    let triangles = |item: &Item| match *item {
        Item::Object { object, .. } => crowd.mesh(crowd.mesh_at(object, 0)).triangles.len(),
        Item::Group(_) => 0,
    };
    count(items.iter().map(triangles).sum())
}

fn caption(frame: &Frame) -> String {
    let what = match frame.groups {
        0 => "LOD only",
        _ => "LOD and groups",
    };
    let triangles = count(frame.triangles as usize);
    format!("{what}, {triangles} triangles, FLIP {:.3}", frame.flip)
}

fn curves(stands: &[Stand]) -> String {
    let colors = ["#1a7f37", "#c0392b", "#7fbf8f", "#e59a92"];
    let curve = |(stand, color): (&Stand, &'static str)| Curve {
        name: name(stand),
        color,
        points: (0u32..)
            .zip(&stand.triangles)
            .map(|(step, &n)| [f64::from(step) * 1e-3, n as f64])
            .collect(),
    };
    let curves: Vec<Curve> = stands.iter().zip(colors).map(curve).collect();
    svg(&curves, ["Omega_t", "triangles drawn"])
}

fn name(stand: &Stand) -> String {
    let kind = if stand.mixed { "mixed" } else { "one colour" };
    format!("{kind}, {} m", stand.distance)
}

fn markdown(stands: &[Stand], wide: &[Frame]) -> String {
    let names: Vec<String> = stands.iter().map(name).collect();
    let mut header = vec!["Omega_t"];
    header.extend(names.iter().map(String::as_str));
    let row = |&step: &u32| {
        let mut row = vec![format!("{:.3}", f64::from(step) * 1e-3)];
        row.extend(
            stands
                .iter()
                .map(|s| s.triangles[step as usize].to_string()),
        );
        row
    };
    let curve: Vec<Vec<String>> = ROWS.iter().map(row).collect();
    let facts = stands.iter().take(2).map(|s| {
        let [least, most] = s.omega0;
        let [mixing, groups] = s.mixing;
        format!(
            "- {}: {groups} groups, Omega0 from {least:.3} to {most:.3}; {mixing} hold trees of both colours.\n",
            if s.mixed { "mixed" } else { "one colour" }
        )
    });
    let frame = |f: &Frame| {
        vec![
            format!("{:.2}", f.threshold),
            count(f.objects),
            count(f.groups),
            count(f.triangles as usize),
            format!("{:.4}", f.flip),
        ]
    };
    let frames: Vec<Vec<String>> = wide.iter().map(frame).collect();
    format!(
        "{HEAD}\n{}\n\n{}\n\n{}\n{WIDE_HEAD}\n{}\n",
        machine(),
        table(&header, &curve, true),
        facts.collect::<String>(),
        table(
            &["Omega_t", "objects", "groups", "triangles", "FLIP"],
            &frames,
            true
        )
    )
}

const HEAD: &str = "\
## Experiments of Kato, Kanoh and Nishihara

Written by `karui bench hlod --paper --pictures docs/pictures -o FILE`: the weights of the paper,
its unit taken to be a centimetre. Triangles drawn of 32 trees of 105 triangles (12
each in their simplified form, which all have at these distances, 12 for the box of a group), seen
from so far in front of the first row; 5 of the mixed trees are red. The paper tells neither where
its trees stand nor how far the eye is. Its thresholds end at 0.1; here they go on, as the trees of
our stand are farther apart than that allows.

![Triangles drawn against Omega_t](pictures/hlod-curve.svg)
";

const WIDE_HEAD: &str = "
The wide scene: 24 trees of 720 triangles near the eye, 400 of 105 far behind, 640 x 360 pixels;
at Omega_t = 0 objects have their levels and nothing is grouped. Groups are drawn as the paper does,
as blended boxes. FLIP: mean, against all objects at full detail.

![Original, levels only, levels and groups](pictures/hlod-wide.png)
";
