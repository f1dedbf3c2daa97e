//! Pieces of a surface that lie flat in a texture.

use crate::geom::{DVec3, normal_times_two_areas};
use crate::mesh::{PositionIds, TriMesh};

/// Cosine of the largest angle between the normals of a chart: projected onto one
/// plane, nothing is more than 1.4 times as long as in the texture.
const FLAT: f64 = 0.71;

/// Triangles that are projected onto one plane.
#[derive(Debug, Clone)]
pub(super) struct Chart {
    pub triangles: Vec<u32>,
    /// Directions of u and v, of length 1.
    pub axes: [DVec3; 2],
    /// Least u and v, model units.
    pub least: [f64; 2],
    /// Extent along u and v, model units.
    pub size: [f64; 2],
}

impl Chart {
    /// Place of a position, model units from the corner of the chart.
    pub fn place(&self, p: DVec3) -> [f64; 2] {
        [0, 1].map(|k| p.dot(self.axes[k]) - self.least[k])
    }
}

/// Cuts the surface into charts: from the largest triangle left on over all that
/// are connected and turned about the same way, within one range.
pub(super) fn charts(mesh: &TriMesh) -> Vec<Chart> {
    let normals: Vec<DVec3> = (0..mesh.triangles.len())
        .map(|t| normal_times_two_areas(mesh.corners(t)))
        .collect();
    let neighbours = Neighbours::of(mesh);
    let mut seeds: Vec<u32> = (0..mesh.triangles.len() as u32).collect();
    let size = |t: u32| normals[t as usize].length_squared();
    seeds.sort_by(|&a, &b| size(b).total_cmp(&size(a)).then(a.cmp(&b)));
    let mut taken = vec![false; mesh.triangles.len()];
    let mut charts = Vec::new();
    for seed in seeds {
        if !taken[seed as usize] {
            let triangles = grow(seed, &normals, &neighbours, &mut taken);
            charts.push(chart(mesh, triangles, normals[seed as usize]));
        }
    }
    charts
}

fn grow(seed: u32, normals: &[DVec3], neighbours: &Neighbours, taken: &mut [bool]) -> Vec<u32> {
    let axis = normals[seed as usize].normalize_or_zero();
    let mut triangles = vec![seed];
    taken[seed as usize] = true;
    let mut next = 0;
    while let Some(&t) = triangles.get(next) {
        next += 1;
        for &n in neighbours.of_triangle(t) {
            let normal = normals[n as usize];
            // What has no area fits everywhere.
            if !taken[n as usize] && normal.dot(axis) >= FLAT * normal.length() {
                taken[n as usize] = true;
                triangles.push(n);
            }
        }
    }
    triangles
}

fn chart(mesh: &TriMesh, triangles: Vec<u32>, normal: DVec3) -> Chart {
    let axes = axes(mesh.corners(triangles[0] as usize), normal);
    let corners = triangles.iter().flat_map(|&t| mesh.corners(t as usize));
    let (mut least, mut most) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for p in corners {
        for k in 0..2 {
            let at = p.dot(axes[k]);
            (least[k], most[k]) = (least[k].min(at), most[k].max(at));
        }
    }
    let size = [most[0] - least[0], most[1] - least[1]];
    // Higher than wide would waste more of a shelf.
    if size[1] > size[0] {
        return Chart {
            triangles,
            axes: [axes[1], -axes[0]],
            least: [least[1], -most[0]],
            size: [size[1], size[0]],
        };
    }
    Chart {
        triangles,
        axes,
        least,
        size,
    }
}

/// Along the longest side of a triangle, and across.
fn axes([a, b, c]: [DVec3; 3], normal: DVec3) -> [DVec3; 2] {
    let sides = [b - a, c - b, a - c];
    let longest = sides.into_iter().fold(DVec3::ZERO, |best, side| {
        if side.length_squared() > best.length_squared() {
            side
        } else {
            best
        }
    });
    let u = longest.normalize_or(DVec3::X);
    let v = normal.normalize_or_zero().cross(u);
    [u, v.normalize_or(u.any_orthonormal_vector())]
}

/// Triangles that share an edge, by position, and a range.
struct Neighbours {
    starts: Vec<u32>,
    list: Vec<u32>,
}

impl Neighbours {
    fn of(mesh: &TriMesh) -> Self {
        let ids = PositionIds::of_mesh(mesh);
        let range_of = mesh.range_of_triangles();
        let mut edges: Vec<([u32; 3], u32)> = Vec::with_capacity(3 * mesh.triangles.len());
        for (t, triangle) in ids.triangles(&mesh.triangles).iter().enumerate() {
            for k in 0..3 {
                let (a, b) = (triangle[k], triangle[(k + 1) % 3]);
                edges.push(([range_of[t], a.min(b), a.max(b)], t as u32));
            }
        }
        edges.sort_unstable();
        let mut pairs: Vec<(u32, u32)> = Vec::with_capacity(edges.len());
        for pair in edges.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
            pairs.extend([(pair[0].1, pair[1].1), (pair[1].1, pair[0].1)]);
        }
        pairs.sort_unstable();
        let before = |t: usize| pairs.partition_point(|p| (p.0 as usize) < t) as u32;
        Self {
            starts: (0..=mesh.triangles.len()).map(before).collect(),
            list: pairs.into_iter().map(|p| p.1).collect(),
        }
    }

    fn of_triangle(&self, t: u32) -> &[u32] {
        let [first, end] = [t, t + 1].map(|t| self.starts[t as usize] as usize);
        &self.list[first..end]
    }
}
