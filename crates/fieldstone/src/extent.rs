//! Where to look for what is to be drawn.

use crate::request::Warning;
use fieldstone_field::{Bindings, Field, Graph, Input};
use fieldstone_scene::{Ball, Bounds, BoundsError};
use fieldstone_space::{Extent, FoundBounds, solid_bounds};
use glam::DVec3;

/// What is searched: a solid or a surface, and what of it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wanted<'m> {
    pub(crate) field: &'m Field,
    pub(crate) bindings: &'m Bindings,
    pub(crate) surface: bool,
    pub(crate) clip: Option<&'m Ball>,
}

/// The box around the solid of a field.
pub(crate) fn find_solid(
    field: &Field,
    bindings: &Bindings,
) -> Result<(Bounds, Option<Warning>), BoundsError> {
    find_bounds(&Wanted { field, bindings, surface: false, clip: None })
}

/// The box around what is wanted, and what may be strange about it.
pub(crate) fn find_bounds(wanted: &Wanted<'_>) -> Result<(Bounds, Option<Warning>), BoundsError> {
    let mut varying_free = wanted.bindings.clone();
    (0..3).for_each(|k| varying_free.set(Input::Coordinate(k), 0.0));
    let found = if wanted.surface || wanted.clip.is_some() {
        solid_bounds(&searched_field(wanted), &varying_free)
    } else {
        solid_bounds(wanted.field, &varying_free)
    };
    let warning = warning(wanted, &found);
    let bounds = Bounds::new(DVec3::from(found.min), DVec3::from(found.max))?;
    let bounds = match wanted.clip {
        None => bounds,
        // A ball may lie where nothing is searched.
        Some(ball) if found.extent != Extent::Bounded => *ball.bounds(),
        Some(ball) => bounds.intersection(ball.bounds()).unwrap_or(*ball.bounds()),
    };
    Ok((bounds, warning))
}

fn warning(wanted: &Wanted<'_>, found: &FoundBounds) -> Option<Warning> {
    match (found.extent, wanted.surface, wanted.clip) {
        (Extent::Unbounded, _, Some(_)) => None,
        (Extent::Empty | Extent::NotFound, _, Some(_)) => Some(Warning::NothingInSphere),
        (Extent::Empty, true, None) => Some(Warning::EmptySurface),
        _ => match Warning::of_bounds(found) {
            Some(Warning::Unbounded(cut)) if wanted.surface => Some(Warning::UnboundedSurface(cut)),
            other => other,
        },
    }
}

/// A field that is negative where there is something to be seen.
fn searched_field(wanted: &Wanted<'_>) -> Field {
    let mut graph = Graph::clone(wanted.field.graph());
    let mut value = wanted.field.value();
    if wanted.surface {
        // Negative where f is 0, and nowhere else but for rounding.
        let (size, least) = (graph.abs(value), graph.constant(f64::MIN_POSITIVE));
        value = graph.sub(size, least);
    }
    if let Some(ball) = wanted.clip {
        let mut outside = graph.constant(-ball.radius() * ball.radius());
        for (axis, centre) in ball.centre().to_array().into_iter().enumerate() {
            let (x, centre) = (graph.input(Input::Coordinate(axis as u16)), graph.constant(centre));
            let apart = graph.sub(x, centre);
            let square = graph.square(apart);
            outside = graph.add(outside, square);
        }
        value = graph.max(value, outside);
    }
    Field::new(graph, value, Vec::new()).with_fuel(wanted.field.fuel())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Inputs, formula};

    fn find(text: &str, surface: bool, clip: Option<(DVec3, f64)>) -> (Bounds, Option<Warning>) {
        let model = formula(text).unwrap().model;
        let bindings = Inputs::default().bindings(&model).unwrap();
        let clip = clip.map(|(centre, radius)| Ball::new(centre, radius).unwrap());
        let wanted = Wanted { field: &model.field, bindings: &bindings, surface, clip: clip.as_ref() };
        find_bounds(&wanted).unwrap()
    }

    /// Whether a box is that around the origin with this half side, or a little larger.
    fn is_about(bounds: &Bounds, half: f64) -> bool {
        let (low, high) = (-bounds.max().max_element(), bounds.min().min_element());
        let sides = [-low, -high, -bounds.min().max_element(), bounds.max().min_element()];
        sides.iter().all(|s| (half..1.07 * half).contains(s))
    }

    #[test]
    fn surfaces_are_where_the_field_is_zero() {
        for text in ["(x^2+y^2+z^2-4)^2", "4-x^2-y^2-z^2", "x^2+y^2+z^2-4", "abs(x^2+y^2+z^2-4)"] {
            let (bounds, warning) = find(text, true, None);
            assert!(is_about(&bounds, 2.0), "{text}: {bounds:?}");
            assert_eq!(warning, None, "{text}");
        }
        assert_eq!(find("z^2", true, None).1, Some(Warning::UnboundedSurface(10)));
        assert_eq!(find("x^2+1", true, None).1, Some(Warning::EmptySurface));
        assert_eq!(find("(x^2+y^2+z^2-4)^2", false, None).1, Some(Warning::Empty));
    }

    #[test]
    fn a_ball_bounds_what_is_endless() {
        for (text, surface) in [("x", false), ("x", true), ("-1", false)] {
            let (bounds, warning) = find(text, surface, Some((DVec3::ZERO, 3.0)));
            assert!((bounds.size() - DVec3::new(6.0, 6.0, 6.0)).max_element() <= 0.0, "{bounds:?}");
            assert!(bounds.max().y.min(bounds.max().z) > 2.9, "{text}: {bounds:?}");
            assert_eq!(warning, None, "{text}");
        }
        // Half of the ball is left, or a disc.
        assert!(find("x", false, Some((DVec3::ZERO, 3.0))).0.max().x < 0.1);
        let disc = find("x", true, Some((DVec3::ZERO, 3.0))).0;
        assert!(disc.size().x < 0.2, "{disc:?}");
        let far = find("-1", false, Some((DVec3::splat(5000.0), 3.0)));
        assert_eq!(far.0.centre(), DVec3::splat(5000.0));
        let nothing = find("x^2+y^2+z^2-1", false, Some((DVec3::splat(5.0), 1.0)));
        assert_eq!(nothing.1, Some(Warning::NothingInSphere));
    }
}
