//! Radial functions.

/// A function of the distance from a centre.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Kernel {
    /// r³, the fundamental solution of Δ³: the smoothest through points in space (Carr et al. 2001).
    Triharmonic,
    /// (1 − r/s)⁴ (4r/s + 1) within the support s, 0 beyond: positive definite and twice differentiable (Wendland 1995).
    Wendland {
        /// Where it vanishes.
        support: f64,
    },
}

impl Kernel {
    /// φ(r).
    pub fn value(self, r: f64) -> f64 {
        match self {
            Self::Triharmonic => r * r * r,
            Self::Wendland { support } => {
                let t = r / support;
                let rest = (1.0 - t).max(0.0);
                rest * rest * rest * rest * (4.0 * t + 1.0)
            }
        }
    }

    /// φ′(r)/r: the gradient is this times the vector from the centre.
    pub fn slope(self, r: f64) -> f64 {
        match self {
            Self::Triharmonic => 3.0 * r,
            Self::Wendland { support } => {
                let rest = (1.0 - r / support).max(0.0);
                -20.0 * rest * rest * rest / (support * support)
            }
        }
    }

    /// φ″(r) − φ′(r)/r: the second derivatives are φ′/r on the diagonal and this times n nᵀ, with the direction n from the
    /// centre.
    pub fn bend(self, r: f64) -> f64 {
        match self {
            Self::Triharmonic => 3.0 * r,
            Self::Wendland { support } => {
                let t = r / support;
                let rest = (1.0 - t).max(0.0);
                60.0 * t * rest * rest / (support * support)
            }
        }
    }

    /// A bound of the third derivative along every direction, and so of how fast the second derivatives change.
    ///
    /// With c the cosine between direction and radius it is φ‴c³ + 3(φ″/r − φ′/r²)(c − c³): 9c − 3c³ for r³, and at most
    /// 180c − 60c³ over s³ at the centre of Wendland's function.
    pub fn twist(self) -> f64 {
        match self {
            Self::Triharmonic => 6.0,
            Self::Wendland { support } => 120.0 / (support * support * support),
        }
    }

    /// Beyond this distance the function vanishes.
    pub fn reach(self) -> f64 {
        match self {
            Self::Triharmonic => f64::INFINITY,
            Self::Wendland { support } => support,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_are_those_of_differences() {
        for kernel in [Kernel::Triharmonic, Kernel::Wendland { support: 1.5 }] {
            for r in [0.1, 0.7, 1.2, 1.4999, 2.0] {
                let first = |r: f64| (kernel.value(r + 1e-6) - kernel.value(r - 1e-6)) / 2e-6;
                assert!((kernel.slope(r) * r - first(r)).abs() < 1e-7, "{kernel:?} {r}");
                let second =
                    (kernel.slope(r + 1e-6) * (r + 1e-6) - kernel.slope(r - 1e-6) * (r - 1e-6)) / 2e-6;
                assert!((kernel.bend(r) + kernel.slope(r) - second).abs() < 1e-5, "{kernel:?} {r}");
            }
        }
    }

    #[test]
    fn second_derivatives_change_no_faster_than_stated() {
        // Along lines that pass the centre at a distance.
        for kernel in [Kernel::Triharmonic, Kernel::Wendland { support: 1.5 }] {
            let mut fastest = 0.0f64;
            for a in [0.0, 1e-3, 0.05, 0.3, 0.8, 1.3] {
                let second = |s: f64| {
                    let r = f64::hypot(a, s).max(1e-300);
                    kernel.slope(r) + kernel.bend(r) * (s / r).powi(2)
                };
                for i in 0..4000 {
                    let s = f64::from(i) * 5e-4 - 1.0;
                    fastest = fastest.max(((second(s + 5e-4) - second(s)) / 5e-4).abs());
                }
            }
            assert!(fastest <= kernel.twist() * (1.0 + 1e-9), "{kernel:?} {fastest}");
            assert!(fastest > 0.95 * kernel.twist(), "{kernel:?} {fastest}");
        }
    }
}
