//! Surfaces beside OpenSubdiv's: its regression shapes with their creases, corners, holes,
//! boundary rules and texture coordinates.
//!
//! `data/opensubdiv.json` holds every vertex of level 1, of levels 2 to 4 sums with weights
//! that look random and some vertices, and sums of limits and texture coordinates.
//! `tools/osd_oracle/build.sh SHAPES OUT` writes everything; with `KARUI_OSD_FIXTURES=OUT`
//! every vertex of every level, limit, normal and texture coordinate is compared.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test")]

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use karui::subdiv::{Boundary, ControlMesh, FaceVaryingRule, Refinement, Scheme, SubdivOptions};
use std::path::{Path, PathBuf};

const RULES: [FaceVaryingRule; 6] = [
    FaceVaryingRule::None,
    FaceVaryingRule::CornersOnly,
    FaceVaryingRule::CornersPlus1,
    FaceVaryingRule::CornersPlus2,
    FaceVaryingRule::Boundaries,
    FaceVaryingRule::All,
];

/// One level of one shape as OpenSubdiv has it.
struct Expected {
    sizes: Vec<u32>,
    corners: Vec<u32>,
    holes: Vec<bool>,
    positions: Vec<[f64; 3]>,
    limits: Vec<[f64; 3]>,
    normals: Vec<[f64; 3]>,
    /// By rule, then by corner.
    uvs: Vec<Vec<[f64; 2]>>,
}

struct Bytes<'a>(&'a [u8]);

impl Bytes<'_> {
    fn take<const N: usize>(&mut self) -> [u8; N] {
        let (head, rest) = self.0.split_first_chunk().expect("a whole fixture");
        self.0 = rest;
        *head
    }

    fn whole(&mut self) -> u32 {
        u32::from_le_bytes(self.take())
    }

    fn list<T>(&mut self, count: usize, read: impl Fn(&mut Self) -> T) -> Vec<T> {
        (0..count).map(|_| read(self)).collect()
    }

    fn vector<const N: usize>(&mut self) -> [f64; N] {
        std::array::from_fn(|_| f64::from_le_bytes(self.take()))
    }

    fn levels(mut self) -> Vec<Expected> {
        assert_eq!(&self.take::<4>(), b"KOSD");
        let (levels, rules) = (self.whole(), self.whole());
        let level = |bytes: &mut Self| {
            let [vertices, faces, corners] = [0; 3].map(|_: usize| bytes.whole() as usize);
            Expected {
                sizes: bytes.list(faces, Self::whole),
                corners: bytes.list(corners, Self::whole),
                holes: bytes.list(faces, |b| b.take::<1>() != [0]),
                positions: bytes.list(vertices, Self::vector),
                limits: bytes.list(vertices, Self::vector),
                normals: bytes.list(vertices, Self::vector),
                uvs: bytes.list(rules as usize, |b| b.list(corners, Self::vector)),
            }
        };
        self.list(levels as usize, level)
    }
}

