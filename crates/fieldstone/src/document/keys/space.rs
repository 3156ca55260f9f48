//! The keys of motions and mappings of space.

use super::Shape::{Either, Matrix, Number, Numbers, Table, Whole};
use super::{Key, PLANE_OFFSET, Section, key};

static ROTATION: Section = Section {
    name: "a rotation",
    shared: &[],
    keys: &[
        key("axis", Numbers(3), "The axis, through the origin."),
        key("degrees", Number, "Counter-clockwise, seen from the end of the axis."),
    ],
};

static REFLECTION: Section = Section {
    name: "a reflection",
    shared: &[],
    keys: &[key("normal", Numbers(3), "The normal of the plane."), PLANE_OFFSET],
};

/// What moves space as a whole.
const MOTIONS: &[Key] = &[
    key("translate", Numbers(3), "By a vector."),
    key("rotate", Table(&ROTATION), "About an axis through the origin."),
    key("reflect", Table(&REFLECTION), "To the other side of a plane."),
    key("scale", Either(&Number, &Numbers(3)), "By a factor, or one for each axis."),
    key("matrix", Matrix, "Three rows of three numbers, or four, the last a translation."),
];

pub(in crate::document) static MOTION: Section = Section { name: "a motion", shared: &[], keys: MOTIONS };

static TWIST: Section = Section {
    name: "a twist",
    shared: &[],
    keys: &[
        key("axis", Numbers(3), "The axis, through the origin."),
        key("degrees", Number, "How far it is turned for each unit of length along the axis."),
    ],
};

static TAPER: Section = Section {
    name: "a taper",
    shared: &[],
    keys: &[
        key("axis", Numbers(3), "The axis, through the origin."),
        key("from", Number, "Where on the axis it begins."),
        key("to", Number, "Where on the axis it ends."),
        key("scale", Numbers(2), "The scale across the axis up to `from` and beyond `to`, above 0."),
    ],
};

static BEND: Section = Section {
    name: "a bend",
    shared: &[],
    keys: &[
        key("degrees", Number, "How far it turns for each unit of length; 0: straight."),
        key("along", Numbers(3), "The line through the origin that becomes a circle; default: [1, 0, 0]."),
        key("towards", Numbers(3), "The side on which the centre is; default: [0, 0, 1]."),
    ],
};

static MIRROR: Section = Section {
    name: "a mirror",
    shared: &[],
    keys: &[key("normal", Numbers(3), "The direction of the side that is kept."), PLANE_OFFSET],
};

static REPEAT: Section = Section {
    name: "a repetition",
    shared: &[],
    keys: &[
        key("axis", Numbers(3), "The direction in which the copies stand."),
        key("spacing", Number, "How far apart they are, above 0."),
        key("count", Whole(1, 1 << 30), "How many from the original on; default: without end to both sides."),
    ],
};

static REPEAT_AROUND: Section = Section {
    name: "a repetition around an axis",
    shared: &[],
    keys: &[
        key("axis", Numbers(3), "The axis, through the origin."),
        key("count", Whole(1, 1 << 20), "How many."),
    ],
};

static INVERSION: Section = Section {
    name: "an inversion",
    shared: &[],
    keys: &[key("radius", Number, "Of the sphere about the origin that stays what it is, above 0.")],
};

/// Motions and mappings of space.
pub(in crate::document) static STEP: Section = Section {
    name: "a motion or mapping of space",
    shared: MOTIONS,
    keys: &[
        key("twist", Table(&TWIST), "Turned about an axis, the farther along it the more."),
        key("taper", Table(&TAPER), "Scaled across an axis, from one factor to another."),
        key("bend", Table(&BEND), "What lies along a line, along a circle."),
        key("mirror", Table(&MIRROR), "One side of a plane, and its image on the other."),
        key("repeat", Table(&REPEAT), "Copies in a row, of what is nearer than half the spacing."),
        key("repeat_around", Table(&REPEAT_AROUND), "Copies around an axis, of what is in a sector."),
        key("invert", Table(&INVERSION), "Turned inside out at a sphere."),
    ],
};

/// The mappings of space that are no motions, with an example of each.
pub(in crate::document) const MAPS: [(&str, &str); 7] = [
    ("twist", "twist = { axis = [0, 0, 1], degrees = 45 }"),
    ("taper", "taper = { axis = [0, 0, 1], from = 0, to = 2, scale = [1, 0.5] }"),
    ("bend", "bend = { degrees = 30, along = [1, 0, 0], towards = [0, 0, 1] }"),
    ("mirror", "mirror = { normal = [1, 0, 0] }"),
    ("repeat", "repeat = { axis = [1, 0, 0], spacing = 2, count = 5 }"),
    ("repeat_around", "repeat_around = { axis = [0, 0, 1], count = 6 }"),
    ("invert", "invert = { radius = 1 }"),
];
