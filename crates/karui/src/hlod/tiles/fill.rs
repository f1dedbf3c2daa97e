//! Stand-ins for the tiles that are not made of objects, from the leaves up.

use super::coarse::stretch;
use super::options::HlodOptions;
use super::{Hlod, Tile, TileContent};
use crate::error::Result;
use crate::hlod::proxy::{
    ChooseOptions, Group, Look, Member, MergedOptions, Objects, Proxy, choose,
};
use crate::progress::step;
use crate::render::Picture;
use rayon::prelude::*;
use std::sync::{Mutex, OnceLock, PoisonError};

/// Makes all stand-ins; those of a tile's children at the same time.
pub(super) fn fill(
    hlod: &mut Hlod<'_>,
    images: &[Option<Picture>],
    options: &HlodOptions<'_>,
) -> Result<()> {
    step(options.progress, "stand-ins", 0.0)?;
    let look = Look::of_scene(hlod.scene, images);
    let filler = Filler {
        hlod,
        look: &look,
        options,
        children: children(&hlod.tiles),
        made: hlod.tiles.iter().map(|_| OnceLock::new()).collect(),
        done: Mutex::new(0),
    };
    filler.fill(0)?;
    let children = filler.children;
    let made: Vec<Option<Proxy>> = filler.made.into_iter().map(take).collect();
    for (t, proxy) in made.into_iter().enumerate().rev() {
        if matches!(hlod.tiles[t].content, TileContent::Nothing) {
            let below = children[t].iter().map(|&c| &hlod.tiles[c as usize]);
            let least = below.fold((0.0, 0.0), |(error, refine), tile| {
                (tile.error.max(error), tile.refine.max(refine))
            });
            let unseen = unseen(&hlod.tiles[t], &options.choose);
            hlod.tiles[t].take(proxy, least, unseen);
        }
    }
    Ok(())
}

/// Error on the screen, pixels, at which clients go on to the tiles below where there
/// is no bound on errors: the default of clients of 3D Tiles.
const REFINED: f64 = 16.0;

/// The error that is as long on the screen as a client allows when the tile covers as
/// much of it as stand-ins were looked at with.
fn unseen(tile: &Tile, options: &ChooseOptions<'_>) -> f64 {
    let allowed = match options.error.is_finite() {
        true => options.error,
        false => REFINED,
    };
    allowed * tile.bounds.diagonal() / f64::from(options.pixels)
}

fn take(made: OnceLock<Option<Proxy>>) -> Option<Proxy> {
    made.into_inner().flatten()
}

/// Tiles below every tile.
fn children(tiles: &[Tile]) -> Vec<Vec<u32>> {
    let mut children = vec![Vec::new(); tiles.len()];
    for (t, tile) in (0u32..).zip(tiles) {
        if let Some(parent) = tile.parent {
            children[parent as usize].push(t);
        }
    }
    children
}

impl Tile {
    /// `least` are the largest errors below, `unseen` the least that a client is told
    /// of a stand-in.
    fn take(&mut self, proxy: Option<Proxy>, least: (f64, f64), unseen: f64) {
        match proxy {
            Some(proxy) => {
                self.error = proxy.error.max(least.0);
                self.refine = self.error.max(least.1).max(unseen);
                self.triangles = proxy.triangles();
                self.content = TileContent::Proxy(Box::new(proxy));
            }
            // As if nothing stood for what has this size.
            None => {
                self.error = self.bounds.diagonal().max(least.0);
                self.refine = self.error.max(least.1);
            }
        }
    }
}

/// Stand-ins as they are made.
struct Filler<'a> {
    hlod: &'a Hlod<'a>,
    look: &'a Look<'a>,
    options: &'a HlodOptions<'a>,
    children: Vec<Vec<u32>>,
    /// By tile.
    made: Vec<OnceLock<Option<Proxy>>>,
    /// Number of tiles that are ready.
    done: Mutex<usize>,
}

impl Filler<'_> {
    /// Fills a tile after all below. A tree of tiles is not deep: a child has no more
    /// than half of the triangles.
    fn fill(&self, tile: u32) -> Result<()> {
        let below = self.children[tile as usize].par_iter();
        below.try_for_each(|&child| self.fill(child))?;
        if matches!(self.content(tile), TileContent::Nothing) {
            let made = self.stand_in(&self.drawn(tile))?;
            // Nobody else fills this tile.
            let _ = self.made[tile as usize].set(made);
        }
        let mut done = self.done.lock().unwrap_or_else(PoisonError::into_inner);
        *done += 1;
        let share = *done as f32 / self.made.len() as f32;
        step(self.options.progress, "stand-ins", share)
    }

    fn content(&self, tile: u32) -> &TileContent {
        &self.hlod.tiles[tile as usize].content
    }

    fn proxy(&self, tile: u32) -> Option<&Proxy> {
        self.made[tile as usize].get()?.as_ref()
    }

    /// For all of these tiles.
    fn stand_in(&self, tiles: &[u32]) -> Result<Option<Proxy>> {
        let proxies: Vec<&Proxy> = tiles.iter().filter_map(|&t| self.proxy(t)).collect();
        let pictures: Vec<_> = proxies.iter().map(|p| p.pictures()).collect();
        let looks = proxies.iter().zip(&pictures);
        let looks: Vec<Look<'_>> = looks.map(|(p, i)| Look::of_scene(&p.scene, i)).collect();
        let mut members: Vec<Member<'_>> = proxies
            .iter()
            .zip(&looks)
            .map(|(proxy, look)| proxy.member(look))
            .collect();
        let objects: Vec<u32> = self.objects_in(tiles).collect();
        members.extend(objects.iter().map(|&o| self.hlod.member(o, self.look)));
        let group = Group::new(&members)?;
        let most = self.options.stand_in.min(group.triangles() / 2);
        let merged = self.options.choose.merged.map(|merged| MergedOptions {
            // What is hidden in a stand-in was left out when it was made.
            drop_hidden: merged.drop_hidden && !objects.is_empty(),
            ..merged
        });
        let bounded = ChooseOptions {
            triangles: Some(most),
            merged,
            ..self.options.choose
        };
        Ok(choose(&group, &bounded)?.proxy)
    }

    /// The nearest tiles below one in which something is drawn.
    fn drawn(&self, tile: u32) -> Vec<u32> {
        let below = |t: u32| self.children[t as usize].iter().rev().copied();
        let mut open: Vec<u32> = below(tile).collect();
        let mut drawn = Vec::new();
        while let Some(t) = open.pop() {
            match self.content(t) {
                TileContent::Nothing if self.proxy(t).is_none() => open.extend(below(t)),
                _ => drawn.push(t),
            }
        }
        drawn
    }

    fn objects_in(&self, tiles: &[u32]) -> impl Iterator<Item = u32> {
        let objects = |&t: &u32| match self.content(t) {
            TileContent::Objects(objects) | TileContent::Coarse(objects) => objects.as_slice(),
            _ => &[],
        };
        tiles.iter().flat_map(objects).copied()
    }
}

impl Hlod<'_> {
    fn member<'b>(&'b self, object: u32, look: &'b Look<'b>) -> Member<'b> {
        let placed = &self.objects[object as usize];
        let coarse = self.coarse_of(object);
        let own = &self.scene.meshes[placed.mesh as usize].mesh;
        Member {
            mesh: coarse.map_or(own, |c| &c.mesh),
            world_from_mesh: placed.world_from_mesh,
            look,
            objects: Objects::One(object),
            error: coarse.map_or(0.0, |c| c.error * stretch(&placed.world_from_mesh)),
        }
    }
}
