//! Schemes and rules by name.

use crate::choice::choice;
use karui::subdiv::{Boundary, CreaseMethod, FaceVaryingRule, Rules, Scheme, TriangleRule};
use pyo3::PyResult;

const SCHEMES: [(&str, Scheme); 5] = [
    ("catmull-clark", Scheme::CatmullClark),
    ("sqrt2", Scheme::Sqrt2),
    ("sqrt3", Scheme::Sqrt3),
    ("loop", Scheme::Loop),
    ("bilinear", Scheme::Bilinear),
];
const BOUNDARIES: [(&str, Boundary); 3] = [
    ("none", Boundary::None),
    ("edge", Boundary::EdgeOnly),
    ("corner", Boundary::EdgeAndCorner),
];
const CREASE_METHODS: [(&str, CreaseMethod); 2] = [
    ("uniform", CreaseMethod::Uniform),
    ("chaikin", CreaseMethod::Chaikin),
];
const TRIANGLE_RULES: [(&str, TriangleRule); 2] = [
    ("catmull-clark", TriangleRule::CatmullClark),
    ("smooth", TriangleRule::Smooth),
];
const UV_RULES: [(&str, FaceVaryingRule); 6] = [
    ("none", FaceVaryingRule::None),
    ("corners-only", FaceVaryingRule::CornersOnly),
    ("corners-plus1", FaceVaryingRule::CornersPlus1),
    ("corners-plus2", FaceVaryingRule::CornersPlus2),
    ("boundaries", FaceVaryingRule::Boundaries),
    ("all", FaceVaryingRule::All),
];

/// The scheme of a name.
pub fn scheme(name: &str) -> PyResult<Scheme> {
    choice("scheme", name, &SCHEMES)
}

/// Names of rules, where any are given.
#[derive(Default)]
pub struct RuleNames<'a> {
    pub boundary: Option<&'a str>,
    pub crease_method: Option<&'a str>,
    pub triangle_rule: Option<&'a str>,
    pub uv_rule: Option<&'a str>,
}

impl RuleNames<'_> {
    /// These rules, and where none is given those of the cage.
    pub fn over(&self, of_cage: Rules) -> PyResult<Rules> {
        Ok(Rules {
            boundary: rule("boundary", self.boundary, &BOUNDARIES)?.or(of_cage.boundary),
            creases: rule("crease_method", self.crease_method, &CREASE_METHODS)?
                .or(of_cage.creases),
            triangles: rule("triangle_rule", self.triangle_rule, &TRIANGLE_RULES)?
                .or(of_cage.triangles),
            face_varying: rule("uv_rule", self.uv_rule, &UV_RULES)?.or(of_cage.face_varying),
        })
    }
}

fn rule<T: Copy>(option: &str, name: Option<&str>, all: &[(&str, T)]) -> PyResult<Option<T>> {
    name.map(|name| choice(option, name, all)).transpose()
}
