//! What a frame draws.

/// Something to draw.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Item {
    /// The proxy of a group, by number.
    Group(u32),
    /// An object.
    Object {
        /// Number of the object.
        object: u32,
        /// Which of its levels, 0 the finest.
        level: u32,
    },
}

/// How much a frame draws.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counts {
    /// Objects drawn as such.
    pub objects: usize,
    /// Groups drawn as one.
    pub groups: usize,
    /// Triangles of both.
    pub triangles: u64,
    /// Groups and objects that were looked at.
    pub visited: usize,
}

/// What a frame draws.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct DrawList {
    /// Groups and objects, in an order that the tree and the view alone decide.
    pub items: Vec<Item>,
    /// How much that is.
    pub counts: Counts,
    /// The threshold that was kept: that of the view, or one to which a limit of
    /// triangles made it rise.
    pub threshold: f64,
    /// Whether the limit of triangles, if there is one, is kept.
    pub within_limit: bool,
}

impl DrawList {
    pub(super) fn restart(&mut self, threshold: f64) {
        self.items.clear();
        self.counts = Counts::default();
        self.threshold = threshold;
        self.within_limit = true;
    }

    pub(super) fn group(&mut self, id: u32, triangles: u32) {
        self.items.push(Item::Group(id));
        self.counts.groups += 1;
        self.counts.triangles += u64::from(triangles);
    }

    pub(super) fn object(&mut self, object: u32, (level, triangles): (u32, u32)) {
        self.items.push(Item::Object { object, level });
        self.counts.objects += 1;
        self.counts.triangles += u64::from(triangles);
    }
}