fn shapes() -> Vec<PathBuf> {
    let models = std::env::var("KARUI_MODELS")
        .unwrap_or_else(|_| concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/models").into());
    let folder = Path::new(&models).join("subdivision/opensubdiv");
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut all: Vec<_> = entries.map(|entry| entry.path()).collect();
    all.sort();
    all
}

fn options(path: &Path, mesh: &ControlMesh, levels: u32) -> SubdivOptions {
    let name = path.file_name().unwrap().to_str().unwrap();
    let scheme = match name.split('_').next() {
        Some("loop") => Scheme::Loop,
        Some("bilinear") => Scheme::Bilinear,
        _ => Scheme::CatmullClark,
    };
    mesh.rules.apply(SubdivOptions {
        scheme,
        levels,
        boundary: Boundary::EdgeOnly,
        ..SubdivOptions::default()
    })
}

fn worst<const N: usize>(ours: &[[f32; N]], theirs: &[[f64; N]]) -> f64 {
    let off = |(a, b): (&[f32; N], &[f64; N])| {
        (0..N)
            .map(|i| (f64::from(a[i]) - b[i]).abs())
            .fold(0.0, f64::max)
    };
    ours.iter().zip(theirs).map(off).fold(0.0, f64::max)
}

fn diagonal(positions: &[[f32; 3]]) -> f64 {
    let extent = |i: usize| {
        let all = positions.iter().map(|p| f64::from(p[i]));
        all.clone().fold(f64::MIN, f64::max) - all.fold(f64::MAX, f64::min)
    };
    (0..3).map(|i| extent(i).powi(2)).sum::<f64>().sqrt()
}

#[test]
fn every_vertex_is_opensubdivs() {
    let Ok(fixtures) = std::env::var("KARUI_OSD_FIXTURES") else {
        println!("SKIPPED: KARUI_OSD_FIXTURES is not set");
        return;
    };
    let shapes = shapes();
    let mut broken = Vec::new();
    let mut compared = [0usize; 2];
    for shape in &shapes {
        let name = shape.file_stem().unwrap().to_str().unwrap();
        let bytes = std::fs::read(Path::new(&fixtures).join(format!("{name}.bin"))).unwrap();
        let mesh = karui_io::read_control(shape).unwrap().mesh;
        for (i, expected) in Bytes(&bytes).levels().iter().enumerate() {
            let options = options(shape, &mesh, i as u32 + 1);
            compared[0] += expected.positions.len();
            compared[1] += expected.uvs.iter().map(Vec::len).sum::<usize>();
            if let Err(error) = compare(&mesh, expected, options) {
                broken.push(format!("{name} level {}: {error}", i + 1));
            }
        }
    }
    println!(
        "{} shapes, {} positions, {} corners with texture coordinates",
        shapes.len(),
        compared[0],
        compared[1]
    );
    assert_eq!(broken, Vec::<String>::new());
}

fn compare(mesh: &ControlMesh, expected: &Expected, options: SubdivOptions) -> Result<(), String> {
    let refinement = Refinement::new(&mesh.cage, &options).map_err(|e| e.to_string())?;
    let faces = refinement.faces();
    let sizes = (0..faces.count()).map(|f| faces.corners(f).len() as u32);
    if refinement.corners() != expected.corners || !sizes.eq(expected.sizes.iter().copied()) {
        return Err("faces differ".into());
    }
    if let Some(f) = (0..faces.count()).find(|&f| refinement.is_hole(f) != expected.holes[f]) {
        return Err(format!("face {f}: a hole or not"));
    }
    let cage: Vec<[f32; 3]> = mesh.positions.iter().map(|p| p.to_array()).collect();
    let ours = refinement.evaluate(&cage).map_err(|e| e.to_string())?;
    let diagonal = diagonal(&cage);
    let off = worst(&ours, &expected.positions) / diagonal;
    if ours.len() != expected.positions.len() || off.is_nan() || off > 1e-6 {
        return Err(format!("positions are off by {off:e}"));
    }
    compare_limits(&refinement, &cage, expected, diagonal)?;
    let Some(uvs) = &mesh.uvs else {
        return Ok(());
    };
    let values: Vec<[f32; 2]> = uvs.values.iter().map(|v| [v.x, 1.0 - v.y]).collect();
    for (rule, expected) in RULES.into_iter().zip(&expected.uvs) {
        let options = SubdivOptions {
            face_varying: rule,
            ..options
        };
        let charts = Refinement::new(&mesh.cage, &options)
            .and_then(|refinement| refinement.face_varying(&uvs.indices, values.len()))
            .map_err(|e| e.to_string())?;
        let ours = charts.evaluate(&values).map_err(|e| e.to_string())?;
        let by_corner: Vec<_> = charts.corners().iter().map(|&v| ours[v as usize]).collect();
        let off = worst(&by_corner, expected);
        if by_corner.len() != expected.len() || off.is_nan() || off > 1e-5 {
            return Err(format!("{rule:?}: texture coordinates are off by {off:e}"));
        }
    }
    Ok(())
}

fn compare_limits(
    refinement: &Refinement,
    cage: &[[f32; 3]],
    expected: &Expected,
    diagonal: f64,
) -> Result<(), String> {
    let limits = refinement.limits(cage).map_err(|e| e.to_string())?;
    let ours: Vec<_> = limits.positions.iter().map(|p| p.to_array()).collect();
    let off = worst(&ours, &expected.limits) / diagonal;
    if off.is_nan() || off > 1e-6 {
        return Err(format!("limits are off by {off:e}"));
    }
    // A normal of one side only is that of another side in OpenSubdiv. Where sheets lie on one
    // another tangents are one direction, and what single precision leaves turns the normal.
    let largest = ours.iter().flatten().fold(0.0f32, |m, c| c.abs().max(m));
    let unsure = |[a, b]: [glam::Vec3; 2]| {
        let noise = 2e-6 * largest * (a.length() + b.length());
        a.cross(b).length() * 2e-3 < noise
    };
    let mut others = 0;
    let both = limits.normals.iter().zip(&expected.normals).enumerate();
    let sure = both.filter(|&(v, _)| !limits.one_sided[v] && !unsure(limits.tangents[v]));
    for (_, (ours, theirs)) in sure {
        let ours = ours.to_array();
        let dot: f64 = (0..3).map(|i| f64::from(ours[i]) * theirs[i]).sum();
        others += usize::from(theirs != &[0.0; 3] && ours != [0.0; 3] && dot < 1.0 - 1e-5);
    }
    if others > 0 {
        return Err(format!("{others} normals differ"));
    }
    Ok(())
}

/// As `tools/osd_oracle/pack.py` has it.
fn weight(i: usize) -> f64 {
    let mut x = (i as u32).wrapping_mul(2_654_435_761).wrapping_add(12345);
    x ^= x >> 15;
    x = x.wrapping_mul(2_246_822_519);
    x ^= x >> 13;
    f64::from(x) / 2_147_483_648.0 - 1.0
}

fn sums<const N: usize>(values: &[[f32; N]], blocks: usize) -> Vec<[f64; N]> {
    let mut sums = vec![[0.0; N]; blocks];
    for (i, value) in values.iter().enumerate() {
        let sum = &mut sums[i * blocks / values.len()];
        (0..N).for_each(|c| sum[c] += weight(i) * f64::from(value[c]));
    }
    sums
}

fn fnv(corners: &[u32]) -> String {
    let bytes = corners.iter().flat_map(|c| c.to_le_bytes());
    let hash = bytes.fold(0xcbf2_9ce4_8422_2325u64, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3)
    });
    format!("{hash:016x}")
}

