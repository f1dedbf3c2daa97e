//! The uniform refinement of a cage, as far as anything has asked for it.
//!
//! Tier 0 is the cage, tier `m` what `m` Catmull-Clark steps make of it: the same vertices,
//! edges and faces, but only those that were needed, in the order in which they were. What
//! has a place in it has the position that uniform refinement gives it there, whatever has
//! been made around it.

use super::piece::Piece;
use super::stamp::{Mark, Stamps};
use crate::error::{Error, Result};
use crate::subdiv::level::{Faces, Level};
use crate::subdiv::options::{CreaseMethod, SubdivOptions, TriangleRule};
use glam::Vec3;

/// No element.
pub(super) const NONE: u32 = u32::MAX;

/// What a vertex was in the tier above.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Origin {
    Cage,
    Face(u32),
    Edge(u32),
    Vertex(u32),
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Vertex {
    pub position: Vec3,
    /// Whether `position` has been found.
    pub known: bool,
    /// Whether its faces are not one fan or ring.
    pub odd: bool,
    pub origin: Origin,
    /// A corner at it.
    pub corner: u32,
    /// The same vertex in the next tier.
    pub child: u32,
    /// The same vertex in all tiers.
    pub point: u32,
    pub sharpness: f32,
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Edge {
    pub ends: [u32; 2],
    /// Corners at which it starts in its faces, as far as they have been made.
    pub corners: [u32; 2],
    /// The edge of the tier above that it is half of.
    pub parent: u32,
    /// Vertex of the next tier on it.
    pub point: u32,
    /// Its halves in the next tier: at `ends[0]`, and at `ends[1]` the one after.
    pub halves: u32,
    pub sharpness: f32,
    /// Whether it has one face only.
    pub open: bool,
    /// Whether texture coordinates differ across it.
    pub seam: bool,
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Face {
    /// The corner of the tier above that it is the child of.
    pub parent: u32,
    /// Its first child; that of its `i`-th corner is `i` after.
    pub children: u32,
    /// Its place: the cage's corner it lies at, then two bits a tier. In the order of places
    /// everything comes out the same, whatever was made first.
    pub place: u64,
}

/// One level of the uniform refinement.
#[derive(Debug, Clone)]
pub(super) struct Tier {
    pub vertices: Vec<Vertex>,
    pub edges: Vec<Edge>,
    pub faces: Vec<Face>,
    /// Vertex, edge to the next corner, and wedge of every corner.
    pub corners: Vec<u32>,
    pub corner_edges: Vec<u32>,
    pub wedges: Vec<u32>,
    /// Of faces and of the diamonds over edges, as far as they have been asked for; apart from
    /// them, so that these lie close together.
    pub face_shapes: Vec<Shape>,
    pub edge_shapes: Vec<Shape>,
    /// Of every face, and of the diamond over every edge.
    pub face_stamps: Vec<Stamps>,
    pub edge_stamps: Vec<Stamps>,
    /// Where the corners of faces are; all others have four.
    pub cage: Option<Faces>,
}

/// A vertex through all tiers.
#[derive(Debug, Clone, Copy)]
pub(super) struct Point {
    /// The frame in which `place`, its deepest tier and vertex there, was set.
    pub frame: u32,
    pub place: [u32; 2],
}

/// The surface at a point between two edges that stay sharp, or all around.
#[derive(Debug, Clone, Copy)]
pub(super) struct Wedge {
    pub point: u32,
    /// Where the point goes in the limit.
    pub limit: Vec3,
    pub normal: Vec3,
}

/// What does not depend on the view in whether a piece is to be split.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shape {
    /// A sphere around it.
    pub center: Vec3,
    pub radius: f32,
    /// All normals are this far from the axis, as a sine; more than 1 if that says nothing.
    pub axis: Vec3,
    pub spread: f32,
    /// Distance to the limit surface, model units; negative if not known.
    pub error: f32,
    /// Its longest side, model units.
    pub side: f32,
    /// Points of its corners, the last one twice for a triangle; `NONE` if there are more.
    pub points: [u32; 4],
    /// Wedges of its corners if it is one polygon of four; else `NONE`.
    pub wedges: [u32; 4],
}

impl Shape {
    pub const UNKNOWN: Self = Self {
        center: Vec3::ZERO,
        radius: 0.0,
        axis: Vec3::ZERO,
        spread: 2.0,
        error: -1.0,
        side: 0.0,
        points: [NONE; 4],
        wedges: [NONE; 4],
    };
}

#[derive(Debug, Clone)]
pub(super) struct Store {
    pub tiers: Vec<Tier>,
    pub points: Vec<Point>,
    pub wedges: Vec<Wedge>,
    /// Of every point.
    pub marks: Vec<Mark>,
    /// Of every wedge, the frame in which it became a vertex, and which.
    pub drawn: Vec<[u32; 2]>,
    pub creases: CreaseMethod,
    pub triangles: TriangleRule,
    /// Whether nothing is smooth: what is there stays, and the rest is means.
    pub linear: bool,
    /// Faces of the cage that are left out; empty if none is.
    pub holes: Vec<bool>,
}

impl Store {
    pub fn of_level(level: &Level, positions: &[Vec3], options: &SubdivOptions) -> Result<Self> {
        check_edges(level)?;
        let mut store = Self {
            tiers: vec![Tier::of_level(level)],
            points: Vec::new(),
            wedges: Vec::new(),
            marks: Vec::new(),
            drawn: Vec::new(),
            creases: options.creases,
            triangles: options.triangles,
            linear: false,
            holes: level.holes.clone(),
        };
        store.points = (0..positions.len()).map(|_| Point::NEW).collect();
        store.move_cage(positions);
        Ok(store)
    }

    /// Puts the cage's vertices elsewhere: what was known of positions no longer is.
    pub fn move_cage(&mut self, positions: &[Vec3]) {
        for tier in &mut self.tiers {
            tier.vertices.iter_mut().for_each(|v| v.known = false);
            tier.edge_shapes.clear();
            tier.face_shapes.clear();
            tier.wedges.fill(NONE);
        }
        self.wedges.clear();
        self.drawn.clear();
        for (vertex, &position) in self.tiers[0].vertices.iter_mut().zip(positions) {
            vertex.position = position;
            vertex.known = true;
        }
    }

    /// Number of faces made, of all tiers.
    pub fn face_count(&self) -> usize {
        self.tiers.iter().map(|t| t.faces.len()).sum()
    }

    /// Forgets all but the cage, and in which frames something was done.
    pub fn forget(&mut self) {
        self.tiers.truncate(1);
        self.wedges.clear();
        self.drawn.clear();
        let cage = &mut self.tiers[0];
        self.points.truncate(cage.vertices.len());
        self.points.iter_mut().for_each(|p| p.frame = 0);
        self.marks.clear();
        cage.vertices.iter_mut().for_each(|v| v.child = NONE);
        cage.wedges.fill(NONE);
        cage.edge_shapes.clear();
        cage.face_shapes.clear();
        for edge in &mut cage.edges {
            (edge.point, edge.halves) = (NONE, NONE);
        }
        cage.faces.iter_mut().for_each(|f| f.children = NONE);
        cage.face_stamps = new_stamps(cage.faces.len());
        cage.edge_stamps = new_stamps(cage.edges.len());
    }

    /// The face of the cage that a face lies on.
    pub fn base(&self, tier: usize, face: u32) -> u32 {
        let Some(cage) = self.tiers[0].cage.as_ref().filter(|_| tier > 0) else {
            return face;
        };
        let place = self.tiers[tier].faces[face as usize].place;
        cage.of_corner((place >> (2 * (tier - 1))) as u32)
    }

    pub fn stamps(&self, tier: usize, piece: Piece) -> &Stamps {
        match piece {
            Piece::Face(f) => &self.tiers[tier].face_stamps[f as usize],
            Piece::Diamond(e) => &self.tiers[tier].edge_stamps[e as usize],
        }
    }

    /// Whether the wedge of a corner has been found.
    pub fn has_wedge(&self, tier: usize, corner: u32) -> bool {
        self.tiers[tier].wedges[corner as usize] != NONE
    }

    /// Whether a face is left out of the result.
    pub fn is_hole(&self, tier: usize, face: u32) -> bool {
        !self.holes.is_empty() && self.holes[self.base(tier, face) as usize]
    }
}

impl Point {
    pub const NEW: Self = Self {
        frame: 0,
        place: [0; 2],
    };
}

impl Vertex {
    pub fn new(origin: Origin, point: u32, sharpness: f32, odd: bool) -> Self {
        Self {
            position: Vec3::ZERO,
            known: false,
            odd,
            origin,
            corner: NONE,
            child: NONE,
            point,
            sharpness,
        }
    }
}

impl Edge {
    pub fn new(ends: [u32; 2], parent: u32, sharpness: f32, open: bool) -> Self {
        Self {
            ends,
            corners: [NONE; 2],
            parent,
            point: NONE,
            halves: NONE,
            sharpness,
            open,
            seam: false,
        }
    }
}

impl Face {
    pub fn new(parent: u32, place: u64) -> Self {
        Self {
            parent,
            children: NONE,
            place,
        }
    }
}

impl Tier {
    pub const fn quads() -> Self {
        Self {
            vertices: Vec::new(),
            edges: Vec::new(),
            faces: Vec::new(),
            corners: Vec::new(),
            corner_edges: Vec::new(),
            wedges: Vec::new(),
            face_shapes: Vec::new(),
            edge_shapes: Vec::new(),
            face_stamps: Vec::new(),
            edge_stamps: Vec::new(),
            cage: None,
        }
    }

    fn of_level(level: &Level) -> Self {
        let edge = |e: u32| {
            let open = level.edge_corners(e).len() == 1;
            let mut edge = Edge::new(level.edge(e), NONE, level.edge_sharpness(e), open);
            for (to, &c) in edge.corners.iter_mut().zip(level.edge_corners(e)) {
                *to = c;
            }
            edge
        };
        let vertex = |v: u32| Vertex {
            corner: level.vertex_corners(v).first().copied().unwrap_or(NONE),
            ..Vertex::new(
                Origin::Cage,
                v,
                level.vertex_sharpness(v),
                level.odd_vertices[v as usize],
            )
        };
        Self {
            vertices: (0..level.vertex_count() as u32).map(vertex).collect(),
            edges: (0..level.edge_count() as u32).map(edge).collect(),
            faces: (0..level.faces().count() as u64)
                .map(|f| Face::new(NONE, f))
                .collect(),
            corners: level.corners().to_vec(),
            corner_edges: level.corner_edges().to_vec(),
            wedges: vec![NONE; level.corners().len()],
            face_shapes: Vec::new(),
            edge_shapes: Vec::new(),
            face_stamps: new_stamps(level.faces().count()),
            edge_stamps: new_stamps(level.edge_count()),
            cage: Some(level.faces().clone()),
        }
    }

    /// The corners of a face.
    pub fn corners_of(&self, face: u32) -> std::ops::Range<u32> {
        match &self.cage {
            Some(cage) => {
                let range = cage.corners(face as usize);
                range.start as u32..range.end as u32
            }
            None => 4 * face..4 * face + 4,
        }
    }

    pub fn face_of(&self, corner: u32) -> u32 {
        match &self.cage {
            Some(cage) => cage.of_corner(corner),
            None => corner / 4,
        }
    }

    pub fn next(&self, corner: u32) -> u32 {
        match &self.cage {
            Some(cage) => cage.next(corner),
            None => corner & !3 | (corner + 1) & 3,
        }
    }

    pub fn previous(&self, corner: u32) -> u32 {
        match &self.cage {
            Some(cage) => cage.previous(corner),
            None => corner & !3 | (corner + 3) & 3,
        }
    }

    /// The child face at a corner whose face has children.
    pub fn child(&self, corner: u32) -> u32 {
        let face = self.face_of(corner);
        self.faces[face as usize].children + corner - self.corners_of(face).start
    }

    /// Where the face of a corner is.
    pub fn place(&self, corner: u32) -> u64 {
        self.faces[self.face_of(corner) as usize].place
    }
}

fn new_stamps(count: usize) -> Vec<Stamps> {
    (0..count).map(|_| Stamps::default()).collect()
}

/// Refuses edges that faces do not meet at in pairs.
fn check_edges(level: &Level) -> Result<()> {
    let Some(odd) = level.odd_edges.iter().position(|&odd| odd) else {
        return Ok(());
    };
    let e = odd as u32;
    let ([a, b], corners) = (level.edge(e), level.edge_corners(e));
    let face = |i: usize| level.faces().of_corner(corners[i]) as usize;
    Err(match corners.len() {
        0 | 1 => Error::DegenerateFace { face: face(0) },
        2 => Error::InconsistentEdge {
            a,
            b,
            first: face(0),
            second: face(1),
        },
        faces => Error::NonManifoldEdge { a, b, faces },
    })
}
