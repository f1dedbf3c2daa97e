//! What sessions over one model share, made when the first one asks for it.

use super::Geometry;
use karui::hierarchy::cluster::{ClusterDag, ClusterDagOptions};
use karui::hierarchy::{Hierarchy, HierarchyOptions};
use karui::{Progress, Scene, TriMesh};
use std::sync::{Arc, Mutex, PoisonError};

/// What has been made of a model so far.
#[derive(Debug, Default)]
pub struct Prepared {
    mesh: Once<(TriMesh, Geometry)>,
    half_edge: Once<Hierarchy>,
    clusters: Once<ClusterDag>,
}

/// Something that is made once; who comes while it is made waits.
#[derive(Debug)]
struct Once<T>(Mutex<Option<Arc<T>>>);

impl<T> Default for Once<T> {
    fn default() -> Self {
        Self(Mutex::new(None))
    }
}

impl<T> Once<T> {
    fn get<E>(&self, make: impl FnOnce() -> Result<T, E>) -> Result<Arc<T>, E> {
        let mut made = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(made) = &*made {
            return Ok(Arc::clone(made));
        }
        let new = Arc::new(make()?);
        *made = Some(Arc::clone(&new));
        Ok(new)
    }
}

impl Prepared {
    /// The scene as one mesh, and its vertices.
    ///
    /// # Errors
    /// As [`Scene::into_single_mesh`].
    pub fn mesh(&self, scene: &Scene) -> karui::Result<Arc<(TriMesh, Geometry)>> {
        self.mesh.get(|| {
            let mesh = scene.clone().into_single_mesh()?;
            let geometry = Geometry::of(&mesh)?;
            Ok((mesh, geometry))
        })
    }

    /// The half-edge hierarchy, as coarse as can be at its root.
    ///
    /// # Errors
    /// As [`Hierarchy::build`].
    pub fn half_edge(
        &self,
        mesh: &TriMesh,
        progress: &dyn Progress,
    ) -> karui::Result<Arc<Hierarchy>> {
        let options = HierarchyOptions {
            alpha: f64::INFINITY,
            progress,
            ..HierarchyOptions::default()
        };
        self.half_edge.get(|| Hierarchy::build(mesh, &options))
    }

    /// The graph of clusters.
    ///
    /// # Errors
    /// As [`ClusterDag::build`].
    pub fn clusters(
        &self,
        mesh: &TriMesh,
        progress: &dyn Progress,
    ) -> karui::Result<Arc<ClusterDag>> {
        let options = ClusterDagOptions {
            progress,
            ..ClusterDagOptions::default()
        };
        self.clusters.get(|| ClusterDag::build(mesh, &options))
    }
}
