//! Solids of several parts: those that Hijazi et al. 2008 show, and some that are made to be hard.

use fieldstone_field::{Bindings, Field, Graph, NodeId};
use fieldstone_lang::{Source, parse_formula};
use fieldstone_scene::{Blended, Bounds, Material, Part, Solid, Tree};
use glam::DVec3;

/// A solid of parts.
pub(crate) struct Panel {
    pub(crate) name: &'static str,
    pub(crate) parts: Vec<String>,
    pub(crate) tree: Tree,
    /// Half of the side of the bounds.
    pub(crate) half: f64,
    /// A quarter of the thinnest feature, at most.
    pub(crate) step: f64,
}

pub(crate) const CUBE: &str = "x^500+y^500+z^500-.25";
pub(crate) const TORUS: &str = "(1-sqrt(x^2+y^2))^2+z^2-.125";
pub(crate) const HEART: &str = "(2*x^2+y^2+z^2-1)^3-(.1*x^2+y^2)*z^3";
pub(crate) const CITRUS: &str = "x^2+z^2-4*y^3*(1-.5*y)^3";
pub(crate) const TANGLE: &str = "x^4-5*x^2+y^4-5*y^2+z^4-5*z^2+11.8";
pub(crate) const DECOCUBE: &str =
    "((x^2+y^2-.8^2)^2+(z^2-1)^2)*((y^2+z^2-.8^2)^2+(x^2-1)^2)*((z^2+x^2-.8^2)^2+(y^2-1)^2)-.02";
pub(crate) const TRIGONOMETRIC: &str = "(1-sqrt(x^2+y^2))^2+sin(z)^3-.125";
pub(crate) const SUPERQUADRIC: &str = "x^200+(.5*y^4+.5*z^4)^4-1";
pub(crate) const ELLIPSOID: &str = ".25*x^2+.25*y^2+z^2-1";
pub(crate) const ICOS: &str =
    "let u=(1+sqrt(5))/2; 2-(cos(x+u*y)+cos(x-u*y)+cos(y+u*z)+cos(y-u*z)+cos(z-u*x)+cos(z+u*x))";
pub(crate) const SE: &str = "x^6+.5*(y^4+z^4)^4-20";
pub(crate) const SC: &str = "x*y+cos(z)+1.741*sin(2*x)*sin(z)*cos(y)+sin(2*y)*sin(x)*cos(z)+sin(2*z)*sin(y)*cos(x)\
                      -cos(2*x)*cos(2*y)+cos(2*y)*cos(2*z)+cos(2*z)*cos(2*x)+.05";

pub(crate) fn part(number: usize) -> Tree {
    Tree::Part(number)
}

pub(crate) fn not(tree: Tree) -> Tree {
    Tree::Complement(Box::new(tree))
}

fn all(count: usize) -> Vec<Tree> {
    (0..count).map(Tree::Part).collect()
}

fn panel(name: &'static str, parts: &[&str], tree: Tree, (half, step): (f64, f64)) -> Panel {
    Panel { name, parts: parts.iter().map(|p| p.to_string()).collect(), tree, half, step }
}

fn moved_ball(centre: f64, square: f64) -> String {
    format!("(x-({centre}))^2+(y-({centre}))^2+(z-({centre}))^2-{square}")
}

