//! Which transparent bodies a ray is in.

use fieldstone_scene::{Appearance, Rgb};
use glam::DVec3;

/// The most bodies that a ray may be in at once; in those that it enters beyond, it is not known to be.
const MOST: usize = 4;

/// A transparent body.
#[derive(Clone, Copy, PartialEq, Debug)]
struct Medium {
    body: usize,
    index: f64,
    absorption: Rgb,
}

/// The bodies that a ray is in, in the order in which it entered them. Where bodies overlap, the one entered last fills
/// the place: a liquid that reaches a little into its glass meets it without a gap.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub(crate) struct Media {
    bodies: [Option<Medium>; MOST],
}

/// What a passage through the surface of a body changes.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct Passage {
    /// The refractive index beyond, relative to that before.
    pub(crate) eta: f64,
    /// The bodies that the ray is in beyond.
    pub(crate) beyond: Media,
}

impl Media {
    fn index(&self) -> f64 {
        self.bodies.iter().flatten().last().map_or(1.0, |medium| medium.index)
    }

    /// How much of the light is left after a length in here.
    pub(crate) fn transmittance(&self, length: f64) -> Rgb {
        let absorption = self.bodies.iter().flatten().last().map_or(DVec3::ZERO, |m| m.absorption);
        // 0 · ∞ is nothing absorbed.
        if absorption == DVec3::ZERO { DVec3::ONE } else { (-absorption * length).exp() }
    }

    fn without(&self, body: usize) -> Self {
        let mut bodies = [None; MOST];
        let others = self.bodies.iter().flatten().filter(|medium| medium.body != body);
        bodies.iter_mut().zip(others).for_each(|(place, medium)| *place = Some(*medium));
        Self { bodies }
    }

    /// What lies beyond the surface of a body that looks like this, seen from its inside or from outside.
    pub(crate) fn passage(&self, body: usize, look: &Appearance, from_inside: bool) -> Passage {
        let others = self.without(body);
        if from_inside {
            // A ray that began inside has not entered.
            let known = self.bodies.iter().flatten().find(|medium| medium.body == body);
            let is_last = self.bodies.iter().flatten().last() == known;
            let here = match known {
                None => look.index,
                Some(medium) if is_last => medium.index,
                Some(_) => self.index(),
            };
            let eta = if known.is_some() && !is_last { 1.0 } else { others.index() / here };
            return Passage { eta, beyond: others };
        }
        let mut beyond = others;
        let entered = Medium { body, index: look.index, absorption: look.absorption };
        if let Some(place) = beyond.bodies.iter_mut().find(|place| place.is_none()) {
            *place = Some(entered);
        }
        Passage { eta: look.index / others.index(), beyond }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn glass(index: f64) -> Appearance {
        Appearance { index, absorption: DVec3::new(0.0, 1.0, 2.0), ..Appearance::default() }
    }

    #[test]
    fn a_body_is_entered_and_left() {
        let air = Media::default();
        let entering = air.passage(7, &glass(1.5), false);
        assert_eq!(entering.eta, 1.5);
        let left = entering.beyond.passage(7, &glass(1.5), true);
        assert_eq!((left.eta, left.beyond), (1.0 / 1.5, air));
        // A ray that began inside.
        assert_eq!(air.passage(7, &glass(1.5), true), Passage { eta: 1.0 / 1.5, beyond: air });
    }

    #[test]
    fn of_overlapping_bodies_the_last_fills_the_place() {
        let in_glass = Media::default().passage(0, &glass(1.5), false).beyond;
        let entering = in_glass.passage(1, &glass(1.33), false);
        assert!((entering.eta - 1.33 / 1.5).abs() < 1e-15);
        // The end of the glass, within the liquid, is nothing.
        let out_of_glass = entering.beyond.passage(0, &glass(1.5), true);
        assert_eq!(out_of_glass.eta, 1.0);
        assert!((out_of_glass.beyond.passage(1, &glass(1.33), true).eta - 1.0 / 1.33).abs() < 1e-15);
    }

    #[test]
    fn light_fades_inside_and_not_outside() {
        let inside = Media::default().passage(0, &glass(1.5), false).beyond;
        let fraction = |x: f64| (-x).exp();
        assert!((inside.transmittance(0.5) - DVec3::new(1.0, fraction(0.5), fraction(1.0))).length() < 1e-15);
        assert_eq!(Media::default().transmittance(f64::INFINITY), DVec3::ONE);
    }

    #[test]
    fn there_is_no_end_of_bodies() {
        let mut media = Media::default();
        for body in 0..9 {
            media = media.passage(body, &glass(1.5), false).beyond;
        }
        for body in 0..9 {
            media = media.passage(body, &glass(1.5), true).beyond;
        }
        assert_eq!(media, Media::default());
    }
}
