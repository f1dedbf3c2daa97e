//! Groups by perception against groups by place, at equal numbers of triangles.

use super::coarser::Curve;
use super::crowd::Crowd;
use super::nestings::{clusters, nested, octants};
use super::stage::{Stage, StandIns, camera, original};
use crate::commands::bench::page::machine;
use crate::commands::scene::city::read_parts;
use crate::console::{Console, to_stderr};
use crate::input::{self, Input};
use crate::output::Staged;
use crate::progress::check_cancelled;
use crate::sheet::Layout;
use crate::table::{count, percent, table};
use crate::textures;
use anyhow::Result;
use karui::geom::{Camera, Vec3};
use karui::hlod::proxy::Look;
use karui::hlod::{DrawList, Nest, OmegaOptions, Tree, TreeOptions, View};
use karui::mesh::Scene;
use karui::mesh::scenes::{CityOptions, ForestOptions, city, forest};
use karui::metrics::image::{PIXELS_PER_DEGREE, flip};
use karui::render::Picture;
use serde::Serialize;
use serde_json::Value;
use std::path::Path;

/// Width and height of the pictures.
pub const SIZE: [u32; 2] = [640, 360];
/// Triangles allowed, as shares of those that are drawn without groups.
const SHARES: [f64; 2] = [0.5, 0.2];

/// What is compared.
pub struct Plan<'a> {
    /// Folder of models.
    pub models: &'a Path,
    /// Objects of forest and city.
    pub objects: usize,
    /// Pictures a scene.
    pub views: u32,
    pub pictures: Option<&'a Staged>,
}

#[derive(Debug, Serialize)]
struct Row {
    scene: String,
    objects: usize,
    stand_ins: &'static str,
    grouping: &'static str,
    /// One for each share that was allowed.
    means: Vec<Mean>,
}

/// What is found with a number of triangles; means over the views.
#[derive(Debug, Default, Serialize)]
struct Mean {
    flip: f64,
    triangles: f64,
    items: f64,
    /// Triangles with which levels alone look as well.
    levels_alone: f64,
    /// Views in which the limit could not be kept.
    beyond: usize,
}

/// A scene, and how near the eye goes: shares of half of its diagonal.
struct Subject {
    name: &'static str,
    crowd: Crowd,
    reach: [f32; 2],
}

/// A view, how it should look, and what is drawn of it without groups.
pub struct Shot {
    pub camera: Camera,
    pub original: Picture,
    triangles: u64,
}

/// A way to group.
struct Grouping {
    name: &'static str,
    tree: Tree,
}

/// Compares all groupings on all scenes that are there; as Markdown and rows.
pub fn run(plan: &Plan<'_>, console: &Console) -> Result<(String, Value)> {
    let mut rows = Vec::new();
    let mut missing = Vec::new();
    for name in ["forest", "city", "engine"] {
        let subject = match name {
            "forest" => Some(forest_of(plan.objects)?),
            "city" => city_of(plan, console)?,
            _ => engine(plan.models, console)?,
        };
        match subject {
            Some(subject) => compare(&subject, plan, console, &mut rows)?,
            None => missing.push(name),
        }
    }
    Ok((
        markdown(&rows, &missing, plan),
        serde_json::to_value(&rows)?,
    ))
}

/// A fifth of the trees is red; the ground is always drawn.
fn forest_of(count: usize) -> Result<Subject> {
    let scene = forest(&ForestOptions {
        count,
        red: 0.2,
        ..ForestOptions::default()
    })?;
    Ok(Subject {
        name: "forest",
        crowd: Crowd::new(scene, Vec::new(), "ground", true)?,
        reach: [2.5, 0.3],
    })
}

fn city_of(plan: &Plan<'_>, console: &Console) -> Result<Option<Subject>> {
    let folder = plan.models.join("scenes/kaykit-city");
    if !folder.is_dir() {
        return Ok(None);
    }
    let options = CityOptions {
        count: plan.objects,
        ..CityOptions::default()
    };
    let scene = city(&options, &read_parts(&folder, console)?)?;
    let (scene, images) = decoded(&folder, scene, console);
    Ok(Some(Subject {
        name: "KayKit city",
        crowd: Crowd::new(scene, images, "", true)?,
        reach: [2.5, 0.3],
    }))
}

fn engine(models: &Path, console: &Console) -> Result<Option<Subject>> {
    let path = models.join("gltf/2CylinderEngine.glb");
    if !path.is_file() {
        return Ok(None);
    }
    let scene = input::read(&path, console)?.scene;
    let (scene, images) = decoded(&path, scene, console);
    Ok(Some(Subject {
        name: "2CylinderEngine",
        crowd: Crowd::new(scene, images, "", true)?,
        reach: [8.0, 1.5],
    }))
}

fn decoded(path: &Path, scene: Scene, console: &Console) -> (Scene, Vec<Option<Picture>>) {
    let input = Input {
        path: path.to_owned(),
        bytes: 0,
        scene,
    };
    let images = textures::decode(&input, console);
    (input.scene, images)
}

