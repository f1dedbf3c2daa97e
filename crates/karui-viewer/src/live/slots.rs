//! What a page draws, place by place, and how to tell it what has changed there.

use super::frame::Frame;

/// The places as the page has them; each holds `W` numbers.
#[derive(Debug, Clone)]
pub(crate) struct Slots<const W: usize> {
    held: Vec<[u32; W]>,
}

/// Writes runs of changed slots.
pub(crate) struct Runs<'a, const W: usize> {
    slots: &'a mut Slots<W>,
    changed: Vec<u32>,
}

impl<const W: usize> Slots<W> {
    pub fn new() -> Self {
        Self { held: Vec::new() }
    }

    /// There are `len` slots now; those beyond hold nothing that anyone knows.
    pub fn resize(&mut self, len: usize) -> Runs<'_, W> {
        self.held.resize(len, [u32::MAX; W]);
        Runs {
            slots: self,
            changed: Vec::new(),
        }
    }
}

impl<const W: usize> Runs<'_, W> {
    /// Slot `at` holds this now. Slots come in ascending order.
    #[inline]
    pub fn set(&mut self, at: usize, value: [u32; W]) {
        if self.slots.held[at] != value {
            self.slots.held[at] = value;
            self.changed.push(at as u32);
        }
    }

    /// Runs of what has changed: the slots passed over since the last run and the length,
    /// then every number as a step from the one before.
    pub fn write(self, frame: &mut Frame) {
        let held = &self.slots.held;
        frame.slots = held.len() as u32;
        let (mut next, mut last) = (0, 0);
        for run in self.changed.chunk_by(|a, b| a + 1 == *b) {
            frame.number(run[0] - next);
            frame.number(run.len() as u32);
            frame.runs += 1;
            next = run[0] + run.len() as u32;
            for &number in run.iter().flat_map(|&slot| &held[slot as usize]) {
                frame.step(last, number);
                last = number;
            }
        }
    }
}
