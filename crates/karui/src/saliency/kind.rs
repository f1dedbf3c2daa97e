//! Saliency by kind, with the defaults of this library.

use super::{
    HybridOptions, MeshSaliencyOptions, MultiView, MultiViewOptions, SMOOTHING, Views, curvature,
    curvature_sizes, hybrid, mesh_saliency_observed, multi_view, smooth,
};
use crate::error::{Error, Result};
use crate::mesh::TriMesh;
use crate::progress::{Progress, Share, step};
use crate::render::Model;
use std::str::FromStr;

/// Directions that pictures are made from.
const VIEWS: u32 = 96;

/// A way to tell what matters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// How strongly the surface bends.
    Curvature,
    /// Where it bends otherwise than around it (Lee, Varshney & Jacobs 2005).
    Mesh,
    /// What stands out in pictures from all around, textures included (Itti, Koch & Niebur
    /// 1998; mean of 96 views).
    Image,
    /// All three: at each vertex the one that has most to say (An 2014).
    Hybrid,
}

impl Kind {
    /// All there are.
    pub const ALL: [Self; 4] = [Self::Curvature, Self::Mesh, Self::Image, Self::Hybrid];

    /// `curvature`, `mesh`, `image` or `hybrid`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Curvature => "curvature",
            Self::Mesh => "mesh",
            Self::Image => "image",
            Self::Hybrid => "hybrid",
        }
    }

    /// How wide values are smoothed if nothing else is asked for, as a share of the diagonal.
    #[must_use]
    pub const fn smoothing(self) -> f64 {
        match self {
            Self::Hybrid => SMOOTHING,
            Self::Curvature | Self::Mesh | Self::Image => 0.0,
        }
    }

    /// Whether the model is drawn to find out, so that its textures count.
    #[must_use]
    pub const fn looks(self) -> bool {
        matches!(self, Self::Image | Self::Hybrid)
    }

    /// Saliency of the vertices of every mesh of a model, 0 to 1; 0 for a mesh without
    /// triangles. Smoothed over `smoothing`, a share of the diagonal, or as the kind is.
    ///
    /// # Errors
    /// Those of [`curvature`], [`mesh_saliency`](super::mesh_saliency), [`multi_view`], [`hybrid`] and [`smooth`];
    /// [`Error::Cancelled`].
    pub fn saliency(
        self,
        model: &Model<'_>,
        smoothing: Option<f64>,
        progress: &dyn Progress,
    ) -> Result<Vec<Vec<f32>>> {
        let width = smoothing.unwrap_or(self.smoothing());
        let views = match self.looks() {
            true => multi_view(model, &looks(), progress)?,
            false => vec![MultiView::default(); model.meshes.len()],
        };
        let count = model.meshes.len().max(1) as f32;
        let each = model.meshes.iter().zip(views).enumerate();
        each.map(|(i, (mesh, views))| {
            let own = Share {
                whole: progress,
                stage: "saliency",
                from: i as f32 / count,
                to: (i + 1) as f32 / count,
            };
            step(&own, "saliency", 0.0)?;
            match mesh.triangles.is_empty() {
                true => Ok(vec![0.0; mesh.positions.len()]),
                false => smooth(mesh, &self.of_mesh(mesh, views, &own)?, width),
            }
        })
        .collect()
    }

    fn of_mesh(
        self,
        mesh: &TriMesh,
        views: MultiView,
        progress: &dyn Progress,
    ) -> Result<Vec<f32>> {
        let bends = || Ok::<_, Error>(curvature_sizes(&curvature(mesh)?));
        let shape = || mesh_saliency_observed(mesh, &MeshSaliencyOptions::default(), progress);
        match self {
            Self::Curvature => bends(),
            Self::Mesh => shape(),
            Self::Image => Ok(views.mean),
            Self::Hybrid => {
                let (bends, shape) = (bends()?, shape()?);
                Ok(hybrid(&bends, &shape, &views, &HybridOptions::default())?.values)
            }
        }
    }
}

fn looks() -> MultiViewOptions {
    MultiViewOptions {
        views: Views::Fibonacci(VIEWS),
        ..MultiViewOptions::default()
    }
}

impl FromStr for Kind {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self> {
        let mut all = Self::ALL.into_iter();
        all.find(|k| k.name() == name).ok_or(Error::BadOption {
            option: "saliency",
            found: name.into(),
            expected: "curvature, mesh, image or hybrid",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::shapes;
    use crate::progress::Silent;
    use crate::saliency::mesh_saliency;
    use std::sync::Mutex;

    /// Stops once the fraction of a stage is reached.
    struct Until(&'static str, f32, Mutex<Vec<f32>>);

    impl Progress for Until {
        fn report(&self, stage: &'static str, fraction: f32) {
            if stage == self.0 {
                self.2.lock().unwrap().push(fraction);
            }
        }

        fn cancelled(&self) -> bool {
            let told = self.2.lock().unwrap();
            told.last().is_some_and(|&last| last >= self.1)
        }
    }

    #[test]
    fn a_single_mesh_can_be_stopped_on_the_way() {
        let mesh = shapes::torus(2.0, 0.7, 48, 24);
        let model = Model::of_mesh(&mesh);
        let observer = Until("saliency", 0.5, Mutex::default());
        let stopped = Kind::Mesh.saliency(&model, None, &observer);
        assert_eq!(stopped, Err(Error::Cancelled));
        let told = observer.2.lock().unwrap();
        assert!(told.len() > 3 && told.is_sorted(), "{told:?}");
    }

    #[test]
    fn names_lead_back() {
        for kind in Kind::ALL {
            assert_eq!(kind.name().parse(), Ok(kind));
        }
        assert!("taste".parse::<Kind>().is_err());
    }

    #[test]
    fn kinds_are_what_they_are_named_after() {
        let mesh = shapes::torus(2.0, 0.7, 24, 12);
        let model = Model::of_mesh(&mesh);
        let found = |kind: Kind, width| kind.saliency(&model, width, &Silent).unwrap();
        let bends = curvature_sizes(&curvature(&mesh).unwrap());
        let smoothed = smooth(&mesh, &bends, 0.1).unwrap();
        assert_eq!(found(Kind::Curvature, None), [bends]);
        assert_eq!(found(Kind::Curvature, Some(0.1)), [smoothed]);
        let shape = mesh_saliency(&mesh, &MeshSaliencyOptions::default()).unwrap();
        assert_eq!(found(Kind::Mesh, None), [shape]);
    }
}
