//! Rough surfaces of microfacets: the distribution of Trowbridge and Reitz (1975), "GGX".
//!
//! Smith's shadowing with correlated heights (Heitz 2014); visible normals are sampled by caps of the sphere (Dupuy and
//! Benyoub 2023, after Heitz 2018). Of those, some mirror light that comes from below the surface, which is none: where
//! nothing goes through, a part of the cap is sampled that has fewer of them (Eto and Tokuyoshi 2023). All in the frame of
//! the surface: z is its normal, directions point away from it.

use crate::sampling::{at_height, point};
use glam::{DVec3, DVec4};
use std::f64::consts::TAU;
use std::sync::LazyLock;

/// How many visible normals a directional albedo is summed over.
const ALBEDO_POINTS: u32 = 128;

/// Evenly spread places on a cap: the part of its height, sine and cosine of the angle around it.
static CAP_POINTS: LazyLock<Vec<(f64, f64, f64)>> = LazyLock::new(|| {
    let place = |(u, v): (f64, f64)| (1.0 - v, (TAU * u).sin(), (TAU * u).cos());
    (0..ALBEDO_POINTS).map(|i| place(point(i, 0))).collect()
});

/// A distribution of facets.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct Ggx {
    /// The width α of the distribution, from 0 (exclusive) to 1.
    pub(crate) alpha: f64,
}

impl Ggx {
    /// The density of normals per unit of area and solid angle.
    pub(crate) fn distribution(self, normal: DVec3) -> f64 {
        let alpha_squared = self.alpha * self.alpha;
        let spread = (normal.x * normal.x + normal.y * normal.y) / alpha_squared + normal.z * normal.z;
        if normal.z > 0.0 { 1.0 / (std::f64::consts::PI * alpha_squared * spread * spread) } else { 0.0 }
    }

    /// Smith's Λ: the area of hidden facets for one that is seen from a direction.
    fn lambda(self, direction: DVec3) -> f64 {
        let cosine_squared = direction.z * direction.z;
        let tangent_squared = (1.0 - cosine_squared).max(0.0) / cosine_squared;
        0.5 * ((1.0 + self.alpha * self.alpha * tangent_squared).sqrt() - 1.0)
    }

    /// The part of facets that is seen from both directions, on the same side.
    pub(crate) fn seen_from_both(self, a: DVec3, b: DVec3) -> f64 {
        1.0 / (1.0 + self.lambda(a) + self.lambda(b))
    }

    /// Of facets seen from `from`, on the side of the normal, the part that is seen from `to`, on either side. Of the
    /// sides, shadows are taken as unrelated.
    pub(crate) fn seen_from_too(self, from: DVec3, to: DVec3) -> f64 {
        if to.z > 0.0 {
            (1.0 + self.lambda(from)) * self.seen_from_both(from, to)
        } else {
            1.0 / (1.0 + self.lambda(to))
        }
    }

    /// A facet's normal, as often as it is seen from `from`, which is above the surface.
    pub(crate) fn visible_normal(self, from: DVec3, (u, v): (f64, f64)) -> DVec3 {
        let stretched = self.stretched(from);
        self.normal_of_cap(stretched, at_height((1.0 - v) * (1.0 + stretched.z) - stretched.z, u))
    }

    /// The same without many of the facets that mirror what comes from below the surface, and the part of all visible
    /// facets that is left: no light is lost if what is mirrored is multiplied by it.
    pub(crate) fn mirroring_normal(self, from: DVec3, (u, v): (f64, f64)) -> (DVec3, f64) {
        let stretched = self.stretched(from);
        let lowest = self.mirroring_bound(from) * stretched.z;
        let normal = self.normal_of_cap(stretched, at_height((1.0 - v) * (1.0 + lowest) - lowest, u));
        (normal, (1.0 + lowest) / (1.0 + stretched.z))
    }

    /// How low the part of the cap reaches, relative to the cap: k of Eto and Tokuyoshi 2023, eq. 5.
    fn mirroring_bound(self, from: DVec3) -> f64 {
        let alpha_squared = self.alpha * self.alpha;
        let reach = 1.0 + from.x.hypot(from.y);
        let reach_squared = reach * reach;
        (1.0 - alpha_squared) * reach_squared / (reach_squared + alpha_squared * from.z * from.z)
    }

    /// A direction where facets are those of a sphere.
    fn stretched(self, from: DVec3) -> DVec3 {
        DVec3::new(self.alpha * from.x, self.alpha * from.y, from.z).normalize()
    }

    /// The facet for a place on the cap of what is seen of a sphere.
    fn normal_of_cap(self, stretched: DVec3, cap: DVec3) -> DVec3 {
        let normal = cap + stretched;
        DVec3::new(self.alpha * normal.x, self.alpha * normal.y, normal.z.max(0.0)).normalize_or(DVec3::Z)
    }

