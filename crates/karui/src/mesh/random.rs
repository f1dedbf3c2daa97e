//! Numbers that look random.

use glam::Vec3;

/// SplitMix64 (Steele, Lea and Flood, "Fast splittable pseudorandom number
/// generators", OOPSLA 2014).
#[derive(Debug, Clone)]
pub(super) struct Random(pub u64);

impl Random {
    /// A generator of its own for cell (`i`, `j`).
    pub fn of_cell(seed: u64, i: i64, j: i64) -> Self {
        let mut random = Self(seed);
        random.0 = random.bits() ^ i as u64;
        random.0 = random.bits() ^ j as u64;
        Self(random.bits())
    }

    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ self.0 >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ mixed >> 31
    }

    /// In 0..1.
    pub fn next(&mut self) -> f32 {
        (self.bits() >> 40) as f32 / (1u32 << 24) as f32
    }

    /// In `low..high`.
    pub fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.next()
    }

    /// Below `count`, which is not 0.
    pub fn below(&mut self, count: usize) -> usize {
        ((u128::from(self.bits()) * count as u128) >> 64) as usize
    }

    /// In the unit ball.
    pub fn in_ball(&mut self) -> Vec3 {
        loop {
            let point = Vec3::new(self.next(), self.next(), self.next()) * 2.0 - 1.0;
            if point.length_squared() <= 1.0 {
                return point;
            }
        }
    }
}
