//! A session over a graph of clusters.

use super::frame::{FLAG_COMPLETE, FLAG_TRUNCATED, Frame, Header, Kind};
use super::geometry::Geometry;
use super::request::{Order, Request};
use super::slots::Slots;
use super::vertices::Vertices;
use super::{Result, Session};
use karui::geom::{Camera, Light};
use karui::hierarchy::ViewAndLight;
use karui::hierarchy::cluster::{ClusterDag, Cut, Detail, View};
use serde::Deserialize;
use std::time::Instant;

/// Not drawn, and not sent yet.
const NONE: u32 = u32::MAX;

/// How often a threshold, in pixels at least this, is doubled at most to keep to a budget,
/// and the interval halved.
const LEAST: f32 = 1.0 / 64.0;
const DOUBLINGS: u32 = 64;
const HALVINGS: u32 = 6;

/// What is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ClusterOptions {
    /// Largest error on the screen, pixels. Default: 1.
    pub threshold: f32,
    /// Whether what is outside the picture is left out. Default: yes.
    pub frustum: bool,
    /// Whether what faces away is left out. Default: no, so that it is there when seen from
    /// elsewhere.
    pub back_facing: bool,
    /// Factor to the threshold in highlights and where light and dark part; 1, the default,
    /// turns it off.
    pub light_factor: f32,
    /// A highlight: degrees between the mirrored light and the eye. Default: 30.
    pub highlight: f64,
}

impl Default for ClusterOptions {
    fn default() -> Self {
        Self {
            threshold: 1.0,
            frustum: true,
            back_facing: false,
            light_factor: 1.0,
            highlight: 30.0,
        }
    }
}

impl ClusterOptions {
    /// Where light makes detail visible, and nowhere else.
    #[must_use]
    pub fn criteria(&self, camera: Camera, lights: Vec<Light>, size: [u32; 2]) -> ViewAndLight {
        ViewAndLight::by_light(camera, size, lights, self.highlight)
    }

    /// The view that `criteria` belong to, with another threshold.
    #[must_use]
    pub fn view<'c>(&self, criteria: &'c ViewAndLight, threshold: f32) -> View<'c> {
        let [width, height] = criteria.size.map(|side| side as f32);
        let factor = self.light_factor;
        // What is no factor is asked about, so that it is refused.
        let detail = (factor != 1.0).then_some(Detail { criteria, factor });
        View {
            height,
            aspect: width / height,
            threshold,
            frustum: self.frustum,
            backfaces: self.back_facing,
            detail,
            ..View::new(criteria.camera)
        }
    }

    /// The cut of the least threshold, no less than the own one, with at most so many
    /// triangles, and that threshold: doubled until the cut is small enough, then halved
    /// between a few times. The same view has the same cut. If even the coarsest has more
    /// triangles, that is it.
    ///
    /// # Errors
    /// As [`ClusterDag::cut`].
    pub fn cut_within<'d>(
        &self,
        dag: &'d ClusterDag,
        criteria: &ViewAndLight,
        most: Option<usize>,
    ) -> karui::Result<(Cut<'d>, f32)> {
        let most = most.unwrap_or(usize::MAX);
        let cut = |threshold: f32| dag.cut(&self.view(criteria, threshold));
        let mut low = self.threshold;
        let mut best = (cut(low)?, low);
        for _ in 0..DOUBLINGS {
            if best.0.triangle_count() <= most {
                break;
            }
            low = best.1;
            let high = (2.0 * low).max(LEAST);
            best = (cut(high)?, high);
        }
        let mut halvings = if low < best.1 { HALVINGS } else { 0 };
        while halvings > 0 && best.0.triangle_count() <= most {
            halvings -= 1;
            let middle = 0.5 * (low + best.1);
            let finer = cut(middle)?;
            match finer.triangle_count() <= most {
                true => best = (finer, middle),
                false => low = middle,
            }
        }
        Ok(best)
    }
}

/// One page's cuts of a graph of clusters.
#[derive(Debug, Clone)]
pub struct ClusterSession<'a> {
    dag: &'a ClusterDag,
    vertices: Vertices<'a>,
    slots: Slots<1>,
    order: Order,
    /// By cluster: number under which the page has it.
    number: Vec<u32>,
    sent: u32,
    /// By cluster: the slot that it is drawn in.
    place: Vec<u32>,
    /// By slot: its cluster.
    drawn: Vec<u32>,
    /// The clusters of the last cut, ascending.
    cut: Vec<u32>,
}