fn packed<const N: usize, const BYTES: usize>(
    text: &serde_json::Value,
    number: fn([u8; BYTES]) -> f64,
) -> Vec<[f64; N]> {
    let bytes = BASE64_STANDARD.decode(text.as_str().unwrap()).unwrap();
    let numbers: Vec<f64> = bytes.as_chunks().0.iter().map(|&b| number(b)).collect();
    numbers.as_chunks().0.to_vec()
}

fn doubles<const N: usize>(text: &serde_json::Value) -> Vec<[f64; N]> {
    packed(text, f64::from_le_bytes)
}

fn singles(text: &serde_json::Value) -> Vec<[f64; 3]> {
    packed(text, |b| f64::from(f32::from_le_bytes(b)))
}

/// Sums may be off by what their vertices may, at random.
fn sums_agree<const N: usize>(
    ours: &[[f32; N]],
    expected: &[[f64; N]],
    bound: f64,
) -> Result<(), String> {
    let mine = sums(ours, expected.len());
    let bound = bound * (ours.len() as f64 / expected.len() as f64).sqrt().max(1.0);
    for (a, b) in mine.iter().flatten().zip(expected.iter().flatten()) {
        if (a - b).is_nan() || (a - b).abs() > bound {
            return Err(format!("a sum is off by {:e} of {bound:e}", (a - b).abs()));
        }
    }
    Ok(())
}

