//! A tileset put to a place in a cloud.
//!
//! There is no renaming of folders there, so order has to do: the root file is put last, and when
//! a tileset is replaced, taken away first. Whoever finds a root file finds all that it names.

use super::{
    publish::{ROOT, is_ours, may_replace},
    read::read_bytes,
};
use crate::{
    Cloud,
    error::{Error, ErrorKind, Result},
};
use karui::outofcore::{self, Store as _};
use rayon::prelude::*;
use std::path::Path;

/// Folders of a tileset of ours.
const FOLDERS: [&str; 3] = ["content/", "tilesets/", "subtrees/"];

/// A tileset of which all but the root file is being put.
pub(super) struct Upload {
    cloud: Cloud,
}

impl Upload {
    /// The target, if it is a place in a cloud.
    pub fn url(target: &Path) -> Option<&str> {
        target.to_str().filter(|name| Cloud::is_url(name))
    }

    /// Starts at `url`. A tileset that is there is taken away, and so is what is left of one that
    /// was not finished.
    pub fn new(url: &str, overwrite: bool) -> Result<Self> {
        let cloud = Cloud::open(url).map_err(failed)?;
        let old = replaceable(&cloud, overwrite)?;
        cloud.remove(ROOT).map_err(failed)?;
        let gone: outofcore::Result<()> = old.par_iter().try_for_each(|name| cloud.remove(name));
        gone.map_err(failed)?;
        Ok(Self { cloud })
    }

    /// Whether a tileset may be put at `url`.
    pub fn may_write(url: &str, overwrite: bool) -> Result<()> {
        let cloud = Cloud::open(url).map_err(failed)?;
        replaceable(&cloud, overwrite).map(drop)
    }

    pub fn write(&self, name: &str, bytes: &[u8]) -> Result<()> {
        self.cloud.put(name, bytes).map_err(failed)
    }
}

/// Files of a tileset of ours, or of a part of one, that may be replaced.
fn replaceable(cloud: &Cloud, overwrite: bool) -> Result<Vec<String>> {
    let mut names = cloud.list_below().map_err(failed)?;
    let part = |name: &String| FOLDERS.iter().any(|folder| name.starts_with(folder));
    let may = if names.iter().any(|name| name == ROOT) {
        let text = cloud.get(ROOT).map_err(failed)?;
        let ours = read_bytes(&text, ROOT).is_ok_and(|tileset| is_ours(&tileset));
        may_replace(ours, overwrite)
    } else {
        // What an upload that did not come to its end has left is nobody's tileset.
        may_replace(names.iter().all(part), true)
    };
    may.map_err(|error| Error::file(cloud.url(), ErrorKind::Io(error)))?;
    names.retain(part);
    Ok(names)
}

fn failed(error: outofcore::Error) -> Error {
    Error::file("", ErrorKind::Blocks(error))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tiles::publish::{Draft, signature};
    use object_store::{ObjectStore, memory::InMemory};
    use std::sync::Arc;

    /// The same place, opened as often as wanted.
    fn place() -> impl Fn() -> Cloud {
        let bucket: Arc<dyn ObjectStore> = Arc::new(InMemory::new());
        move || Cloud::in_memory(Arc::clone(&bucket), "some/where")
    }

    fn ours() -> Vec<u8> {
        let text = serde_json::json!({
            "asset": { "version": "1.1", "extras": signature() },
            "geometricError": 1.0,
            "root": {
                "boundingVolume": { "sphere": [0, 0, 0, 1] },
                "geometricError": 0.0,
                "refine": "REPLACE",
            },
        });
        text.to_string().into_bytes()
    }

    fn told(cloud: &Cloud, overwrite: bool) -> String {
        let error = replaceable(cloud, overwrite).expect_err("refused");
        error.to_string()
    }

    #[test]
    fn only_tilesets_of_ours_are_replaced_and_only_if_asked() {
        let cloud = place()();
        assert_eq!(replaceable(&cloud, false).expect("nothing"), [""; 0]);
        cloud.put("content/0/1.glb", b"part").expect("put");
        let left = replaceable(&cloud, false).expect("a part of one");
        assert_eq!(left, ["content/0/1.glb"]);
        cloud.put(ROOT, &ours()).expect("put");
        assert!(told(&cloud, false).contains("overwriting was not asked for"));
        cloud.put("notes.txt", b"of somebody").expect("put");
        let old = replaceable(&cloud, true).expect("asked for");
        assert_eq!(old, ["content/0/1.glb"], "the rest is not ours");
        cloud.remove(ROOT).expect("removed");
        assert!(told(&cloud, true).contains("something else"));
        cloud.put(ROOT, b"{}").expect("put");
        assert!(told(&cloud, true).contains("something else"));
    }

    #[test]
    fn the_root_file_is_put_last() {
        let place = place();
        let draft = Draft::Upload(Upload { cloud: place() });
        draft.write("content/0/0.glb", b"a tile").expect("put");
        assert_eq!(place().list_below().expect("listed"), ["content/0/0.glb"]);
        drop(draft);
        assert!(!place().exists(ROOT).expect("asked"), "given up");
        let draft = Draft::Upload(Upload { cloud: place() });
        assert_eq!(draft.publish(&ours()).expect("put"), ours().len() as u64);
        assert_eq!(place().get(ROOT).expect("read"), ours());
    }

    #[test]
    fn names_below_folders_are_listed() {
        let cloud = place()();
        for name in ["b/2.glb", "b/c/3.glb", "a.json"] {
            cloud.put(name, name.as_bytes()).expect("put");
        }
        let names = cloud.list_below().expect("listed");
        assert_eq!(names, ["a.json", "b/2.glb", "b/c/3.glb"]);
        for name in names {
            assert_eq!(cloud.get(&name).expect("read"), name.as_bytes());
        }
        assert_eq!(cloud.list().expect("listed"), ["a.json"]);
    }
}
