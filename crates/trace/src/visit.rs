//! The march of one ray, step by step: for those who want to see how a hit was found.

use crate::march::{Job, Marcher};
use crate::ray::{Method, Outcome, Ray, Settings};
use fieldstone_field::Tape;

/// A span that the march looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Visit {
    /// The least t.
    pub start: f64,
    /// The largest t.
    pub end: f64,
    /// The part to which zeros are confined, all of the span if nothing is known; `None`: there are none.
    pub left: Option<(f64, f64)>,
}

/// The first crossing of a ray and the spans that were looked at on the way, in their order.
///
/// One ray is marched for itself: [`Tracer`](crate::Tracer) asks for boxes around whole bundles first, and its rays begin
/// where these end. [`Method::Sampled`] looks at no spans; with it nothing is found.
pub fn visited_spans(tape: &Tape, ray: Ray, settings: &Settings) -> (Outcome, Vec<Visit>) {
    let (mut outcome, mut visits) = (Outcome::nothing(), Vec::new());
    if !matches!(settings.method, Method::Sampled { .. }) {
        let job = Job { ray, place: 0, spent: 0, inside: None };
        let finish = |_: &Job, found| outcome = found;
        Marcher::default().run_observed(tape, settings, [job].into_iter(), finish, |(start, end), span| {
            // A bracket's near end may pass a span before anybody looks at it.
            if start < end {
                visits.push(Visit { start, end, left: span.clip(start, end) });
            }
        });
    }
    (outcome, visits)
}

#[cfg(test)]
mod tests {
    use super::*;
    use fieldstone_field::{Field, Graph, Input, TapeOptions};

    /// x² + y² + z² − 1.
    fn ball() -> Tape {
        let mut graph = Graph::new();
        let squares = [0, 1, 2].map(|i| {
            let x = graph.input(Input::Coordinate(i));
            graph.square(x)
        });
        let sum = graph.add(squares[0], squares[1]);
        let sum = graph.add(sum, squares[2]);
        let one = graph.constant(1.0);
        let value = graph.sub(sum, one);
        Tape::new(&Field::new(graph, value, Vec::new()), &TapeOptions::default())
    }

    fn visits(method: Method, height: f64) -> (Outcome, Vec<Visit>) {
        let ray = Ray { origin: [-3.0, height, 0.0], direction: [1.0, 0.0, 0.0], start: 0.0, end: 6.0 };
        visited_spans(&ball(), ray, &Settings { method, ..Settings::new(2.0) })
    }

    #[test]
    fn what_was_excluded_leads_up_to_the_hit() {
        for method in [Method::Affine, Method::Interval { accept_epsilon: None }] {
            let (outcome, visits) = visits(method, 0.0);
            let hit = outcome.hit.unwrap();
            assert!((hit.t - 2.0).abs() < 1e-7);
            // Clipped parts count as excluded where they were cut off.
            let mut front = 0.0;
            for visit in &visits {
                assert!(visit.start <= front, "{visit:?} after {front}");
                let next = visit.left.map_or(visit.end, |(a, _)| a);
                front = if visit.start <= front { f64::max(front, next) } else { front };
            }
            assert!((front - hit.before).abs() < 1e-9, "{front} {hit:?}");
        }
    }

    #[test]
    fn a_miss_is_excluded_from_end_to_end() {
        let (outcome, visits) = visits(Method::Affine, 1.5);
        assert_eq!(outcome.hit, None);
        let excluded: f64 = visits.iter().filter(|v| v.left.is_none()).map(|v| v.end - v.start).sum();
        let clipped: f64 = visits.iter().filter_map(|v| v.left.map(|(a, _)| a - v.start)).sum();
        assert!((excluded + clipped - 6.0).abs() < 1e-9, "{excluded} {clipped}");
    }

    #[test]
    fn samples_visit_nothing() {
        assert_eq!(visits(Method::Sampled { step: 0.1 }, 0.0).1, []);
    }
}
