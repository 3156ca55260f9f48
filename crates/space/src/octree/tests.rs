use super::packet::ORDER;
use super::*;
use fieldstone_field::{F64, Graph, Points, Workspace};
use fieldstone_lang::{Source, parse_formula};
use fieldstone_trace::{Certificate, Outcome, Ray, Settings, Tracer};

const SIDE: f64 = 2.0;

/// Smooth, with edges, thin, partial, with jumps, with poles, not to be told from 0.
const FORMULAS: [&str; 12] = [
    "x^2 + y^2 + z^2 - 1",
    "x^4 - 5*x^2 + y^4 - 5*y^2 + z^4 - 5*z^2 + 11.8",
    "max(max(abs(x) - 1, abs(y) - 1, abs(z) - 1), 1.3 - sqrt(x^2 + y^2 + z^2))",
    "max(x^2 + y^2 + z^2 - 2, abs(sin(4*x)*cos(4*y) + sin(4*y)*cos(4*z) + sin(4*z)*cos(4*x)) - 0.2)",
    "(sqrt(x^2 + y^2) - 1.5)^2 + z^2 - 0.0004",
    "min(x^2 + y^2 + z^2 - 1, (x - 1.999)^2 + y^2 + z^2 - 1)",
    "sqrt(x) + y + z - 1",
    "y + 0.25*floor(4*x) + 0.1*z",
    "1/(x^2 + y^2 + z^2) - 3 + tan(x)",
    "(x^2 + y^2 + z^2 - 1)^2 * ((x - 1)^2 + y^2 + z^2 - 0.5)",
    "x^2 + y^2 + z^2 - 1.5 + 0.2*sin(20*x)*sin(20*y)*sin(20*z)",
    "exp(x) + ln(y + 3) - 2 + z^3",
];

fn field(text: &str) -> Field {
    parse_formula(&Source::new("formula", text)).expect("a formula").field
}

fn fields() -> impl Iterator<Item = (&'static str, Field)> {
    FORMULAS.into_iter().map(|text| (text, field(text)))
}

fn tree(field: &Field, memory: OctreeMemory) -> Octree {
    Octree::new(field, &Bindings::new(), ([-SIDE; 3], [SIDE; 3]), memory)
}

fn random(state: &mut u64) -> f64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    (z ^ (z >> 31)) as f64 / u64::MAX as f64
}

/// The part of a line within the bounds.
fn clipped(origin: [f64; 3], direction: [f64; 3]) -> Ray {
    let (mut start, mut end) = (0.0f64, f64::INFINITY);
    for axis in 0..3 {
        let (a, b) = ((-SIDE - origin[axis]) / direction[axis], (SIDE - origin[axis]) / direction[axis]);
        if direction[axis] != 0.0 {
            (start, end) = (start.max(a.min(b)), end.min(a.max(b)));
        } else if origin[axis].abs() > SIDE {
            end = start;
        }
    }
    Ray { origin, direction, start, end: end.max(start) }
}

/// Rays between random places at a distance from the middle: of bundles that spread, and of all directions.
fn rays(count: usize, distance: f64, seed: u64) -> Vec<Ray> {
    let mut state = seed;
    let mut eye = [0.0; 3];
    let ray = |i: usize| {
        if i.is_multiple_of(64) || i > count / 2 {
            eye = [0; 3].map(|_| distance * (2.0 * random(&mut state) - 1.0));
        }
        let target = [0; 3].map(|_| SIDE * (2.0 * random(&mut state) - 1.0));
        let way = [0, 1, 2].map(|axis| target[axis] - eye[axis]);
        let length = way.iter().map(|x| x * x).sum::<f64>().sqrt();
        clipped(eye, way.map(|x| x / length))
    };
    (0..count).map(ray).collect()
}

fn walk(tree: &Octree, rays: &[Ray], settings: &Settings) -> Vec<Outcome> {
    tree.first_hits(&mut Walker::new(), rays, settings)
}

/// Panics unless the outcomes are those of the tracer, as closely as both know them.
fn compare(text: &str, rays: &[Ray], settings: &Settings) {
    let field = field(text);
    let found = walk(&tree(&field, OctreeMemory::default()), rays, settings);
    let tape = Tape::new(&field, &TapeOptions { reading: Reading::Sign, ..TapeOptions::default() });
    let wanted = Tracer::new().first_hits(&tape, rays, settings);
    let mut weaker = 0;
    for ((ray, found), wanted) in rays.iter().zip(&found).zip(&wanted) {
        weaker += usize::from(found.certificate > wanted.certificate);
        let certain = found.certificate.max(wanted.certificate) == Certificate::Certified;
        let same = match (found.hit, wanted.hit) {
            (None, None) => settings.any_hit || found.ends_inside == wanted.ends_inside,
            (Some(a), Some(b)) => {
                settings.any_hit || (a.entering == b.entering && (a.t - b.t).abs() < 1e-7 * settings.size)
            }
            _ => false,
        };
        let same = same && found.starts_inside == wanted.starts_inside;
        assert!(same || !certain, "{text}\n{ray:?}\n{found:?}\n{wanted:?}");
    }
    assert!(weaker * 50 <= rays.len(), "{text}: {weaker} of {}", rays.len());
}

