//! Light that comes straight from lamps and from the sky.
//!
//! Every surface that is seen asks for light: it makes wishes, each a ray towards a place on a lamp, or into a direction
//! of the sky, with what it brings if nothing is in its way. Wishes of many surfaces for one lamp are granted together.
//! Shadow rays start where the ray that looks was certainly still on its side, one bracket's width before the surface, so
//! that there is neither acne nor leaking light.
//!
//! Surfaces that the picture shows faintly, as in a mirror or since they are dark, make fewer wishes, and so do all
//! samples of a pixel but the first: their means are those of the pixel.
//!
//! Where it is known what an even sky sends if nothing is in its way, only the share that gets through is estimated
//! (the ratio estimator of Heitz, Hill and McGuire 2018): in the open there is no noise at all.

use crate::bsdf::Scatter;
use crate::query::{Asker, Prepared};
use crate::sampling::{Draw, derive, luminance, sphere};
use crate::shadows::{ShadowRay, Shadows};
use crate::sky::Sky;
use crate::volumes::{Flakes, Piece};
use fieldstone_scene::{Environment, Illumination, Light, Rgb};
use fieldstone_texel::lit_share;
use glam::DVec3;
use std::f64::consts::PI;

/// About how many shadow rays are asked for together.
const TOGETHER: usize = 1 << 14;

/// Surfaces whose light counts less than this in the picture look at fewer places, in proportion.
const FAINT: f64 = 0.25;

/// From so many directions on, the share that gets through is taken for that of all the sky's light. The error of a
/// ratio of means falls with their number.
const ENOUGH: u32 = 4;

/// The choices that points of a pixel's sequences stand for.
pub(crate) mod choice {
    pub(crate) const LENS: u32 = 1;
    pub(crate) const FACET: u32 = 2;
    pub(crate) const KIND: u32 = 3;
    pub(crate) const SKY: u32 = 4;
    /// And those after it, for further lamps.
    pub(crate) const LAMP: u32 = 16;
}

/// A surface that is seen, and how it scatters light.
pub(crate) struct Seen<'c> {
    /// The last place that is certainly before it.
    pub(crate) place: DVec3,
    pub(crate) normal: DVec3,
    pub(crate) scatter: &'c Scatter,
    /// Which sample of the picture the light is for, and what it is multiplied by on its way there.
    pub(crate) sample: usize,
    pub(crate) weight: Rgb,
    /// What chance depends on here.
    pub(crate) draw: Draw,
    /// Whether one place on each lamp is enough, because chance led here already.
    pub(crate) by_chance: bool,
}

/// A piece of a ray in a volume, and how it scatters light.
pub(crate) struct Lit<'c> {
    pub(crate) piece: &'c Piece<'c>,
    pub(crate) flakes: Flakes,
    /// An origin and a unit direction.
    pub(crate) ray: (DVec3, DVec3),
    /// Which sample of the picture the light is for, and what it is multiplied by on its way there.
    pub(crate) sample: usize,
    pub(crate) weight: Rgb,
    /// What chance depends on here.
    pub(crate) draw: Draw,
}

/// The optical depth towards each lamp from where the last piece of a ray ended: the next mostly begins there.
#[derive(Default)]
pub(crate) struct Known(Vec<Option<KnownDepth>>);

#[derive(Clone, Copy)]
struct KnownDepth {
    t: f64,
    to_light: DVec3,
    depth: f64,
}

impl Lit<'_> {
    fn at(&self, t: f64) -> DVec3 {
        self.ray.0 + t * self.ray.1
    }
}

/// Light that surfaces get straight from where it is given off.
pub(crate) struct Lamps<'s, 'p> {
    prepared: &'p Prepared<'s>,
    sky: &'p Sky<'s>,
    shadows: Shadows<'s, 'p>,
}

/// A shadow ray, and what it brings if neither solids nor volumes are in its way.
#[derive(Clone, Copy)]
struct Wish {
    ray: ShadowRay,
    brings: Rgb,
    /// What volumes leave of it.
    passes: f64,
}

