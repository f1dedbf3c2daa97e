//! What decides whether detail is kept: the tests by view and by light.

mod light;
mod travel;
mod view;

pub use travel::{Vantage, Way};

use super::node::Bounds;
use crate::error::{Error, Result};
use crate::geom::{Aabb, Camera, Light, Projection, Vec3};
use light::{LightTests, large_enough};
use travel::Answer;
use view::{Facing, facing};

/// Something that can be asked, frame by frame, which detail to keep.
pub trait Criteria {
    /// The answer for one frame.
    type Frame: Keep;

    /// Works out what is the same for all nodes. `bounds` are those of the mesh.
    ///
    /// # Errors
    /// [`Error::BadOption`] if a camera, light or threshold is out of range.
    fn frame(&self, bounds: Aabb) -> Result<Self::Frame>;
}

/// Which detail to keep in one frame.
///
/// Both answers must grow with the bounds: what is kept within bounds must also
/// be kept within any that hold them. Then one camera gives one mesh, whatever
/// path has led to it.
pub trait Keep: Sync {
    /// Whether the vertex that a node removes is to stay.
    fn keep(&self, bounds: &Bounds) -> bool;

    /// How much of the picture is affected, square pixels; infinite if the eye
    /// is inside. Budgets keep what is largest.
    fn area(&self, bounds: &Bounds) -> f64;

    /// The same as [`Keep::keep`], and how far the vantage may go before the
    /// answer can become another, model units; 0 if that is not known. If the
    /// lights stand `still`, only the eye's way counts, else the sum of both.
    fn keep_for(&self, bounds: &Bounds, _still: bool) -> (bool, f64) {
        (self.keep(bounds), 0.0)
    }

    /// As [`Keep::keep_for`], but whether a vertex that is there may stay. What is
    /// to be kept may always stay; if more may, the mesh depends on the path, and
    /// does not change to and fro where a threshold is met.
    fn stay_for(&self, bounds: &Bounds, still: bool) -> (bool, f64) {
        self.keep_for(bounds, still)
    }

    /// What the answers depend on; `None` has every node asked every frame.
    fn vantage(&self) -> Option<Vantage> {
        None
    }
}

/// What to do where a surface turns away from the eye or from a light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Silhouette {
    /// It is as good as any other part.
    Ignored,
    /// All detail is kept whose area on the screen is at least this, square
    /// pixels; 0 keeps all, as published.
    Kept {
        /// Least area on the screen, square pixels.
        area: f64,
    },
}

/// Detail by view and by light: the seven tests of Miyamura and Imai.
///
/// They are asked in this order, and the first that knows decides:
///
/// 1. outside the picture: coarse (`frustum`);
/// 2. all normals face away from the eye: coarse (`back_facing`);
/// 3. silhouette: keep (`silhouette`);
/// 6. silhouette seen from a light, where light and dark part: keep
///    (`light_silhouette`);
/// 7. highlight: the mirrored light is less than `highlight` away from the
///    viewer: keep;
/// 4. smaller on the screen than `area`: coarse;
/// 5. normals closer together than `flatness`: coarse;
///
/// and what is left is kept. Lights come before area and flatness, so that they
/// keep what the view alone would give up, and after what cannot be seen.
///
/// Defaults: all of it seen at 1920 x 1080 pixels, no lights, `area` 25 (a square
/// of 5 pixels), `flatness` 3 degrees, silhouettes and
/// highlights (within 30 degrees) kept down to 4 square pixels.
#[derive(Debug, Clone, PartialEq)]
pub struct ViewAndLight {
    /// Where it is looked at from.
    pub camera: Camera,
    /// Width and height of the picture, pixels.
    pub size: [u32; 2],
    /// Lights; without any, tests 6 and 7 never keep.
    pub lights: Vec<Light>,
    /// Test 1.
    pub frustum: bool,
    /// Test 2.
    pub back_facing: bool,
    /// Test 3.
    pub silhouette: Silhouette,
    /// Test 4, tau: least area on the screen, square pixels, of the sphere
    /// around what a collapse touches. 0 keeps everything that is not flat.
    pub area: f64,
    /// Test 5, phi: least angle between axis and side of the cone of normals,
    /// degrees. 0 keeps all.
    pub flatness: f64,
    /// Test 6.
    pub light_silhouette: Silhouette,
    /// Test 7, rho: degrees between the mirrored direction to a light and the
    /// direction to the eye. 0 turns it off.
    pub highlight: f64,
    /// Least area on the screen, square pixels, at which test 7 keeps; 0 as
    /// published.
    pub highlight_area: f64,
    /// Detail that is there stays until it would go were its sphere larger by this
    /// factor, 1 or more, and its cone wider by a tenth of a radian for every 1
    /// beyond 1. The default is 1: none, so that the mesh does not depend on the
    /// path. [`Budget`](super::Budget)s in triangles or time do without.
    pub hysteresis: f64,
}

