//! A plan, its store and its model, opened together.

use super::{observer, place::Place, told};
use crate::console::Console;
use crate::failure::Failure;
use anyhow::Result;
use karui::outofcore::{self, Error, Manifest, Plan, PlanOptions, RunOptions, Source, Summary};
use karui_io::{Format, slices::PlyWriter};
use std::path::Path;

/// A plan, its store and its model.
pub struct Work {
    /// Where blocks are kept.
    pub store: Place,
    /// The model.
    pub source: Box<dyn Source + Send>,
    /// What is to be done.
    pub plan: Plan,
}

impl Work {
    /// Puts a plan for `input` into `folder`, or finds the same there.
    pub fn create(input: &Path, folder: &Path, options: PlanOptions) -> Result<Self> {
        let source = karui_io::slices::open(input)?;
        // Tasks may run elsewhere.
        let uri = std::path::absolute(input)?.display().to_string();
        let plan = Plan::new(&*source, &uri, options).map_err(told)?;
        let store = Place::create(folder)?;
        plan.save(&store).map_err(told)?;
        Ok(Self {
            store,
            source,
            plan,
        })
    }

    /// Opens the plan in `folder`.
    pub fn open(folder: &Path) -> Result<Self> {
        let store = Place::open(folder)?;
        let plan = Plan::load(&store).map_err(|error| match error {
            Error::Missing { .. } => {
                let message = format!("{} holds no plan", folder.display());
                Failure::input(message)
                    .hint("make one with `karui plan new`")
                    .into()
            }
            error => told(error),
        })?;
        let source = karui_io::slices::open(&plan.source)?;
        Ok(Self {
            store,
            source,
            plan,
        })
    }

    /// Does what is still to be done with so much memory; the last manifest.
    pub fn run(&self, memory: u64, threads: usize, console: &Console) -> Result<Manifest> {
        let observer = observer(console.quiet);
        let options = RunOptions {
            workers: self.plan.options.workers_for(memory).min(threads),
            progress: &*observer,
        };
        let done = outofcore::run(&self.store, &*self.source, &self.plan, &options);
        done.map_err(|error| self.stopped(error))
    }

    /// Writes the result.
    pub fn write(&self, last: &Manifest, output: &Path, console: &Console) -> Result<Summary> {
        let observer = observer(console.quiet);
        let mut sink = PlyWriter::create(output)?;
        let summary = outofcore::write(&self.store, last, &mut sink, &*observer);
        let summary = summary.map_err(|error| self.stopped(error))?;
        sink.finish()?;
        Ok(summary)
    }

    /// What was wrong, and that nothing done is lost.
    fn stopped(&self, error: Error) -> anyhow::Error {
        let folder = self.store.name().display();
        let hint = format!("what is done is kept; `karui plan resume {folder}` goes on from there");
        match &error {
            Error::Block(karui::Error::Cancelled) => {
                Failure::cancelled("interrupted").hint(hint).into()
            }
            Error::Store { .. } => told(error).context(hint),
            _ => told(error),
        }
    }
}

/// Refuses a name that cannot be streamed to, before any work is done for it.
pub fn finish(output: &Path) -> Result<()> {
    match Format::from_path(output)? {
        Format::Ply => Ok(()),
        other => {
            let message = format!("{other} cannot be written in pieces");
            let hint = "name a .ply; `karui convert` makes other formats of one that fits memory";
            Err(Failure::input(message).hint(hint).into())
        }
    }
}
