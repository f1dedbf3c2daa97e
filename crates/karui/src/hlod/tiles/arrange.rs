//! From groups to tiles.

use super::{Hlod, Tile, TileContent};
use crate::hlod::{Bounds, Member};
use std::collections::VecDeque;

/// Tiles of all groups, parents first, none of them filled.
pub(super) fn arrange(hlod: &Hlod<'_>, most: usize) -> Vec<Tile> {
    let below = Below::new(hlod, most);
    let roots: Vec<Member> = hlod.tree.roots().collect();
    let mut tiles = Vec::new();
    let mut open = VecDeque::from([(None, roots)]);
    while let Some((parent, members)) = open.pop_front() {
        if below.triangles(&members) <= most || matches!(members[..], [Member::Object(_)]) {
            below.push_objects(&mut tiles, parent, &members);
            continue;
        }
        let tile = tiles.len() as u32;
        tiles.push(Tile {
            parent,
            bounds: below.bounds(&members),
            error: f64::INFINITY,
            refine: f64::INFINITY,
            triangles: 0,
            content: TileContent::Nothing,
        });
        let children = below.children(members);
        open.extend(children.into_iter().map(|c| (Some(tile), c)));
    }
    tiles
}

/// What is below every group.
struct Below<'a> {
    hlod: &'a Hlod<'a>,
    most: usize,
    /// By group.
    triangles: Vec<usize>,
}

impl<'a> Below<'a> {
    fn new(hlod: &'a Hlod<'a>, most: usize) -> Self {
        let mut below = Self {
            hlod,
            most,
            triangles: vec![0; hlod.tree.group_capacity()],
        };
        for group in hlod.tree.bottom_up() {
            let members = below.own(Member::Group(group));
            below.triangles[group as usize] = below.triangles(&members);
        }
        below
    }

    fn of(&self, member: Member) -> usize {
        match member {
            Member::Group(id) => self.triangles[id as usize],
            Member::Object(id) => self.hlod.triangles_of(id),
        }
    }

    fn triangles(&self, members: &[Member]) -> usize {
        members.iter().map(|&m| self.of(m)).sum()
    }

    fn bounds(&self, members: &[Member]) -> Bounds {
        let tree = &self.hlod.tree;
        let of = |&member: &Member| match member {
            Member::Group(id) => tree.group(id).map(|g| g.bounds()),
            Member::Object(id) => tree.object(id).map(|o| o.bounds),
        };
        let joined = members.iter().filter_map(of).reduce(|a, b| a.union(&b));
        joined.unwrap_or(Bounds::point(glam::DVec3::ZERO))
    }

    /// The members of the tiles below one with `members`: those with more than half of
    /// all triangles give way to their own, small ones share a tile.
    fn children(&self, members: Vec<Member>) -> Vec<Vec<Member>> {
        let half = self.triangles(&members) / 2;
        let mut open: VecDeque<Member> = members.into();
        let mut children: Vec<Vec<Member>> = Vec::new();
        let mut shared = (0, Vec::new());
        while let Some(member) = open.pop_front() {
            let triangles = self.of(member);
            match member {
                Member::Group(_) if triangles > half => {
                    let own = self.own(member);
                    own.into_iter().rev().for_each(|m| open.push_front(m));
                }
                _ if triangles > self.most => children.push(self.own(member)),
                _ => {
                    if shared.0 + triangles > self.most {
                        children.push(std::mem::take(&mut shared.1));
                        shared.0 = 0;
                    }
                    shared.0 += triangles;
                    shared.1.push(member);
                }
            }
        }
        children.extend((!shared.1.is_empty()).then_some(shared.1));
        children
    }

    /// The members of a group; an object is its own.
    fn own(&self, member: Member) -> Vec<Member> {
        match member {
            Member::Object(_) => vec![member],
            Member::Group(id) => {
                let group = self.hlod.tree.group(id);
                group.map_or(Vec::new(), |g| g.children().collect())
            }
        }
    }

    /// The objects of all members, in order.
    fn objects(&self, members: &[Member]) -> Vec<u32> {
        let tree = &self.hlod.tree;
        let of = |&member: &Member| match member {
            Member::Object(id) => vec![id],
            Member::Group(id) => tree.group(id).map_or(Vec::new(), |g| g.objects().collect()),
        };
        members.iter().flat_map(of).collect()
    }

    /// A tile of objects, below one of their coarsest levels if that has at most half of
    /// the triangles.
    fn push_objects(&self, tiles: &mut Vec<Tile>, parent: Option<u32>, members: &[Member]) {
        let objects = self.objects(members);
        let bounds = self.bounds(members);
        let own = self.triangles(members);
        let (coarse, error) = self.coarsest(&objects);
        let mut parent = parent;
        if 2 * coarse <= own {
            tiles.push(Tile {
                parent,
                bounds,
                error,
                refine: error,
                triangles: coarse,
                content: TileContent::Coarse(objects.clone()),
            });
            parent = Some(tiles.len() as u32 - 1);
        }
        tiles.push(Tile {
            parent,
            bounds,
            error: 0.0,
            refine: 0.0,
            triangles: own,
            content: TileContent::Objects(objects),
        });
    }

    /// Triangles of the coarsest levels and the largest of their errors.
    fn coarsest(&self, objects: &[u32]) -> (usize, f64) {
        objects.iter().fold((0, 0.0), |(sum, most), &o| {
            let placed = &self.hlod.objects[o as usize];
            match self.hlod.coarse_of(o) {
                Some(level) => {
                    let error = level.error * super::coarse::stretch(&placed.world_from_mesh);
                    (sum + level.mesh.triangles.len(), f64::max(most, error))
                }
                None => (sum + self.hlod.triangles_of(o), most),
            }
        })
    }
}
