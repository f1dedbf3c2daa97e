//! The log as bytes, little-endian: `KARUILOG`, the version, then
//!
//! - the mesh: vertices, triangles (`u32`), hashes of connectivity and
//!   positions (`u64`), what becomes of the normals, whether there are wedges
//!   (one byte each);
//! - a list of the triangles that took part (empty: all), as distances;
//! - the points: a list of ids by vertex (empty: the vertex itself) as
//!   differences from the vertex, and a list of corners with another id;
//! - the wedges likewise, if there are any;
//! - a list of collapses: the point that stays, as difference from that of the
//!   collapse before; the point that goes, as difference from the one that
//!   stays, times four, plus where the point comes to lie: 0 where it was, 1
//!   where the other was, 2 at the three `f32` that follow.
//!
//! Lists begin with their length. Lengths, ids and distances are LEB128,
//! differences zigzag before that. About 17 bytes a collapse.

use super::base::{Base, Ids, NONE};
use super::{Collapse, CollapseLog};
use crate::error::{Error, Result};
use crate::simplify::rounds::Place;
use crate::simplify::wedges::Normals;
use glam::Vec3;
use std::sync::Arc;

const MAGIC: [u8; 8] = *b"KARUILOG";
const VERSION: u32 = 1;

impl CollapseLog {
    /// The log as bytes, the same on every machine.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let base = &*self.base;
        let mut out = Vec::with_capacity(64 + 18 * self.len);
        out.extend(MAGIC);
        for word in [VERSION, base.vertices, base.triangles] {
            out.extend(word.to_le_bytes());
        }
        out.extend(base.connectivity.to_le_bytes());
        out.extend(base.shape.to_le_bytes());
        out.push(match base.normals {
            Normals::Kept => 0,
            Normals::Flat => 1,
            Normals::LookedUp => 2,
        });
        out.push(u8::from(base.wedge.is_some()));
        put_source(&mut out, &base.source);
        put_ids(&mut out, &base.point);
        if let Some(wedge) = &base.wedge {
            put_ids(&mut out, wedge);
        }
        put(&mut out, self.len as u64);
        let mut last = 0;
        for collapse in self.collapses() {
            put_collapse(&mut out, collapse, last);
            last = collapse.kept;
        }
        out
    }

    /// Reads what [`Self::to_bytes`] has written. Takes memory as the bytes
    /// are read, never on the word of a length.
    ///
    /// # Errors
    /// [`Error::BadLog`] with the number of the byte.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self> {
        let mut bytes = Bytes { bytes, at: 0 };
        if bytes.take()? != MAGIC {
            return Err(Error::BadLog {
                at: 0,
                problem: "it does not begin with KARUILOG",
            });
        }
        if bytes.word()? != VERSION {
            return Err(bytes.bad("the version is not 1, the only one known"));
        }
        let base = bytes.base()?;
        let points = base.point.count(base.vertices) as u32;
        let mut last = 0;
        let collapses = bytes.list(|bytes| {
            let collapse = bytes.collapse(last, points)?;
            last = collapse.kept;
            Ok(collapse)
        })?;
        if bytes.at != bytes.bytes.len() {
            return Err(bytes.bad("there are bytes left over"));
        }
        Ok(Self {
            base: Arc::new(base),
            len: collapses.len(),
            collapses: Arc::new(collapses),
        })
    }
}

/// LEB128.
pub(crate) fn put(out: &mut Vec<u8>, mut number: u64) {
    while number >= 0x80 {
        out.push(number as u8 | 0x80);
        number >>= 7;
    }
    out.push(number as u8);
}

/// The difference, small where it is small either way.
pub(crate) fn zigzag(to: u32, from: u32) -> u64 {
    let difference = i64::from(to) - i64::from(from);
    ((difference << 1) ^ (difference >> 63)) as u64
}

fn put_source(out: &mut Vec<u8>, source: &[u32]) {
    put(out, source.len() as u64);
    let mut next = 0;
    for &t in source {
        put(out, u64::from(t - next));
        next = t + 1;
    }
}

fn put_ids(out: &mut Vec<u8>, ids: &Ids) {
    put(out, ids.of_vertex.len() as u64);
    for (v, &id) in (0..).zip(&ids.of_vertex) {
        put(out, if id == NONE { 0 } else { 1 + zigzag(id, v) });
    }
    put(out, ids.other.len() as u64);
    let mut next = 0;
    for &(corner, id) in &ids.other {
        put(out, u64::from(corner - next));
        put(out, id.into());
        next = corner + 1;
    }
}

fn put_collapse(out: &mut Vec<u8>, collapse: &Collapse, last: u32) {
    put(out, zigzag(collapse.kept, last));
    let place = match collapse.place {
        Place::Kept => 0,
        Place::Removed => 1,
        Place::New(_) => 2,
    };
    put(out, zigzag(collapse.removed, collapse.kept) << 2 | place);
    if let Place::New(place) = collapse.place {
        out.extend(place.to_array().iter().flat_map(|v| v.to_le_bytes()));
    }
}