/// The wishes of one surface for one lamp.
struct Estimate {
    sample: usize,
    /// How many of the wishes are its own, and of how many directions they are what is lit.
    wishes: usize,
    directions: u32,
    /// What all bring if nothing is in the way, where that is known exactly.
    whole: Option<Rgb>,
    /// Whether another choice of directions would bring something else.
    by_chance: bool,
}

/// Wishes for one lamp, or for the sky.
#[derive(Default)]
struct Asked {
    wishes: Vec<Wish>,
    estimates: Vec<Estimate>,
}

/// Wishes for all light. A thread keeps it, since memory is dear to get.
#[derive(Default)]
pub(crate) struct Wishes {
    /// Of each lamp; the last are those for the sky.
    asked: Vec<Asked>,
}

/// What a surface sends back.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Sent {
    pub(crate) colour: Rgb,
    /// The variance of its luminance, as far as it comes of chance.
    pub(crate) variance: f64,
}

impl<'s, 'p> Lamps<'s, 'p> {
    pub(crate) fn new(prepared: &'p Prepared<'s>, sky: &'p Sky<'s>) -> Self {
        Self { prepared, sky, shadows: Shadows::new(prepared) }
    }

    /// Asks for the light that a surface sends back against its ray; what the ambient light brings, it has at once.
    pub(crate) fn ask(&self, wishes: &mut Wishes, seen: &Seen<'_>) -> Rgb {
        let lighting = self.prepared.scene.lighting();
        wishes.asked.resize_with(lighting.lights.len() + 1, Asked::default);
        if seen.scatter.is_lit() {
            for (number, light) in (0..).zip(&lighting.lights) {
                let asked = &mut wishes.asked[number as usize];
                self.ask_lamp(asked, seen, (number, light));
            }
            if let (Some(environment), Some(asked)) = (self.sky.environment(), wishes.asked.last_mut()) {
                self.ask_sky(asked, seen, environment);
            }
        }
        seen.scatter.diffuse() * lighting.ambient
    }

    fn ask_lamp(&self, asked: &mut Asked, seen: &Seen<'_>, (number, light): (u32, &Light)) {
        let samples = light.samples();
        let directions = self.directions(seen, samples, 1.0);
        let lit = seen.draw.points(choice::LAMP + number, directions).filter_map(|place| {
            let Illumination { to_light, distance, colour } = light.sample(seen.place, place)?;
            let passes = self.passes(light.casts_shadow(), seen.place, (to_light, distance));
            let response = seen.scatter.respond(to_light);
            let brings = seen.weight * colour * response / f64::from(directions);
            let is_lit = to_light.dot(seen.normal) > 0.0 && brings.max_element() > 0.0;
            let ray = seen.ray((to_light, distance), brings);
            is_lit.then_some(Wish { ray, brings, passes })
        });
        asked.add(lit, |wishes| Estimate {
            sample: seen.sample,
            wishes,
            directions,
            whole: None,
            by_chance: light.is_area(),
        });
    }

    fn ask_sky(&self, asked: &mut Asked, seen: &Seen<'_>, environment: &Environment) {
        let (diffuse, highlight) = (seen.scatter.diffuse(), seen.scatter.highlight());
        let share = diffuse.max_element() + highlight.map_or(0.0, |h| h.albedo());
        if share <= 0.0 {
            return;
        }
        let samples = environment.samples();
        let directions = self.directions(seen, samples, share);
        let points = seen.draw.points(choice::SKY, directions);
        let lit = points.filter_map(|square| {
            let look = self.sky.look(seen.normal, highlight.as_ref(), square)?;
            let mut response = diffuse * look.direction.dot(seen.normal);
            response += highlight.map_or(0.0, |h| h.respond(look.direction));
            let light = environment.light(seen.place, look.direction);
            let weight = 1.0 / (PI * look.density * f64::from(directions));
            let passes = self.passes(true, seen.place, (look.direction, f64::INFINITY));
            let brings = seen.weight * light * response * weight;
            Some(Wish { ray: seen.ray((look.direction, f64::INFINITY), brings), brings, passes })
        });
        let whole = environment.on_matt(seen.normal).filter(|_| highlight.is_none());
        asked.add(lit, |wishes| Estimate {
            sample: seen.sample,
            wishes,
            directions,
            whole: whole.map(|light| seen.weight * light * diffuse),
            by_chance: true,
        });
    }

