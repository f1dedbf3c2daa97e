//! What there is to draw.

use super::super::tree::Tree;
use crate::error::{Error, Result};

/// Levels of detail of a mesh, shared by all its placements.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Levels {
    /// Distances to the eye, ascending, world units: up to the first, level 0 is
    /// drawn, from there on level 1, and so on.
    pub switch: Vec<f32>,
    /// Triangles of every level: one more than there are distances.
    pub triangles: Vec<u32>,
}

impl Levels {
    /// The level for an object this far away.
    #[must_use]
    pub fn at(&self, distance: f64) -> usize {
        let passed = |&&switch: &&f32| f64::from(switch) <= distance;
        self.switch.iter().take_while(passed).count()
    }
}

/// What there is to draw for the objects and groups of a [`Tree`].
#[derive(Debug, Clone, Copy, Default)]
pub struct Assets<'a> {
    /// Levels of detail of the meshes.
    pub levels: &'a [Levels],
    /// Which of them every object has, by number.
    pub levels_of_object: &'a [u32],
    /// Triangles of the proxy of every group, by number.
    pub proxies: &'a [u32],
}

impl Assets<'_> {
    pub(super) fn check(&self, tree: &Tree) -> Result<()> {
        let objects = self.levels_of_object.len();
        at_least("levels of objects", tree.object_capacity(), objects)?;
        at_least("proxies", tree.group_capacity(), self.proxies.len())?;
        let mut levels = self.levels.iter();
        levels.try_for_each(|levels| {
            let (expected, found) = (levels.switch.len() + 1, levels.triangles.len());
            match expected == found {
                true => Ok(()),
                false => Err(wrong_length("triangles of levels", expected, found)),
            }
        })
    }

    /// Level of an object, and its triangles.
    pub(super) fn level(&self, object: u32, distance: f64) -> Result<(u32, u32)> {
        let index = object as usize;
        let to = self.levels_of_object[index] as usize;
        let levels = self.levels.get(to).ok_or(Error::BadReference {
            what: "object",
            index,
            target: "levels",
            to,
            problem: "does not exist",
        })?;
        let level = levels.at(distance);
        Ok((level as u32, levels.triangles[level]))
    }
}

fn at_least(what: &str, expected: usize, found: usize) -> Result<()> {
    if found >= expected {
        return Ok(());
    }
    Err(wrong_length(what, expected, found))
}

fn wrong_length(what: &str, expected: usize, found: usize) -> Error {
    Error::LengthMismatch {
        what: what.into(),
        expected,
        found,
    }
}
