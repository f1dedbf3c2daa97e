#![no_main]

use karui::geom::{Aabb, Camera, Vec3};
use karui::hierarchy::cluster::{ClusterDag, View};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    for bytes in [bytes.to_vec(), sealed(bytes.to_vec())] {
        let Ok(dag) = ClusterDag::from_bytes(&bytes) else {
            continue;
        };
        dag.validate().expect("what was read holds together");
        let camera = Camera::looking_at(Aabb::EMPTY, Vec3::Z, 0.8);
        let cut = dag.cut(&View::new(camera)).expect("the view is one");
        assert_eq!(cut.triangles().len(), cut.triangle_count());
        let again = ClusterDag::from_bytes(&dag.to_bytes());
        assert_eq!(again.as_ref(), Ok(&dag));
    }
});

/// With the checksum at the end, which is hard to guess.
fn sealed(mut bytes: Vec<u8>) -> Vec<u8> {
    let mix = |sum: u64, word: u64| {
        let mixed = (sum ^ word).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        mixed ^ mixed >> 29
    };
    let (words, rest) = bytes.as_chunks::<8>();
    let words = words.iter().map(|w| u64::from_le_bytes(*w));
    let rest = rest.iter().map(|&b| u64::from(b) | 0x100);
    let sum = words.chain(rest).fold(bytes.len() as u64, mix);
    bytes.extend(sum.to_le_bytes());
    bytes
}