fn compare(
    subject: &Subject,
    plan: &Plan<'_>,
    console: &Console,
    rows: &mut Vec<Row>,
) -> Result<()> {
    let crowd = &subject.crowd;
    let look = Look::of_scene(&crowd.scene, &crowd.images);
    let groupings = groupings(crowd)?;
    let mut stage = Stage::new(crowd, &groupings[0].tree, &look, StandIns::Boxes);
    let mut alone = Mean::default();
    let mut shots = Vec::new();
    for camera in cameras(subject, plan.views) {
        check_cancelled()?;
        let list = stage.list(&view(camera, None))?;
        let original = original(crowd, &list, &camera, SIZE)?;
        let picture = stage.picture(&list, &camera, SIZE)?;
        alone.add(
            &list,
            flip(&original, &picture, PIXELS_PER_DEGREE)?.mean,
            plan.views,
        );
        shots.push(Shot {
            camera,
            original,
            triangles: list.counts.triangles,
        });
    }
    alone.levels_alone = alone.triangles;
    rows.push(Row::new(subject, ["-", "none"], vec![alone]));
    let curve = Curve::of(&mut stage, &shots)?;
    let mut tiles = Vec::new();
    for (kind, kind_name) in [(StandIns::Boxes, "boxes"), (StandIns::Cards, "cards")] {
        for grouping in &groupings {
            if !console.quiet {
                to_stderr(&format!("{}: {kind_name}, {}", subject.name, grouping.name));
            }
            let mut stage = Stage::new(crowd, &grouping.tree, &look, kind);
            let mut means = Vec::new();
            for share in SHARES {
                let (mut mean, middle) = along(&mut stage, &shots, share)?;
                mean.levels_alone = curve.triangles_at(mean.flip);
                means.push(mean);
                if share == SHARES[0] {
                    tiles.push((middle, format!("{kind_name}, {}", grouping.name)));
                }
            }
            rows.push(Row::new(subject, [kind_name, grouping.name], means));
        }
    }
    write(plan, subject, &shots, tiles)
}

/// All views with a share of their triangles, and the picture in the middle.
fn along(stage: &mut Stage<'_>, shots: &[Shot], share: f64) -> Result<(Mean, Picture)> {
    let mut mean = Mean::default();
    let mut middle = Picture::default();
    for (i, shot) in shots.iter().enumerate() {
        check_cancelled()?;
        let limit = (shot.triangles as f64 * share) as u64;
        let list = stage.list(&view(shot.camera, Some(limit)))?;
        let picture = stage.picture(&list, &shot.camera, SIZE)?;
        let found = flip(&shot.original, &picture, PIXELS_PER_DEGREE)?.mean;
        mean.add(&list, found, shots.len() as u32);
        if i == shots.len() / 2 {
            middle = picture;
        }
    }
    Ok((mean, middle))
}

/// The original and what comes of some groupings.
fn write(
    plan: &Plan<'_>,
    subject: &Subject,
    shots: &[Shot],
    tiles: Vec<(Picture, String)>,
) -> Result<()> {
    let Some(staged) = plan.pictures else {
        return Ok(());
    };
    let shown = ["cards, Omega", "cards, octree", "cards, k-means"];
    let mut sheet = vec![(
        shots[shots.len() / 2].original.clone(),
        "original".to_owned(),
    )];
    sheet.extend(tiles.into_iter().filter(|t| shown.contains(&t.1.as_str())));
    let sheet = Layout::new(sheet.len(), (SIZE[0], SIZE[1])).draw(&sheet, [255; 4]);
    let name = subject.name.split(' ').next_back().unwrap_or("scene");
    let name = format!("hlod-{}.png", name.to_lowercase());
    staged.bytes(&name, &karui_io::encode_png(&sheet)?)
}

/// Groups are taken apart as far as there are triangles.
pub fn view(camera: Camera, triangles: Option<u64>) -> View {
    View {
        threshold: 0.0,
        triangles,
        ..View::new(camera)
    }
}

/// From afar around the scene and towards it.
fn cameras(subject: &Subject, views: u32) -> Vec<Camera> {
    let bounds = subject.crowd.objects.iter().map(|o| o.bounds);
    let Some(bounds) = bounds.reduce(|a, b| a.union(&b)) else {
        return Vec::new();
    };
    let (center, half) = (bounds.center().as_vec3(), 0.5 * bounds.diagonal() as f32);
    let [far, near] = subject.reach;
    let eye = |i: u32| {
        let t = i as f32 / (views.max(2) - 1) as f32;
        let (s, c) = (0.4 + 4.0 * t).sin_cos();
        let away = half * far * (near / far).powf(t);
        center + away * Vec3::new(0.94 * s, 0.34, 0.94 * c)
    };
    (0..views).map(|i| camera(eye(i), center)).collect()
}

