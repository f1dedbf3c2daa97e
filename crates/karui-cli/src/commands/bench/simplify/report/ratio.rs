//! Figures of ours divided by another's.

/// A quotient, and whether that is good enough.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ratio {
    pub value: f64,
    pub won: bool,
}

impl Ratio {
    /// `ours / theirs`, won up to 1. Nothing divided by nothing is 1.
    pub fn of(ours: f64, theirs: f64) -> Self {
        let value = match ours == theirs {
            true => 1.0,
            false => ours / theirs,
        };
        Self {
            value,
            won: value <= 1.0,
        }
    }

    /// Won only under a further condition.
    pub fn only_if(self, fair: bool) -> Self {
        Self {
            won: self.won && fair,
            ..self
        }
    }
}

/// A cell, bold if `bad`.
pub fn marked(text: String, bad: bool) -> String {
    match bad {
        true => format!("**{text}**"),
        false => text,
    }
}

/// A ratio as a cell, bold unless won; empty if there is nobody to compare
/// with.
pub fn cell(ratio: Option<Ratio>) -> String {
    ratio.map_or_else(String::new, |r| marked(format!("{:.2}", r.value), !r.won))
}

/// The geometric mean of those that have one.
pub fn geometric_mean(ratios: &[Ratio]) -> f64 {
    let logs = ratios
        .iter()
        .map(|r| r.value.ln())
        .filter(|l| l.is_finite());
    let logs: Vec<f64> = logs.collect();
    (logs.iter().sum::<f64>() / logs.len() as f64).exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_won_is_bold() {
        let cells = [(1.0, 2.0), (2.0, 1.0), (0.0, 0.0), (1.0, 0.0)];
        let cells = cells.map(|(a, b)| cell(Some(Ratio::of(a, b))));
        assert_eq!(cells, ["0.50", "**2.00**", "1.00", "**inf**"]);
        assert_eq!(cell(Some(Ratio::of(1.0, 2.0).only_if(false))), "**0.50**");
        assert_eq!(cell(None), "");
    }

    #[test]
    fn means_of_ratios() {
        let ratios = [0.5, 2.0, f64::INFINITY].map(|r| Ratio::of(r, 1.0));
        assert!((geometric_mean(&ratios) - 1.0).abs() < 1e-12);
    }
}
