//! One stand-in after another, until one will do.

use super::box_proxy::{BoxOptions, box_proxy, least_error as least_of_box};
use super::choose::{Candidate, Choice, ChooseOptions};
use super::group::Group;
use super::impostor::{ImpostorOptions, impostor, least_error as least_of_cards};
use super::judge::Judge;
use super::merged::{Levels, MergedOptions};
use super::proxy::Proxy;
use crate::error::Result;
use crate::simplify::Stop;

/// What is made at once.
#[derive(Debug, Clone, Copy)]
enum Stage<'a> {
    Box(BoxOptions),
    Cards(ImpostorOptions),
    Merged(MergedOptions<'a>),
}

/// A choice on its way.
pub(super) struct Pick<'a> {
    group: &'a Group<'a>,
    options: &'a ChooseOptions<'a>,
    /// A pixel when the stand-in is switched in, world units.
    pixel: f64,
    judge: Option<Judge>,
    choice: Choice,
    /// Of those beyond the bound on the error, the one with the least.
    nearest: Option<Proxy>,
}

impl<'a> Pick<'a> {
    /// Options are checked.
    pub fn new(group: &'a Group<'a>, options: &'a ChooseOptions<'a>) -> Self {
        Self {
            group,
            options,
            pixel: group.bounds().diagonal() / f64::from(options.pixels),
            judge: None,
            choice: Choice::default(),
            nearest: None,
        }
    }

    /// Goes on until one is within tolerance and bounds.
    pub fn made(mut self) -> Result<Choice> {
        let mut later = Vec::new();
        for stage in self.stages() {
            let least = self.least_error(&stage)?;
            match self.is_within(least) {
                true => self.make(stage)?,
                false => later.push((least, stage)),
            }
            if self.choice.within {
                return Ok(self.choice);
            }
        }
        later.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (_, stage) in later {
            if self.choice.proxy.is_none() && self.nearest.is_none() {
                self.make(stage)?;
            }
        }
        self.choice.proxy = self.choice.proxy.or(self.nearest);
        Ok(self.choice)
    }

    fn stages(&self) -> Vec<Stage<'a>> {
        let pixels = self.options.pixels;
        let mut stages = Vec::new();
        stages.extend(self.options.solid.map(Stage::Box));
        if let Some(cards) = self.options.cards {
            let cards = ImpostorOptions { pixels, ..cards };
            // A level card is good for what is flat and bad for what is high.
            stages.push(Stage::Cards(ImpostorOptions {
                top: false,
                ..cards
            }));
            stages.extend(cards.top.then_some(Stage::Cards(cards)));
        }
        let merged = self.options.merged;
        stages.extend(merged.map(|m| Stage::Merged(MergedOptions { pixels, ..m })));
        stages
    }

    /// What the error cannot be less than.
    fn least_error(&self, stage: &Stage<'_>) -> Result<f64> {
        match stage {
            _ if self.options.error == f64::INFINITY => Ok(0.0),
            Stage::Box(_) => least_of_box(self.group),
            Stage::Cards(cards) => least_of_cards(self.group, cards),
            Stage::Merged(_) => Ok(0.0),
        }
    }

    fn is_within(&self, error: f64) -> bool {
        error <= self.options.error * self.pixel
    }

    fn make(&mut self, stage: Stage<'a>) -> Result<()> {
        let made = match stage {
            Stage::Box(solid) => box_proxy(self.group, &solid)?,
            Stage::Cards(cards) => impostor(self.group, &cards)?,
            Stage::Merged(joined) => return self.merge(&joined),
        };
        made.map_or(Ok(()), |proxy| self.take(proxy))
    }

    fn merge(&mut self, options: &MergedOptions<'a>) -> Result<()> {
        let mut errors = self.options.errors.to_vec();
        errors.sort_by(f64::total_cmp);
        let most = self.options.triangles;
        let mut stops: Vec<Stop> = most.map(Stop::triangles).into_iter().collect();
        stops.extend(errors.iter().map(|e| Stop::error(e * self.pixel)));
        let most = most.unwrap_or(usize::MAX);
        let mut levels = Levels::new(self.group, &stops, most, options)?;
        while let Some(proxy) = levels.pop() {
            if let Some(proxy) = proxy? {
                self.take(proxy)?;
            }
            if self.choice.within {
                break;
            }
        }
        Ok(())
    }

    /// Looks at a stand-in, if it is worth it, and keeps it if it is the best so far.
    fn take(&mut self, mut proxy: Proxy) -> Result<()> {
        let is_near = self.is_within(proxy.error);
        let is_affordable = self.is_affordable(&proxy);
        if is_near && is_affordable {
            proxy.image_error = Some(self.judge()?.flip(&proxy)?);
        }
        self.choice.candidates.push(Candidate::of(&proxy));
        let error = proxy.error;
        match proxy.image_error {
            Some(seen) if self.best().is_none_or(|best| seen < best) => {
                self.choice.within = seen <= self.options.tolerance;
                self.choice.proxy = Some(proxy);
            }
            None if is_affordable && self.nearest.as_ref().is_none_or(|n| error < n.error) => {
                self.nearest = Some(proxy);
            }
            _ => {}
        }
        Ok(())
    }

    fn best(&self) -> Option<f64> {
        self.choice.proxy.as_ref()?.image_error
    }

    /// The members are looked at once, and not before there is something to compare
    /// with.
    fn judge(&mut self) -> Result<&Judge> {
        let (pixels, views) = (self.options.pixels, self.options.views);
        let judge = match self.judge.take() {
            Some(judge) => judge,
            None => Judge::new(self.group, pixels, views)?,
        };
        Ok(self.judge.insert(judge))
    }

    fn is_affordable(&self, proxy: &Proxy) -> bool {
        let options = self.options;
        options
            .triangles
            .is_none_or(|most| proxy.triangles() <= most)
            && options.bytes.is_none_or(|most| proxy.bytes <= most)
    }
}
