//! Tests 6 and 7: what lights make visible.

use super::travel::{Answer, Sight, Vantage};
use super::view::{Facing, Seen, facing, not_finite, of_degrees, sum};
use crate::error::Result;
use crate::geom::{DVec3, Light};
use crate::hierarchy::node::Bounds;

/// All lights and what is asked of each.
#[derive(Debug, Clone)]
pub(super) struct LightTests {
    lamps: Vec<Lamp>,
    /// Least sine of what is seen at which test 6 keeps; none if it never does.
    silhouette: Option<f64>,
    /// Sine and cosine of rho; none if test 7 is off.
    highlight: Option<[f64; 2]>,
    /// Least sine of what is seen at which test 7 keeps.
    least: f64,
    /// What a light's turn by a radian counts as.
    size: f64,
}

#[derive(Debug, Clone, Copy)]
enum Lamp {
    /// Unit vector towards it.
    Far(DVec3),
    /// Where it is.
    At(DVec3),
}

impl LightTests {
    pub fn new(
        lights: &[Light],
        silhouette: Option<f64>,
        (rho, least): (f64, f64),
        size: f64,
    ) -> Result<Self> {
        let highlight = (rho > 0.0).then(|| of_degrees(rho));
        let needed = silhouette.is_some() || highlight.is_some();
        let lit = lights.iter().filter(|_| needed);
        Ok(Self {
            lamps: lit
                .filter_map(|l| lamp(l).transpose())
                .collect::<Result<_>>()?,
            silhouette,
            highlight,
            least,
            size,
        })
    }

    /// Whether any light wants a node kept, of which `sight` and `seen` tell what
    /// the eye sees.
    #[inline]
    pub fn keep(&self, bounds: &Bounds, sight: &Sight, seen: &Seen) -> Answer {
        let mut none = Answer::always(false);
        for lamp in &self.lamps {
            let answer = self.asked(lamp, bounds, sight, seen);
            if answer.yes {
                return answer;
            }
            none = none.while_holds(answer);
        }
        none
    }

    fn asked(&self, lamp: &Lamp, bounds: &Bounds, sight: &Sight, seen: &Seen) -> Answer {
        let lit = match lamp {
            Lamp::Far(toward) => Some(Sight::from_far(*toward, self.size)),
            Lamp::At(place) => Sight::from_point(bounds, *place),
        };
        // A light inside it is an eye inside it.
        let Some(lit) = lit else {
            let inside = match lamp {
                Lamp::At(place) => bounds.radius - place.distance(bounds.center),
                Lamp::Far(_) => 0.0,
            };
            return of_light(true, inside);
        };
        let turn = facing(bounds, &lit);
        let turned = of_light(false, turn.way);
        if turn.facing == Facing::Away {
            return turned;
        }
        let mut answer = turned;
        if let (Facing::Across, Some(least)) = (turn.facing, self.silhouette) {
            let large = large_enough(seen, sight, least);
            answer = answer.while_holds(large);
            if large.yes {
                return answer.and(true);
            }
        }
        let large = large_enough(seen, sight, self.least);
        answer = answer.while_holds(large);
        if !large.yes {
            return answer;
        }
        self.has_highlight(bounds, sight, &lit).while_holds(answer)
    }

    /// Test 7 for all normals in the cone: a normal that turns by an angle turns
    /// the mirrored light by twice that.
    fn has_highlight(&self, bounds: &Bounds, sight: &Sight, lit: &Sight) -> Answer {
        let (Some(rho), Some(spread)) = (self.highlight, bounds.spread) else {
            return Answer::always(self.highlight.is_some());
        };
        let mirrored = bounds.axis * (2.0 * bounds.axis.dot(lit.toward)) - lit.toward;
        let mut least = f64::INFINITY;
        let mut reach = rho;
        let mut all = false;
        for angle in [spread, spread, sight.extent, lit.extent] {
            reach = sum(reach, angle);
            // Beyond two right angles: everything is within reach.
            least = least.min(reach[0].abs());
            all = reach[0] < 0.0;
            if all {
                break;
            }
        }
        let gap = mirrored.dot(sight.toward) - reach[1];
        if !all {
            least = least.min(gap.abs());
        }
        let of_eye = sight.turn + sight.growth;
        let of_both = of_eye.max(lit.turn + lit.growth);
        Answer {
            yes: all || gap > 0.0,
            way: (least / of_eye).min(sight.way),
            with_lights: (least / of_both).min(sight.way).min(lit.way),
        }
    }

    /// Adds what the answers depend on.
    pub fn add_to(&self, vantage: &mut Vantage) {
        for lamp in &self.lamps {
            match lamp {
                Lamp::Far(toward) => vantage.directions.push(*toward),
                Lamp::At(place) => vantage.places.push(*place),
            }
            vantage
                .rest
                .push(f64::from(u8::from(matches!(lamp, Lamp::Far(_)))));
        }
        let none = -1.0;
        vantage
            .rest
            .extend([self.silhouette.unwrap_or(none), self.least]);
        vantage.rest.extend(self.highlight.unwrap_or([none; 2]));
    }
}

/// An answer that the eye has nothing to do with.
const fn of_light(yes: bool, way: f64) -> Answer {
    Answer {
        yes,
        way: f64::INFINITY,
        with_lights: way,
    }
}

/// Whether a node is seen under no less than a given sine.
#[inline]
pub(super) fn large_enough(seen: &Seen, sight: &Sight, least: f64) -> Answer {
    // Without perspective nothing ever grows.
    let gap = seen.sine - least;
    let yes = gap >= 0.0;
    Answer::of(gap, sight.growth).within(sight.way).and(yes)
}

fn lamp(light: &Light) -> Result<Option<Lamp>> {
    let (option, at) = match light {
        Light::Directional { direction, .. } => ("light.direction", direction),
        Light::Point { position, .. } => ("light.position", position),
    };
    if !at.is_finite() {
        return Err(not_finite(option, at));
    }
    let at = at.as_dvec3();
    Ok(match light {
        // A light that goes nowhere lights nothing.
        Light::Directional { .. } => at.try_normalize().map(|d| Lamp::Far(-d)),
        Light::Point { .. } => Some(Lamp::At(at)),
    })
}
