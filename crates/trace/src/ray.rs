//! Rays, and what is found along them.

use std::cmp::Ordering;

/// A part of a straight line: origin + direction·t, t from `start` to `end`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where t = 0.
    pub origin: [f64; 3],
    /// A unit vector, so that t is a length.
    pub direction: [f64; 3],
    /// The least t that is looked at.
    pub start: f64,
    /// The largest t that is looked at.
    pub end: f64,
}

impl Ray {
    /// The point at t.
    pub fn at(&self, t: f64) -> [f64; 3] {
        [0, 1, 2].map(|i| self.origin[i] + self.direction[i] * t)
    }

    /// Whether no t lies between the ends; so it is where an end is undefined.
    pub fn is_empty(&self) -> bool {
        self.start.partial_cmp(&self.end) != Some(Ordering::Less)
    }

    /// The part between two values of t, empty where it does not reach there.
    pub(crate) fn between(&self, a: f64, b: f64) -> Self {
        Self { start: self.start.max(a), end: self.end.min(b), ..*self }
    }
}

/// What an outcome rests on, for misses as for hits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Certificate {
    /// Everything before the hit, or the whole span, was excluded by inclusion; at a hit the sign changes inside its
    /// final bracket.
    Certified = 1,
    /// A span was accepted, or passed over, at the tolerance without proof.
    Tolerance = 2,
    /// A black box, an undefined value, or fuel that ran out.
    Undecided = 3,
}

/// The first place where a ray crosses the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Where the surface is, inside the final bracket.
    pub t: f64,
    /// The near end of the final bracket: still on the side that the ray comes from.
    pub before: f64,
    /// The far end of the final bracket.
    pub after: f64,
    /// Whether the ray goes from outside to inside.
    pub entering: bool,
    /// Whether the sign changes without a root: a jump or a pole.
    pub jump: bool,
    /// Whether the field touches 0 there without a change of sign, as far as rounding lets one tell; only for
    /// surfaces ([`Settings::surface`]). Such a hit is a [`Certificate::Tolerance`] at best.
    pub touching: bool,
}

/// What was found along a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// The first crossing, if there is one.
    pub hit: Option<Hit>,
    /// What that rests on.
    pub certificate: Certificate,
    /// How many times the field was evaluated, over points and sets.
    pub cost: u32,
    /// Whether the field is negative where the ray starts; where it is, the hit is the way out.
    pub starts_inside: bool,
    /// Whether the field is negative where the ray ends without a hit.
    pub ends_inside: bool,
}

impl Outcome {
    /// That of a ray about which nothing has been found yet: certified, outside, without a hit.
    pub fn nothing() -> Self {
        Self {
            hit: None,
            certificate: Certificate::Certified,
            cost: 0,
            starts_inside: false,
            ends_inside: false,
        }
    }
}

/// How crossings are found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// Front march with mixed affine forms and slope clipping (Gamito and Maddock 2007; Knoll et al. 2009).
    Affine,
    /// Dichotomy with intervals (Mitchell 1990; Hijazi et al. 2008).
    Interval {
        /// Accept a span as a hit as soon as it is shorter than this (in units of t) and cannot be excluded, without
        /// a sign change, as Hijazi et al. do; such hits are [`Certificate::Tolerance`]. `None`: never.
        accept_epsilon: Option<f64>,
    },
    /// Fixed steps, then a bracketed solve where the sign changes: fast, and blind to what is thinner than a step.
    Sampled {
        /// The step, in units of t.
        step: f64,
    },
}

/// How rays are traced.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// How crossings are found.
    pub method: Method,
    /// The size of the scene, in units of t: the longest side of its bounds. Tolerances are relative to it.
    pub size: f64,
    /// The width of the final bracket, relative to `size`; at most 10⁻⁶ for certificates to mean much. Where any hit will
    /// do, spans shorter than a 64th of it are passed over without proof.
    pub tolerance: f64,
    /// Whether a ray that starts inside needs no crossing: it starts on a cap.
    pub caps: bool,
    /// Whether any crossing will do, as for shadows: it is not located closely, and what lies before it is not proved.
    pub any_hit: bool,
    /// Whether every place where the field is 0 counts, those where it does not change its sign too, as on the squared
    /// equation of a surface. If not, only changes of sign do.
    pub surface: bool,
}

impl Settings {
    /// The affine method with the default tolerance.
    pub fn new(size: f64) -> Self {
        Self {
            method: Method::Affine,
            size,
            tolerance: Self::TOLERANCE,
            caps: false,
            any_hit: false,
            surface: false,
        }
    }

    /// The default width of the final bracket, relative to the size: 2⁻³⁰.
    pub const TOLERANCE: f64 = 1.0 / (1u64 << 30) as f64;
}
