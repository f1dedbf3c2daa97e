//! What a picture is to show.

use crate::error::{Error, Result};
use crate::geom::Vec3;

/// Longest side of a picture, pixels.
pub const MAX_SIDE: u32 = 16_384;

/// What a picture is to show, and how.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RenderOptions<'a> {
    /// Pixels a row, 1 to [`MAX_SIDE`]; 512 by default.
    pub width: u32,
    /// Rows, 1 to [`MAX_SIDE`]; 512 by default.
    pub height: u32,
    /// Samples a pixel is the mean of, along each side: 1 (the default), 2 or 4.
    pub samples: u32,
    /// What is made; colour, depth and hits by default.
    pub outputs: Outputs,
    /// Behind everything: sRGB with straight alpha; transparent by default.
    pub background: [u8; 4],
    /// How surfaces answer light.
    pub shading: Shading,
    /// Whether normals are interpolated.
    pub normals: Normals,
    /// Light from all around.
    pub ambient: Ambient,
    /// Which sides of triangles are shown.
    pub faces: Faces,
    /// Where the colours of surfaces come from.
    pub paint: Paint<'a>,
    /// Edges drawn over the surface, if any.
    pub wireframe: Option<Wireframe>,
}

impl Default for RenderOptions<'_> {
    fn default() -> Self {
        Self {
            width: 512,
            height: 512,
            samples: 1,
            outputs: Outputs::default(),
            background: [0; 4],
            shading: Shading::default(),
            normals: Normals::default(),
            ambient: Ambient::default(),
            faces: Faces::default(),
            paint: Paint::default(),
            wireframe: None,
        }
    }
}

/// What a frame holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Outputs {
    /// The picture; without it, nothing is shaded.
    pub color: bool,
    /// Distance along the view.
    pub depth: bool,
    /// Which triangle is seen, and where on it.
    pub hits: bool,
}

impl Default for Outputs {
    fn default() -> Self {
        Self {
            color: true,
            ..Self::GEOMETRY
        }
    }
}

impl Outputs {
    /// Depth and hits, without shading.
    pub const GEOMETRY: Self = Self {
        color: false,
        depth: true,
        hits: true,
    };
    /// The picture alone.
    pub const COLOR: Self = Self {
        color: true,
        depth: false,
        hits: false,
    };
}

/// How surfaces answer light.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Shading {
    /// glTF's metallic-roughness model: microfacets of the GGX distribution
    /// (Walter et al., "Microfacet models for refraction through rough
    /// surfaces", 2007), correlated masking (Heitz 2014), Schlick's Fresnel
    /// term (1994), and a matte rest.
    #[default]
    Pbr,
    /// Matte plus a highlight (Blinn, "Models of light reflection for computer
    /// synthesized pictures", 1977), its exponent after the roughness.
    BlinnPhong,
    /// The surface's own colour, without light.
    Unlit,
}

/// Whether normals are interpolated.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Normals {
    /// Between those of the corners; a mesh without normals gets them, smooth
    /// across seams, each face counting by its area.
    #[default]
    Smooth,
    /// Those of the faces.
    Flat,
}

/// Light from all around: of one colour above, of another below, mixed by how
/// far a normal points along the camera's `up`. With no light at all, it is
/// the only one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ambient {
    /// Linear RGB from above; 0.25 by default.
    pub sky: Vec3,
    /// Linear RGB from below; 0.1 by default.
    pub ground: Vec3,
}

impl Default for Ambient {
    fn default() -> Self {
        Self {
            sky: Vec3::splat(0.25),
            ground: Vec3::splat(0.1),
        }
    }
}

/// Which sides of triangles are shown. A back is shaded with its normal turned.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Faces {
    /// Both of double-sided materials and where there is no material, else the
    /// front alone.
    #[default]
    ByMaterial,
    /// Both.
    Both,
    /// The front alone; of a closed surface nothing is missing then.
    Front,
}

/// Where the colours of surfaces come from.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub enum Paint<'a> {
    /// The materials, their textures and the vertex colours.
    #[default]
    Material,
    /// The material of what has none: light grey, matte.
    Clay,
    /// A value a vertex, shown as a colour; everything else as for `Clay`.
    Scalar(Scalar<'a>),
}

/// A value a vertex and how it becomes a colour.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scalar<'a> {
    /// For every mesh, its vertices' values. Where one is not finite, the
    /// surface keeps the grey of [`Paint::Clay`].
    pub values: &'a [&'a [f32]],
    /// Value shown as the first colour.
    pub low: f32,
    /// Value shown as the last colour; above `low`.
    pub high: f32,
    /// sRGB colours from low to high.
    pub map: &'a [[u8; 3]; 256],
}

/// Edges of the visible triangles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wireframe {
    /// sRGB with straight alpha.
    pub color: [u8; 4],
    /// Width of a line that two triangles share, pixels.
    pub width: f32,
}

impl Default for Wireframe {
    fn default() -> Self {
        Self {
            color: [0, 0, 0, 160],
            width: 1.0,
        }
    }
}

impl RenderOptions<'_> {
    pub(super) fn check(&self) -> Result<()> {
        side("width", self.width)?;
        side("height", self.height)?;
        let wrong = |option, found: String, expected| Error::BadOption {
            option,
            found,
            expected,
        };
        if ![1, 2, 4].contains(&self.samples) {
            return Err(wrong("samples", self.samples.to_string(), "1, 2 or 4"));
        }
        if let Paint::Scalar(Scalar { low, high, .. }) = self.paint
            && !(low < high && low.is_finite() && high.is_finite())
        {
            let found = format!("{low} to {high}");
            return Err(wrong(
                "paint.low, paint.high",
                found,
                "finite, low below high",
            ));
        }
        match self.wireframe {
            Some(w) if !(w.width >= 0.0 && w.width.is_finite()) => {
                let found = w.width.to_string();
                Err(wrong("wireframe.width", found, "zero or more pixels"))
            }
            _ => Ok(()),
        }
    }
}

fn side(option: &'static str, pixels: u32) -> Result<()> {
    if (1..=MAX_SIDE).contains(&pixels) {
        return Ok(());
    }
    Err(Error::BadOption {
        option,
        found: pixels.to_string(),
        expected: "1 to 16384 pixels",
    })
}