    /// The density of [`visible_normal`](Self::visible_normal) per solid angle.
    #[cfg(test)]
    pub(crate) fn visible_density(self, from: DVec3, normal: DVec3) -> f64 {
        let masking = 1.0 / (1.0 + self.lambda(from));
        masking * self.distribution(normal) * from.dot(normal).max(0.0) / from.z
    }

    /// The mean over the facets that are seen from a direction. Of facets that mirror everything, the mean of
    /// [`mirrored_share`](Self::mirrored_share) is the directional albedo.
    pub(crate) fn mean_over_visible(self, from: DVec3, value: impl Fn(DVec3) -> DVec4) -> DVec4 {
        let stretched = self.stretched(from);
        let normal = |&(part, sin, cos): &(f64, f64, f64)| {
            let height = part * (1.0 + stretched.z) - stretched.z;
            let radius = (1.0 - height * height).max(0.0).sqrt();
            self.normal_of_cap(stretched, DVec3::new(radius * cos, radius * sin, height))
        };
        CAP_POINTS.iter().map(normal).map(value).sum::<DVec4>() / f64::from(ALBEDO_POINTS)
    }

    /// What reaches the outside of the light that a visible facet mirrors.
    pub(crate) fn mirrored_share(self, from: DVec3, normal: DVec3) -> f64 {
        let to = 2.0 * from.dot(normal) * normal - from;
        if to.z > 0.0 { self.seen_from_too(from, to) } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// The sum of a function over the upper hemisphere, weighted by solid angle.
    fn over_hemisphere(f: impl Fn(DVec3) -> f64) -> f64 {
        const ROWS: u32 = 1500;
        const COLUMNS: u32 = 360;
        let mut sum = 0.0;
        for row in 0..ROWS {
            // Finer near the pole, where narrow distributions are.
            let t = (f64::from(row) + 0.5) / f64::from(ROWS);
            let (z, width) = (1.0 - t * t * t, 3.0 * t * t / f64::from(ROWS));
            for column in 0..COLUMNS {
                let turn = (f64::from(column) + 0.5) / f64::from(COLUMNS);
                sum += f(at_height(z, turn)) * width * TAU / f64::from(COLUMNS);
            }
        }
        sum
    }

    fn from(cosine: f64) -> DVec3 {
        at_height(cosine, 0.2)
    }

    fn albedo(ggx: Ggx, from: DVec3) -> f64 {
        ggx.mean_over_visible(from, |normal| DVec4::splat(ggx.mirrored_share(from, normal))).x
    }

    #[test]
    fn facets_cover_the_surface_and_visible_ones_what_is_seen() {
        for alpha in [0.1, 0.4, 1.0] {
            let ggx = Ggx { alpha };
            assert!((over_hemisphere(|n| ggx.distribution(n) * n.z) - 1.0).abs() < 1e-3, "{alpha}");
            for cosine in [0.95, 0.5, 0.15] {
                let all = over_hemisphere(|n| ggx.visible_density(from(cosine), n));
                assert!((all - 1.0).abs() < 2e-3, "{alpha} from {cosine}: {all}");
            }
        }
    }

    /// Pearson's χ² over cells of equal solid angle above the surface, joined until each expects five samples or more.
    fn chi_squared(sample: impl Fn((f64, f64)) -> DVec3, density: impl Fn(DVec3) -> f64) -> (f64, f64) {
        const SAMPLES: u32 = 100_000;
        const SIDE: usize = 24;
        const FINE: usize = 16;
        let mut found = vec![0.0; SIDE * SIDE];
        for i in 0..SAMPLES {
            // Unrelated samples: the test counts on their chance.
            let u = (f64::from(crate::sampling::hash(i)) + 0.5) / 2f64.powi(32);
            let v = (f64::from(crate::sampling::hash(i ^ 0x8000_0000)) + 0.5) / 2f64.powi(32);
            let n = sample((u, v));
            if n.z <= 0.0 {
                continue;
            }
            let turn = (n.y.atan2(n.x) / TAU).rem_euclid(1.0);
            let cell = |x: f64| ((x * SIDE as f64) as usize).min(SIDE - 1);
            found[cell(n.z) * SIDE + cell(turn)] += 1.0;
        }
        let place = |i: usize, k: usize| (i as f64 + (k as f64 + 0.5) / FINE as f64) / SIDE as f64;
        let expected = |cell: usize| {
            let fine = (0..FINE * FINE).map(|k| {
                let n = at_height(place(cell / SIDE, k / FINE), place(cell % SIDE, k % FINE));
                density(n)
            });
            fine.sum::<f64>() * TAU / (SIDE * SIDE * FINE * FINE) as f64 * f64::from(SAMPLES)
        };
        let (mut statistic, mut freedom, mut rest) = (0.0, -1.0, (0.0, 0.0));
        for (cell, found) in found.into_iter().enumerate() {
            rest = (rest.0 + found, rest.1 + expected(cell));
            if rest.1 >= 5.0 {
                statistic += (rest.0 - rest.1) * (rest.0 - rest.1) / rest.1;
                freedom += 1.0;
                rest = (0.0, 0.0);
            }
        }
        (statistic, freedom)
    }

    /// χ² of many degrees of freedom is about normal, with a variance of twice their number: five deviations.
    fn is_plausible((statistic, freedom): (f64, f64)) -> bool {
        (statistic - freedom) / (2.0 * freedom).sqrt() < 5.0
    }

    #[test]
    fn sampled_normals_have_their_density() {
        for alpha in [0.3, 0.6, 1.0] {
            for cosine in [0.95, 0.5, 0.15] {
                let (ggx, from) = (Ggx { alpha }, from(cosine));
                let sample = |square| ggx.visible_normal(from, square);
                let result = chi_squared(sample, |n| ggx.visible_density(from, n));
                assert!(is_plausible(result), "α = {alpha}, cos = {cosine}: {result:?}");
                // The test can fail: a distribution wider by a twentieth is told apart.
                let wider = Ggx { alpha: alpha * 1.05 };
                assert!(!is_plausible(chi_squared(sample, |n| wider.visible_density(from, n))));
            }
        }
    }

    /// Mirrored directions have the density of those of all visible normals, over the part that is left, wherever they
    /// are above the surface.
    #[test]
    fn mirrored_directions_have_their_density() {
        for alpha in [0.3, 0.6, 1.0] {
            for cosine in [0.95, 0.5, 0.15] {
                let (ggx, from) = (Ggx { alpha }, from(cosine));
                let mirrored = |n: DVec3| 2.0 * from.dot(n) * n - from;
                let part = ggx.mirroring_normal(from, (0.5, 0.5)).1;
                let density = |ggx: Ggx, to: DVec3| {
                    let half = (from + to).normalize();
                    ggx.visible_density(from, half) / (4.0 * from.dot(half)) / part
                };
                let sample = |square| mirrored(ggx.mirroring_normal(from, square).0);
                let result = chi_squared(sample, |to| density(ggx, to));
                assert!(is_plausible(result), "α = {alpha}, cos = {cosine}: {result:?}");
                let wider = Ggx { alpha: alpha * 1.05 };
                assert!(!is_plausible(chi_squared(sample, |to| density(wider, to))));
            }
        }
    }

    /// With bounds fewer rays are lost below the surface: for smooth enough surfaces hardly any.
    #[test]
    fn few_facets_mirror_light_from_below() {
        let below = |alpha: f64, cosine: f64, bounded: bool| {
            let (ggx, from) = (Ggx { alpha }, from(cosine));
            let normal = |square| match bounded {
                true => ggx.mirroring_normal(from, square).0,
                false => ggx.visible_normal(from, square),
            };
            let lost = (0..4096).map(|i| normal(point(i, 3))).filter(|n| 2.0 * from.dot(*n) * n.z <= from.z);
            lost.count() as f64 / 4096.0
        };
        for (alpha, cosine, most) in [(0.3, 0.15, 0.25), (0.6, 0.3, 0.2), (0.6, 0.7, 0.2)] {
            let (all, bounded) = (below(alpha, cosine, false), below(alpha, cosine, true));
            assert!(bounded < 0.9 * all && bounded < most, "{alpha}, {cosine}: {bounded} of {all}");
        }
    }

    #[test]
    fn the_albedo_is_that_of_quadrature() {
        for alpha in [0.1, 0.5, 1.0] {
            for cosine in [0.95, 0.5, 0.15] {
                let (ggx, from) = (Ggx { alpha }, from(cosine));
                let brdf_cosine = |to: DVec3| {
                    let half = (from + to).normalize();
                    ggx.distribution(half) * ggx.seen_from_both(from, to) / (4.0 * from.z)
                };
                let exact = over_hemisphere(brdf_cosine);
                let found = albedo(ggx, from);
                assert!((found - exact).abs() < 0.01, "{alpha}, {cosine}: {found} {exact}");
            }
        }
        // Facets of a nearly smooth surface hide nothing from each other.
        assert!((albedo(Ggx { alpha: 1e-3 }, from(0.7)) - 1.0).abs() < 1e-4);
        assert!(Ggx { alpha: 1.0 }.distribution(DVec3::Z) * PI - 1.0 < 1e-12);
    }
}
