//! What a picture is to show, and from where.

use clap::ValueEnum;
use karui::geom::{Aabb, Camera, Vec3, sin_cos, tan};
use karui::render::{Faces, MAX_SIDE, Normals, Outputs, Paint, RenderOptions, Wireframe};

/// What a picture is to show, and from where.
#[derive(Debug, Clone, clap::Args)]
pub struct PictureArgs {
    /// Pixels: of both sides, or width and height of each tile; up to 16384
    #[arg(long, value_name = "N|WxH", default_value = "1024", value_parser = size)]
    pub size: (u32, u32),
    /// Samples a pixel is the mean of, along each side: 1, 2 or 4
    #[arg(long, value_name = "N", default_value = "2", value_parser = samples)]
    samples: u32,
    /// Behind everything, as hexadecimal digits; alpha is ff if left out
    #[arg(long, value_name = "RRGGBB[AA]", default_value = "dde1e6", value_parser = color)]
    background: Rgba,
    /// Where the colours come from
    #[arg(long, value_enum, default_value_t = PaintArg::Model)]
    paint: PaintArg,
    /// Draw the edges of the triangles
    #[arg(long)]
    wireframe: bool,
    /// Shade each triangle with its own normal
    #[arg(long)]
    flat: bool,
    /// Which sides of triangles are shown
    #[arg(long, value_enum, default_value_t = FacesArg::Material)]
    faces: FacesArg,
    #[command(flatten)]
    camera: CameraArgs,
}

/// Where a picture is taken from.
#[derive(Debug, Clone, clap::Args)]
#[command(next_help_heading = "Camera (looks at the middle of the first model; y is up)")]
struct CameraArgs {
    /// From the model towards the eye, instead of azimuth and elevation
    #[arg(long, value_name = "X,Y,Z", value_parser = direction, allow_hyphen_values = true,
          conflicts_with_all = ["azimuth", "elevation"])]
    direction: Option<Vec3>,
    /// Degrees around the model, from +z (its front in glTF) towards +x
    #[arg(
        long,
        value_name = "DEG",
        default_value_t = 30.0,
        allow_hyphen_values = true, value_parser = azimuth
    )]
    azimuth: f32,
    /// Degrees above the horizon
    #[arg(long, value_name = "DEG", default_value_t = 20.0, allow_hyphen_values = true,
          value_parser = elevation)]
    elevation: f32,
    /// Vertical field of view in degrees; the model fits in whatever it is
    #[arg(long, value_name = "DEG", default_value_t = 30.0, value_parser = fov)]
    fov: f32,
    /// Without perspective
    #[arg(long)]
    orthographic: bool,
}

/// sRGB with straight alpha.
pub type Rgba = [u8; 4];

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum PaintArg {
    /// The model: materials, textures, vertex colours
    Model,
    /// Nowhere: all is light grey
    Clay,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum FacesArg {
    /// Both of double-sided materials and where there is no material, else the front alone
    Material,
    /// Both
    Both,
    /// The front alone
    Front,
}

impl PictureArgs {
    /// As the renderer wants it.
    pub fn resolve(&self) -> RenderOptions<'static> {
        RenderOptions {
            width: self.size.0,
            height: self.size.1,
            samples: self.samples,
            outputs: Outputs::COLOR,
            background: self.background,
            normals: match self.flat {
                true => Normals::Flat,
                false => Normals::Smooth,
            },
            faces: match self.faces {
                FacesArg::Material => Faces::ByMaterial,
                FacesArg::Both => Faces::Both,
                FacesArg::Front => Faces::Front,
            },
            paint: match self.paint {
                PaintArg::Model => Paint::Material,
                PaintArg::Clay => Paint::Clay,
            },
            wireframe: self.wireframe.then(Wireframe::default),
            ..RenderOptions::default()
        }
    }

    /// Whether textures appear at all.
    pub fn shows_textures(&self) -> bool {
        self.paint == PaintArg::Model
    }

    /// A camera that has all of `bounds` in view, `turn` degrees further around
    /// it than was asked for.
    pub fn camera(&self, bounds: Aabb, turn: f64) -> Camera {
        let args = &self.camera;
        let fov = args.fov.to_radians();
        let direction = turned(args.towards_eye(), turn);
        let mut camera = Camera::looking_at(bounds, direction, fov);
        let narrow = f64::from(self.size.0) / f64::from(self.size.1);
        if narrow < 1.0 {
            step_back(&mut camera, fov.into(), narrow);
        }
        match args.orthographic {
            true => camera.without_perspective(),
            false => camera,
        }
    }
}

