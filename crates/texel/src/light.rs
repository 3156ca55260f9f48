//! Light that comes back along a ray after it was scattered once.
//!
//! L = Σ ∫ T(s) σ_t albedo p(v → l) E(s) ds over lamps and segments, front to back. Between the ends of a segment the
//! optical depth towards the lamp is taken to rise evenly from one end to the other, and the integral is exact: in an even
//! slab that is no approximation, and a dense cell is bright where the light reaches it and dark behind. Phase functions are those
//! of the middle. Light that was scattered before is left out, as in the paper of 1995.

use crate::phase::{Model, Reflector};
use crate::walk::{Ray, Segment};
use crate::{Texel, Volume};
use glam::DVec3;

/// Where less than this of the light passes, nothing behind is looked at.
const FAINTEST: f64 = 1.0 / 4096.0;

/// Segments are cut into pieces no longer than this many cells of the level looked at: what casts a shadow on a great even
/// cell may be smaller. Where cells of all densities stand side by side, shadows cross a cell unevenly, and light is 1 %
/// too bright; pieces of half a cell would bring that to 0.2 %, at twice the cost.
const CELLS: f64 = 4.0;

/// How far from its ends, in parts of its length, the depths of a piece are found: within its own cell.
const INSET: f64 = 1e-7;

/// A lamp, in units of the volume's edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lamp {
    /// Far away.
    Directional {
        /// The unit direction to the lamp.
        to_lamp: DVec3,
        /// Light on a plane that faces the lamp, red, green, blue.
        irradiance: DVec3,
    },
    /// At a place.
    Point {
        /// The place.
        place: DVec3,
        /// Light per steradian: the irradiance at a distance of 1.
        intensity: DVec3,
    },
}

impl Lamp {
    /// The ray to the lamp that ends at t = 1 or, for one far away, behind the volume; the irradiance.
    fn seen_from(&self, from: DVec3) -> (Ray, f64, DVec3) {
        match *self {
            Self::Directional { to_lamp, irradiance } => {
                (Ray { origin: from, direction: to_lamp }, f64::INFINITY, irradiance)
            }
            Self::Point { place, intensity } => {
                let way = place - from;
                let square = way.length_squared().max(f64::MIN_POSITIVE);
                (Ray { origin: from, direction: way }, 1.0, intensity / square)
            }
        }
    }
}

/// What a ray brings back from a volume.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gathered {
    /// Scattered light, red, green, blue.
    pub radiance: DVec3,
    /// How much of what is behind is seen.
    pub transmittance: f64,
}

/// How much of the light that arrives with the irradiance 1 at the surface of a medium leaves a piece of a ray, were
/// all of it scattered towards the eye: ∫₀¹ d e^{−d s} e^{−(a + (b − a) s)} ds for the optical depths d of the piece, and a and b from its two
/// ends to the lamp.
pub fn lit_share(depth: f64, to_lamp: [f64; 2]) -> f64 {
    // e^{−1000} is 0: what is opaque needs no infinities.
    let [a, b] = to_lamp.map(|depth| depth.min(1000.0));
    let rise = depth + b - a;
    let mean = if rise.abs() < 1e-5 {
        // The next term is rise² / 6.
        (-a).exp() * (1.0 - 0.5 * rise)
    } else {
        // Neither exponent is positive.
        ((-a).exp() - (-depth - b).exp()) / rise
    };
    depth * mean
}

impl Volume {
    /// The light of `lamps` that comes back along `ray` from `span.0` to `span.1`, by single scattering, with shadows of
    /// the volume on itself. `level` is the level that is looked at by t, as in [`Volume::segments`]; shadow rays keep that
    /// of the place they start at.
    pub fn single_scattering(
        &self,
        ray: &Ray,
        span: (f64, f64),
        level: impl Fn(f64) -> f32,
        (lamps, model): (&[Lamp], Model),
    ) -> Gathered {
        let mut gathered = Gathered { radiance: DVec3::ZERO, transmittance: 1.0 };
        let Some(view) = (-ray.direction).try_normalize() else { return gathered };
        let mut depths = vec![(f64::NAN, 0.0); lamps.len()];
        for segment in self.segments(ray, span, &level) {
            // A cell may hold so little that nothing of it is seen.
            if segment.extinction(ray) == 0.0 {
                continue;
            }
            let looked_at = level(segment.from);
            for (from, to) in self.pieces(&segment, ray, looked_at) {
                let piece = Piece { from, to, extinction: segment.extinction(ray), level: looked_at };
                let reflectors = segment.layers().iter().map(|layer| {
                    let weight = layer.extinction(ray.direction) / piece.extinction;
                    (albedo(&layer.texel) * weight, Reflector::new(&layer.texel, model, view))
                });
                let reflectors: Vec<_> = reflectors.collect();
                for (lamp, known) in lamps.iter().zip(&mut depths) {
                    let light = self.light_on(ray, &piece, (lamp, known), &reflectors);
                    gathered.radiance += gathered.transmittance * light;
                }
                gathered.transmittance *= (-piece.depth()).exp();
            }
            if gathered.transmittance < FAINTEST {
                gathered.transmittance = 0.0;
                break;
            }
        }
        gathered
    }

    /// Cuts a segment into pieces that are not too long.
    fn pieces(&self, segment: &Segment, ray: &Ray, level: f32) -> impl Iterator<Item = (f64, f64)> + use<> {
        let cells = (segment.to - segment.from) * ray.direction.length() / self.cell_width(level as u32);
        let count = (cells / CELLS).ceil().clamp(1.0, 4096.0);
        let (from, step) = (segment.from, (segment.to - segment.from) / count);
        (0..count as u32).map(move |i| (from + f64::from(i) * step, from + f64::from(i + 1) * step))
    }

    /// The light of one lamp that a piece of a ray sends back, without what is before it. `known` is the last end that a depth
    /// to the lamp was found for, and the depth.
    fn light_on(
        &self,
        ray: &Ray,
        piece: &Piece,
        (lamp, known): (&Lamp, &mut (f64, f64)),
        reflectors: &[(DVec3, Reflector)],
    ) -> DVec3 {
        let depth_at = |t: f64| {
            let (to_lamp, end, _) = lamp.seen_from(ray.at(t));
            self.depth_along(&to_lamp, (0.0, end), |_| piece.level)
        };
        let (to_lamp, _, irradiance) = lamp.seen_from(ray.at(0.5 * (piece.from + piece.to)));
        let Some(light) = to_lamp.direction.try_normalize() else { return DVec3::ZERO };
        // Most pieces begin where the one before ended. Where the light runs along the faces of cells, the two sides of a
        // face are different columns.
        let is_shared = known.0 == piece.from && light.abs().min_element() > 1e-6;
        let inset = INSET * (piece.to - piece.from);
        let near = if is_shared { known.1 } else { depth_at(piece.from + inset) };
        let far = depth_at(piece.to - inset);
        *known = (piece.to, far);
        let reflected: DVec3 = reflectors.iter().map(|(albedo, r)| *albedo * r.phase(light)).sum();
        irradiance * reflected * lit_share(piece.depth(), [near, far])
    }
}

/// A piece of a segment.
struct Piece {
    from: f64,
    to: f64,
    extinction: f64,
    level: f32,
}

impl Piece {
    fn depth(&self) -> f64 {
        self.extinction * (self.to - self.from)
    }
}

fn albedo(texel: &Texel) -> DVec3 {
    DVec3::from_array(texel.albedo.map(f64::from))
}