#[test]
fn shapes_are_opensubdivs() {
    let shapes = shapes();
    if shapes.is_empty() {
        println!("SKIPPED: no subdivision/opensubdiv in KARUI_MODELS");
        return;
    }
    let json: serde_json::Value =
        serde_json::from_str(include_str!("data/opensubdiv.json")).unwrap();
    let mut broken = Vec::new();
    for shape in &shapes {
        let name = shape.file_stem().unwrap().to_str().unwrap();
        let mesh = karui_io::read_control(shape).unwrap().mesh;
        for (i, expected) in json[name].as_array().expect(name).iter().enumerate() {
            let options = options(shape, &mesh, i as u32 + 1);
            if let Err(error) = agrees(&mesh, expected, options) {
                broken.push(format!("{name} level {}: {error}", i + 1));
            }
        }
    }
    assert!(shapes.len() > 100, "only {} shapes", shapes.len());
    assert_eq!(broken, Vec::<String>::new());
}

fn agrees(
    mesh: &ControlMesh,
    expected: &serde_json::Value,
    options: SubdivOptions,
) -> Result<(), String> {
    let refinement = Refinement::new(&mesh.cage, &options).map_err(|e| e.to_string())?;
    let cage: Vec<[f32; 3]> = mesh.positions.iter().map(|p| p.to_array()).collect();
    let bound = 1e-6 * diagonal(&cage);
    let ours = refinement.evaluate(&cage).map_err(|e| e.to_string())?;
    let faces = refinement.faces().count();
    let holes = (0..faces).filter(|&f| refinement.is_hole(f)).count();
    let counts = [("vertices", ours.len()), ("faces", faces), ("holes", holes)];
    if let Some((what, found)) = counts.iter().find(|(what, found)| expected[what] != *found) {
        return Err(format!("{found} {what}"));
    }
    if expected["corners"]
        .as_str()
        .is_some_and(|hash| hash != fnv(refinement.corners()))
    {
        return Err("faces differ".into());
    }
    if !expected["positions"].is_null() {
        let off = worst(&ours, &singles(&expected["positions"]));
        return if off <= bound {
            Ok(())
        } else {
            Err(format!("off by {off:e}"))
        };
    }
    sums_agree(&ours, &doubles(&expected["sums"]), bound)?;
    let samples = singles(&expected["samples"]);
    let step = (ours.len() / 4).max(1);
    let some: Vec<_> = ours
        .iter()
        .copied()
        .step_by(step)
        .take(samples.len())
        .collect();
    let off = worst(&some, &samples);
    if off.is_nan() || off > bound {
        return Err(format!("off by {off:e}"));
    }
    if !expected["limits"].is_null() {
        let limits = refinement.limits(&cage).map_err(|e| e.to_string())?;
        let limits: Vec<_> = limits.positions.iter().map(|p| p.to_array()).collect();
        sums_agree(&limits, &doubles(&expected["limits"]), bound)?;
    }
    let Some(uvs) = &mesh.uvs else {
        return Ok(());
    };
    let values: Vec<[f32; 2]> = uvs.values.iter().map(|v| [v.x, 1.0 - v.y]).collect();
    for (face_varying, expected) in RULES
        .into_iter()
        .zip(expected["uvs"].as_array().into_iter().flatten())
    {
        let options = SubdivOptions {
            face_varying,
            ..options
        };
        let charts = Refinement::new(&mesh.cage, &options)
            .and_then(|refinement| refinement.face_varying(&uvs.indices, values.len()))
            .map_err(|e| e.to_string())?;
        let ours = charts.evaluate(&values).map_err(|e| e.to_string())?;
        let by_corner: Vec<_> = charts.corners().iter().map(|&v| ours[v as usize]).collect();
        sums_agree(&by_corner, &doubles(expected), 1e-5)
            .map_err(|e| format!("{face_varying:?}: {e}"))?;
    }
    Ok(())
}
