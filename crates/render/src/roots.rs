//! Where rays cross the zeros of a field, by whatever method they are to be found.

use crate::query::Asker;
use fieldstone_field::{Bindings, Field, Reading, Tape, TapeOptions};
use fieldstone_scene::Bounds;
use fieldstone_space::{Octree, OctreeOptions};
use fieldstone_trace::{Method, Outcome, Ray, Settings};

/// A field with its program compiled, and the octree that rays of the affine method walk.
#[derive(Debug)]
pub(crate) struct Roots {
    /// The field, for its sign.
    pub(crate) sign: Tape,
    tree: Octree,
}

impl Roots {
    pub(crate) fn new(field: &Field, bindings: &Bindings, bounds: &Bounds) -> Self {
        let options = TapeOptions { bindings: bindings.clone(), ..TapeOptions::default() };
        let sign = Tape::new(field, &TapeOptions { reading: Reading::Sign, ..options });
        let corners = (bounds.min().to_array(), bounds.max().to_array());
        Self { sign, tree: Octree::new(field, bindings, corners, OctreeOptions::default()) }
    }

    /// Whether rays certainly meet nothing whose origins and directions, of any length, lie between the four given; asked
    /// of the octree only.
    pub(crate) fn is_clear(
        &self,
        asker: &mut Asker,
        hull: &[([f64; 3], [f64; 3]); 4],
        settings: &Settings,
    ) -> bool {
        settings.method == Method::Affine && {
            let before = asker.walker.shared_cost();
            let is_clear = self.tree.is_clear(&mut asker.walker, hull);
            asker.evaluations += asker.walker.shared_cost() - before;
            is_clear
        }
    }

    /// The first crossing of every ray, and the gradients there if the program that is right there is at hand; rays stay
    /// within the bounds.
    pub(crate) fn first_hits_with_gradients(
        &self,
        asker: &mut Asker,
        rays: &[Ray],
        settings: &Settings,
    ) -> (Vec<Outcome>, Option<Vec<[f64; 3]>>) {
        if settings.method != Method::Affine {
            return (self.first_hits(asker, rays, settings), None);
        }
        let before = asker.walker.shared_cost();
        let (outcomes, gradients) = self.tree.first_hits_with_gradients(&mut asker.walker, rays, settings);
        asker.evaluations += asker.walker.shared_cost() - before;
        (outcomes, Some(gradients))
    }

    /// The first crossing of every ray.
    pub(crate) fn first_hits(&self, asker: &mut Asker, rays: &[Ray], settings: &Settings) -> Vec<Outcome> {
        if settings.method != Method::Affine {
            let before = asker.tracer.shared_cost();
            let outcomes = asker.tracer.first_hits(&self.sign, rays, settings);
            asker.evaluations += asker.tracer.shared_cost() - before;
            return outcomes;
        }
        let before = asker.walker.shared_cost();
        let outcomes = self.tree.first_hits(&mut asker.walker, rays, settings);
        asker.evaluations += asker.walker.shared_cost() - before;
        outcomes
    }
}
