//! One content of a tile: read, counted, and held against the volumes that
//! are to enclose it.

use super::{
    features,
    findings::{Findings, Notes},
    legacy,
    solid::Solid,
};
use crate::{
    Error, ErrorKind,
    gltf::Inspected,
    source::{Source, load},
};
use glam::{DMat4, DVec3};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// glTF has y up, tiles have z up (specification, "y-up to z-up").
pub(super) const Z_UP_FROM_Y_UP: DMat4 = DMat4::from_cols_array(&[
    1.0, 0.0, 0.0, 0.0, //
    0.0, 0.0, 1.0, 0.0, //
    0.0, -1.0, 0.0, 0.0, //
    0.0, 0.0, 0.0, 1.0,
]);

/// Times the tolerance from which on a content that sticks out is an error: a
/// client may well drop it while it is in view. Up to there it is a warning;
/// volumes that were meant for another level of detail are off by that much.
const SEVERE: f64 = 10.0;

/// A content to be looked at.
#[derive(Debug)]
pub(super) struct Job {
    /// The file on disk.
    pub path: PathBuf,
    /// The tileset file that names it, and where.
    pub owner: PathBuf,
    pub place: String,
    /// Takes the tile's frame to the root's.
    pub root_from_tile: DMat4,
    /// What is to enclose it, and under which rule.
    pub volumes: Vec<(Solid, &'static str)>,
    /// Whether this file was not looked at before.
    pub first: bool,
    /// Share of a volume's size by which points may lie outside.
    pub tolerance: f64,
}

/// What a content holds.
#[derive(Debug, Default)]
pub(super) struct Facts {
    pub bytes: u64,
    /// Triangles drawn, those of instances each.
    pub triangles: u64,
    pub findings: Findings,
}

impl Job {
    /// Reads and checks the file.
    pub fn run(&self) -> Facts {
        let mut facts = Facts::default();
        let bytes = match load(&self.path, &crate::ReadOptions::default()) {
            Ok(bytes) => bytes,
            Err(error) => {
                self.unreadable(&error, &mut facts);
                return facts;
            }
        };
        facts.bytes = bytes.len() as u64;
        if legacy::is_legacy(&bytes) {
            self.legacy(&bytes, &mut facts);
        } else {
            self.model(&bytes, Some(DMat4::IDENTITY), "", &mut facts);
        }
        if !self.first {
            // What is wrong within a file was told when it was first met.
            facts.findings.errors.retain(|f| f.file == self.owner);
            facts.findings.warnings.retain(|f| f.file == self.owner);
        }
        facts
    }

    fn legacy(&self, bytes: &[u8], facts: &mut Facts) {
        let mut notes = Notes {
            file: &self.path,
            findings: &mut facts.findings,
        };
        let found = legacy::read(bytes, "", &mut notes);
        for (i, (model, center)) in found.models.iter().enumerate() {
            let moved = center.map(|c| DMat4::from_translation(DVec3::from(c)));
            self.model(model, moved, &format!("model {i}"), facts);
        }
    }

    /// A glTF; `moved` is `None` where instances say where it stands.
    fn model(&self, bytes: &[u8], moved: Option<DMat4>, place: &str, facts: &mut Facts) {
        let mut source = Source::of_file(&self.path, bytes);
        let gltf = match Inspected::read(&mut source) {
            Ok(gltf) => gltf,
            Err(error) => return self.unreadable(&error, facts),
        };
        let mut notes = Notes {
            file: &self.path,
            findings: &mut facts.findings,
        };
        for warning in source.warnings.into_messages() {
            notes.warn(place, "gltf", "a glTF without oddities", warning);
        }
        if self.first {
            features::check(&gltf, &mut notes);
        }
        let placed = gltf.placed();
        let meshes = &gltf.scene.meshes;
        let triangles = |m: u32| meshes.get(m as usize).map_or(0, |m| m.mesh.triangles.len());
        facts.triangles += placed.iter().map(|p| triangles(p.mesh) as u64).sum::<u64>();
        if let Some(moved) = moved {
            let moved = moved * DMat4::from_translation(rtc(gltf.json()));
            self.enclosed(&gltf, self.root_from_tile * moved * Z_UP_FROM_Y_UP, facts);
        }
    }