fn groupings(crowd: &Crowd) -> Result<Vec<Grouping>> {
    let built = |name, omega| -> Result<Grouping> {
        let options = TreeOptions {
            omega,
            ..TreeOptions::default()
        };
        let tree = Tree::build(crowd.objects.clone(), &options)?;
        Ok(Grouping { name, tree })
    };
    let given = |name, split| -> Result<Grouping> {
        let nests = nested(&crowd.objects, split);
        let tree = Tree::of_nesting(crowd.objects.clone(), &nests, &TreeOptions::default())?;
        Ok(Grouping { name, tree })
    };
    let all = OmegaOptions::default();
    let no_color = OmegaOptions { color: 0.0, ..all };
    let no_shape = OmegaOptions { shape: 0.0, ..all };
    let omega = built("Omega", all)?;
    let by_size = by_size(crowd, &omega.tree)?;
    Ok(vec![
        omega,
        built("without colour", no_color)?,
        built("without shape", no_shape)?,
        by_size,
        given("octree", octants)?,
        given("k-means", clusters)?,
    ])
}

/// The groups of a tree, taken apart by the lengths of their boxes.
fn by_size(crowd: &Crowd, tree: &Tree) -> Result<Grouping> {
    let nest = |id: u32| {
        let group = tree.group(id)?;
        Some(Nest {
            children: group.children().collect(),
            omega0: group.bounds().diagonal(),
        })
    };
    let nests: Vec<Nest> = (0..tree.group_capacity() as u32).filter_map(nest).collect();
    let tree = Tree::of_nesting(crowd.objects.clone(), &nests, &TreeOptions::default())?;
    let name = "Omega, by size";
    Ok(Grouping { name, tree })
}

impl Row {
    fn new(subject: &Subject, [stand_ins, grouping]: [&'static str; 2], means: Vec<Mean>) -> Self {
        Self {
            scene: subject.name.to_owned(),
            objects: subject.crowd.objects.len(),
            stand_ins,
            grouping,
            means,
        }
    }
}

impl Mean {
    /// One of so many views.
    fn add(&mut self, list: &DrawList, flip: f64, views: u32) {
        let share = 1.0 / f64::from(views);
        self.flip += share * flip;
        self.triangles += share * list.counts.triangles as f64;
        self.items += share * list.items.len() as f64;
        self.beyond += usize::from(!list.within_limit);
    }
}

fn markdown(rows: &[Row], missing: &[&str], plan: &Plan<'_>) -> String {
    let mut header = vec!["scene".to_owned(), "stand-ins".into(), "grouping".into()];
    for share in SHARES.map(percent) {
        header.extend([
            format!("FLIP at {share}"),
            "triangles".into(),
            "levels alone".into(),
            "items".into(),
        ]);
        header.push("beyond".into());
    }
    let header: Vec<&str> = header.iter().map(String::as_str).collect();
    let row = |row: &Row| {
        let mut cells = vec![
            row.scene.clone(),
            row.stand_ins.to_owned(),
            row.grouping.to_owned(),
        ];
        for mean in &row.means {
            cells.push(format!("{:.4}", mean.flip));
            let counts = [mean.triangles, mean.levels_alone, mean.items];
            cells.extend(counts.map(|n| count(n.round() as usize)));
            cells.push(mean.beyond.to_string());
        }
        cells.resize(header.len(), String::new());
        cells
    };
    let cells: Vec<Vec<String>> = rows.iter().map(row).collect();
    let missing = match missing {
        [] => String::new(),
        names => format!("Not there, so left out: {}.\n\n", names.join(", ")),
    };
    format!(
        "{HEAD}\nForest and city have {} objects; {} views a scene. {}\n\n{missing}{}\n",
        count(plan.objects),
        plan.views,
        machine(),
        table(&header, &cells, true)
    )
}

const HEAD: &str = "\
## Groups by perception and by place

Written by `karui bench hlod --groupings -o FILE`: a forest, a fifth of its trees red, on ground that
is always drawn; a city of KayKit's parts; an engine, each placed mesh an object. FLIP: mean over the
views of a way from far outside into the scene (the engine is only approached), 640 x 360 pixels,
against all objects at full detail. Every view may have a share of the triangles that it has without
groups (grouping `none`: objects at the level for their distance, whose own figures come first).

- Omega: groups by default options, taken apart by Omega; then with single terms switched off.
  Omega, by size: the groups of the first, taken apart by the angle under which their boxes are seen.
- octree, k-means: groups of at most 8 by the middles of the objects, taken apart by size too.
- boxes: of the mean colour, blended; cards: three pictures that cross. 12 triangles, both.
- levels alone: triangles with which objects without groups come to the same FLIP, their levels
  being switched ever nearer; if their coarsest levels still differ less, what those take.
- beyond: views where the limit could not be kept, the eye being inside groups, which are always
  taken apart.
";
