//! A page without a browser: what the client makes of frames, step by step as
//! `web/src/live/surface.ts` does it.

use karui_viewer::live::{FLAG_RESET, HEADER_BYTES, Kind, MAGIC};

/// Positions by their bits, so that equal means the same.
pub type Corners = [[u32; 3]; 3];

/// What a page has.
#[derive(Debug, Default)]
pub struct Page {
    pub vertices: Vec<[u32; 3]>,
    clusters: Vec<Cluster>,
    slots: Vec<Vec<u32>>,
    kind: u32,
}

/// A cluster as it was defined.
#[derive(Debug)]
struct Cluster {
    /// Number in the graph.
    number: u32,
    triangles: Vec<[u32; 3]>,
}

struct Reader<'a> {
    bytes: &'a [u8],
}

impl Reader<'_> {
    fn number(&mut self) -> u32 {
        let mut value = 0;
        for shift in (0..32).step_by(7) {
            let (&byte, rest) = self.bytes.split_first().expect("a whole number");
            self.bytes = rest;
            value |= u32::from(byte & 0x7f) << shift;
            if byte < 0x80 {
                return value;
            }
        }
        panic!("a number of more than five bytes");
    }

    fn step(&mut self, from: u32) -> u32 {
        let folded = self.number();
        let step = (folded >> 1) as i32 ^ -((folded & 1) as i32);
        from.wrapping_add_signed(step)
    }

    fn take(&mut self, length: usize) -> &[u8] {
        let (taken, rest) = self.bytes.split_at(length);
        self.bytes = rest;
        taken
    }
}

/// Word `i` of a frame.
pub fn word(frame: &[u8], i: usize) -> u32 {
    u32::from_le_bytes(frame[4 * i..4 * i + 4].try_into().expect("four bytes"))
}

impl Page {
    /// Does what a frame says.
    pub fn apply(&mut self, frame: &[u8]) {
        assert_eq!(word(frame, 0), MAGIC);
        self.kind = word(frame, 1);
        if word(frame, 3) & FLAG_RESET != 0 {
            *self = Self {
                kind: self.kind,
                ..Self::default()
            };
        }
        assert_eq!(
            word(frame, 4) as usize,
            self.vertices.len(),
            "known vertices"
        );
        let new = word(frame, 5) as usize;
        let vertices = &frame[HEADER_BYTES..HEADER_BYTES + 12 * new];
        let number = |b: &[u8]| u32::from_le_bytes(b.try_into().expect("four bytes"));
        let vertex = |v: &[u8]| [0, 4, 8].map(|k| number(&v[k..k + 4]));
        self.vertices.extend(vertices.chunks_exact(12).map(vertex));
        let body = HEADER_BYTES + 16 * new;
        assert_eq!(frame.len(), body + word(frame, 14) as usize);
        let mut reader = Reader {
            bytes: &frame[body..],
        };
        for _ in 0..word(frame, 6) {
            self.define(&mut reader);
        }
        self.place(frame, &mut reader);
        assert!(reader.bytes.is_empty(), "nothing is left over");
        assert_eq!(self.triangles().len(), word(frame, 9) as usize);
    }

    fn define(&mut self, reader: &mut Reader<'_>) {
        let [number, _level, vertices, triangles] = [(); 4].map(|()| reader.number());
        let mut last = 0;
        let mut next = || {
            last = reader.step(last);
            last
        };
        let numbers: Vec<u32> = (0..vertices).map(|_| next()).collect();
        let corners = reader.take(3 * triangles as usize).chunks_exact(3);
        let triangle = |t: &[u8]| [0, 1, 2].map(|k| numbers[usize::from(t[k])]);
        let triangles = corners.map(triangle).collect();
        self.clusters.push(Cluster { number, triangles });
    }

    fn place(&mut self, frame: &[u8], reader: &mut Reader<'_>) {
        let width = match self.kind {
            k if k == Kind::HalfEdge as u32 => 3,
            k if k == Kind::Clusters as u32 => 1,
            _ => 4,
        };
        self.slots.resize(word(frame, 8) as usize, Vec::new());
        let (mut at, mut last) = (0, 0);
        for _ in 0..word(frame, 7) {
            at += reader.number() as usize;
            for _ in 0..reader.number() {
                let mut next = || {
                    last = reader.step(last);
                    last
                };
                self.slots[at] = (0..width).map(|_| next()).collect();
                at += 1;
            }
        }
    }

    /// Numbers of the clusters on the screen, in ascending order.
    pub fn cut(&self) -> Vec<u32> {
        let number = |slot: &Vec<u32>| self.clusters[slot[0] as usize].number;
        let mut all: Vec<u32> = self.slots.iter().map(number).collect();
        all.sort_unstable();
        all
    }

    /// The triangles on the screen, in ascending order.
    pub fn triangles(&self) -> Vec<Corners> {
        let mut all = Vec::new();
        for slot in &self.slots {
            match slot[..] {
                [a, b, c] => all.push([a, b, c]),
                [a, b, c, d] => {
                    all.push([a, b, c]);
                    // The last two are the same in a triangle.
                    all.extend((c != d).then_some([a, c, d]));
                }
                [cluster] => all.extend(&self.clusters[cluster as usize].triangles),
                _ => panic!("a slot that nothing was put into"),
            }
        }
        let places = |t: [u32; 3]| t.map(|v| self.vertices[v as usize]);
        let mut all: Vec<Corners> = all.into_iter().map(places).collect();
        all.sort_unstable();
        all
    }
}
