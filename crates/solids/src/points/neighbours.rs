//! The nearest points of a cloud.

/// A k-d tree (Bentley 1975): the middle of each stretch of the order divides it along the axis of its depth.
pub(super) struct Neighbours<'a> {
    points: &'a [[f64; 3]],
    order: Vec<usize>,
}

impl<'a> Neighbours<'a> {
    /// Sorts points, of which all numbers are finite.
    pub(super) fn new(points: &'a [[f64; 3]]) -> Self {
        let mut order: Vec<usize> = (0..points.len()).collect();
        sort(points, &mut order, 0);
        Self { points, order }
    }

    /// The `count` points nearest to a place, in order of their distance, or all if there are fewer.
    pub(super) fn nearest(&self, place: [f64; 3], count: usize) -> Vec<usize> {
        let mut found = Vec::with_capacity(count + 1);
        self.visit(&self.order, 0, &mut Query { place, count, found: &mut found });
        found.into_iter().map(|(_, point)| point).collect()
    }

    fn visit(&self, order: &[usize], axis: usize, query: &mut Query<'_>) {
        let middle = order.len() / 2;
        let Some(&point) = order.get(middle) else { return };
        let at = self.points[point];
        query.offer(point, at);
        let beside = query.place[axis] - at[axis];
        let (before, behind) = (&order[..middle], &order[middle + 1..]);
        let (near, far) = if beside < 0.0 { (before, behind) } else { (behind, before) };
        let next = (axis + 1) % 3;
        self.visit(near, next, query);
        if query.reaches(beside * beside) {
            self.visit(far, next, query);
        }
    }
}

fn sort(points: &[[f64; 3]], order: &mut [usize], axis: usize) {
    let middle = order.len() / 2;
    if middle == 0 {
        return;
    }
    order.select_nth_unstable_by(middle, |&a, &b| points[a][axis].total_cmp(&points[b][axis]));
    let (before, behind) = order.split_at_mut(middle);
    sort(points, before, (axis + 1) % 3);
    sort(points, &mut behind[1..], (axis + 1) % 3);
}

struct Query<'f> {
    place: [f64; 3],
    count: usize,
    /// Squared distances and points, the nearest first.
    found: &'f mut Vec<(f64, usize)>,
}

impl Query<'_> {
    fn offer(&mut self, point: usize, at: [f64; 3]) {
        let squared = (0..3).map(|k| (at[k] - self.place[k]).powi(2)).sum::<f64>();
        if self.reaches(squared) {
            let place = self.found.partition_point(|known| *known < (squared, point));
            self.found.insert(place, (squared, point));
            self.found.truncate(self.count);
        }
    }

    /// Whether a point so far away may be one of those that are looked for.
    fn reaches(&self, squared: f64) -> bool {
        self.found.len() < self.count || self.found.last().is_some_and(|(most, _)| squared <= *most)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points on a lattice, of which many are equally far and some coincide.
    #[test]
    fn the_nearest_are_those_of_a_search_of_all() {
        let points: Vec<[f64; 3]> = (0..300u32)
            .map(|i| [i.wrapping_mul(7) % 11, i.wrapping_mul(5) % 13, i * i % 7].map(f64::from))
            .collect();
        let tree = Neighbours::new(&points);
        for place in [points[17], [3.3, 2.1, 9.0], [-50.0, 0.0, 0.0]] {
            let squared = |p: &[f64; 3]| (0..3).map(|k| (p[k] - place[k]).powi(2)).sum::<f64>();
            let mut all: Vec<f64> = points.iter().map(squared).collect();
            all.sort_by(f64::total_cmp);
            let found: Vec<f64> = tree.nearest(place, 20).into_iter().map(|i| squared(&points[i])).collect();
            assert_eq!(found, all[..20]);
        }
        assert_eq!(tree.nearest([0.0; 3], 1000).len(), 300);
    }
}
