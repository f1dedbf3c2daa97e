//! Surfaces beside OpenSubdiv's: its regression shapes with their creases, corners, holes,
//! boundary rules and texture coordinates.
//!
//! `tools/osd_oracle/build.sh SHAPES OUT` writes what OpenSubdiv makes of them. With
//! `KARUI_OSD_FIXTURES=OUT` every vertex of every level is compared.

use karui::subdiv::{
    Boundary, ControlMesh, FaceVaryingRule, Refinement, Scheme, SubdivOptions,
};
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
        (0..N).map(|i| (f64::from(a[i]) - b[i]).abs()).fold(0.0, f64::max)
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
    let (Ok(fixtures), shapes) = (std::env::var("KARUI_OSD_FIXTURES"), shapes()) else {
        println!("SKIPPED: KARUI_OSD_FIXTURES is not set");
        return;
    };
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
    println!("{} shapes, {} positions, {} corners with texture coordinates", shapes.len(), compared[0], compared[1]);
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
        let options = SubdivOptions { face_varying: rule, ..options };
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
    // A normal of one side only is that of another side in OpenSubdiv.
    let mut others = 0;
    let both = limits.normals.iter().zip(&limits.one_sided).zip(&expected.normals);
    for ((ours, _), theirs) in both.filter(|((_, one_sided), _)| !**one_sided) {
        let ours = ours.to_array();
        let dot: f64 = (0..3).map(|i| f64::from(ours[i]) * theirs[i]).sum();
        others += usize::from(theirs != &[0.0; 3] && ours != [0.0; 3] && dot < 1.0 - 1e-5);
    }
    if others > 0 {
        return Err(format!("{others} normals differ"));
    }
    Ok(())
}
