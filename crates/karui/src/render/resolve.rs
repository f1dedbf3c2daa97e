//! From samples to pixels.

use super::band::{Band, triangle_of};
use super::bins::BAND;
use super::frame::{Frame, Hit};
use super::layers::{Layer, collect};
use super::options::{Outputs, RenderOptions};
use super::pass::Pass;
use super::shade::Shader;
use super::{Picture, renderer::Renderer};
use crate::geom::Vec4;
use rayon::prelude::*;

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
    let mut frame = blank(options);
    let rows: Vec<Rows<'_>> = split(&mut frame, options, pass.bands());
    let bands = rows.into_par_iter().enumerate();
    bands.for_each_init(Scratch::default, |scratch, (index, mut rows)| {
        scratch.band.draw(pass, shader, index);
        let outputs = options.outputs;
        if outputs.color {
            collect(&mut scratch.layers, pass, &scratch.band, index);
            rows.shade(shader, scratch);
        }
        if outputs.depth || outputs.hits {
            rows.locate(pass, shader, &scratch.band);
        }
    });
    frame
}

fn blank(options: &RenderOptions<'_>) -> Frame {
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
        color: Picture::filled(w, h, [0; 4]),
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
    fn shade(&mut self, shader: &Shader<'_>, scratch: &Scratch) {
        let n = shader.options.samples as usize;
        let Scratch { band, layers } = scratch;
        let width = band.width / n;
        let by_count = 1.0 / (n * n) as f32;
        for (i, pixel) in self.color.iter_mut().enumerate() {
            let (left, top) = (i % width * n, i / width * n);
            let mut sum = Vec4::ZERO;
            for k in 0..n * n {
                let slot = (top + k / n) * band.width + left + k % n;
                sum += sample(shader, band, layers, slot);
            }
            *pixel = shader.encoded(sum * by_count);
        }
    }

    fn locate(&mut self, pass: &Pass<'_>, shader: &Shader<'_>, band: &Band) {
        let n = shader.options.samples as usize;
        let (width, inner) = (band.width / n, (n - 1) / 2);
        let count = self.depth.len().max(self.hits.len());
        for i in 0..count {
            let (x, y) = (i % width * n + inner, i / width * n + inner);
            let Some(t) = triangle_of(band.keys[y * band.width + x]) else {
                continue;
            };
            let place = pass.place(t, x as i32, y as i32 + band.first_row);
            if let Some(depth) = self.depth.get_mut(i) {
                *depth = place.depth;
            }
            if let Some(hit) = self.hits.get_mut(i) {
                *hit = hit_of(shader.renderer, t, place.weights());
            }
        }
    }
}

#[inline]
fn sample(shader: &Shader<'_>, band: &Band, layers: &[Layer], slot: usize) -> Vec4 {
    let column = (slot % band.width) as i32;
    let row = (slot / band.width) as i32 + band.first_row;
    let solid = triangle_of(band.keys[slot]);
    if layers.is_empty() {
        return shader.color(column, row, std::iter::empty(), solid);
    }
    let start = layers.partition_point(|layer| (layer.slot as usize) < slot);
    let here = layers[start..]
        .iter()
        .take_while(|layer| layer.slot as usize == slot)
        .count();
    let front_to_back = layers[start..start + here].iter().rev();
    let triangles = front_to_back.filter_map(|layer| triangle_of(layer.key));
    shader.color(column, row, triangles, solid)
}

fn hit_of(renderer: &Renderer<'_>, t: u32, [_, b, c]: [f32; 3]) -> Hit {
    let part = renderer.part_of(t);
    Hit {
        instance: part.instance,
        triangle: t - part.first_triangle + part.first_of_mesh,
        barycentric: [b, c],
    }
}
