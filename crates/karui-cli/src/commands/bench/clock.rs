//! What a call costs: time on the wall, time of the processor, memory.

use serde::{Deserialize, Serialize};
use std::time::Instant;

/// What a call took.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cost {
    /// Seconds on the clock on the wall.
    pub wall: f64,
    /// Seconds of the processor, all threads of the process together.
    pub cpu: f64,
    /// Most memory that the process had, beyond what it had before, bytes.
    pub growth: Option<u64>,
}

/// Whether to look at the memory, which takes time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Watch {
    Time,
    TimeAndMemory,
}

impl Watch {
    /// Runs `work` and tells what it took.
    pub fn call<T>(self, work: impl FnOnce() -> T) -> (T, Cost) {
        let had = match self {
            Self::Time => None,
            Self::TimeAndMemory => forget_peak(),
        };
        let (cpu_before, started) = (cpu_seconds(), Instant::now());
        let done = work();
        let wall = started.elapsed().as_secs_f64();
        let cpu = match (cpu_before, cpu_seconds()) {
            (Some(before), Some(after)) => after - before,
            _ => wall,
        };
        let growth = had.and_then(|had| Some(status("VmHWM:")?.saturating_sub(had)));
        (done, Cost { wall, cpu, growth })
    }
}

/// Makes the kernel forget the most memory the process has had, and tells how
/// much it has now; `None` where that cannot be done.
fn forget_peak() -> Option<u64> {
    std::fs::write("/proc/self/clear_refs", "5").ok()?;
    status("VmRSS:")
}

/// Most memory the process has had since it was last looked at by
/// [`Watch::TimeAndMemory`], bytes.
pub fn peak_memory() -> Option<u64> {
    status("VmHWM:")
}

/// A size of the process by the Linux kernel, bytes.
fn status(key: &str) -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|l| l.starts_with(key))?;
    let kib: u64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kib * 1024)
}

/// Processor time of the process so far, where the system tells it exactly.
#[cfg(unix)]
fn cpu_seconds() -> Option<f64> {
    use nix::time::{ClockId, clock_gettime};
    let time = clock_gettime(ClockId::CLOCK_PROCESS_CPUTIME_ID).ok()?;
    Some(time.tv_sec() as f64 + time.tv_nsec() as f64 * 1e-9)
}

#[cfg(not(unix))]
fn cpu_seconds() -> Option<f64> {
    None
}

/// Median and least of several runs, seconds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    pub median: f64,
    pub least: f64,
}

impl Spread {
    /// Of at least one run; of an even number of runs the median is the lower
    /// of the two in the middle.
    pub fn of(runs: impl Iterator<Item = f64>) -> Self {
        let mut runs: Vec<f64> = runs.collect();
        runs.sort_by(f64::total_cmp);
        let at = |i: usize| runs.get(i).copied().unwrap_or(f64::NAN);
        Self {
            median: at(runs.len().saturating_sub(1) / 2),
            least: at(0),
        }
    }
}

/// What several runs of a call took.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Costs {
    pub runs: usize,
    pub wall: Spread,
    pub cpu: Spread,
    /// Of any run, bytes.
    pub growth: Option<u64>,
}

impl Costs {
    pub fn of(runs: &[Cost]) -> Self {
        Self {
            runs: runs.len(),
            growth: runs.iter().filter_map(|c| c.growth).max(),
            wall: Spread::of(runs.iter().map(|t| t.wall)),
            cpu: Spread::of(runs.iter().map(|t| t.cpu)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn median_and_least() {
        let spread = Spread::of([3.0, 1.0, 2.0].into_iter());
        assert_eq!((spread.median, spread.least), (2.0, 1.0));
        let spread = Spread::of([4.0, 1.0, 2.0, 3.0].into_iter());
        assert_eq!((spread.median, spread.least), (2.0, 1.0));
    }

    #[test]
    fn work_takes_time_of_the_processor() {
        let work = || (0..10_000_000u64).fold(0, |sum, x| std::hint::black_box(sum ^ x));
        let (_, cost) = Watch::Time.call(work);
        assert!(cost.wall > 0.0 && cost.cpu > 0.0, "{cost:?}");
        assert_eq!(cost.growth, None);
    }

    #[test]
    fn memory_that_is_free_again_counts() {
        const SIZE: usize = 64 << 20;
        let (sum, cost) = Watch::TimeAndMemory.call(|| {
            let much: Vec<u8> = std::hint::black_box(vec![1; SIZE]);
            much.iter().map(|&b| usize::from(b)).sum::<usize>()
        });
        assert_eq!(sum, SIZE);
        // Other tests may use memory at the same time.
        if let Some(growth) = cost.growth {
            assert!(growth > SIZE as u64 * 9 / 10, "{growth}");
        }
    }
}