impl<'a> ClusterSession<'a> {
    /// Starts with nothing sent. `geometry` is that of the mesh which `dag` was built of.
    ///
    /// # Errors
    /// [`karui::Error::IndexOutOfRange`] if it has too few vertices.
    pub fn new(geometry: &'a Geometry, dag: &'a ClusterDag) -> karui::Result<Self> {
        let count = dag.clusters().len() as u32;
        let vertices = geometry.vertex_count();
        for c in 0..count {
            let last = dag.vertices_of(c).last().copied().unwrap_or(0);
            if last as usize >= vertices {
                return Err(karui::Error::IndexOutOfRange {
                    face: c as usize,
                    index: last,
                    vertices,
                });
            }
        }
        Ok(Self {
            dag,
            vertices: Vertices::new(geometry),
            slots: Slots::new(),
            order: Order::default(),
            number: vec![NONE; count as usize],
            sent: 0,
            place: vec![NONE; count as usize],
            drawn: Vec::new(),
            cut: Vec::new(),
        })
    }

    /// The clusters that were sent last, ascending.
    #[must_use]
    pub fn cut(&self) -> &[u32] {
        &self.cut
    }

    /// Puts the new clusters where the old ones were; what is left over closes the gaps from
    /// the end. How many came and went.
    fn place(&mut self, cut: &[u32]) -> [usize; 2] {
        let only = |of: &[u32], not: &[u32]| -> Vec<u32> {
            let missing = |c: &&u32| not.binary_search(c).is_err();
            of.iter().filter(missing).copied().collect()
        };
        let (came, went) = (only(cut, &self.cut), only(&self.cut, cut));
        let mut free: Vec<u32> = went.iter().map(|&c| self.place[c as usize]).collect();
        free.sort_unstable();
        went.iter().for_each(|&c| self.place[c as usize] = NONE);
        for (i, &cluster) in came.iter().enumerate() {
            match free.get(i) {
                Some(&slot) => self.drawn[slot as usize] = cluster,
                None => self.drawn.push(cluster),
            }
        }
        // From the last, so that what fills a gap is drawn.
        for &slot in free.iter().skip(came.len()).rev() {
            self.drawn.swap_remove(slot as usize);
        }
        let filled = self.drawn.iter().zip(0..);
        filled.for_each(|(&c, slot)| self.place[c as usize] = slot);
        [came.len(), went.len()]
    }

    /// The page's number of a cluster, which is sent if it was not before.
    fn define(&mut self, cluster: u32, frame: &mut Frame) -> u32 {
        let number = self.number[cluster as usize];
        if number != NONE {
            return number;
        }
        let number = self.sent;
        self.number[cluster as usize] = number;
        self.sent += 1;
        frame.definitions += 1;
        let (vertices, corners) = (self.dag.vertices_of(cluster), self.dag.corners_of(cluster));
        frame.number(cluster);
        frame.number(u32::from(self.dag.clusters()[cluster as usize].level));
        frame.number(vertices.len() as u32);
        frame.number(corners.len() as u32);
        let mut last = 0;
        for &vertex in vertices {
            let number = self.vertices.number(vertex, frame);
            frame.step(last, number);
            last = number;
        }
        frame.body.extend_from_slice(corners.as_flattened());
        number
    }

    /// Definitions first, then slots.
    fn write(&mut self, frame: &mut Frame) {
        let drawn = std::mem::take(&mut self.drawn);
        let numbers: Vec<u32> = drawn.iter().map(|&c| self.define(c, frame)).collect();
        self.drawn = drawn;
        let mut runs = self.slots.resize(numbers.len());
        for (at, &number) in numbers.iter().enumerate() {
            runs.set(at, [number]);
        }
        runs.write(frame);
    }
}

impl Session for ClusterSession<'_> {
    fn answer(&mut self, message: &str) -> Result<Vec<u8>> {
        let started = Instant::now();
        let request: Request<ClusterOptions> = Request::parse(message)?;
        self.order.check(request.seq)?;
        request.budget.resolve()?;
        let (camera, lights) = request.view()?;
        let options = request.options;
        let criteria = options.criteria(camera, lights, request.size);
        let most = request.budget.most_triangles();
        let (cut, threshold) = options.cut_within(self.dag, &criteria, most)?;
        self.order.answered(request.seq);
        let known = self.vertices.sent();
        let mut frame = Frame::default();
        let changes = self.place(cut.clusters());
        self.cut = cut.clusters().to_vec();
        self.write(&mut frame);
        let coarser = threshold > options.threshold;
        let header = Header {
            kind: Kind::Clusters,
            seq: request.seq,
            flags: FLAG_COMPLETE | if coarser { FLAG_TRUNCATED } else { 0 },
            triangles: cut.triangle_count(),
            microseconds: started.elapsed().as_micros(),
            changes,
            level: f64::from(threshold),
        };
        Ok(frame.finish(&header, known))
    }
}
