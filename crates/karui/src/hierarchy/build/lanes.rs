//! How much the faces around a vertex turn when it moves to a neighbour, four
//! faces at a time.

use glam::{DVec3, Vec3};

const WIDTH: usize = 4;

type Lane = [f32; WIDTH];

/// Four faces: two corners, seen from the third, and the unit normal.
#[derive(Debug, Clone, Copy, Default)]
struct Four {
    a: [Lane; 3],
    b: [Lane; 3],
    normal: [Lane; 3],
    /// What each turned by, last time.
    turn: Lane,
}

/// The faces around a vertex.
#[derive(Debug, Default)]
pub(super) struct Lanes {
    fours: Vec<Four>,
    faces: usize,
}

/// Whether face `f` of those around has the `to`th point as a corner.
#[inline]
pub(super) fn is_hidden(f: usize, to: usize, faces: usize, closed: bool) -> bool {
    f == to || f + 1 == to || (closed && to == 0 && f + 1 == faces)
}

impl Lanes {
    /// Takes the points around, seen from the vertex, in units of `1 / scale`; the
    /// last closes the ring.
    pub fn fill(&mut self, places: &[DVec3], scale: f64) {
        self.faces = places.len().saturating_sub(1);
        self.fours.clear();
        self.fours
            .resize(self.faces.div_ceil(WIDTH), Four::default());
        for (f, pair) in places.windows(2).enumerate() {
            let [a, b] = [pair[0], pair[1]].map(|p| (p * scale).as_vec3());
            let four = &mut self.fours[f / WIDTH];
            let normal = unit(a.cross(b));
            for axis in 0..3 {
                four.a[axis][f % WIDTH] = a[axis];
                four.b[axis][f % WIDTH] = b[axis];
                four.normal[axis][f % WIDTH] = normal[axis];
            }
        }
    }

    /// `2/k` times the sum of `1 - cos` over the angles by which the `k` faces
    /// turn that stay when the vertex moves to the `to`th point; nothing if one
    /// turns by a right angle or more. For unit vectors `2 (1 - cos)` is their
    /// squared distance, in which small angles do not cancel.
    pub fn flatness(&mut self, to: usize, closed: bool) -> Option<f32> {
        let (four, lane) = match to < self.faces {
            true => (&self.fours[to / WIDTH].a, to % WIDTH),
            false => (&self.fours.last()?.b, (self.faces - 1) % WIDTH),
        };
        let place = [four[0][lane], four[1][lane], four[2][lane]];
        self.fours.iter_mut().for_each(|four| four.turn_to(place));
        let (mut sum, mut changed) = (0.0, 0u32);
        for f in (0..self.faces).filter(|&f| !is_hidden(f, to, self.faces, closed)) {
            let turn = self.fours[f / WIDTH].turn[f % WIDTH];
            // Not a number where the face has no area left.
            if turn.is_nan() || turn >= 2.0 {
                return None;
            }
            sum += turn;
            changed += 1;
        }
        Some(if changed == 0 {
            0.0
        } else {
            sum / changed as f32
        })
    }
}

/// Not `normalize_or_zero`: that is zero for short vectors, too.
fn unit(v: Vec3) -> Vec3 {
    let length = v.length();
    if length > 0.0 { v / length } else { Vec3::ZERO }
}

impl Four {
    #[inline]
    fn turn_to(&mut self, place: [f32; 3]) {
        let ([ax, ay, az], [bx, by, bz]) = (&self.a, &self.b);
        let [nx, ny, nz] = &self.normal;
        for i in 0..WIDTH {
            let u = [ax[i] - place[0], ay[i] - place[1], az[i] - place[2]];
            let v = [bx[i] - place[0], by[i] - place[1], bz[i] - place[2]];
            let n = [
                u[1] * v[2] - u[2] * v[1],
                u[2] * v[0] - u[0] * v[2],
                u[0] * v[1] - u[1] * v[0],
            ];
            let by_length = 1.0 / (n[0] * n[0] + n[1] * n[1] + n[2] * n[2]).sqrt();
            let d = [
                n[0] * by_length - nx[i],
                n[1] * by_length - ny[i],
                n[2] * by_length - nz[i],
            ];
            self.turn[i] = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        }
    }
}
