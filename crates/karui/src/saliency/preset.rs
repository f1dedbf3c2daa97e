//! Saliency as published, by name.

use super::{
    CurvatureOptions, Estimator, HybridOptions, ImageSaliencyOptions, MeshSaliencyOptions,
    MultiView, MultiViewOptions, Opponency, Unseen, WeightMap, curvature_sizes, curvature_with,
    hybrid, mesh_saliency, multi_view,
};
use crate::error::{Error, Result};
use crate::mesh::TriMesh;
use crate::progress::Progress;
use crate::render::Model;
use crate::simplify::Cost;
use std::str::FromStr;

/// A published way to find saliency, with the options of its paper where the defaults
/// here are others.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Preset {
    /// An's thesis: hybrid saliency of Taubin's curvature, mesh saliency with linear
    /// suppression and 614 views, a view that does not see a vertex counting as 0. The
    /// classes' thresholds, which the thesis does not give, are the defaults.
    Thesis2014,
    /// Lee, Varshney & Jacobs: mesh saliency of Taubin's curvature with squared
    /// suppression.
    Lee2005,
    /// Itti, Koch & Niebur: the mean of image saliency with colours compared as printed,
    /// over the views that see a vertex.
    Itti1998,
}

impl Preset {
    /// All there are.
    pub const ALL: [Self; 3] = [Self::Thesis2014, Self::Lee2005, Self::Itti1998];

    /// `thesis2014`, `lee2005` or `itti1998`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Thesis2014 => "thesis2014",
            Self::Lee2005 => "lee2005",
            Self::Itti1998 => "itti1998",
        }
    }

    /// What mesh saliency looks for, if it has a part.
    #[must_use]
    pub fn mesh(self) -> Option<MeshSaliencyOptions> {
        let options = match self {
            Self::Thesis2014 => MeshSaliencyOptions::thesis2014(),
            Self::Lee2005 => MeshSaliencyOptions::lee2005(),
            Self::Itti1998 => return None,
        };
        Some(MeshSaliencyOptions {
            estimator: Estimator::Taubin1995,
            ..options
        })
    }

    /// How the model is looked at, if it is: from the grid of 614.
    #[must_use]
    pub fn views(self) -> Option<MultiViewOptions> {
        let unseen = match self {
            Self::Thesis2014 => Unseen::Zero,
            Self::Itti1998 => Unseen::Ignored,
            Self::Lee2005 => return None,
        };
        let image = ImageSaliencyOptions {
            opponency: Opponency::Printed,
            ..ImageSaliencyOptions::default()
        };
        Some(MultiViewOptions {
            unseen,
            image,
            ..MultiViewOptions::default()
        })
    }

    /// From saliency to weights: the thesis multiplies costs by the saliency itself, which
    /// here is at least 0.001, so that no edge is free; Itti et al. have none, and take the
    /// default.
    #[must_use]
    pub fn weights(self) -> WeightMap {
        match self {
            Self::Thesis2014 => WeightMap::Linear {
                least: 1e-3,
                most: 1.0,
            },
            Self::Lee2005 => WeightMap::LEE2005,
            Self::Itti1998 => WeightMap::default(),
        }
    }

    /// What a collapse costs before the weight: the thesis averages quadrics (eq. 4.3), Lee
    /// et al. sum them up as Garland & Heckbert do; Itti et al. have none, and take the
    /// default.
    #[must_use]
    pub const fn cost(self) -> Cost {
        match self {
            Self::Thesis2014 => Cost::Averaged,
            Self::Lee2005 => Cost::Accumulated,
            Self::Itti1998 => Cost::Memoryless,
        }
    }

    /// Saliency of the vertices of every mesh of a model, 0 to 1; 0 for a mesh without
    /// triangles.
    ///
    /// # Errors
    /// Those of [`mesh_saliency`], [`multi_view`] and [`hybrid`].
    pub fn saliency(self, model: &Model<'_>, progress: &dyn Progress) -> Result<Vec<Vec<f32>>> {
        let views = match self.views() {
            Some(options) => multi_view(model, &options, progress)?,
            None => vec![MultiView::default(); model.meshes.len()],
        };
        let each = model.meshes.iter().zip(views);
        each.map(|(mesh, views)| self.of_mesh(mesh, views))
            .collect()
    }

    fn of_mesh(self, mesh: &TriMesh, views: MultiView) -> Result<Vec<f32>> {
        if mesh.triangles.is_empty() {
            return Ok(vec![0.0; mesh.positions.len()]);
        }
        let Some(options) = self.mesh() else {
            return Ok(views.mean);
        };
        let shape = mesh_saliency(mesh, &options)?;
        if self == Self::Lee2005 {
            return Ok(shape);
        }
        let estimator = Estimator::Taubin1995;
        let bends = curvature_sizes(&curvature_with(mesh, &CurvatureOptions { estimator })?);
        Ok(hybrid(&bends, &shape, &views, &HybridOptions::default())?.values)
    }
}

impl FromStr for Preset {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self> {
        let mut all = Self::ALL.into_iter();
        all.find(|p| p.name() == name).ok_or(Error::BadOption {
            option: "preset",
            found: name.into(),
            expected: "thesis2014, lee2005 or itti1998",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::shapes;
    use crate::progress::Silent;
    use crate::saliency::{Suppression, Views};

    #[test]
    fn names_lead_back() {
        for preset in Preset::ALL {
            assert_eq!(preset.name().parse(), Ok(preset));
        }
        assert!("taste".parse::<Preset>().is_err());
    }

    #[test]
    fn options_are_those_of_the_papers() {
        let mesh = |p: Preset| p.mesh().map(|m| (m.suppression, m.estimator));
        let taubin = Estimator::Taubin1995;
        assert_eq!(
            Preset::ALL.map(mesh),
            [
                Some((Suppression::Linear, taubin)),
                Some((Suppression::Squared, taubin)),
                None
            ]
        );
        let views = |p: Preset| p.views().map(|v| (v.views, v.unseen, v.image.opponency));
        let grid = || Views::Grid { n1: 36, n2: 36 };
        assert_eq!(
            Preset::ALL.map(views),
            [
                Some((grid(), Unseen::Zero, Opponency::Printed)),
                None,
                Some((grid(), Unseen::Ignored, Opponency::Printed))
            ]
        );
        assert_eq!(Preset::Lee2005.weights(), WeightMap::LEE2005);
    }

    #[test]
    fn lee_s_is_mesh_saliency() {
        let mesh = shapes::torus(2.0, 0.7, 24, 12);
        let found = Preset::Lee2005.saliency(&Model::of_mesh(&mesh), &Silent);
        let options = Preset::Lee2005.mesh().unwrap();
        assert_eq!(found, Ok(vec![mesh_saliency(&mesh, &options).unwrap()]));
    }
}
