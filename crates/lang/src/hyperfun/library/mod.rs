//! The library of HyperFun: the functions whose names start with `hf`.
//!
//! Every function builds its formula in a program, in HyperFun's own sign (F ≥ 0 inside), and may change the arrays
//! it is called with. Where the C interpreter's library differs from its documented meaning, the dialect decides.
//!
//! The formulas are rearranged where that makes them tighter over intervals or removes a singularity; their values
//! stay the same up to rounding.

mod arc;
mod attributes;
mod bezier;
mod blends;
mod blobs;
mod call;
mod convolution;
mod distance;
mod ellipsoid;
mod noise;
mod primitives;
mod sardf;
mod space;
mod tables;
#[cfg(test)]
mod tests;

use crate::Dialect;
use fieldstone_field::{Function as WholeFunctionBody, Graph, NodeId};
use fieldstone_solids::expression;
use std::sync::Arc;

/// What a parameter of a function is.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Kind {
    /// A number.
    Real,
    /// An array, which the function may change.
    Array,
}

/// What a function is called with.
#[derive(Clone, PartialEq, Debug)]
pub(crate) enum Argument {
    /// A number.
    Real(NodeId),
    /// The elements of an array.
    Array(Vec<NodeId>),
}

/// Where a call stands.
pub(crate) struct Context<'g> {
    /// The program that receives the formula.
    pub(crate) graph: &'g mut Graph,
    /// Which meaning counts where C and mathematics differ.
    pub(crate) dialect: Dialect,
}

/// Builds the formula of a call and returns its value; an error is a message about the arguments.
pub(crate) type Body = fn(&mut Context<'_>, &mut [Argument]) -> Result<NodeId, String>;

/// A function of the library.
pub(crate) struct Function {
    /// The name in lower case.
    pub(crate) name: &'static str,
    /// The parameters in order, with their names in messages.
    pub(crate) parameters: &'static [(&'static str, Kind)],
    /// The formula.
    pub(crate) body: Body,
}

/// Documented functions that the C interpreter has not registered: names like any other in the strict dialect.
const LENIENT_ONLY: [&str; 4] = ["hfcylx", "hfcyly", "hfcylz", "hffmapblob"];

/// The function of a name in lower case.
pub(crate) fn lookup(lower_case_name: &str, dialect: Dialect) -> Option<&'static Function> {
    let hidden = dialect == Dialect::Strict && LENIENT_ONLY.contains(&lower_case_name);
    FUNCTIONS.iter().find(|f| f.name == lower_case_name && !hidden)
}

/// The names of all functions, in lower case.
pub(crate) fn names() -> impl Iterator<Item = &'static str> {
    FUNCTIONS.iter().map(|f| f.name)
}

/// A function that programs call as a whole, because it has no closed form.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum WholeFunction {
    /// The noise of `hfA_NoiseP` at (x, y, z).
    PerlinNoise,
    /// The distance of `hfDEllipsoid` at (x, y, z) with three half-axes, around the origin.
    EllipsoidDistance,
    /// `hfDInt` of two values, the radius and the angle.
    RoundedIntersection,
    /// The same with the rounding of the C interpreter.
    SnappingIntersection,
}

impl WholeFunction {
    /// What it is called in messages.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::PerlinNoise => "hfA_NoiseP",
            Self::EllipsoidDistance => "hfDEllipsoid",
            Self::RoundedIntersection => "hfDInt",
            Self::SnappingIntersection => "hfDInt of the strict dialect",
        }
    }

    /// The function itself.
    pub(crate) fn function(self) -> &'static Arc<dyn WholeFunctionBody> {
        match self {
            Self::PerlinNoise => fieldstone_solids::gradient_noise(),
            Self::EllipsoidDistance => &ellipsoid::ELLIPSOID,
            Self::RoundedIntersection => &sardf::EXACT,
            Self::SnappingIntersection => &sardf::SNAPPING,
        }
    }
}

/// The function that the node `id` of a program calls with `arguments`. The program is only asked: a call of the same
/// function with the same arguments is the same node.
pub(crate) fn whole_function(graph: &mut Graph, id: NodeId, arguments: &[NodeId]) -> Option<WholeFunction> {
    use WholeFunction::*;
    let all = [PerlinNoise, EllipsoidDistance, RoundedIntersection, SnappingIntersection];
    all.into_iter().find(|known| graph.call(known.function(), arguments) == id)
}

/// Why a function that is known elsewhere does not run, if `lower_case_name` is one.
pub(crate) fn unsupported(lower_case_name: &str) -> Option<&'static str> {
    Some(match lower_case_name {
        "hfbeziersplinef" => "it is named in the documentation, but its formula was never published",
        "hfr" => "it calls a function of the R session that it runs in, and there is none here",
        _ => return None,
    })
}