/// Those of the paper.
pub(crate) fn panels() -> Vec<Panel> {
    let wide = "x^2+y^2+z^2-1.44";
    let [far, near] = [moved_ball(1.0, 0.2), moved_ball(-1.0, 0.1)];
    let many = [CUBE, far.as_str(), DECOCUBE, HEART, TORUS, near.as_str()];
    let cylinders = ["x^2+y^2-1", "y^2+z^2-1", "z^2+x^2-1"];
    let difference = Tree::Intersection(vec![part(0), not(part(1))]);
    let dent = "x^2+(y+1)^2+(z-.6)^2-.5";
    let leaf = "(x/2)^2+(y/2)^2+(z/.6)^2-1";
    vec![
        panel("cube or sphere", &[CUBE, wide], Tree::Union(all(2)), (1.3, 0.005)),
        panel("cube and sphere", &[CUBE, wide], Tree::Intersection(all(2)), (1.3, 0.005)),
        panel("cube less sphere", &[CUBE, wide], difference.clone(), (1.3, 0.005)),
        panel("three cylinders", &cylinders, Tree::Union(all(3)), (1.6, 0.01)),
        panel("what three cylinders share", &cylinders, Tree::Intersection(all(3)), (1.3, 0.01)),
        panel("citrus and heart", &[CITRUS, HEART], Tree::Union(all(2)), (2.2, 0.002)),
        panel("tangle and sphere", &[TANGLE, "x^2+y^2+z^2-4"], Tree::Union(all(2)), (2.6, 0.01)),
        panel("decocube and heart", &[DECOCUBE, HEART], Tree::Union(all(2)), (1.5, 0.004)),
        panel(
            "trigonometric and sphere",
            &[TRIGONOMETRIC, "x^2+y^2+z^2-2"],
            Tree::Union(all(2)),
            (4.0, 0.01),
        ),
        panel("superquadric or ellipsoid", &[SUPERQUADRIC, ELLIPSOID], Tree::Union(all(2)), (2.2, 0.01)),
        panel(
            "superquadric and ellipsoid",
            &[SUPERQUADRIC, ELLIPSOID],
            Tree::Intersection(all(2)),
            (2.2, 0.01),
        ),
        panel("superquadric less ellipsoid", &[SUPERQUADRIC, ELLIPSOID], difference.clone(), (1.4, 0.01)),
        panel("multiple unions", &many, Tree::Union(all(6)), (1.6, 0.004)),
        panel("sesc", &[SE, SC], difference, (2.0, 0.004)),
        // ((cube − (sphere − torus)) − dent) ∩ (ellipsoid ∪ torus)
        panel(
            "nested differences",
            &[CUBE, wide, TORUS, dent, leaf],
            Tree::Intersection(vec![
                part(0),
                not(Tree::Intersection(vec![part(1), not(part(2))])),
                not(part(3)),
                Tree::Union(vec![part(4), part(2)]),
            ]),
            (1.3, 0.004),
        ),
    ]
}

/// The program of a formula, inside a graph.
pub(crate) fn import(graph: &mut Graph, formula: &str) -> NodeId {
    let model = parse_formula(&Source::new("part", formula)).expect("the formula is sound");
    graph.import(model.field.graph(), &[model.field.value()], |graph, input| graph.input(input))[0]
}

/// What a tree makes of the fields of its parts.
fn compose(graph: &mut Graph, tree: &Tree, parts: &[NodeId]) -> NodeId {
    match tree {
        Tree::Part(number) => parts[*number],
        Tree::Complement(tree) => {
            let inner = compose(graph, tree, parts);
            graph.neg(inner)
        }
        Tree::Union(trees) | Tree::Intersection(trees) => {
            let union = matches!(tree, Tree::Union(_));
            let nodes: Vec<NodeId> = trees.iter().map(|tree| compose(graph, tree, parts)).collect();
            let join = |a, &b: &NodeId| if union { graph.min(a, b) } else { graph.max(a, b) };
            nodes[1..].iter().fold(nodes[0], join)
        }
    }
}

pub(crate) fn bounds(half: f64) -> Bounds {
    Bounds::new(DVec3::splat(-half), DVec3::splat(half)).expect("the bounds are sound")
}

impl Panel {
    /// The solid whose value the tree makes of its parts, which are its attributes.
    pub(crate) fn field(&self) -> Field {
        let mut graph = Graph::new();
        let parts: Vec<NodeId> = self.parts.iter().map(|formula| import(&mut graph, formula)).collect();
        let value = compose(&mut graph, &self.tree, &parts);
        Field::new(graph, value, parts)
    }

    pub(crate) fn solid(&self) -> Solid {
        let part = |number: usize| Part {
            name: format!("part {number}"),
            field: Some(number),
            materials: vec![Blended { material: Material::default(), share: None }],
            back: None,
        };
        let parts = (0..self.parts.len()).map(part).collect();
        let solid = Solid::new(self.field(), Bindings::new(), bounds(self.half));
        solid.with_parts(parts, self.tree.clone()).expect("the parts are there")
    }
}