#[test]
fn first_hits_are_those_of_the_tracer() {
    for (i, (text, _)) in fields().enumerate() {
        // From outside, and from places that may be inside.
        compare(text, &rays(512, 6.0, i as u64), &Settings::new(2.0 * SIDE));
        compare(text, &rays(256, 1.9, i as u64), &Settings::new(2.0 * SIDE));
    }
}

#[test]
fn caps_any_hit_and_surfaces_are_those_of_the_tracer() {
    let settings = Settings::new(2.0 * SIDE);
    for (i, (text, _)) in fields().enumerate() {
        compare(text, &rays(192, 1.9, i as u64), &Settings { caps: true, ..settings });
        compare(text, &rays(192, 6.0, i as u64), &Settings { any_hit: true, ..settings });
        compare(text, &rays(192, 6.0, i as u64), &Settings { surface: true, ..settings });
    }
}

#[test]
fn rays_along_faces_and_edges_of_cells_are_followed() {
    let settings = Settings::new(2.0 * SIDE);
    for (text, _) in fields() {
        let tree = tree(&field(text), OctreeMemory::default());
        let along = |axis: usize, u: u32, v: u32| {
            let (mut origin, mut direction) = ([0.0; 3], [0.0; 3]);
            origin[axis] = -6.0;
            direction[axis] = 1.0;
            origin[(axis + 1) % 3] = tree.face((axis + 1) % 3, 16 * u + 64);
            origin[(axis + 2) % 3] = tree.face((axis + 2) % 3, 16 * v + 64);
            clipped(origin, direction)
        };
        let rays: Vec<Ray> = (0..192).map(|i| along(i % 3, i as u32 / 3 % 8, i as u32 / 24)).collect();
        compare(text, &rays, &settings);
    }
}

#[test]
fn far_away_rays_hit_as_near_ones_do() {
    let field = field("x^2 + y^2 + z^2 - 1");
    let tree = tree(&field, OctreeMemory::default());
    let settings = Settings::new(2.0 * SIDE);
    for distance in [10.0, 1e3, 1e6] {
        let rays: Vec<Ray> =
            (0..64).map(|i| clipped([f64::from(i) / 64.0, 0.25, distance], [0.0, 0.0, -1.0])).collect();
        for (ray, outcome) in rays.iter().zip(walk(&tree, &rays, &settings)) {
            let inside = 1.0 - 0.0625 - ray.origin[0].powi(2);
            assert_eq!(outcome.hit.is_some(), inside > 0.0);
            if let Some(hit) = outcome.hit {
                let wanted = distance - inside.sqrt();
                assert!((hit.t - wanted).abs() < 1e-8 + 4.0 * f64::EPSILON * distance, "{hit:?} {wanted}");
                assert_eq!(outcome.certificate, Certificate::Certified);
            }
        }
    }
}

#[test]
fn a_tree_without_room_finds_the_same() {
    let (rays, settings) = (rays(256, 6.0, 3), Settings::new(2.0 * SIDE));
    for (text, field) in fields().take(4) {
        let [all, none] = [usize::MAX, 0].map(|memory| tree(&field, OctreeMemory::new(memory)));
        let found = walk(&all, &rays, &settings);
        assert_eq!(found, walk(&none, &rays, &settings), "{text}");
        assert!(all.census().nodes > 1);
        assert_eq!(none.census().nodes, 0);
    }
}

/// Calls with each open cell, its place and number; of cells that are not open with their side of the surface.
fn each_cell(cell: &Cell, place: Place, visit: &mut impl FnMut(Place, u32, Result<&Cell, bool>)) {
    let Some(node) = cell.below.get() else { return };
    for number in 0..64 {
        if node.outside >> number & 1 == 1 {
            visit(place, number, Err(false));
        } else if node.inside >> number & 1 == 1 {
            visit(place, number, Err(true));
        } else {
            let below = node.cell(number);
            visit(place, number, Ok(below));
            each_cell(below, place.child(number), visit);
        }
    }
}

fn value_of(program: &Tape, p: [f64; 3]) -> f64 {
    let mut points = Workspace::<F64, Points>::new();
    (0..3).for_each(|axis| points.input(axis, 0)[0] = p[axis]);
    points.run(program, 1);
    points.output(0, 0)[0]
}

