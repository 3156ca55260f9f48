//! The table of all keys of scene files. Checks, suggestions and the JSON Schema are made from it.

mod space;
mod texels;

pub(super) use space::{MAPS, MOTION, STEP};
pub(super) use texels::TEXELS;

/// What a value may be.
#[derive(Clone, Copy, Debug)]
pub(super) enum Shape {
    /// A number, a formula of t and parameters, or keys.
    Number,
    /// A whole number between two.
    Whole(u64, u64),
    /// True or false.
    Flag,
    /// Any text.
    Text,
    /// A formula over space.
    Formula,
    /// The place of a file.
    File,
    /// One of some words.
    Choice(&'static [&'static str]),
    /// So many [numbers](Self::Number), or keys with such lists.
    Numbers(usize),
    /// Three rows of three or four numbers.
    Matrix,
    /// A colour.
    Colour,
    /// A number of a material, or a texture.
    Channel,
    /// A colour of a material, or a texture.
    ColourChannel,
    /// The same, or a number for grey.
    LightChannel,
    /// The name of a solid, or a table like those of solids.
    Solid,
    /// The name of a material.
    Material,
    /// What is on a face of a cube or a wall of a room.
    Face,
    /// A motion, or a list of them.
    Motions,
    /// A motion or a mapping of space, or a list of them.
    Steps,
    /// A table with these keys.
    Table(&'static Section),
    /// A list of such values; at least one.
    List(&'static Shape),
    /// Such a value, or a list of them.
    OneOrMany(&'static Shape),
    /// A table of names that the user chooses.
    Named(&'static Shape),
    /// Either of two.
    Either(&'static Shape, &'static Shape),
}

/// A key.
#[derive(Debug)]
pub(super) struct Key {
    pub(super) name: &'static str,
    pub(super) shape: Shape,
    /// What it is, with its unit and default.
    pub(super) about: &'static str,
}

/// The keys of a kind of table.
#[derive(Debug)]
pub(super) struct Section {
    /// What such a table is called.
    pub(super) name: &'static str,
    pub(super) keys: &'static [Key],
    /// Keys that it shares with other tables.
    pub(super) shared: &'static [Key],
}

/// How solids are drawn, whether it is said of the solid or of the object.
const DRAWN: &[Key] = &[
    key("where", CONDITIONS, "Conditions that hold where its surface is: `a < b`; default: none."),
    key("bounds", Numbers(6), "x0, y0, z0, x1, y1, z1: where it is; default: found."),
    key("open", Flag, "Whether one looks into it where it is cut; default: false."),
    key("surface", Flag, "Whether it is the surface where the function is 0; default: false."),
    key("clip_sphere", Numbers(4), "x, y, z, r: a sphere outside of which nothing is drawn; default: none."),
    key("method", METHODS, "How its surface is found; default: that of the scene."),
    key("step", Number, "sampled: the step, relative to its longest side."),
    key("accept_epsilon", Number, "interval: accepted without proof, relative to its longest side."),
    key("tolerance", Number, "How closely it is located, relative to its longest side."),
];

impl Section {
    /// All keys.
    pub(super) fn all(&self) -> impl Iterator<Item = &'static Key> + Clone {
        self.keys.iter().chain(self.shared)
    }

    pub(super) fn key(&self, name: &str) -> Option<&'static Key> {
        let name = if name == "color" { "colour" } else { name };
        self.all().find(|key| key.name == name)
    }
}

const fn key(name: &'static str, shape: Shape, about: &'static str) -> Key {
    Key { name, shape, about }
}

use Shape::{
    Channel, Choice, Colour, ColourChannel, Either, Face, File, Flag, Formula, LightChannel, List, Material,
    Motions, Named, Number, Numbers, OneOrMany, Solid, Steps, Table, Text, Whole,
};

/// The keys that say what a solid is; it has exactly one.
pub(super) const SOURCES: [&str; 13] = [
    "formula",
    "file",
    "union",
    "intersection",
    "difference",
    "complement",
    "blend",
    "metamorphosis",
    "voxels",
    "points",
    "spline",
    "sweep",
    "projection",
];

/// The keys of a solid that have a meaning where it is an object itself.
pub(super) const OF_OBJECTS: [&str; 9] =
    ["where", "bounds", "open", "surface", "clip_sphere", "method", "step", "accept_epsilon", "tolerance"];

const METHODS: Shape = Choice(&["affine", "interval", "sampled"]);
const CONDITIONS: Shape = OneOrMany(&Formula);

const PLANE_OFFSET: Key =
    key("offset", Number, "The plane is normal·p = offset, for a normal of length 1; default: 0.");

pub(super) static SECTION: Section = Section {
    name: "a section",
    shared: &[],
    keys: &[
        key("normal", Numbers(3), "The direction of what is removed."),
        PLANE_OFFSET,
        key(
            "material",
            Material,
            "The material of the cut; default: those of the parts that it goes through.",
        ),
    ],
};

pub(super) static BLEND: Section = Section {
    name: "a blend",
    shared: &[],
    keys: &[
        key("solids", List(&Solid), "What is blended, at least two."),
        key("kind", Choice(&BLENDS), "The formula."),
        key(
            "operation",
            Choice(&["union", "intersection", "difference"]),
            "What is blended; default: union.",
        ),
        key("c", Number, "product, hyperbolic: how far it reaches, from 0 on; default: 0.01."),
        key("weight", Number, "linear: from 0 to 1; default: 0.5."),
        key("radius", Number, "super-elliptic: how far it reaches; default: 1."),
        key("power", Number, "super-elliptic: the exponent; default: 2."),
        key("sigma", Number, "gaussian: the width; default: 1."),
        key("steepness", Number, "sigmoid: the slope; default: 10."),
        key("drive", Formula, "gaussian, sigmoid: what drives the weight; default: t."),
        key("a0", Number, "displacement, bounded: the height; default: 0.2."),
        key("a1", Number, "displacement: how far it reaches along the first; default: 1."),
        key("a2", Number, "displacement: how far it reaches along the second; default: 1."),
        key("b", Number, "bounded: how far it reaches; default: 1."),
        key("within", Solid, "bounded: where there is a blend."),
        key("k", Number, "smooth-minimum: how far it reaches; default: 0.2."),
        key("degree", Choice(&["quadratic", "cubic"]), "smooth-minimum: default: quadratic."),
    ],
};

/// The kinds of blends.
pub(super) const BLENDS: [&str; 9] = [
    "product",
    "linear",
    "hyperbolic",
    "super-elliptic",
    "gaussian",
    "sigmoid",
    "displacement",
    "bounded",
    "smooth-minimum",
];

pub(super) static METAMORPHOSIS: Section = Section {
    name: "a metamorphosis",
    shared: &[],
    keys: &[
        key("from", Solid, "What it is at share 0."),
        key("to", Solid, "What it is at share 1."),
        key("share", Number, "From 0 to 1."),
    ],
};

pub(super) static VOXELS: Section = Section {
    name: "a voxel array",
    shared: &[],
    keys: &[
        key("file", File, "NRRD (.nrrd, .nhdr), or raw numbers, those along x next to one another."),
        key("size", List(&Whole(2, 1 << 26)), "raw: how many numbers there are along x, y and z."),
        key("type", Choice(&NUMBER_TYPES), "raw: how a number is written."),
        key("endian", Choice(&["little", "big"]), "raw: the order of the bytes; default: little."),
        key("skip", Whole(0, 1 << 29), "raw: bytes before the first number; default: 0."),
        key("level", Number, "The value at the surface; default: 0."),
        key("inside", Choice(&["above", "below"]), "Where values are inside; default: above."),
        key("interpolation", Choice(&["linear", "catmull-rom", "b-spline"]), "Default: linear."),
        key(
            "box",
            Numbers(6),
            "x0, y0, z0, x1, y1, z1: the outermost numbers; default: -1 to 1 along the longest side.",
        ),
    ],
};

/// How numbers of voxel arrays are written.
pub(super) const NUMBER_TYPES: [&str; 8] = ["u8", "i8", "u16", "i16", "u32", "i32", "f32", "f64"];

pub(super) static POINTS: Section = Section {
    name: "a solid from points",
    shared: &[],
    keys: &[
        key("file", File, "PLY, or a table of x, y, z, nx, ny, nz; without normals they are estimated."),
        key("smoothing", Number, "How much noise is evened out, from 0 on; default: 0."),
        key("offset", Number, "How far from the points its values are set, of their box; default: 0.01."),
    ],
};

pub(super) static SPLINE: Section = Section {
    name: "a spline volume",
    shared: &[],
    keys: &[
        key("controls", List(&Number), "The control values, those along x next to one another."),
        key("size", List(&Whole(2, 1 << 20)), "How many there are along x, y and z."),
        key("basis", Choice(&["bezier", "b-spline"]), "One polynomial, or uniform cubics; default: bezier."),
        key("box", Numbers(6), "x0, y0, z0, x1, y1, z1: where it is; default: -1 to 1."),
    ],
};

pub(super) static SWEEP: Section = Section {
    name: "a sweep",
    shared: &[],
    keys: &[
        key("solid", Solid, "What is moved along the curve, without being turned."),
        key("polyline", List(&Numbers(3)), "The curve from point to point."),
        key("bezier", List(&Numbers(3)), "The Bezier curve of 2 to 16 control points."),
        key("helix", Numbers(3), "Around z: radius, rise of a turn, turns."),
        key("curve", Table(&CURVE), "Any curve, by formulas of u."),
    ],
};

pub(super) static CURVE: Section = Section {
    name: "a curve",
    shared: &[],
    keys: &[
        key("x", Formula, "A formula of u."),
        key("y", Formula, "A formula of u."),
        key("z", Formula, "A formula of u."),
        key("from", Number, "The least u; default: 0."),
        key("to", Number, "The largest u; default: 1."),
    ],
};

pub(super) static PROJECTION: Section = Section {
    name: "a projection",
    shared: &[],
    keys: &[
        key("solid", Solid, "A solid of x, y, z and w, of which the shadow along w is seen."),
        key("from", Number, "The least w; default: -1."),
        key("to", Number, "The largest w; default: 1."),
    ],
};

pub(super) static SOLID: Section = Section {
    name: "a solid",
    shared: DRAWN,
    keys: &[
        key("formula", Formula, "A function of x, y, z that is negative inside."),
        key("file", File, "A model: .hf, .vm, .jsurf, or a formula."),
        key("union", List(&Solid), "What lies in any of these solids."),
        key("intersection", List(&Solid), "What lies in all of these solids."),
        key("difference", List(&Solid), "The first of these solids without the others."),
        key("complement", Solid, "What does not lie in the solid."),
        key("blend", Table(&BLEND), "Solids that flow into one another."),
        key("metamorphosis", Table(&METAMORPHOSIS), "One solid on its way into another."),
        key("voxels", Table(&VOXELS), "Numbers on a grid."),
        key("points", Table(&POINTS), "Scattered points of its surface."),
        key("spline", Table(&SPLINE), "A free form by control values."),
        key("sweep", Table(&SWEEP), "A solid that moves along a curve."),
        key("projection", Table(&PROJECTION), "The shadow of a solid of four dimensions."),
        key("object", Text, "The object of a HyperFun file; default: my_model, or the first."),
        key("dialect", Choice(&["lenient", "strict"]), "What a HyperFun text means; default: lenient."),
        key("parameters", Named(&Number), "The values of parameters; default: those of the file."),
        key("coordinates", Named(&Number), "Coordinates from the fourth on, counted from 1; default: 0."),
        key(
            "fuel",
            Whole(1, 1_000_000_000),
            "Turns that loops may take at a point; default: found by trial.",
        ),
        key("material", Material, "Its material; default: that of what it is part of."),
        key("back", Material, "The material of its surface from inside; default: as from outside."),
        key("transform", Steps, "Motions and mappings of space, applied in this order; default: none."),
        key(
            "offset",
            Number,
            "How far its surface is moved out, where its function is a distance; default: 0.",
        ),
        key(
            "shell",
            Number,
            "A wall along its surface, so thick where its function is a distance; default: none.",
        ),
        key(
            "set_operations",
            Choice(&["minmax", "r"]),
            "Minima and maxima, or R-functions; default: minmax.",
        ),
        key("section", OneOrMany(&Table(&SECTION)), "Planes that cut it; default: none."),
    ],
};

pub(super) static SCATTER: Section = Section {
    name: "a scatter",
    shared: &[],
    keys: &[
        key("count", Whole(1, super::MAX_INSTANCES as u64), "How many copies."),
        key("seed", Whole(0, u32::MAX as u64), "Other numbers give other places; default: 0."),
        key("box", Numbers(6), "x0, y0, z0, x1, y1, z1: where they are."),
        key("scale", Numbers(2), "The smallest and the largest scale; default: 1."),
        key(
            "rotate",
            Choice(&["none", "x", "y", "z", "any"]),
            "The axis they are turned about; default: none.",
        ),
    ],
};

pub(super) static GRID: Section = Section {
    name: "a grid",
    shared: &[],
    keys: &[
        key("count", List(&Whole(1, super::MAX_INSTANCES as u64)), "How many along x, y and z."),
        key("spacing", Numbers(3), "How far apart they are."),
        key("origin", Numbers(3), "Where the first is; default: 0, 0, 0."),
    ],
};

pub(super) static OBJECT: Section = Section {
    name: "an object",
    shared: DRAWN,
    keys: &[
        key("solid", Solid, "What stands there."),
        key("material", Material, "Its material instead of its own."),
        key("transform", Steps, "Motions and mappings of space, applied in this order; default: none."),
        key("instances", List(&Motions), "Motions of each copy, after `transform`."),
        key("scatter", Table(&SCATTER), "Copies at random places."),
        key("grid", Table(&GRID), "Copies in rows."),
    ],
};

pub(super) static MATERIAL: Section = Section {
    name: "a material",
    shared: &[],
    keys: &[
        key(
            "model",
            Choice(&["blinn-phong", "ggx", "metal", "glass", "mirror", "gradient"]),
            "How light is scattered; default: blinn-phong.",
        ),
        key("normalised", Flag, "Blinn-Phong: whether energy is conserved; default: false."),
        key("compensated", Flag, "GGX: whether light between facets is added (Turquin 2019); default: true."),
        key("fresnel", Flag, "Blinn-Phong: whether grazing light is mirrored more; default: false."),
        key("colour", ColourChannel, "Of light that is scattered, from 0 to 1; default: clay."),
        key("specular", Channel, "Blinn-Phong: strength of highlights, from 0 on; default: 0.18."),
        key("shininess", Channel, "Blinn-Phong: exponent of highlights, from 1 on; default: 40."),
        key("roughness", Channel, "GGX: from 0 (a mirror) to 1; default: 0.5."),
        key("metallic", Channel, "GGX: from 0 (dielectric) to 1 (metal); default: 0."),
        key("reflection", Channel, "Blinn-Phong: the mirrored part, from 0 to 1; default: 0."),
        key("transmission", Channel, "The part of the rest that goes through, from 0 to 1; default: 0."),
        key("index", Channel, "Refractive index inside relative to outside, from 1 on; default: 1.5."),
        key("absorption", LightChannel, "Absorbed for each unit of length, linear, from 0 on; default: 0."),
        key("opacity", Channel, "From 0 (invisible) to 1; default: 1."),
        key("emission", LightChannel, "Light that it gives off, from 0 on; default: 0."),
    ],
};

pub(super) static LIGHT: Section = Section {
    name: "a light",
    shared: &[],
    keys: &[
        key("kind", Choice(&["directional", "point", "sphere", "rectangle"]), "What it is."),
        key("towards", Numbers(3), "directional: the direction to the light."),
        key("position", Numbers(3), "Where it stands; of a rectangle, a corner."),
        key("radius", Number, "sphere: its radius."),
        key("edges", List(&Numbers(3)), "rectangle: its two edges."),
        key("colour", Colour, "Its colour; default: white."),
        key("strength", Number, "Times the colour, at distance 1; default: 1."),
        key("shadows", Flag, "Whether solids block it; default: true."),
        key(
            "samples",
            Whole(1, 1024),
            "sphere, rectangle: points looked at from each place, at most; default: 4.",
        ),
        key("visible", Flag, "sphere, rectangle: whether one sees it; default: false."),
    ],
};

pub(super) static LIGHTING: Section = Section {
    name: "the lighting",
    shared: &[],
    keys: &[key("ambient", Colour, "The light from everywhere; default with lights: none.")],
};

pub(super) static BACKGROUND: Section = Section {
    name: "the background",
    shared: &[],
    keys: &[
        key("colour", Colour, "One colour all over."),
        key("top", Colour, "The colour at the upper edge."),
        key("bottom", Colour, "The colour at the lower edge."),
    ],
};

pub(super) static ENVIRONMENT: Section = Section {
    name: "the environment",
    shared: &[],
    keys: &[
        key("kind", Choice(&["uniform", "gradient", "image", "cube", "room"]), "What is around the scene."),
        key("colour", Colour, "uniform: its colour; default: white."),
        key("zenith", Colour, "gradient: the colour above."),
        key("horizon", Colour, "gradient: the colour at the horizon."),
        key("nadir", Colour, "gradient: the colour below."),
        key("file", File, "image: latitude and longitude; PNG, HDR or EXR."),
        key("faces", List(&Face), "cube, room: a list of six: right, left, up, down, front, back."),
        key("bounds", Numbers(6), "room: x0, y0, z0, x1, y1, z1."),
        key("strength", Number, "Times the colours; default: 1."),
        key("visible", Flag, "Whether one sees it behind the solids; default: true."),
        key("rotation", Number, "Degrees about the axis `up`, counter-clockwise; default: 0."),
        key(
            "samples",
            Whole(1, 1024),
            "Directions looked at from each point that it lights, at most; default: 4.",
        ),
        key("up", Numbers(3), "The direction of the zenith; default: that of the camera."),
    ],
};

pub(super) static FACE: Section = Section {
    name: "a face",
    shared: &[],
    keys: &[
        key("file", File, "A picture: PNG, HDR or EXR."),
        key("checker", List(&Colour), "Two colours."),
        key("count", Whole(1, 4096), "Squares of a checker along a side; default: 8."),
        key("linear", Numbers(3), "A colour in linear RGB."),
    ],
};

pub(super) static CAMERA: Section = Section {
    name: "the camera",
    shared: &[],
    keys: &[
        key("eye", Numbers(3), "Where it stands; default: in front, to the right and above."),
        key("target", Numbers(3), "What it looks at; default: the middle of all bounds."),
        key("up", Numbers(3), "What is up in the picture; default: z, or y of HyperFun files."),
        key("fov", Number, "Degrees from the lower to the upper edge; default: what fits."),
        key("ortho", Number, "A parallel view, so high."),
        key("aperture", Number, "The radius of the lens; default: 0, all is sharp."),
        key("focus", Number, "The distance of what is sharp; default: that of the target."),
    ],
};

pub(super) static RENDER: Section = Section {
    name: "the rendering",
    shared: &[],
    keys: &[
        key("size", List(&Whole(1, 1 << 26)), "Width and height in pixels; default: 512, 512."),
        key(
            "samples",
            Whole(1, 4096),
            "The most samples of a pixel where there are edges or noise in it; default: 4.",
        ),
        key("method", METHODS, "How surfaces are found; default: affine."),
        key("step", Number, "sampled: the step, relative to the longest side of the bounds."),
        key("accept_epsilon", Number, "interval: accepted without proof, relative to the longest side."),
        key("tolerance", Number, "How closely surfaces are located, relative to the longest side."),
        key("shadow_tolerance", Number, "The same for shadow rays; default: as for others."),
        key(
            "bounces",
            Whole(0, 64),
            "How often light is followed on; 0: mirrors and glass are black; default: 8.",
        ),
        key("exposure", Number, "Stops, in PNG files; default: 0."),
        key("tone_map", Choice(&TONE_MAPS), "How bright light is shown in PNG files; default: none."),
        key("time", Number, "Seconds; default: 0."),
    ],
};

/// How light becomes a picture.
pub(super) const TONE_MAPS: [&str; 3] = ["none", "khronos-neutral", "aces"];

pub(super) static SCENE: Section = Section {
    name: "a scene",
    shared: &[],
    keys: &[
        key("parameters", Named(&Number), "Names for numbers."),
        key("fields", Named(&Formula), "Names for functions of x, y, z."),
        key("solids", Named(&Either(&Formula, &Table(&SOLID))), "Solids by name."),
        key("objects", List(&Table(&OBJECT)), "What stands where; default: solids that no other uses."),
        key("texels", List(&Table(&TEXELS)), "Volumes of texels, and where they stand."),
        key("materials", Named(&Table(&MATERIAL)), "Materials by name."),
        key("lights", List(&Table(&LIGHT)), "Lights; default: two that move with the camera."),
        key("lighting", Table(&LIGHTING), "All light together."),
        key("background", Table(&BACKGROUND), "What is seen where nothing is hit."),
        key("environment", Table(&ENVIRONMENT), "What is around the scene."),
        key("camera", Table(&CAMERA), "From where it is seen."),
        key("render", Table(&RENDER), "How it is drawn."),
    ],
};

pub(super) static TEXTURE: Section = Section {
    name: "a texture",
    shared: &[],
    keys: &[
        key("attributes", Whole(1, 65536), "The first attribute of the model that it takes, counted from 1."),
        key("red", Formula, "The red of a colour, sRGB."),
        key("green", Formula, "The green of a colour, sRGB."),
        key("blue", Formula, "The blue of a colour, sRGB."),
        key("from", Colour, "The colour where `by` is 0."),
        key("to", Colour, "The colour where `by` is 1."),
        key("by", Formula, "What goes from 0 to 1."),
        key("linear", Numbers(3), "A colour in linear RGB."),
    ],
};