    /// Checks that all points lie in all volumes.
    fn enclosed(&self, gltf: &Inspected, root_from_world: DMat4, facts: &mut Facts) {
        let clouds: Vec<Cloud> = (0..gltf.scene.meshes.len())
            .map(|m| Cloud::new(gltf.points(m)))
            .collect();
        let placed = gltf.placed();
        for (solid, rule) in &self.volumes {
            let mut worst: Option<(f64, f64, DVec3)> = None;
            for mesh in &placed {
                let Some(cloud) = clouds.get(mesh.mesh as usize) else {
                    continue;
                };
                let matrix = root_from_world * mesh.world_from_mesh;
                let allowed = self.tolerance * solid.size() + cloud.rounding(&matrix, solid);
                let far = cloud.furthest(&matrix, solid, allowed);
                if let Some((away, point)) = far.filter(|f| f.0 > allowed)
                    && worst.is_none_or(|w| away - allowed > w.0 - w.1)
                {
                    worst = Some((away, allowed, point));
                }
            }
            if let Some((away, allowed, point)) = worst {
                let mut notes = Notes {
                    file: &self.owner,
                    findings: &mut facts.findings,
                };
                let expected = format!("content within {allowed:.3e} m of the volume");
                let found = format!("a point {away:.6} m outside, at {point:.3}");
                if away > SEVERE * allowed {
                    notes.error(&self.place, rule, expected, found);
                } else {
                    notes.warn(&self.place, rule, expected, found);
                }
            }
        }
    }

    fn unreadable(&self, error: &Error, facts: &mut Facts) {
        let path = if error.path.as_os_str().is_empty() {
            &self.path
        } else {
            &error.path
        };
        let mut notes = Notes {
            file: path,
            findings: &mut facts.findings,
        };
        let place = error.place.to_string();
        let (expected, found) = ("a content that can be read", error.kind.to_string());
        match &*error.kind {
            ErrorKind::Unsupported(_) => notes.warn(place, "content-unsupported", expected, found),
            _ => notes.error(place, "content-unreadable", expected, found),
        }
    }
}

/// `CESIUM_RTC`: the centre that coordinates are relative to.
fn rtc(json: &Value) -> DVec3 {
    let center = |i: usize| {
        let found = json.pointer(&format!("/extensions/CESIUM_RTC/center/{i}"));
        found.and_then(Value::as_f64).unwrap_or(0.0)
    };
    DVec3::from([0, 1, 2].map(center))
}

/// Points of a mesh and the box around them.
struct Cloud {
    points: Vec<DVec3>,
    corners: [DVec3; 8],
    reach: f64,
}

impl Cloud {
    fn new(points: Vec<DVec3>) -> Self {
        let start = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let (min, max) = points
            .iter()
            .fold(start, |(a, b), p| (a.min(*p), b.max(*p)));
        let corner = |i: usize| {
            let pick = |bit: usize, a: f64, b: f64| if i >> bit & 1 == 1 { b } else { a };
            DVec3::new(
                pick(0, min.x, max.x),
                pick(1, min.y, max.y),
                pick(2, min.z, max.z),
            )
        };
        Self {
            corners: std::array::from_fn(corner),
            reach: if points.is_empty() {
                0.0
            } else {
                min.abs().max(max.abs()).max_element()
            },
            points,
        }
    }

    /// Metres that numbers of 32 bits in the file and of 64 bits on the way
    /// can be off.
    fn rounding(&self, matrix: &DMat4, solid: &Solid) -> f64 {
        let axes = [matrix.x_axis, matrix.y_axis, matrix.z_axis];
        let scale = axes
            .map(|a| a.truncate().length())
            .into_iter()
            .fold(0.0, f64::max);
        2.4e-7 * self.reach * scale + 1e-12 * solid.reach()
    }

    /// The point that lies furthest outside, if any lies further than allowed.
    fn furthest(&self, matrix: &DMat4, solid: &Solid, allowed: f64) -> Option<(f64, DVec3)> {
        let far = |points: &[DVec3]| {
            let moved = points.iter().map(|p| matrix.transform_point3(*p));
            let away = moved.map(|p| (solid.outside(p), p));
            away.fold(None, |best: Option<(f64, DVec3)>, next| match best {
                Some(best) if best.0 >= next.0 => Some(best),
                _ => Some(next),
            })
        };
        if self.points.is_empty() {
            return None;
        }
        // Boxes and spheres are convex: corners inside, all inside.
        let corners = far(&self.corners).filter(|_| !solid.is_region());
        if corners.is_some_and(|c| c.0 <= allowed) {
            return None;
        }
        far(&self.points)
    }
}

/// What the first bytes of a file tell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Model,
    Json,
    Unknown,
}

/// Tells a content by its first bytes.
pub(super) fn sniff(path: &Path) -> std::io::Result<Kind> {
    use std::io::Read;
    if !std::fs::metadata(path)?.is_file() {
        return Err(std::io::Error::other("is not a regular file"));
    }
    let mut head = Vec::new();
    std::fs::File::open(path)?.take(64).read_to_end(&mut head)?;
    let extension = path
        .extension()
        .and_then(|e| e.to_str())
        .unwrap_or_default();
    let gltf = ["gltf", "glb"]
        .iter()
        .any(|e| extension.eq_ignore_ascii_case(e));
    Ok(
        if head.starts_with(b"glTF") || legacy::is_legacy(&head) || gltf {
            Kind::Model
        } else if head.trim_ascii_start().starts_with(b"{") {
            Kind::Json
        } else {
            Kind::Unknown
        },
    )
}
