//! What a format cannot hold.

use crate::{Format, color, stl};
use karui::{
    Scene,
    mesh::{Attribute, Attributes},
};

/// What a format holds besides positions and triangles.
struct Holds {
    normals: bool,
    tangents: bool,
    uv_sets: usize,
    color_sets: usize,
    custom: bool,
    materials: bool,
    face_attribute: fn(&Attribute) -> bool,
}

/// glTF keeps all but face attributes, and tells itself of the rest.
fn holds(format: Format) -> Option<Holds> {
    let nothing = Holds {
        normals: false,
        tangents: false,
        uv_sets: 0,
        color_sets: 0,
        custom: false,
        materials: false,
        face_attribute: |_| false,
    };
    let one_set_each = Holds {
        normals: true,
        uv_sets: 1,
        color_sets: 1,
        ..nothing
    };
    Some(match format {
        Format::Obj => Holds {
            materials: true,
            ..one_set_each
        },
        Format::Off => Holds {
            face_attribute: color::is_face_color,
            ..one_set_each
        },
        Format::Ply => Holds {
            tangents: true,
            uv_sets: crate::ply::SETS,
            color_sets: crate::ply::SETS,
            custom: true,
            face_attribute: |_| true,
            ..one_set_each
        },
        Format::Stl => Holds {
            face_attribute: |a| a.name == stl::ATTRIBUTE,
            ..nothing
        },
        Format::Gltf | Format::Glb => return None,
    })
}

/// What is left out when the scene is written in the format.
pub(crate) fn lost(format: Format, scene: &Scene) -> Vec<String> {
    let Some(holds) = holds(format) else {
        return Vec::new();
    };
    let any =
        |test: &dyn Fn(&Attributes) -> bool| scene.meshes.iter().any(|m| test(&m.mesh.attributes));
    let mut faces = scene.meshes.iter().flat_map(|m| &m.mesh.face_attributes);
    let table = [
        ("normals", !holds.normals && any(&|a| a.normals.is_some())),
        (
            "tangents",
            !holds.tangents && any(&|a| a.tangents.is_some()),
        ),
        ("texture coordinates", any(&|a| a.uvs.len() > holds.uv_sets)),
        ("colours", any(&|a| a.colors.len() > holds.color_sets)),
        ("skin weights", any(&|a| !a.skins.is_empty())),
        ("morph targets", any(&|a| !a.morphs.is_empty())),
        (
            "custom attributes",
            !holds.custom && any(&|a| !a.custom.is_empty()),
        ),
        ("face attributes", faces.any(|a| !(holds.face_attribute)(a))),
        ("materials", !holds.materials && !scene.materials.is_empty()),
        ("the node tree", scene.instance_count() > 1),
    ];
    let lost = table.into_iter().filter(|(_, is_lost)| *is_lost);
    lost.map(|(what, _)| what.to_owned()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use karui::{TriMesh, geom::Vec3};

    #[test]
    fn each_format_tells_what_it_leaves_out() {
        let mut mesh = TriMesh::new(vec![Vec3::ZERO; 3], vec![[0, 1, 2]]);
        mesh.attributes.normals = Some(vec![Vec3::Z; 3]);
        mesh.attributes.uvs = vec![Vec::new(); 2];
        let mut scene = Scene::from_mesh(mesh);
        scene.materials.push(Default::default());
        let nothing: [&str; 0] = [];
        assert_eq!(lost(Format::Obj, &scene), ["texture coordinates"]);
        assert_eq!(lost(Format::Ply, &scene), ["materials"]);
        let all = ["normals", "texture coordinates", "materials"];
        assert_eq!(lost(Format::Stl, &scene), all);
        assert_eq!(lost(Format::Glb, &scene), nothing);
        assert_eq!(lost(Format::Off, &Scene::default()), nothing);
    }
}
