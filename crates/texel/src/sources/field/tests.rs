use super::*;
use crate::{Mode, Volume};
use std::f64::consts::PI;

/// x² + y² + z² < r², with the attributes x, 0, 1.
fn ball(radius: f64) -> Field {
    let mut graph = Graph::new();
    let x = [0, 1, 2].map(|i| graph.input(Input::Coordinate(i)));
    let squares = x.map(|x| graph.square(x));
    let sum = graph.add(squares[0], squares[1]);
    let sum = graph.add(sum, squares[2]);
    let square = graph.constant(radius * radius);
    let value = graph.sub(sum, square);
    let (zero, one) = (graph.constant(0.0), graph.constant(1.0));
    Field::new(graph, value, vec![x[0], zero, one])
}

/// x·n < 0.
fn half_space(n: [f64; 3]) -> Field {
    let mut graph = Graph::new();
    let mut value = graph.constant(0.0);
    for (axis, slope) in n.into_iter().enumerate() {
        let x = graph.input(Input::Coordinate(axis as u16));
        let slope = graph.constant(slope);
        let part = graph.mul(slope, x);
        value = graph.add(value, part);
    }
    Field::new(graph, value, Vec::new())
}

fn baked(field: &Field, edge: u32, half: f64, options: &BakeOptions) -> (Volume, Place) {
    let mut builder = Builder::new(edge).unwrap();
    let paint = |_: DVec3, attributes: &[f64]| match attributes {
        [red, ..] => Paint { albedo: [(0.5 + 0.5 * red) as f32, 0.0, 1.0], gloss: 0.5 },
        [] => Paint::default(),
    };
    let bounds = [[-half; 3], [half; 3]];
    let place = bake(&mut builder, (field, &Bindings::new()), bounds, options, &paint).unwrap();
    (builder.build(Mode::Sggx).unwrap(), place)
}

/// All filled cells of the finest level.
fn cells(volume: &Volume) -> Vec<([u32; 3], Texel)> {
    let n = volume.edge();
    let all = (0..n.pow(3)).map(|i| [i % n, i / n % n, i / n / n]);
    all.filter_map(|cell| volume.texel(0, cell).map(|texel| (cell, texel))).collect()
}

const EMPTY: BakeOptions = BakeOptions { roughness: 0.0, inside: Inside::Empty, open: false, within: None };

#[test]
fn a_ball_has_the_projected_area_of_a_disc_from_everywhere() {
    let (volume, place) = baked(&ball(1.0), 32, 1.2, &EMPTY);
    let exact = PI * place.scale().powi(2);
    let cell = volume.cell_width(0).powi(3);
    for w in [[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 1.0, 1.0], [0.3, -0.5, 2.0], [-1.0, 0.1, 0.0]] {
        let w = DVec3::from_array(w).normalize();
        let all = cells(&volume);
        let seen = all.iter().map(|(_, t)| f64::from(t.density) * t.flakes.projected_area(w) * cell);
        let error = seen.sum::<f64>() / exact - 1.0;
        assert!(error.abs() < 0.01, "{w}: {error}");
    }
}

#[test]
fn the_surface_of_a_ball_converges() {
    for (edge, allowed) in [(16, 0.01), (32, 0.003), (64, 0.002)] {
        let (volume, place) = baked(&ball(1.0), edge, 1.2, &EMPTY);
        let cell = volume.cell_width(0).powi(3);
        let amount: f64 = cells(&volume).iter().map(|(_, t)| f64::from(t.density) * cell).sum();
        // Cauchy: a quarter of 4 π r².
        let error = amount / (PI * place.scale().powi(2)) - 1.0;
        assert!(error.abs() < allowed, "{edge}: {error}");
    }
}

/// The share of the cube's face across an axis behind which something is hidden.
fn hidden(volume: &Volume, axis: usize) -> f64 {
    let n = volume.edge();
    let column = |i: u32| -> f32 {
        let cells = (0..n).map(|k| {
            let mut cell = [k; 3];
            (cell[(axis + 1) % 3], cell[(axis + 2) % 3]) = (i % n, i / n);
            cell
        });
        cells.filter_map(|cell| volume.texel(0, cell)).map(|texel| texel.depth[axis]).sum()
    };
    (0..n * n).map(|i| f64::from(-(-column(i)).exp_m1()) / f64::from(n * n)).sum()
}

