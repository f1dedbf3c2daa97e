//! Work that takes longer than a request.

use crate::refusal::Refusal;
use karui::Progress;
use serde::Serialize;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Jobs that are remembered.
const KEPT: usize = 64;

/// A piece of long work.
#[derive(Debug)]
pub struct Job {
    /// File it alone works on.
    file: Option<usize>,
    /// What is to be done, in words that are the same for the same work.
    what: String,
    /// Bits of an `f32`.
    fraction: AtomicU32,
    cancelled: AtomicBool,
    state: Mutex<State>,
}

#[derive(Debug, Clone)]
struct State {
    stage: &'static str,
    outcome: Option<Outcome>,
}

/// How a job ended.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// As it should.
    Done,
    /// Because it was asked to.
    Cancelled,
    /// For this reason.
    Failed(String),
}

/// What is told about a job.
#[derive(Debug, Serialize, PartialEq)]
pub struct Report {
    state: &'static str,
    /// Share of the stage that is done, 0 to 1.
    fraction: f32,
    stage: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<String>,
}

impl Job {
    fn new(file: Option<usize>, what: &str) -> Self {
        let (stage, outcome) = ("waiting", None);
        Self {
            file,
            what: what.to_owned(),
            fraction: AtomicU32::new(0),
            cancelled: AtomicBool::new(false),
            state: Mutex::new(State { stage, outcome }),
        }
    }

    /// A job that no number leads to.
    pub fn nameless() -> Self {
        Self::new(None, "")
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Whether it will end as it should, as far as one knows.
    fn goes_on(&self) -> bool {
        self.state().outcome.is_none() && !self.cancelled()
    }

    /// Ends the work at its next step.
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::SeqCst);
    }

    /// Writes down how it ended.
    pub fn end(&self, outcome: Outcome) {
        self.state().outcome = Some(outcome);
    }

    /// Writes down how its work ended, of which this came.
    pub fn end_with<T>(&self, made: &Result<T, Refusal>) {
        self.end(match made {
            Ok(_) => Outcome::Done,
            Err(_) if self.cancelled() => Outcome::Cancelled,
            Err(refusal) => Outcome::Failed(refusal.message().to_owned()),
        });
    }

    /// How it is going.
    pub fn report(&self) -> Report {
        let State { stage, outcome } = self.state().clone();
        let (state, error) = match outcome {
            None => ("running", None),
            Some(Outcome::Done) => ("done", None),
            Some(Outcome::Cancelled) => ("cancelled", None),
            Some(Outcome::Failed(why)) => ("failed", Some(why)),
        };
        Report {
            state,
            fraction: f32::from_bits(self.fraction.load(Ordering::Relaxed)),
            stage,
            error,
        }
    }
}

impl Progress for Job {
    fn report(&self, stage: &'static str, fraction: f32) {
        let bits = fraction.clamp(0.0, 1.0).to_bits();
        self.fraction.store(bits, Ordering::Relaxed);
        self.state().stage = stage;
    }

    fn cancelled(&self) -> bool {
        self.cancelled.load(Ordering::SeqCst)
    }
}

/// All jobs by their number.
#[derive(Debug, Default)]
pub struct Jobs(Mutex<Numbered>);

#[derive(Debug, Default)]
struct Numbered {
    begun: usize,
    /// The latest, in order.
    kept: Vec<(usize, Arc<Job>)>,
}

impl Numbered {
    /// Takes in a job. One that is over makes room, or the oldest if none is.
    fn add(&mut self, job: Job) -> (usize, Arc<Job>) {
        if self.kept.len() == KEPT {
            let over = self.kept.iter().position(|(_, job)| !job.goes_on());
            self.kept.remove(over.unwrap_or(0)).1.cancel();
        }
        let (id, job) = (self.begun, Arc::new(job));
        self.kept.push((id, Arc::clone(&job)));
        self.begun += 1;
        (id, job)
    }
}