/// A facet encloses the values of its program at two points of its cell, and the slope between them.
fn check_facet(text: &str, facet: &Facet, (p, q): ([f64; 3], [f64; 3]), [f, g]: [f64; 2]) {
    let along = |p: [f64; 3], q: [f64; 3]| -> f64 { (0..3).map(|i| facet.gradient[i] * (p[i] - q[i])).sum() };
    assert!((f - facet.value - along(p, facet.centre)).abs() <= facet.error, "{text} {p:?}");
    let spread: f64 = (0..3).map(|i| facet.radius[i] * (p[i] - q[i]).abs()).sum();
    let rise = f - g - along(p, q);
    assert!(rise.abs() <= spread + 1e-12 * (1.0 + f.abs()), "{text} {p:?} {q:?}");
}

#[test]
fn what_cells_say_holds_all_over_them() {
    let mut state = 5;
    for (text, field) in fields() {
        let tree = tree(&field, OctreeMemory::default());
        walk(&tree, &rays(256, 6.0, 11), &Settings::new(2.0 * SIDE));
        let at = |p: [f64; 3]| field.at(&p, &Bindings::new())[0];
        let mut checked = [0; 2];
        each_cell(&tree.root, Place::ROOT, &mut |place, number, cell| {
            if random(&mut state) > 0.1 {
                return;
            }
            let (child, unit) = (place.child(number), place.unit());
            let mut point = || {
                [0, 1, 2].map(|axis| {
                    let face = |up| tree.face(axis, child.corner[axis] + up);
                    face(0) + random(&mut state) * (face(unit) - face(0))
                })
            };
            for _ in 0..4 {
                let (p, q) = (point(), point());
                let f = at(p);
                match cell {
                    Err(inside) => {
                        checked[0] += 1;
                        assert!(if inside { f < 0.0 } else { f > 0.0 || f.is_nan() }, "{text} {p:?}: {f}");
                    }
                    Ok(cell) => {
                        let Some(pieces) = &cell.pieces else { continue };
                        let mut negative = 0;
                        for (k, piece) in pieces.list().iter().enumerate() {
                            checked[1] += 1;
                            let values = [p, q].map(|p| value_of(&piece.program, p));
                            negative |= u32::from(values[0] < 0.0) << k;
                            check_facet(text, &piece.facet, (p, q), values);
                        }
                        assert_eq!(pieces.is_inside(negative), f < 0.0, "{text} {p:?}");
                        assert!(pieces.side(p).is_none_or(|inside| inside == (f < 0.0)), "{text} {p:?}");
                    }
                }
            }
        });
        assert!(checked[0] > 0, "{text}");
        // Where a field jumps or is nearly everywhere close to a pole, facets may be missing.
        assert!(checked[1] > 0 || text.contains("floor"), "{text}");
    }
}

#[test]
fn programs_of_cells_have_the_sign_of_the_field() {
    let mut state = 7;
    let text = FORMULAS[2];
    let field = field(text);
    let tree = tree(&field, OctreeMemory::default());
    walk(&tree, &rays(256, 6.0, 11), &Settings::new(2.0 * SIDE));
    let mut points = fieldstone_field::Workspace::<fieldstone_field::F64, fieldstone_field::Points>::new();
    let mut shorter = 0;
    each_cell(&tree.root, Place::ROOT, &mut |place, number, cell| {
        let Ok(cell) = cell else { return };
        shorter += usize::from(cell.programs.value.len() < tree.program_len());
        let (child, unit) = (place.child(number), place.unit());
        let p = [0, 1, 2].map(|axis| {
            let face = |up| tree.face(axis, child.corner[axis] + up);
            face(0) + random(&mut state) * (face(unit) - face(0))
        });
        (0..3).for_each(|axis| points.input(axis, 0)[0] = p[axis]);
        points.run(&cell.programs.value, 1);
        let (short, full) = (points.output(0, 0)[0], field.at(&p, &Bindings::new())[0]);
        assert_eq!(short < 0.0, full < 0.0, "{p:?}");
    });
    assert!(shorter > 100);
}

#[test]
fn r_functions_become_minima_where_only_their_sign_is_read() {
    let mut graph = fieldstone_field::Graph::new();
    let [x, y, z] = [0, 1, 2].map(|i| graph.input(fieldstone_field::Input::Coordinate(i)));
    let union = graph.rmin(x, y);
    let both = graph.rmax(union, z);
    let whole = graph.add(union, z);
    let [by_sign, by_value] = [both, whole].map(|value| Field::new(graph.clone(), value, Vec::new()));
    let mut state = 1;
    for field in [&by_sign, &by_value] {
        let signs = sign::sign_form(field);
        for _ in 0..1000 {
            let p = [0; 3].map(|_| 2.0 * random(&mut state) - 1.0);
            let (a, b) = (field.at(&p, &Bindings::new())[0], signs.at(&p, &Bindings::new())[0]);
            assert_eq!(a < 0.0, b < 0.0, "{p:?}");
        }
    }
    let node = |field: &Field| format!("{:?}", field.graph().node(field.value()));
    assert!(node(&sign::sign_form(&by_sign)).contains("Max"), "{}", node(&sign::sign_form(&by_sign)));
    assert_eq!(sign::sign_form(&by_value).value(), by_value.value());
}