#[test]
fn a_ball_hides_a_disc_along_each_axis() {
    // Cells one behind the other hide independent parts of their faces by rule, and here the same: the border is as much too
    // dark as a cell is wide.
    for (edge, allowed) in [(32, 0.06), (64, 0.03)] {
        for inside in [Inside::Skin, Inside::Full] {
            let (volume, place) = baked(&ball(1.0), edge, 1.2, &BakeOptions { inside, ..EMPTY });
            let exact = PI * place.scale().powi(2);
            for axis in 0..3 {
                let error = hidden(&volume, axis) / exact - 1.0;
                assert!((0.0..allowed).contains(&error), "{edge}, {axis}: {error}");
            }
        }
    }
}

#[test]
fn all_cells_inside_hold_the_volume_of_a_ball() {
    let (volume, place) = baked(&ball(1.0), 64, 1.2, &BakeOptions { inside: Inside::Full, ..EMPTY });
    let cell = volume.cell_width(0).powi(3);
    let (border, inside): (Vec<_>, Vec<_>) = cells(&volume).into_iter().partition(|(_, t)| t.density > 0.0);
    let (least, most) = (inside.len() as f64 * cell, (inside.len() + border.len()) as f64 * cell);
    let exact = 4.0 / 3.0 * PI * place.scale().powi(3);
    assert!(least < exact && exact < most, "{least} {exact} {most}");
}

#[test]
fn flakes_of_a_plane_lie_in_it() {
    let n = DVec3::new(0.36, 0.48, 0.8);
    let (volume, _) = baked(&half_space(n.to_array()), 16, 1.0, &BakeOptions { open: true, ..EMPTY });
    let found = cells(&volume);
    assert!(found.len() > 100);
    for (cell, texel) in found.iter().filter(|(_, texel)| texel.density > 0.1) {
        let s = texel.flakes;
        // S = 4 n nᵀ, with the mean projected area 1.
        for (entry, exact) in
            s.entries().iter().zip([n.x * n.x, n.y * n.y, n.z * n.z, n.x * n.y, n.x * n.z, n.y * n.z])
        {
            assert!((f64::from(*entry) - 4.0 * exact).abs() < 0.04, "{cell:?}: {s:?}");
        }
    }
    // The whole: a plane across the box.
    let width = volume.cell_width(0);
    let amount: f64 = found.iter().map(|(_, t)| f64::from(t.density) * width.powi(3)).sum();
    assert!((4.0 * amount - slice_area(n, 0.0)).abs() < 0.01);
}

#[test]
fn colours_come_from_attributes_at_the_surface() {
    let (volume, place) = baked(&ball(1.0), 32, 1.2, &EMPTY);
    for (cell, texel) in cells(&volume).iter().filter(|(_, texel)| texel.density > 1.0) {
        let centre = (DVec3::from_array(cell.map(f64::from)) + 0.5) * volume.cell_width(0);
        let x = place.model_from_cube(centre).x;
        assert!((f64::from(texel.albedo[0]) - (0.5 + 0.5 * x)).abs() < 0.06, "{cell:?}");
        assert!((texel.albedo[2], texel.gloss) == (1.0, 128.0 / 255.0));
    }
}

#[test]
fn a_box_that_cuts_a_solid_closes_it() {
    let hidden = |open| {
        let (volume, _) = baked(&ball(1.0), 16, 0.5, &BakeOptions { open, ..EMPTY });
        cells(&volume).len()
    };
    assert_eq!(hidden(true), 0);
    // The six faces of the cube that is left.
    assert!(hidden(false) > 6 * 13 * 13);
}

#[test]
fn what_cannot_be_baked_is_refused() {
    let mut builder = Builder::new(16).unwrap();
    let refused = |low: [f64; 3], high: [f64; 3], roughness: f64, builder: &mut Builder| {
        let options = BakeOptions { roughness, ..EMPTY };
        let field = (&ball(1.0), &Bindings::new());
        bake(builder, field, [low, high], &options, &|_, _| Paint::default()).unwrap_err().to_string()
    };
    let message = refused([0.0; 3], [f64::NAN; 3], 0.0, &mut builder);
    assert!(message.ends_with("is empty or not finite"), "{message}");
    let message = refused([0.0; 3], [1.0; 3], 2.0, &mut builder);
    assert_eq!(message, "`roughness` is a number from 0 to 1, not 2");
}

#[test]
fn threads_do_not_change_a_volume() {
    let bake = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| baked(&ball(1.0), 32, 1.2, &BakeOptions::default()).0)
    };
    assert_eq!(bake(1), bake(3));
}