/// Bytes being read.
struct Bytes<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Bytes<'_> {
    fn bad(&self, problem: &'static str) -> Error {
        Error::BadLog {
            at: self.at,
            problem,
        }
    }

    fn take<const N: usize>(&mut self) -> Result<[u8; N]> {
        let rest = &self.bytes[self.at..];
        let taken = rest.first_chunk().ok_or(self.bad("it ends too early"))?;
        self.at += N;
        Ok(*taken)
    }

    fn word(&mut self) -> Result<u32> {
        self.take().map(u32::from_le_bytes)
    }

    fn number(&mut self) -> Result<u64> {
        let mut number = 0;
        for shift in (0..42).step_by(7) {
            let [byte] = self.take()?;
            number |= u64::from(byte & 0x7f) << shift;
            if byte < 0x80 {
                return Ok(number);
            }
        }
        Err(self.bad("a number has more than 42 bits"))
    }

    /// `start` and the number that follows, together less than `end`.
    fn below(&mut self, start: u32, end: u64) -> Result<u32> {
        let number = u64::from(start) + self.number()?;
        if number >= end.min(NONE.into()) {
            return Err(self.bad("an id is too large"));
        }
        Ok(number as u32)
    }

    /// An id that differs from `from` by what `zigzag` has made this number of.
    fn near(&self, from: u32, zigzag: u64, end: u64) -> Result<u32> {
        let difference = (zigzag >> 1) as i64 ^ -((zigzag & 1) as i64);
        let id = i64::from(from) + difference;
        if id < 0 || id as u64 >= end.min(NONE.into()) {
            return Err(self.bad("an id is out of range"));
        }
        Ok(id as u32)
    }

    fn list<T>(&mut self, mut item: impl FnMut(&mut Self) -> Result<T>) -> Result<Vec<T>> {
        let count = self.number()?;
        // No item takes less than a byte.
        if count > (self.bytes.len() - self.at) as u64 {
            return Err(self.bad("a list is longer than what is left"));
        }
        let mut list = Vec::new();
        for _ in 0..count {
            list.push(item(self)?);
        }
        Ok(list)
    }

    fn base(&mut self) -> Result<Base> {
        let (vertices, triangles) = (self.word()?, self.word()?);
        let connectivity = u64::from_le_bytes(self.take()?);
        let shape = u64::from_le_bytes(self.take()?);
        let normals = match self.take()? {
            [0] => Normals::Kept,
            [1] => Normals::Flat,
            [2] => Normals::LookedUp,
            _ => return Err(self.bad("normals are of an unknown kind")),
        };
        let has_wedges = match self.take()? {
            [has @ 0..=1] => has == 1,
            _ => return Err(self.bad("there must be wedges or none")),
        };
        let mut next = 0;
        let source = self.list(|bytes| {
            let t = bytes.below(next, triangles.into())?;
            next = t + 1;
            Ok(t)
        })?;
        let kept = match source.len() {
            0 => triangles,
            count => count as u32,
        };
        Ok(Base {
            vertices,
            triangles,
            connectivity,
            shape,
            source,
            point: self.ids(vertices, kept)?,
            wedge: has_wedges.then(|| self.ids(vertices, kept)).transpose()?,
            normals,
        })
    }

    fn ids(&mut self, vertices: u32, triangles: u32) -> Result<Ids> {
        // Every vertex may have been split off another.
        let end = 2 * u64::from(vertices) + 3 * u64::from(triangles);
        let mut v = 0;
        let of_vertex = self.list(|bytes| {
            v += 1;
            match bytes.number()? {
                0 => Ok(NONE),
                zigzag => bytes.near(v - 1, zigzag - 1, end),
            }
        })?;
        if !of_vertex.is_empty() && of_vertex.len() != vertices as usize {
            return Err(self.bad("there is not one id a vertex"));
        }
        let mut next = 0;
        let other = self.list(|bytes| {
            let corner = bytes.below(next, 3 * u64::from(triangles))?;
            next = corner + 1;
            Ok((corner, bytes.below(0, end)?))
        })?;
        let ids = Ids { of_vertex, other };
        // Tables are made of as many entries as there are ids.
        let most = 2 * u64::from(vertices) + ids.other.len() as u64;
        if ids.count(vertices) as u64 > most {
            return Err(self.bad("ids are far more than vertices"));
        }
        Ok(ids)
    }

    fn collapse(&mut self, last: u32, points: u32) -> Result<Collapse> {
        let zigzag = self.number()?;
        let kept = self.near(last, zigzag, points.into())?;
        let number = self.number()?;
        let removed = self.near(kept, number >> 2, points.into())?;
        if kept == removed {
            return Err(self.bad("a point goes into itself"));
        }
        let place = match number & 3 {
            0 => Place::Kept,
            1 => Place::Removed,
            2 => {
                let place = Vec3::new(self.float()?, self.float()?, self.float()?);
                if !place.is_finite() {
                    return Err(self.bad("a place is not finite"));
                }
                Place::New(place)
            }
            _ => return Err(self.bad("a place is of an unknown kind")),
        };
        Ok(Collapse {
            kept,
            removed,
            place,
        })
    }

    fn float(&mut self) -> Result<f32> {
        self.take().map(f32::from_le_bytes)
    }
}
