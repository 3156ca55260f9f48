//! What is made of the values of fields alone: offsets, shells and products of spaces.

use fieldstone_field::{Graph, NodeId};

/// f − d: grown by d > 0, shrunk by d < 0. As far as d everywhere where f is a distance; elsewhere by as much as f takes
/// to change by d. What grows any solid by the same distance everywhere is [`dilate`](crate::dilate).
pub fn offset(graph: &mut Graph, field: NodeId, distance: NodeId) -> NodeId {
    graph.sub(field, distance)
}

/// |f| − d/2: a wall along the surface, d thick where f is a distance.
pub fn shell(graph: &mut Graph, field: NodeId, thickness: NodeId) -> NodeId {
    let half = graph.constant(0.5);
    let (size, reach) = (graph.abs(field), graph.mul(half, thickness));
    graph.sub(size, reach)
}

/// The Cartesian product of solids of disjoint coordinates, f(x, y) × g(z): what is inside of both, by the R-function,
/// or sharply by the maximum (Pasko et al. 1995).
pub fn product(graph: &mut Graph, first: NodeId, second: NodeId, sharp: bool) -> NodeId {
    if sharp { graph.max(first, second) } else { graph.rmax(first, second) }
}
