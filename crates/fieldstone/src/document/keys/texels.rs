//! The keys of volumes of texels.

use super::Shape::{Choice, File, List, Motions, Number, Table, Text, Whole};
use super::{GRID, SCATTER, Section, key};
use fieldstone_scene::MAX_REPEATS;

pub(in crate::document) static TEXELS: Section = Section {
    name: "a volume of texels",
    shared: &[],
    keys: &[
        key("name", Text, "What it is called; default: the name of its file."),
        key("file", File, "A volume: .texel."),
        key("recipe", File, "A recipe (.toml) from which the volume is made when the scene is read."),
        key("edge", Whole(1, 1024), "recipe: cells along an edge; default: what the recipe says."),
        key("filter", FILTERS, "How coarser levels are made; default: what the file says."),
        key("transform", Motions, "Motions of the cube from 0, 0, 0 to 1, 1, 1; default: none."),
        key(
            "repeat",
            List(&Whole(1, MAX_REPEATS as u64)),
            "Cubes along x, y, z if cyclic; default: 1, 1, 1.",
        ),
        key("instances", List(&Motions), "Motions of each copy, after `transform`."),
        key("scatter", Table(&SCATTER), "Copies at random places."),
        key("grid", Table(&GRID), "Copies in rows."),
        key("density", Number, "What its optical depths are multiplied by, above 0; default: 1."),
        key("level", Number, "No finer level is looked at, from 0 on; default: 0."),
    ],
};

const FILTERS: super::Shape = Choice(&["sggx", "1995"]);