impl Jobs {
    fn all(&self) -> MutexGuard<'_, Numbered> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A new job on a file, to be done by the caller; another that still works on it is told
    /// to end. The number alone if the very same work goes on already: two pages may ask.
    pub fn begin(&self, file: usize, what: &str) -> (usize, Option<Arc<Job>>) {
        let mut all = self.all();
        let same = |job: &Job| job.file == Some(file) && job.what == what && job.goes_on();
        if let Some(&(id, _)) = all.kept.iter().find(|(_, job)| same(job)) {
            return (id, None);
        }
        let of_file = all.kept.iter().filter(|(_, job)| job.file == Some(file));
        of_file.for_each(|(_, job)| job.cancel());
        let (id, job) = all.add(Job::new(Some(file), what));
        (id, Some(job))
    }

    /// A new job that only its own requests know of: it ends no other, and none ends it.
    pub fn reserve(&self) -> (usize, Arc<Job>) {
        self.all().add(Job::nameless())
    }

    /// The job of a number, if it is remembered.
    pub fn get(&self, id: usize) -> Option<Arc<Job>> {
        let all = self.all();
        let mut kept = all.kept.iter();
        kept.find(|known| known.0 == id)
            .map(|known| Arc::clone(&known.1))
    }

    /// Tells all jobs to end.
    pub fn cancel_all(&self) {
        self.all().kept.iter().for_each(|(_, job)| job.cancel());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_later_job_ends_an_earlier_one_on_the_same_file() {
        let jobs = Jobs::default();
        let begin = |file, what| {
            let (id, job) = jobs.begin(file, what);
            (id, job.unwrap())
        };
        let (_, first) = begin(0, "a");
        let (_, other) = begin(1, "a");
        let (id, second) = begin(0, "b");
        assert!(first.cancelled() && !other.cancelled() && !second.cancelled());
        assert!(Arc::ptr_eq(&jobs.get(id).unwrap(), &second));
        jobs.cancel_all();
        assert!(other.cancelled() && second.cancelled());
    }

    #[test]
    fn what_is_over_makes_room_for_what_goes_on() {
        let jobs = Jobs::default();
        let (levels, job) = jobs.begin(0, "a");
        for _ in 0..2 * KEPT {
            jobs.reserve().1.end(Outcome::Done);
        }
        assert!(!job.unwrap().cancelled() && jobs.get(levels).is_some());
        let (id, oldest) = jobs.reserve();
        for _ in 0..KEPT {
            jobs.reserve();
        }
        assert!(oldest.cancelled() && jobs.get(id).is_none());
    }

    #[test]
    fn the_same_work_is_done_once_at_a_time() {
        let jobs = Jobs::default();
        let (id, job) = jobs.begin(0, "a");
        assert!(matches!(jobs.begin(0, "a"), (same, None) if same == id));
        job.unwrap().end(Outcome::Done);
        assert!(matches!(jobs.begin(0, "a"), (other, Some(_)) if other != id));
    }

    #[test]
    fn old_jobs_are_forgotten() {
        let jobs = Jobs::default();
        let (first, job) = jobs.begin(0, "");
        let job = job.unwrap();
        (1..=KEPT).for_each(|file| drop(jobs.begin(file, "")));
        assert!(jobs.get(first).is_none() && job.cancelled());
        assert!(jobs.get(1).is_some() && jobs.get(KEPT).is_some());
        assert!(jobs.get(KEPT + 1).is_none());
    }

    #[test]
    fn a_job_tells_how_it_goes() {
        let job = Job::nameless();
        Progress::report(&job, "levels", 0.5);
        let told = job.report();
        assert_eq!(
            (told.state, told.stage, told.fraction),
            ("running", "levels", 0.5)
        );
        job.end(Outcome::Failed("why".into()));
        let told = job.report();
        assert_eq!((told.state, told.error.as_deref()), ("failed", Some("why")));
    }
}
