//! What goes with the surface: texture coordinates and colours.
//!
//! Each is a surface in a space of its own, with the faces of the cage, cut open at seams. It
//! has a hierarchy of its own, which grows with what is drawn of the surface, so that values
//! are those of uniform refinement as positions are.

use super::store::{NONE, Store};
use crate::error::{Error, Result};
use crate::mesh::PolyMesh;
use crate::subdiv::cage;
use crate::subdiv::control_mesh::{ControlMesh, FaceVarying};
use crate::subdiv::face_varying::Charts;
use crate::subdiv::level::Level;
use crate::subdiv::options::{FaceVaryingRule, SubdivOptions};
use glam::{Vec3, Vec4};

/// A corner of the surface: its tier and number there.
pub(super) type Place = [u32; 2];

/// All that goes with a surface.
#[derive(Debug, Clone, Default)]
pub(super) struct Skin {
    pub uvs: Option<Values>,
    colors: Option<Colors>,
    /// Material of every face of the cage; empty if none has one.
    materials: Vec<Option<u32>>,
}

/// Red, green and blue; and opacity where that is not 1 all over.
#[derive(Debug, Clone)]
struct Colors {
    rgb: Values,
    alpha: Option<Values>,
}

/// Values of corners.
#[derive(Debug, Clone)]
pub(super) struct Values {
    store: Store,
    /// By tier of the surface: of its faces which ones they are here, of its corners their
    /// wedges here; `NONE`, or shorter, as far as nobody has asked.
    faces: Vec<Vec<u32>>,
    wedges: Vec<Vec<u32>>,
}

impl Skin {
    /// Of a control mesh whose cage is `level` and that of `store`; marks seams in that.
    pub fn new(
        control: &ControlMesh,
        level: &Level,
        store: &mut Store,
        options: &SubdivOptions,
    ) -> Result<Self> {
        let mut skin = Self {
            materials: control.face_materials.clone(),
            ..Self::default()
        };
        if let Some(uvs) = &control.uvs {
            skin.uvs = Some(Values::of_uvs(uvs, level, store, options)?);
        }
        if let Some(colors) = &control.colors {
            skin.colors = Some(Colors::new(colors, level, options)?);
        }
        Ok(skin)
    }

    /// Whether there is nothing that varies along the surface.
    pub fn is_plain(&self) -> bool {
        self.uvs.is_none() && self.colors.is_none()
    }

    /// Forgets all but the cage.
    pub fn forget(&mut self) {
        let colors = self.colors.iter_mut();
        let colors = colors.flat_map(|c| [Some(&mut c.rgb), c.alpha.as_mut()]);
        let all = colors.chain([self.uvs.as_mut()]).flatten();
        all.for_each(Values::forget);
    }

    /// Adds values to a mesh: of vertex `v` those of the corner `places[v]` of the surface, at
    /// its tier or in the limit; and materials, by the cage's faces.
    pub fn put_on(
        &mut self,
        surface: &Store,
        (places, parents): (&[Place], &[u32]),
        limit: bool,
        mesh: &mut PolyMesh,
    ) {
        // What another surface has left is not to stay.
        let attributes = &mut mesh.attributes;
        attributes
            .uvs
            .resize_with(usize::from(self.uvs.is_some()), Vec::new);
        if let (Some(uvs), Some(to)) = (&mut self.uvs, attributes.uvs.first_mut()) {
            let value = |&place: &Place| uvs.value(surface, place, limit).truncate();
            to.clear();
            to.extend(places.iter().map(value));
        }
        attributes
            .colors
            .resize_with(usize::from(self.colors.is_some()), Vec::new);
        if let (Some(colors), Some(to)) = (&mut self.colors, attributes.colors.first_mut()) {
            let value = |&place: &Place| colors.value(surface, place, limit);
            to.clear();
            to.extend(places.iter().map(value));
        }
        let material = |&f: &u32| self.materials.get(f as usize).copied().flatten();
        mesh.face_materials.clear();
        if !self.materials.is_empty() {
            mesh.face_materials.extend(parents.iter().map(material));
        }
    }
}

impl Colors {
    fn new(colors: &[Vec4], level: &Level, options: &SubdivOptions) -> Result<Self> {
        let rgb = colors.iter().map(|c| c.truncate()).collect();
        let clear = colors.iter().any(|c| c.w != 1.0);
        let alpha = clear.then(|| {
            let alpha = colors.iter().map(|c| Vec3::new(c.w, 0.0, 0.0)).collect();
            Values::new(level, alpha, options)
        });
        Ok(Self {
            rgb: Values::new(level, rgb, options)?,
            alpha: alpha.transpose()?,
        })
    }