#[test]
fn cells_come_in_an_order_that_rays_cross_them_in() {
    let sum = |number: u32| (number & 3) + (number >> 2 & 3) + (number >> 4);
    assert!(ORDER.windows(2).all(|pair| sum(pair[0]) <= sum(pair[1])));
    let mut sorted = ORDER;
    sorted.sort_unstable();
    assert!(sorted.iter().copied().eq(0..64));
}

#[test]
fn points_of_a_plane_are_inside_where_the_field_is_negative() {
    for (text, field) in fields() {
        let tree = tree(&field, OctreeMemory::default());
        for (axes, at) in [([0, 1], 0.1), ([2, 0], -0.37), ([1, 2], 1.9)] {
            let lattice = Lattice { axes, at, first: [-2.1, -1.2], step: [0.021, 0.017], size: [201, 140] };
            let inside = tree.inside(&lattice);
            for (i, &found) in inside.iter().enumerate() {
                let place = [(i % 201) as f64 * 0.021 - 2.1, (i / 201) as f64 * 0.017 - 1.2];
                let mut point = [at; 3];
                (point[axes[0]], point[axes[1]]) = (place[0], place[1]);
                // A margin of the bounds belongs to the tree.
                let known = point.iter().all(|x| x.abs() < SIDE);
                assert!(!known || found == (field.at(&point, &Bindings::new())[0] < 0.0), "{text} {point:?}");
            }
        }
    }
}

/// Two balls apart from each other, and a parameter that moves one.
fn moving() -> Field {
    let mut graph = Graph::new();
    let [x, y, z] = [0, 1, 2].map(|k| graph.input(Input::Coordinate(k)));
    let shift = graph.input(Input::Time);
    let (far, one, half) = (graph.constant(1.2), graph.constant(1.0), graph.constant(0.5));
    let along = graph.sub(x, far);
    let along = graph.sub(along, shift);
    let squares = [along, y, z].map(|n| graph.square(n));
    let sum = graph.add(squares[0], squares[1]);
    let sum = graph.add(sum, squares[2]);
    let ball = graph.sub(sum, half);
    let beside = graph.add(x, one);
    let others = [beside, y, z].map(|n| graph.square(n));
    let sum = graph.add(others[0], others[1]);
    let sum = graph.add(sum, others[2]);
    let still = graph.sub(sum, half);
    let value = graph.min(ball, still);
    Field::new(graph, value, Vec::new())
}

#[test]
fn a_tree_with_another_parameter_finds_the_same_as_a_new_one() {
    let field = moving();
    let at = |shift: f64| {
        let mut bindings = Bindings::new();
        bindings.set(Input::Time, shift);
        bindings
    };
    let new = |shift| Octree::new(&field, &at(shift), ([-SIDE; 3], [SIDE; 3]), OctreeMemory::default());
    let (rays, settings) = (rays(512, 6.0, 3), Settings::new(2.0 * SIDE));
    let first = new(0.0);
    let before = walk(&first, &rays, &settings);
    let again = first.rebound(&at(0.3));
    let (found, expected) = (walk(&again, &rays, &settings), walk(&new(0.3), &rays, &settings));
    assert_eq!(format!("{found:?}"), format!("{expected:?}"));
    assert_ne!(format!("{found:?}"), format!("{before:?}"));
    // The cells around the other ball are the old ones.
    let (fresh, shared) = (new(0.3), again.census());
    walk(&fresh, &rays, &settings);
    assert!(shared.bytes < 3 * fresh.census().bytes / 4, "{shared:?} {:?}", fresh.census());
    assert_eq!(shared.nodes, fresh.census().nodes);
    // Nothing changes: all is taken over but the root's cells.
    let same = first.rebound(&at(0.0));
    walk(&same, &rays, &settings);
    assert!(same.census().bytes < first.census().bytes / 3, "{:?} {:?}", same.census(), first.census());
}

#[test]
fn memory_is_given_back() {
    let memory = OctreeMemory::new(1 << 20);
    let tree = tree(&moving(), memory.clone());
    walk(&tree, &rays(256, 6.0, 3), &Settings::new(2.0 * SIDE));
    assert!(memory.used() > 0 && memory.used() == tree.census().bytes);
    drop(tree);
    assert_eq!(memory.used(), 0);
}
