//! Stand-ins for the tiles that are not made of objects, from the leaves up.

use super::coarse::stretch;
use super::options::HlodOptions;
use super::{Hlod, Tile, TileContent};
use crate::error::Result;
use crate::hlod::proxy::{Choice, ChooseOptions, Group, Look, Member, Objects, Proxy, choose};
use crate::progress::step;
use crate::render::Picture;
use rayon::prelude::*;

/// Makes all stand-ins; of one depth at the same time, deepest first.
pub(super) fn fill(
    hlod: &mut Hlod<'_>,
    images: &[Option<Picture>],
    options: &HlodOptions<'_>,
) -> Result<()> {
    let children = children(&hlod.tiles);
    let depths = depths(&hlod.tiles);
    let mut empty: Vec<usize> = (0..hlod.tiles.len())
        .filter(|&t| matches!(hlod.tiles[t].content, TileContent::Nothing))
        .collect();
    empty.sort_by_key(|&t| (std::cmp::Reverse(depths[t]), t));
    let look = Look::of_scene(hlod.scene, images);
    let mut done = 0;
    for together in empty.chunk_by(|&a, &b| depths[a] == depths[b]) {
        // Few at a time, so that one is told how far it is.
        for some in together.chunks(8) {
            step(
                options.progress,
                "stand-ins",
                done as f32 / empty.len() as f32,
            )?;
            let stand_in = |&t: &usize| hlod.stand_in(&hlod.drawn(t, &children), &look, options);
            let made: Vec<Choice> = some.par_iter().map(stand_in).collect::<Result<_>>()?;
            for (&t, choice) in some.iter().zip(made) {
                let below = children[t].iter().map(|&c| hlod.tiles[c as usize].error);
                let least = below.fold(0.0, f64::max);
                hlod.tiles[t].take(choice.proxy, least);
            }
            done += some.len();
        }
    }
    Ok(())
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

fn depths(tiles: &[Tile]) -> Vec<u32> {
    let mut depths = vec![0; tiles.len()];
    for (t, tile) in tiles.iter().enumerate() {
        depths[t] = tile.parent.map_or(0, |p| depths[p as usize] + 1);
    }
    depths
}

impl Tile {
    /// `least` is the largest error below.
    fn take(&mut self, proxy: Option<Proxy>, least: f64) {
        match proxy {
            Some(proxy) => {
                self.error = proxy.error.max(least);
                self.triangles = proxy.triangles();
                self.content = TileContent::Proxy(Box::new(proxy));
            }
            // As if nothing stood for what has this size.
            None => self.error = self.bounds.diagonal().max(least),
        }
    }
}

impl Hlod<'_> {
    /// For all of these tiles.
    fn stand_in(
        &self,
        tiles: &[u32],
        look: &Look<'_>,
        options: &HlodOptions<'_>,
    ) -> Result<Choice> {
        let proxies = self.proxies(tiles);
        let pictures: Vec<_> = proxies.iter().map(|p| p.pictures()).collect();
        let looks = proxies.iter().zip(&pictures);
        let looks: Vec<Look<'_>> = looks.map(|(p, i)| Look::of_scene(&p.scene, i)).collect();
        let mut members: Vec<Member<'_>> = proxies
            .iter()
            .zip(&looks)
            .map(|(proxy, look)| proxy.member(look))
            .collect();
        members.extend(self.objects_in(tiles).map(|o| self.member(o, look)));
        let group = Group::new(&members)?;
        let most = options.stand_in.min(group.triangles() / 2);
        let bounded = ChooseOptions {
            triangles: Some(most),
            ..options.choose
        };
        choose(&group, &bounded)
    }

    /// The nearest tiles below one in which something is drawn.
    fn drawn(&self, tile: usize, children: &[Vec<u32>]) -> Vec<u32> {
        let mut open: Vec<u32> = children[tile].iter().rev().copied().collect();
        let mut drawn = Vec::new();
        while let Some(t) = open.pop() {
            match self.tiles[t as usize].content {
                TileContent::Nothing => open.extend(children[t as usize].iter().rev()),
                _ => drawn.push(t),
            }
        }
        drawn
    }

    fn proxies(&self, tiles: &[u32]) -> Vec<&Proxy> {
        let proxy = |&t: &u32| match &self.tiles[t as usize].content {
            TileContent::Proxy(proxy) => Some(&**proxy),
            _ => None,
        };
        tiles.iter().filter_map(proxy).collect()
    }

    fn objects_in(&self, tiles: &[u32]) -> impl Iterator<Item = u32> {
        let objects = |&t: &u32| match &self.tiles[t as usize].content {
            TileContent::Objects(objects) | TileContent::Coarse(objects) => objects.as_slice(),
            _ => &[],
        };
        tiles.iter().flat_map(objects).copied()
    }

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