impl ViewAndLight {
    /// Where light makes detail visible, and nowhere else: the line between lit and dark, and
    /// highlights within `highlight` degrees ([`Self::highlight`]); for
    /// [`cluster::Detail`](super::cluster::Detail).
    #[must_use]
    pub fn by_light(camera: Camera, size: [u32; 2], lights: Vec<Light>, highlight: f64) -> Self {
        Self {
            camera,
            size,
            lights,
            area: f64::INFINITY,
            silhouette: Silhouette::Ignored,
            light_silhouette: Silhouette::Kept { area: 0.0 },
            highlight,
            highlight_area: 0.0,
            ..Self::default()
        }
    }
}

impl Default for ViewAndLight {
    fn default() -> Self {
        let least = Silhouette::Kept { area: 4.0 };
        Self {
            camera: Camera {
                eye: Vec3::Z,
                target: Vec3::ZERO,
                up: Vec3::Y,
                projection: Projection::Perspective { fov_y: 1.0 },
                near: None,
                far: None,
            },
            size: [1920, 1080],
            lights: Vec::new(),
            frustum: true,
            back_facing: true,
            silhouette: least,
            area: 25.0,
            flatness: 3.0,
            light_silhouette: least,
            highlight: 30.0,
            highlight_area: 4.0,
            hysteresis: 1.0,
        }
    }
}

/// [`ViewAndLight`], ready to be asked.
#[derive(Debug, Clone)]
pub struct Prepared {
    view: view::View,
    back_facing: bool,
    /// Sines, or radii, on the screen.
    silhouette: Option<f64>,
    least: f64,
    flat: f64,
    lights: LightTests,
    /// Factor to the radius of what is there, and sine of what its cone gains.
    larger: f64,
    wider: f64,
}

/// Sine of the angle that a cone gains for every 1 that hysteresis is beyond 1.
const HYSTERESIS_ANGLE: f64 = 0.1;

impl Criteria for ViewAndLight {
    type Frame = Prepared;

    fn frame(&self, bounds: Aabb) -> Result<Prepared> {
        let factor = self.hysteresis;
        if !(1.0..f64::INFINITY).contains(&factor) {
            return Err(Error::BadOption {
                option: "hysteresis",
                found: factor.to_string(),
                expected: "1 or more",
            });
        }
        in_range("area", self.area, f64::INFINITY)?;
        in_range("flatness", self.flatness, 90.0)?;
        in_range("highlight", self.highlight, 180.0)?;
        in_range("highlight_area", self.highlight_area, f64::INFINITY)?;
        let highlight = |view: &view::View| (self.highlight, view.sine_of(self.highlight_area));
        let view = view::View::new(&self.camera, self.size, self.frustum, bounds)?;
        let least = |name, s| match s {
            Silhouette::Ignored => Ok(None),
            Silhouette::Kept { area } => {
                in_range(name, area, f64::INFINITY).map(|()| Some(view.sine_of(area)))
            }
        };
        let of_lights = least("light_silhouette.area", self.light_silhouette)?;
        Ok(Prepared {
            larger: factor,
            wider: (HYSTERESIS_ANGLE * (factor - 1.0)).min(1.0),
            back_facing: self.back_facing,
            silhouette: least("silhouette.area", self.silhouette)?,
            least: view.sine_of(self.area),
            flat: view::of_degrees(self.flatness)[0],
            lights: LightTests::new(&self.lights, of_lights, highlight(&view), view.size)?,
            view,
        })
    }
}