    fn value(&mut self, surface: &Store, place: Place, limit: bool) -> Vec4 {
        let rgb = self.rgb.value(surface, place, limit);
        let alpha = self.alpha.as_mut();
        let alpha = alpha.map_or(1.0, |a| a.value(surface, place, limit).x);
        rgb.extend(alpha).clamp(Vec4::ZERO, Vec4::ONE)
    }
}

impl Values {
    fn new(level: &Level, values: Vec<Vec3>, options: &SubdivOptions) -> Result<Self> {
        if values.len() != level.vertex_count() {
            return Err(Error::LengthMismatch {
                what: "values of the cage".into(),
                expected: level.vertex_count(),
                found: values.len(),
            });
        }
        if let Some(index) = values.iter().position(|v| !v.is_finite()) {
            return Err(cage::not_finite("value of the cage", index));
        }
        Ok(Self {
            store: Store::of_level(level, &values, options)?,
            faces: Vec::new(),
            wedges: Vec::new(),
        })
    }

    fn of_uvs(
        uvs: &FaceVarying,
        level: &Level,
        surface: &mut Store,
        options: &SubdivOptions,
    ) -> Result<Self> {
        let charts = Charts::new(level, &uvs.indices, uvs.values.len(), options)?;
        surface.mark_seams(charts.level.corner_edges());
        let value = |&i: &u32| uvs.values[i as usize].extend(0.0);
        let values = charts.value.iter().map(value).collect();
        let mut made = Self::new(&charts.level, values, options)?;
        made.store.linear = options.face_varying == FaceVaryingRule::All;
        Ok(made)
    }

    fn forget(&mut self) {
        self.store.forget();
        self.faces.clear();
        self.wedges.clear();
    }

    /// The value of a corner, in its tier or in the limit.
    fn value(&mut self, surface: &Store, place: Place, limit: bool) -> Vec3 {
        if limit {
            let wedge = self.wedge(surface, place);
            return self.store.wedges[wedge as usize].limit;
        }
        let corner = self.corner(surface, place);
        let found = self.store.corner_position(place[0] as usize, corner);
        found.as_vec3()
    }

    /// Number of the value of a corner: the same all around a vertex but across seams.
    pub fn point(&mut self, surface: &Store, place: Place) -> u32 {
        let wedge = self.wedge(surface, place);
        self.store.wedges[wedge as usize].point
    }

    fn wedge(&mut self, surface: &Store, place: Place) -> u32 {
        let [t, corner] = surface.first_place(place);
        let known = at(&mut self.wedges, t, corner);
        if *known != NONE {
            return *known;
        }
        let here = self.corner(surface, [t, corner]);
        let wedge = self.store.wedge(t as usize, here);
        *at(&mut self.wedges, t, corner) = wedge;
        wedge
    }

    /// The same corner here.
    fn corner(&mut self, surface: &Store, [t, corner]: Place) -> u32 {
        let tier = &surface.tiers[t as usize];
        let face = tier.face_of(corner);
        let here = self.face(surface, [t, face]);
        let first = self.store.tiers[t as usize].corners_of(here).start;
        first + corner - tier.corners_of(face).start
    }

    /// The same face here, made if need be.
    fn face(&mut self, surface: &Store, [t, face]: Place) -> u32 {
        if t == 0 {
            return face;
        }
        let known = *at(&mut self.faces, t, face);
        if known != NONE {
            return known;
        }
        let parent = surface.tiers[t as usize].faces[face as usize].parent;
        let corner = self.corner(surface, [t - 1, parent]);
        let above = t as usize - 1;
        let from = self.store.tiers[above].face_of(corner);
        self.store.children(above, from);
        let here = self.store.tiers[above].child(corner);
        *at(&mut self.faces, t, face) = here;
        here
    }
}

/// An entry by tier and number, `NONE` if it has not been set.
fn at(all: &mut Vec<Vec<u32>>, t: u32, i: u32) -> &mut u32 {
    let (t, i) = (t as usize, i as usize);
    if all.len() <= t {
        all.resize_with(t + 1, Vec::new);
    }
    if all[t].len() <= i {
        all[t].resize(i + 1, NONE);
    }
    &mut all[t][i]
}

impl Store {
    /// The corner of the first tier that has the vertex of a corner, in the same wedge.
    fn first_place(&self, [mut t, mut corner]: Place) -> Place {
        while t > 0 && corner.is_multiple_of(4) {
            corner = self.tiers[t as usize].faces[corner as usize / 4].parent;
            t -= 1;
        }
        [t, corner]
    }

    /// Marks edges of the cage whose two corners are on different edges of its charts.
    fn mark_seams(&mut self, chart_edges: &[u32]) {
        for edge in &mut self.tiers[0].edges {
            let [a, b] = edge.corners;
            edge.seam = b != NONE && chart_edges[a as usize] != chart_edges[b as usize];
        }
    }
}
