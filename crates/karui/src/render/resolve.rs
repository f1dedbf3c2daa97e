//! From samples to pixels.

use super::band::{Band, triangle_of};
use super::bins::BAND;
use super::frame::{Frame, Hit};
use super::layers::{Layer, collect};
use super::options::{Outputs, RenderOptions};
use super::pass::Pass;
use super::shade::{Seen, Shader};
use super::{Picture, renderer::Renderer};
use crate::geom::Vec4;
use rayon::prelude::*;
use smallvec::SmallVec;

/// Where a band's pixels go; what is not asked for is empty.
struct Rows<'f> {
    color: &'f mut [[u8; 4]],
    depth: &'f mut [f32],
    hits: &'f mut [Hit],
}

/// What a worker needs again and again.
#[derive(Default)]
struct Scratch {
    band: Band,
    layers: Vec<Layer>,
}

pub(super) fn resolve(pass: &Pass<'_>, shader: &Shader<'_>) -> Frame {
    let options = shader.options;
    let mut frame = blank(options, shader.encoded_background());
    let rows: Vec<Rows<'_>> = split(&mut frame, options, pass.bands());
    let bands = rows.into_par_iter().enumerate();
    bands.for_each_init(Scratch::default, |scratch, (index, mut rows)| {
        scratch.band.draw(pass, shader, index);
        if options.outputs.color {
            collect(&mut scratch.layers, pass, &scratch.band, index);
        }
        rows.resolve(pass, shader, scratch);
    });
    frame
}

fn blank(options: &RenderOptions<'_>, background: [u8; 4]) -> Frame {
    let Outputs { color, depth, hits } = options.outputs;
    let (width, height) = (options.width, options.height);
    let pixels = |wanted: bool| {
        if wanted {
            width as usize * height as usize
        } else {
            0
        }
    };
    let (w, h) = if color { (width, height) } else { (0, 0) };
    Frame {
        width,
        height,
        color: Picture::filled(w, h, background),
        depth: vec![f32::INFINITY; pixels(depth)],
        hits: vec![Hit::MISS; pixels(hits)],
    }
}

fn split<'f>(frame: &'f mut Frame, options: &RenderOptions<'_>, bands: usize) -> Vec<Rows<'f>> {
    let chunk = options.width as usize * (BAND as u32 / options.samples) as usize;
    let mut color = frame.color.pixels_mut().chunks_mut(chunk);
    let mut depth = frame.depth.chunks_mut(chunk);
    let mut hits = frame.hits.chunks_mut(chunk);
    let mut next = || Rows {
        color: color.next().unwrap_or_default(),
        depth: depth.next().unwrap_or_default(),
        hits: hits.next().unwrap_or_default(),
    };
    (0..bands).map(|_| next()).collect()
}

