//! Vertices that come back glide to their places instead of popping up
//! (geomorphs: H. Hoppe, Progressive Meshes, 1996).

use super::Cut;

/// The vertices of one [`Cut`] that are on their way.
#[derive(Debug, Clone)]
pub struct Gliding {
    frames: u32,
    moving: Vec<Moving>,
}

/// A vertex on its way: it is drawn at `from + weight * (own - from)`, where `from`
/// and `own` are the positions of the two vertices.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Glide {
    /// The vertex.
    pub vertex: u32,
    /// The vertex that it was part of.
    pub from: u32,
    /// 0 to 1; 1 is its own place, and not listed any more.
    pub weight: f32,
}

#[derive(Debug, Clone, Copy)]
struct Moving {
    node: u32,
    vertex: u32,
    from: u32,
    age: u32,
}

impl Gliding {
    /// A vertex arrives after so many frames; 1 or 0: at once.
    #[must_use]
    pub fn over(frames: u32) -> Self {
        Self {
            frames: frames.max(1),
            moving: Vec::new(),
        }
    }

    /// To be called after every [`Cut::refine`]: all move on by a frame, those that
    /// it has brought back start, those that it has taken away are forgotten.
    pub fn advance(&mut self, cut: &Cut<'_>) {
        let frames = self.frames;
        self.moving.retain_mut(|m| {
            m.age += 1;
            m.age < frames && cut.is_active(m.node)
        });
        let on_the_way: std::collections::HashSet<u32> =
            self.moving.iter().map(|m| m.vertex).collect();
        let started = cut.came_back().into_iter();
        let new = started.filter(|a| frames > 1 && !on_the_way.contains(&a.vertex));
        self.moving.extend(new.map(|a| Moving {
            node: a.node,
            vertex: a.vertex,
            from: a.part_of,
            age: 0,
        }));
    }

    /// All that are on their way, those that have come back first first.
    pub fn glides(&self) -> impl Iterator<Item = Glide> {
        self.moving.iter().map(|m| Glide {
            vertex: m.vertex,
            from: m.from,
            weight: m.age as f32 / self.frames as f32,
        })
    }
}