    /// Asks for the light that a piece of a ray in a volume sends back; what the ambient light brings, it has at once.
    ///
    /// It looks at one place on each lamp, and in one direction to the sky.
    pub(crate) fn ask_in_volume(&self, wishes: &mut Wishes, lit: &Lit<'_>, known: &mut Known) -> Rgb {
        let lighting = self.prepared.scene.lighting();
        wishes.asked.resize_with(lighting.lights.len() + 1, Asked::default);
        let middle = lit.at(0.5 * (lit.piece.from + lit.piece.to));
        known.0.resize(lighting.lights.len(), None);
        let lights = lighting.lights.iter().zip(&mut known.0).zip(&mut wishes.asked);
        for (number, ((light, known), asked)) in (0..).zip(lights) {
            let found = light.sample(middle, lit.draw.point(choice::LAMP + number));
            let Some(Illumination { to_light, distance, colour }) = found else { continue };
            // A white, matt surface scatters a share of 1 / π.
            let brings =
                colour * PI * self.lit(lit, (to_light, distance), light.casts_shadow().then_some(known));
            asked.add_from(lit, middle, (to_light, distance), (brings, light.is_area()));
        }
        if let (Some(environment), Some(asked)) = (self.sky.environment(), wishes.asked.last_mut()) {
            let direction = sphere(lit.draw.point(choice::SKY));
            let towards = (direction, f64::INFINITY);
            let brings =
                environment.light(middle, direction) * (4.0 * PI) * self.lit(lit, towards, Some(&mut None));
            asked.add_from(lit, middle, towards, (brings, true));
        }
        lit.weight * lighting.ambient * lit.flakes.albedo() * -(-lit.piece.depth).exp_m1()
    }

    /// What a piece sends back of light of a direction, if no solid is in its way, per irradiance. A lamp that throws shadows
    /// has a depth that may be known.
    fn lit(
        &self,
        lit: &Lit<'_>,
        (to_light, distance): (DVec3, f64),
        known: Option<&mut Option<KnownDepth>>,
    ) -> Rgb {
        let depths = known.map_or([0.0; 2], |known| {
            let depth = |t: f64| self.prepared.volumes.depth(lit.at(t), to_light, distance);
            let [near, far] = lit.piece.ends();
            // Where light runs along the faces of cells, the two sides of a face are different columns.
            let is_oblique = to_light.abs().min_element() > 1e-6;
            let is_same = |k: &KnownDepth| k.t == lit.piece.from && k.to_light == to_light && is_oblique;
            let depths = [known.filter(is_same).map_or_else(|| depth(near), |k| k.depth), depth(far)];
            *known = Some(KnownDepth { t: lit.piece.to, to_light, depth: depths[1] });
            depths
        });
        lit.weight * lit.flakes.respond(to_light) * lit_share(lit.piece.depth, depths)
    }

    /// What volumes leave of light on its way.
    fn passes(&self, casts_shadow: bool, place: DVec3, (to_light, distance): (DVec3, f64)) -> f64 {
        if casts_shadow { self.prepared.volumes.transmittance(place, to_light, distance) } else { 1.0 }
    }

    /// How many places of so many that are asked for a surface looks at, if it sends back this share of the light.
    fn directions(&self, seen: &Seen<'_>, samples: u32, share: f64) -> u32 {
        if seen.by_chance || samples == 1 {
            return 1;
        }
        let counts = (seen.weight.max_element() * share / FAINT).min(1.0);
        let among = if seen.draw.is_first { 1.0 } else { self.share_of_later() };
        ((f64::from(samples) * counts * among).ceil() as u32).clamp(1, samples)
    }

    /// What each sample of a pixel but the first looks at: together about twice as much as the first.
    fn share_of_later(&self) -> f64 {
        (2.0 / f64::from(self.prepared.scene.settings().samples)).min(1.0)
    }

