//! The earth: WGS 84 longitudes, latitudes and heights against earth-centred,
//! earth-fixed coordinates (EPSG 4979 and 4978).

use glam::{DMat4, DVec3};

/// Semi-major axis of the WGS 84 ellipsoid, metres.
pub(super) const A: f64 = 6_378_137.0;
/// Its flattening.
const F: f64 = 1.0 / 298.257_223_563;
/// Square of its first eccentricity.
const E2: f64 = F * (2.0 - F);
/// Its semi-minor axis, metres.
const B: f64 = A * (1.0 - F);

/// A place on the earth, or above it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Geodetic {
    /// Longitude, radians, east positive.
    pub lon: f64,
    /// Latitude, radians, north positive.
    pub lat: f64,
    /// Height above the ellipsoid, metres.
    pub height: f64,
}

impl Geodetic {
    /// From degrees and metres.
    #[must_use]
    pub fn from_degrees(lat: f64, lon: f64, height: f64) -> Self {
        Self {
            lon: lon.to_radians(),
            lat: lat.to_radians(),
            height,
        }
    }

    /// Earth-centred, earth-fixed coordinates, metres.
    #[must_use]
    pub fn to_ecef(self) -> DVec3 {
        let (sin, cos) = self.lat.sin_cos();
        let normal = A / (1.0 - E2 * sin * sin).sqrt();
        let across = (normal + self.height) * cos;
        let (y, x) = self.lon.sin_cos();
        DVec3::new(
            across * x,
            across * y,
            (normal * (1.0 - E2) + self.height) * sin,
        )
    }

    /// The inverse of [`Geodetic::to_ecef`], by Bowring's formula (Survey
    /// Review 23, 1976) applied three times: exact to a nanometre from 10 km
    /// below ground to the orbits of satellites.
    #[must_use]
    pub fn from_ecef(p: DVec3) -> Self {
        let across = p.x.hypot(p.y);
        let second = E2 / (1.0 - E2);
        let mut reduced = (p.z * A).atan2(across * B);
        let mut lat = 0.0;
        for _ in 0..3 {
            let (sin, cos) = reduced.sin_cos();
            let up = p.z + second * B * sin.powi(3);
            lat = up.atan2(across - E2 * A * cos.powi(3));
            reduced = ((1.0 - F) * lat.sin()).atan2(lat.cos());
        }
        let (sin, cos) = f64::sin_cos(lat);
        let normal = A / (1.0 - E2 * sin * sin).sqrt();
        Self {
            lon: p.y.atan2(p.x),
            lat,
            height: across * cos + p.z * sin - A * A / normal,
        }
    }

    /// Takes east, north and up at this place, in metres, to earth-centred,
    /// earth-fixed coordinates: the `transform` that puts a local scene with z
    /// up on the earth.
    #[must_use]
    pub fn ecef_from_east_north_up(self) -> DMat4 {
        let (sin_lat, cos_lat) = self.lat.sin_cos();
        let (sin_lon, cos_lon) = self.lon.sin_cos();
        let east = DVec3::new(-sin_lon, cos_lon, 0.0);
        let north = DVec3::new(-sin_lat * cos_lon, -sin_lat * sin_lon, cos_lat);
        let up = DVec3::new(cos_lat * cos_lon, cos_lat * sin_lon, sin_lat);
        DMat4::from_cols(
            east.extend(0.0),
            north.extend(0.0),
            up.extend(0.0),
            self.to_ecef().extend(1.0),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_of_the_ellipsoid() {
        let at = |lat, lon, h| Geodetic::from_degrees(lat, lon, h).to_ecef();
        assert!((at(0.0, 0.0, 5.0) - DVec3::new(A + 5.0, 0.0, 0.0)).length() < 1e-8);
        assert!((at(0.0, 90.0, 0.0) - DVec3::new(0.0, A, 0.0)).length() < 1e-8);
        // The semi-minor axis as NIMA TR8350.2 prints it.
        let pole = DVec3::new(0.0, 0.0, 6_356_752.314_2 + 100.0);
        assert!((at(90.0, 0.0, 100.0) - pole).length() < 1e-4);
    }

    /// The normal at latitude 45 degrees in closed form: N = a / sqrt(1 - e2/2).
    #[test]
    fn forty_five_degrees() {
        let n = A / (1.0 - E2 / 2.0).sqrt();
        let half = 0.5f64.sqrt();
        let expected = DVec3::new(n * half, 0.0, n * (1.0 - E2) * half);
        let found = Geodetic::from_degrees(45.0, 0.0, 0.0).to_ecef();
        assert!((found - expected).length() < 1e-8);
        // The point printed in textbooks.
        assert!((found.x - 4_517_590.878_8).abs() < 1e-3, "{found}");
        assert!((found.z - 4_487_348.408_8).abs() < 1e-3, "{found}");
    }

    #[test]
    fn there_and_back() {
        for lat in [-90.0, -89.9999, -45.0, 0.0, 1e-9, 35.6, 89.0, 90.0] {
            for lon in [-180.0, -75.0, 0.0, 139.7, 179.999] {
                for height in [-10_000.0, 0.0, 8848.0, 400_000.0] {
                    let there = Geodetic::from_degrees(lat, lon, height);
                    let back = Geodetic::from_ecef(there.to_ecef());
                    assert!((back.height - height).abs() < 1e-6, "{there:?} {back:?}");
                    assert!((back.lat - there.lat).abs() < 1e-12, "{there:?} {back:?}");
                    let away = (back.to_ecef() - there.to_ecef()).length();
                    assert!(away < 1e-6, "{there:?}: {away}");
                }
            }
        }
    }

    #[test]
    fn the_local_frame_is_that_of_small_steps() {
        let here = Geodetic::from_degrees(35.0, 139.0, 30.0);
        let frame = here.ecef_from_east_north_up();
        let step = 1e-6;
        for (axis, moved) in [
            Geodetic {
                lon: here.lon + step,
                ..here
            },
            Geodetic {
                lat: here.lat + step,
                ..here
            },
            Geodetic {
                height: here.height + 1.0,
                ..here
            },
        ]
        .into_iter()
        .enumerate()
        {
            let direction = (moved.to_ecef() - here.to_ecef()).normalize();
            let along = direction.dot(frame.col(axis).truncate());
            assert!(along > 1.0 - 1e-9, "{axis}: {along}");
        }
        assert!((frame.determinant() - 1.0).abs() < 1e-12);
    }
}