impl Prepared {
    #[inline]
    fn answer(&self, bounds: &Bounds) -> Answer {
        let outside = self.view.outside(bounds);
        if outside.yes {
            return outside.and(false);
        }
        let seen = self.view.look(bounds);
        let Some(sight) = seen.sight else {
            // The eye is inside: everything can be seen from everywhere.
            let way = self.view.way_out(bounds).min(outside.way);
            return Answer::for_way(true, way);
        };
        let turn = facing(bounds, &sight);
        if turn.facing == Facing::Away && self.back_facing {
            let way = turn.way.min(outside.way);
            return Answer::for_way(false, way);
        }
        // Whatever is large and curved is kept by the last test at the latest, so
        // that no other needs to be asked.
        let large = large_enough(&seen, &sight, self.least).within(outside.way);
        let curved = bounds.spread.is_none_or(|[sine, _]| sine >= self.flat);
        if large.yes && curved {
            return large.within(turn.way_to_away);
        }
        let mut answer = large.and(false).within(turn.way);
        if let (Facing::Across, Some(least)) = (turn.facing, self.silhouette) {
            let large = large_enough(&seen, &sight, least);
            answer = answer.within(large.way);
            if large.yes {
                return answer.and(true);
            }
        }
        let lit = self.lights.keep(bounds, &sight, &seen);
        answer.while_holds(lit).and(lit.yes)
    }

    fn answer_for(&self, bounds: &Bounds, still: bool) -> (bool, f64) {
        let answer = self.answer(bounds);
        let way = match still {
            true => answer.way,
            false => answer.way.min(answer.with_lights),
        };
        // A little less, for what rounding may have added.
        (answer.yes, way * (1.0 - 1e-6))
    }

    /// Bounds as hysteresis has them.
    fn inflated(&self, bounds: &Bounds) -> Bounds {
        let gain = [self.wider, (1.0 - self.wider * self.wider).sqrt()];
        let wider = |spread| view::sum(spread, gain);
        Bounds {
            radius: bounds.radius * self.larger,
            // Beyond a right angle it is no cone any more.
            spread: bounds.spread.map(wider).filter(|s| s[1] >= 0.0),
            ..*bounds
        }
    }
}

impl Keep for Prepared {
    #[inline]
    fn keep(&self, bounds: &Bounds) -> bool {
        self.answer(bounds).yes
    }

    fn area(&self, bounds: &Bounds) -> f64 {
        self.view.area(bounds)
    }

    #[inline]
    fn keep_for(&self, bounds: &Bounds, still: bool) -> (bool, f64) {
        self.answer_for(bounds, still)
    }

    #[inline]
    fn stay_for(&self, bounds: &Bounds, still: bool) -> (bool, f64) {
        match self.larger > 1.0 {
            true => self.answer_for(&self.inflated(bounds), still),
            false => self.answer_for(bounds, still),
        }
    }

    fn vantage(&self) -> Option<Vantage> {
        let mut vantage = self.view.vantage();
        let switches = [
            f64::from(u8::from(self.back_facing)),
            self.silhouette.unwrap_or(-1.0),
            self.least,
            self.flat,
            self.larger,
        ];
        vantage.rest.extend(switches);
        self.lights.add_to(&mut vantage);
        Some(vantage)
    }
}

fn in_range(option: &'static str, value: f64, most: f64) -> Result<()> {
    if (0.0..=most).contains(&value) {
        return Ok(());
    }
    Err(Error::BadOption {
        option,
        found: value.to_string(),
        expected: "0 or more, and no more than a right angle (highlight: two)",
    })
}