    /// Grants what has been asked for, if that is much or `all` is wanted: tells `take` for each sample what it gets.
    pub(crate) fn grant(
        &self,
        asker: &mut Asker,
        wishes: &mut Wishes,
        all: bool,
        mut take: impl FnMut(usize, Sent),
    ) {
        let shadows = self.prepared.scene.lighting().lights.iter().map(Light::casts_shadow);
        for (asked, casts_shadow) in wishes.asked.iter_mut().zip(shadows.chain([true])) {
            if asked.wishes.is_empty() || (!all && asked.wishes.len() < TOGETHER) {
                continue;
            }
            let left = match casts_shadow {
                true => self.shadows.left(asker, asked.wishes.iter().map(|wish| wish.ray)),
                false => vec![DVec3::ONE; asked.wishes.len()],
            };
            let mut start = 0;
            for estimate in &asked.estimates {
                let end = start + estimate.wishes;
                take(estimate.sample, estimate.sent(&asked.wishes[start..end], &left[start..end]));
                start = end;
            }
            asked.wishes.clear();
            asked.estimates.clear();
        }
    }
}

impl Seen<'_> {
    /// A shadow ray in a direction, over a distance.
    fn ray(&self, (direction, distance): (DVec3, f64), brings: Rgb) -> ShadowRay {
        let seed = derive(self.draw.seed ^ direction.x.to_bits() as u32, self.draw.index);
        ShadowRay { origin: self.place, direction, distance, worth: brings.max_element(), seed }
    }
}

impl Asked {
    /// The wish of a piece of a ray in a volume, from its middle.
    fn add_from(
        &mut self,
        lit: &Lit<'_>,
        origin: DVec3,
        (direction, distance): (DVec3, f64),
        (brings, by_chance): (Rgb, bool),
    ) {
        let (worth, seed) = (brings.max_element(), derive(lit.draw.seed, lit.draw.index));
        let wish = Wish { ray: ShadowRay { origin, direction, distance, worth, seed }, brings, passes: 1.0 };
        let estimate =
            |wishes| Estimate { sample: lit.sample, wishes, directions: 1, whole: None, by_chance };
        self.add((worth > 0.0).then_some(wish).into_iter(), estimate);
    }

    fn add(&mut self, wishes: impl Iterator<Item = Wish>, estimate: impl FnOnce(usize) -> Estimate) {
        let before = self.wishes.len();
        self.wishes.extend(wishes);
        let added = self.wishes.len() - before;
        if added > 0 {
            self.estimates.push(estimate(added));
        }
    }
}

impl Estimate {
    /// What the wishes bring, if this is left of each.
    fn sent(&self, wishes: &[Wish], left: &[Rgb]) -> Sent {
        let (mut came, mut all, mut squares) = (DVec3::ZERO, DVec3::ZERO, 0.0);
        let (mut some_blocked, mut some_came) = (false, false);
        for (wish, &left) in wishes.iter().zip(left) {
            let left = left * wish.passes;
            let light = wish.brings * left;
            came += light;
            all += wish.brings;
            squares += luminance(light) * luminance(light);
            some_blocked |= left != DVec3::ONE;
            some_came |= left != DVec3::ZERO;
        }
        let whole = self.whole.filter(|_| self.directions >= ENOUGH);
        let colour = whole.map_or(came, |whole| whole * came / all.max(DVec3::splat(f64::MIN_POSITIVE)));
        let n = f64::from(self.directions);
        let spread = match self.directions {
            // Nothing is known; half of it may be in the way.
            1 => 0.25 * luminance(all) * luminance(all),
            _ => ((n * squares - luminance(came) * luminance(came)) / (n - 1.0)).max(0.0),
        };
        let variance = match (self.by_chance, some_blocked && some_came) {
            (false, _) => 0.0,
            // The edge of a shadow: the error of evenly spread places falls about as n to −3/4.
            (true, true) => spread / n.sqrt(),
            (true, false) if whole.is_some() || !some_came => 0.0,
            // Without shadows light varies smoothly: of evenly spread places the error falls as their number.
            (true, false) => spread / n,
        };
        Sent { colour, variance }
    }
}