/// `name(kind parameter, …) => formula`, with the kinds A for an array and R for a number.
macro_rules! functions {
    ($($name:literal ($($kind:ident $parameter:ident),*) => $formula:expr;)*) => {
        static FUNCTIONS: &[Function] = &[$(
            Function {
                name: $name,
                parameters: &[$((stringify!($parameter), kind!($kind))),*],
                body: |context, arguments| {
                    call::run(context, &[$((stringify!($parameter), kind!($kind))),*], arguments, $formula)
                },
            },
        )*];
    };
}

macro_rules! kind {
    (A) => {
        Kind::Array
    };
    (R) => {
        Kind::Real
    };
}

functions! {
    "hfsphere"(A x, A center, R r) => primitives::sphere;
    "hfellipsoid"(A x, A center, R a, R b, R c) => primitives::ellipsoid;
    "hfcylinderx"(A x, A center, R r) => |c| primitives::cylinder(c, 0);
    "hfcylindery"(A x, A center, R r) => |c| primitives::cylinder(c, 1);
    "hfcylinderz"(A x, A center, R r) => |c| primitives::cylinder(c, 2);
    "hfcylx"(A x, A center, R r) => |c| primitives::cylinder(c, 0);
    "hfcyly"(A x, A center, R r) => |c| primitives::cylinder(c, 1);
    "hfcylz"(A x, A center, R r) => |c| primitives::cylinder(c, 2);
    "hfellcylx"(A x, A center, R a, R b) => |c| primitives::elliptic_cylinder(c, 0);
    "hfellcyly"(A x, A center, R a, R b) => |c| primitives::elliptic_cylinder(c, 1);
    "hfellcylz"(A x, A center, R a, R b) => |c| primitives::elliptic_cylinder(c, 2);
    "hftorusx"(A x, A center, R ring, R tube) => |c| primitives::torus(c, 0);
    "hftorusy"(A x, A center, R ring, R tube) => |c| primitives::torus(c, 1);
    "hftorusz"(A x, A center, R ring, R tube) => |c| primitives::torus(c, 2);
    "hfblock"(A x, A vertex, R dx, R dy, R dz) => primitives::block;
    "hfconex"(A x, A center, R r) => |c| primitives::cone(c, 0);
    "hfconey"(A x, A center, R r) => |c| primitives::cone(c, 1);
    "hfconez"(A x, A center, R r) => |c| primitives::cone(c, 2);
    "hfellconex"(A x, A center, R a, R b) => |c| primitives::elliptic_cone(c, 0);
    "hfellconey"(A x, A center, R a, R b) => |c| primitives::elliptic_cone(c, 1);
    "hfellconez"(A x, A center, R a, R b) => |c| primitives::elliptic_cone(c, 2);
    "hfsuperell"(A x, A center, R a, R b, R c, R s1, R s2) => primitives::superellipsoid;
    "hfblobby"(A x, A x0, A y0, A z0, A a, A b, R t) => blobs::blobby;
    "hfmetaball"(A x, A x0, A y0, A z0, A b, A d, R t) => blobs::metaball;
    "hfsoft"(A x, A x0, A y0, A z0, A d, R t) => blobs::soft;
    "hffmapblob"(A x, R fobj, A x0, A y0, A z0, A fobj0, A sigma) => blobs::mapped_blob;

    "hfnoiseg"(A x, R amp, R freq, R phase) => noise::gardner;

    "hfscale3d"(A xt, R sx, R sy, R sz) => space::scale;
    "hfshift3d"(A xt, R dx, R dy, R dz) => space::shift;
    "hfrotate3dx"(A xt, R theta) => |c| space::rotate(c, 0);
    "hfrotate3dy"(A xt, R theta) => |c| space::rotate(c, 1);
    "hfrotate3dz"(A xt, R theta) => |c| space::rotate(c, 2);
    "hftwistx"(A xt, R k1, R k2, R theta1, R theta2) => |c| space::twist(c, 0);
    "hftwisty"(A xt, R k1, R k2, R theta1, R theta2) => |c| space::twist(c, 1);
    "hftwistz"(A xt, R k1, R k2, R theta1, R theta2) => |c| space::twist(c, 2);
    "hfstretch3d"(A xt, A x0, R sx, R sy, R sz) => space::stretch;
    "hftaperx"(A xt, R k1, R k2, R s1, R s2) => |c| space::taper(c, 0);
    "hftapery"(A xt, R k1, R k2, R s1, R s2) => |c| space::taper(c, 1);
    "hftaperz"(A xt, R k1, R k2, R s1, R s2) => |c| space::taper(c, 2);
    "hfspacemapcubic"(A xt, A source, A target, A b) => space::map_cubic;
    "hfspacemapexp"(A xt, A source, A target, A b) => space::map_exponential;

    "hfblenduni"(R f1, R f2, R a0, R a1, R a2) => blends::union;
    "hfblendint"(R f1, R f2, R a0, R a1, R a2) => blends::intersection;

    "hfconvpoint"(A x, A vect, A s, R t) => convolution::point;
    "hfconvline"(A x, A begin, A end, A s, R t) => convolution::line;
    "hfconvcurve"(A x, A vect, A s, R t) => convolution::curve;
    "hfconvliner"(A x, A begin, A end, R r) => convolution::line_of_radius;
    "hfconvarc"(A x, A center, A radius, A theta, A axis, A angle, A s, R t) => arc::arcs;
    "hfconvtriangle"(A x, A vect, A s, R t) => convolution::triangles;
    "hfconvmesh"(A x, A vect, A tri, A s, R t) => convolution::mesh;
    "hfbeziervolume"(A x, R l, R m, R n, A bbox, A w) => bezier::volume;

    "hfdcylinder"(A x, A center, A u, R r) => distance::cylinder;
    "hfdconex"(A x, A center, R r) => |c| distance::cone(c, 0);
    "hfdconey"(A x, A center, R r) => |c| distance::cone(c, 1);
    "hfdconez"(A x, A center, R r) => |c| distance::cone(c, 2);
    "hfdtorusx"(A x, A center, R ring, R tube) => |c| distance::torus(c, 0);
    "hfdtorusy"(A x, A center, R ring, R tube) => |c| distance::torus(c, 1);
    "hfdtorusz"(A x, A center, R ring, R tube) => |c| distance::torus(c, 2);
    "hfdellipsoid"(A x, A center, R a, R b, R c) => distance::ellipsoid;
    "hfdint"(R f, R g, R r, R alpha) => sardf::intersection;
    "hfduni"(R f, R g, R r, R alpha) => sardf::union;
    "hfdsub"(R f, R g, R r, R alpha) => sardf::subtraction;
    "hfdblenduni"(R f, R g, R r) => sardf::blend_union;
    "hfdblendint"(R f, R g, R r) => sardf::blend_intersection;
    "hfsawtooth"(R t, R n, R a, R f) => noise::sawtooth;

    "hfa_setcolor"(R f, A s, R r, R g, R b) => attributes::set_color;
    "hfa_setattributes"(R f, A s, A s1) => attributes::set_attributes;
    "hfa_union"(R f1, R f2, A out, A in1, A in2, R op) => attributes::union;
    "hfa_lerp"(A s, A s1, A s2, R f, R fmin, R fmax) => attributes::linear;
    "hfa_cerp"(A s, A s1, A s2, R f, R fmin, R fmax) => attributes::cubic;
    "hfa_clamp"(R f, R a, R b) => attributes::clamp;
    "hfa_floor"(R f) => attributes::floor;
    "hfa_step"(R f, R a) => attributes::step;
    "hfa_pulse"(R f, R upper, R lower) => attributes::pulse;
    "hfa_smoothstep"(R s, R smin, R smax, R f, R fmin, R fmax) => attributes::smooth_step;
    "hfa_modulo"(R a, R b) => attributes::modulo;
    "hfa_wave"(R v, R b1, R b2, R freq) => attributes::wave;
    "hfa_noiseg"(A x, R freq, R phase) => noise::unit_gardner;
    "hfa_noisep"(A x) => noise::perlin;
    "hfa_turbulence"(A x, R freq) => noise::turbulence;
    "hfa_checkerboard"(A x, A block, A gap, A out, A blocks, A gaps) => attributes::checker_board;
    "hfa_lookuptable"(R t, A out, A attrs, A map) => tables::look_up;
    "hfa_smoothlookuptable"(R t, A out, A attrs, A map) => tables::look_up_smoothly;
    "hfa_circles"(A x, A out, A attrs, A map) => tables::circles;
    "hfa_crackles"(A x, A out, R freq, A attrs, A map) => tables::crackles;
    "hfa_spline"(A s, A list, R v, R vmin, R vmax) => tables::spline;
    "hfa_rgbtohsv"(A from, A out) => attributes::hsv_from_rgb;
    "hfa_hsvtorgb"(A from, A out) => attributes::rgb_from_hsv;
}