impl Rows<'_> {
    fn resolve(&mut self, pass: &Pass<'_>, shader: &Shader<'_>, scratch: &Scratch) {
        if shader.options.samples == 1 && scratch.layers.is_empty() {
            return self.resolve_solid(pass, shader, &scratch.band);
        }
        let Scratch { band, layers } = scratch;
        let n = shader.options.samples as usize;
        let width = band.width / n;
        for y in 0..band.keys.len() / band.width / n {
            for x in 0..width {
                let slot = (y * band.width + x) * n;
                let mut rows = (0..n).map(|k| slot + k * band.width);
                let empty = |row: usize| band.keys[row..row + n].iter().all(|&key| key == 0);
                if !layers.is_empty() || !rows.all(empty) {
                    self.pixel(pass, shader, scratch, (y * width + x, slot));
                }
            }
        }
    }

    /// Pixels that are their only sample and have nothing blended over them, four by
    /// four.
    fn resolve_solid(&mut self, pass: &Pass<'_>, shader: &Shader<'_>, band: &Band) {
        let mut batch: SmallVec<[Seen; 4]> = SmallVec::new();
        let mut slots = [0; 4];
        for (row, keys) in (band.first_row..).zip(band.keys.chunks_exact(band.width)) {
            let first = (row - band.first_row) as usize * band.width;
            for (column, &key) in keys.iter().enumerate() {
                let Some(t) = triangle_of(key) else { continue };
                let (slot, seen) = (first + column, Seen::new(pass, t, column as i32, row));
                self.note(shader.renderer, slot, &seen);
                if self.color.is_empty() {
                    continue;
                }
                slots[batch.len()] = slot;
                batch.push(seen);
                if batch.len() == 4 {
                    self.write(shader, &batch, &slots);
                    batch.clear();
                }
            }
        }
        if !batch.is_empty() {
            self.write(shader, &batch, &slots);
        }
    }

    #[inline]
    fn write(&mut self, shader: &Shader<'_>, batch: &[Seen], slots: &[usize; 4]) {
        let colors = shader.layers(batch);
        for (color, &slot) in colors.iter().zip(&slots[..batch.len()]) {
            self.color[slot] = shader.encoded(*color);
        }
    }

    /// Pixel `i` of the band, whose first sample is at `slot`.
    fn pixel(
        &mut self,
        pass: &Pass<'_>,
        shader: &Shader<'_>,
        Scratch { band, layers }: &Scratch,
        (i, slot): (usize, usize),
    ) {
        let n = shader.options.samples as usize;
        let (left, top) = band.place_of(slot);
        let middle = (n - 1) / 2;
        let mut sum = Vec4::ZERO;
        let mut solid: SmallVec<[Seen; 4]> = SmallVec::new();
        for (r, c) in (0..n).flat_map(|r| (0..n).map(move |c| (r, c))) {
            let slot = slot + r * band.width + c;
            let at = |t: u32| Seen::new(pass, t, left + c as i32, top + r as i32);
            let seen = triangle_of(band.keys[slot]).map(at);
            if let Some(seen) = seen.as_ref().filter(|_| (r, c) == (middle, middle)) {
                self.note(shader.renderer, i, seen);
            }
            if self.color.is_empty() {
                continue;
            }
            let over: SmallVec<[Seen; 4]> = layers_at(layers, slot).map(at).collect();
            match seen {
                Some(seen) if over.is_empty() => solid.push(seen),
                seen => sum += shader.blended(&over, seen.as_ref()),
            }
        }
        for batch in solid.chunks(4) {
            let colors = shader.layers(batch);
            sum += colors[..batch.len()].iter().sum::<Vec4>();
        }
        if let Some(pixel) = self.color.get_mut(i) {
            *pixel = shader.encoded(sum * (1.0 / (n * n) as f32));
        }
    }

    fn note(&mut self, renderer: &Renderer<'_>, i: usize, seen: &Seen) {
        if let Some(depth) = self.depth.get_mut(i) {
            *depth = seen.place.depth;
        }
        if let Some(hit) = self.hits.get_mut(i) {
            *hit = hit_of(renderer, seen.triangle, seen.place.weights());
        }
    }
}

/// Triangles that are blended at a sample, front to back.
#[inline]
fn layers_at(layers: &[Layer], slot: usize) -> impl Iterator<Item = u32> {
    let at = |layer: &Layer| layer.slot as usize;
    let start = layers.partition_point(|layer| at(layer) < slot);
    let here = layers[start..]
        .iter()
        .take_while(|layer| at(layer) == slot)
        .count();
    let front_to_back = layers[start..start + here].iter().rev();
    front_to_back.filter_map(|layer| triangle_of(layer.key))
}

fn hit_of(renderer: &Renderer<'_>, t: u32, [_, b, c]: [f32; 3]) -> Hit {
    let part = renderer.part_of(t);
    Hit {
        instance: part.instance,
        triangle: t - part.first_triangle + part.first_of_mesh,
        barycentric: [b, c],
    }
}
