//! A model that is shown.

use crate::file::Origin;
use crate::levels::LevelSet;
use crate::live::Prepared;
use crate::measured::Measured;
use karui::render::Picture;
use karui::{Scene, geom::Aabb};
use karui_io::{Error, Loaded};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError, RwLock};

/// A model that is shown.
#[derive(Debug)]
pub struct Model {
    /// As it was read.
    pub scene: Arc<Scene>,
    /// Size of the file.
    pub bytes: u64,
    /// What the reader passed over.
    pub warnings: Vec<String>,
    /// Where it came from.
    pub origin: Origin,
    /// Around the scene, world units.
    pub bounds: Aabb,
    levels: RwLock<Arc<LevelSet>>,
    /// How often levels were put in the place of others.
    version: AtomicUsize,
    images: OnceLock<Vec<Option<Picture>>>,
    measured: Mutex<Vec<Known>>,
    /// What live refinement works on.
    pub prepared: Prepared,
}

/// What was measured before.
#[derive(Debug)]
struct Known {
    what: Measured,
    level: usize,
    /// Of these levels and no later ones.
    levels: Arc<LevelSet>,
    values: Arc<Vec<Vec<f32>>>,
}

impl Model {
    /// Of what was read.
    ///
    /// # Errors
    /// [`karui_io::Error`] if the scene is not valid, so that no page could show it.
    pub fn new(loaded: Loaded, origin: Origin) -> Result<Self, Error> {
        let Loaded { scene, warnings } = loaded;
        let levels = Arc::new(LevelSet::of_file(&scene)?);
        // Stand-ins are levels from now on, and no part of the original.
        let scene = levels.scene(&scene, 0).unwrap_or(scene);
        Ok(Self {
            bounds: scene.bounds(),
            scene: Arc::new(scene),
            bytes: origin.bytes(),
            warnings,
            origin,
            levels: RwLock::new(levels),
            version: AtomicUsize::new(0),
            images: OnceLock::new(),
            measured: Mutex::default(),
            prepared: Prepared::default(),
        })
    }

    /// The levels there are now.
    pub fn levels(&self) -> Arc<LevelSet> {
        let levels = self.levels.read();
        Arc::clone(&levels.unwrap_or_else(PoisonError::into_inner))
    }

    /// Puts other levels in the place of those there are.
    pub fn set_levels(&self, levels: LevelSet) {
        let mut place = self.levels.write().unwrap_or_else(PoisonError::into_inner);
        *place = Arc::new(levels);
        self.version.fetch_add(1, Ordering::SeqCst);
    }

    /// A number that is another one whenever the levels are others.
    pub fn version(&self) -> usize {
        self.version.load(Ordering::SeqCst)
    }

    /// The images, decoded once.
    pub fn images(&self) -> &[Option<Picture>] {
        self.images
            .get_or_init(|| karui_io::pictures_of(&self.scene).0)
    }

    /// One value a vertex of every mesh of a level, if it was measured before.
    pub fn known(
        &self,
        what: Measured,
        level: usize,
        levels: &Arc<LevelSet>,
    ) -> Option<Arc<Vec<Vec<f32>>>> {
        let known = self.measured.lock().unwrap_or_else(PoisonError::into_inner);
        let same =
            |k: &&Known| k.what == what && k.level == level && Arc::ptr_eq(&k.levels, levels);
        known.iter().find(same).map(|k| Arc::clone(&k.values))
    }

    /// Keeps what was measured; that of levels that are gone is let go.
    pub fn learn(
        &self,
        what: Measured,
        level: usize,
        levels: &Arc<LevelSet>,
        values: Arc<Vec<Vec<f32>>>,
    ) {
        let mut known = self.measured.lock().unwrap_or_else(PoisonError::into_inner);
        known.retain(|k| Arc::ptr_eq(&k.levels, levels));
        known.push(Known {
            what,
            level,
            levels: Arc::clone(levels),
            values,
        });
    }
}