impl CameraArgs {
    fn towards_eye(&self) -> Vec3 {
        let [(s, c), (height, around)] =
            [self.azimuth, self.elevation].map(|angle| sin_cos(f64::from(angle).to_radians()));
        let around_y = Vec3::new((around * s) as f32, height as f32, (around * c) as f32);
        self.direction.unwrap_or(around_y)
    }
}

/// `v` turned about the y axis, from +z towards +x.
fn turned(v: Vec3, degrees: f64) -> Vec3 {
    let (s, c) = sin_cos(degrees.to_radians());
    let (x, z) = (f64::from(v.x), f64::from(v.z));
    Vec3::new((c * x + s * z) as f32, v.y, (c * z - s * x) as f32)
}

/// As far as a picture that is narrower than high by `narrow` needs, for what
/// touches it above and below to fit between left and right.
fn step_back(camera: &mut Camera, fov_y: f64, narrow: f64) {
    let wide = tan(0.5 * fov_y) * narrow;
    let sine = wide / (1.0 + wide * wide).sqrt();
    let farther = sin_cos(0.5 * fov_y).0 / sine;
    camera.eye = camera.target + (camera.eye - camera.target) * farther as f32;
}

/// One number for both sides, or `WIDTHxHEIGHT`.
pub fn size(text: &str) -> Result<(u32, u32), String> {
    let side = |text: &str| match text.parse::<u64>() {
        Ok(n) if (1..=u64::from(MAX_SIDE)).contains(&n) => Ok(n as u32),
        Ok(n) => Err(format!("{n} pixels; a side has 1 to {MAX_SIDE}")),
        Err(_) => Err("expected N or WIDTHxHEIGHT, for instance 800x600".to_owned()),
    };
    match text.split_once('x') {
        Some((width, height)) => Ok((side(width)?, side(height)?)),
        None => side(text).map(|n| (n, n)),
    }
}

fn samples(text: &str) -> Result<u32, String> {
    let known = text.parse().ok().filter(|n| [1, 2, 4].contains(n));
    known.ok_or_else(|| "expected 1, 2 or 4".to_owned())
}

fn color(text: &str) -> Result<Rgba, String> {
    let digits = text.strip_prefix('#').unwrap_or(text);
    let wrong = || "expected 6 or 8 hexadecimal digits, for instance ffffff".to_owned();
    let hex = digits.bytes().all(|b| b.is_ascii_hexdigit());
    let value = u32::from_str_radix(digits, 16).ok().filter(|_| hex);
    match (digits.len(), value) {
        (6, Some(rgb)) => Ok((rgb << 8 | 0xff).to_be_bytes()),
        (8, Some(rgba)) => Ok(rgba.to_be_bytes()),
        _ => Err(wrong()),
    }
}

fn direction(text: &str) -> Result<Vec3, String> {
    let numbers: Vec<f32> = text
        .split(',')
        .filter_map(|n| n.trim().parse().ok())
        .collect();
    let v = match (text.split(',').count(), numbers[..].try_into()) {
        (3, Ok(numbers)) => Vec3::from_array(numbers),
        _ => return Err("expected three numbers, for instance 1,0.5,1".to_owned()),
    };
    let length = v.as_dvec3().length();
    match length > 0.0 && length.is_finite() {
        true => Ok(v),
        false => Err("a direction is finite and not zero".to_owned()),
    }
}

fn azimuth(text: &str) -> Result<f32, String> {
    within(text, -360.0, 360.0)
}

fn elevation(text: &str) -> Result<f32, String> {
    within(text, -90.0, 90.0)
}

fn fov(text: &str) -> Result<f32, String> {
    within(text, 1.0, 150.0)
}

fn within(text: &str, least: f32, most: f32) -> Result<f32, String> {
    let number = text.parse().ok().filter(|x| (least..=most).contains(x));
    number.ok_or_else(|| format!("expected a number of degrees, {least} to {most}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_read_by_their_digits() {
        assert_eq!(color("#102030"), Ok([0x10, 0x20, 0x30, 0xff]));
        assert_eq!(color("01020304"), Ok([1, 2, 3, 4]));
        for wrong in ["", "fff", "+fffff", "gggggg", "1234567", "é1234"] {
            assert!(color(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_turn_goes_from_z_to_x() {
        assert!(turned(Vec3::Z, 90.0).distance(Vec3::X) < 1e-6);
        assert!(turned(Vec3::X + Vec3::Y, 90.0).distance(Vec3::Y - Vec3::Z) < 1e-6);
    }

    #[test]
    fn sizes_are_one_number_or_two() {
        assert_eq!(size("12"), Ok((12, 12)));
        assert_eq!(size("12x34"), Ok((12, 34)));
        for wrong in ["0", "99999", "x", "12x", "12x0", "-3", "1x2x3"] {
            assert!(size(wrong).is_err(), "{wrong}");
        }
    }
}
