#![no_main]

use karui::Silent;
use karui::subdiv::{
    Boundary, CreaseMethod, FaceVaryingRule, Scheme, SubdivOptions, SurfaceOptions, subdivide,
};
use karui_io::Format;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|input: (u8, u8, u8, &[u8])| {
    let (first, second, levels, text) = input;
    let Ok(loaded) = karui_io::read_control_bytes(Format::Obj, text, "fuzz") else {
        return;
    };
    let schemes = [
        Scheme::CatmullClark,
        Scheme::Sqrt2,
        Scheme::Sqrt3,
        Scheme::Loop,
        Scheme::Bilinear,
    ];
    let boundaries = [Boundary::None, Boundary::EdgeOnly, Boundary::EdgeAndCorner];
    let rules = [
        FaceVaryingRule::None,
        FaceVaryingRule::CornersOnly,
        FaceVaryingRule::CornersPlus1,
        FaceVaryingRule::CornersPlus2,
        FaceVaryingRule::Boundaries,
        FaceVaryingRule::All,
    ];
    let options = SubdivOptions {
        scheme: schemes[first as usize % 5],
        levels: u32::from(levels % 5),
        boundary: boundaries[first as usize / 5 % 3],
        creases: if second % 2 == 0 { CreaseMethod::Uniform } else { CreaseMethod::Chaikin },
        face_varying: rules[second as usize / 2 % 6],
        max_faces: 20_000,
        ..SubdivOptions::default()
    };
    let surface = SurfaceOptions {
        on_limit: second & 32 != 0,
        normals: second & 64 != 0,
    };
    if let Ok(made) = subdivide(&loaded.mesh, &options, surface, &Silent) {
        let vertices = made.mesh.positions.len();
        assert!(made.mesh.indices.iter().all(|&v| (v as usize) < vertices));
        // Quads across creases are cut in two.
        assert!(made.mesh.face_count() <= 2 * made.faces && made.faces <= 20_000);
    }
});
