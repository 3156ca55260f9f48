//! One convention: what is made of a ball does not depend on the way it comes into a volume.

use fieldstone_field::{Bindings, Field, Graph, Input};
use fieldstone_texel::paint::{Form, Frame, Material, Shape, paint};
use fieldstone_texel::sources::{BakeOptions, Inside, Mesh, MeshOptions, Paint, add_mesh, bake};
use fieldstone_texel::{Builder, Mode, Volume};
use glam::{DMat3, DVec3};

const EDGE: u32 = 64;
const RADIUS: f64 = 0.36;
const MIDDLE: DVec3 = DVec3::splat(0.5);

fn painted(mode: Mode) -> Volume {
    let shape = Shape {
        form: Form::Ellipsoid { radii: DVec3::splat(RADIUS) },
        frame: Frame { origin: MIDDLE, axes: DMat3::IDENTITY },
        material: Material { roughness: 0.0, ..Material::default() },
    };
    let mut builder = Builder::new(EDGE).expect("a power of two");
    paint(&mut builder, [shape.solid(1)]).expect("few cells");
    builder.build(mode).expect("few cells")
}

/// The box that the sources fit into the volume: it leaves a cell at either end.
fn bounds() -> [[f64; 3]; 2] {
    let margin = f64::from(EDGE).recip();
    [[margin; 3], [1.0 - margin; 3]]
}

fn baked(mode: Mode, inside: Inside) -> Volume {
    let mut graph = Graph::new();
    let mut value = graph.constant(-RADIUS * RADIUS);
    for axis in 0..3 {
        let (x, middle) = (graph.input(Input::Coordinate(axis)), graph.constant(MIDDLE[axis as usize]));
        let away = graph.sub(x, middle);
        let square = graph.square(away);
        value = graph.add(value, square);
    }
    let field = Field::new(graph, value, Vec::new());
    let mut builder = Builder::new(EDGE).expect("a power of two");
    let options = BakeOptions { inside, ..BakeOptions::default() };
    bake(&mut builder, (&field, &Bindings::new()), bounds(), &options, &|_, _| Paint::default())
        .expect("few cells");
    builder.build(mode).expect("few cells")
}

/// The ball of triangles; they lie a little inside of it: 0.0003 of its radius in the mean.
fn meshed(mode: Mode, inside: Inside) -> Volume {
    const STEPS: u32 = 96;
    let mut mesh = Mesh::default();
    for i in 0..=STEPS {
        for j in 0..STEPS {
            let (theta, phi) = (f64::from(i) / f64::from(STEPS), 2.0 * f64::from(j) / f64::from(STEPS));
            let ((s, c), (sin, cos)) =
                ((std::f64::consts::PI * theta).sin_cos(), (std::f64::consts::PI * phi).sin_cos());
            // Exact at the poles, so that it is closed.
            let s = if i == STEPS { 0.0 } else { s };
            mesh.points.push((MIDDLE + RADIUS * DVec3::new(s * cos, s * sin, c)).to_array());
            if i < STEPS {
                let next = (j + 1) % STEPS;
                let [a, b, c, d] =
                    [i * STEPS + j, i * STEPS + next, (i + 1) * STEPS + j, (i + 1) * STEPS + next];
                mesh.triangles.extend([[a, c, b], [b, c, d]]);
            }
        }
    }
    let mut builder = Builder::new(EDGE).expect("a power of two");
    let options = MeshOptions { inside, bounds: Some(bounds()), ..MeshOptions::default() };
    add_mesh(&mut builder, &mesh, &options).expect("few cells");
    builder.build(mode).expect("few cells")
}

/// What passes in the mean over 24 × 24 rays along a direction, over the square of the ball's own size around it.
fn transmittance(volume: &Volume, w: DVec3, level: f32) -> f64 {
    let (u, v) = w.any_orthonormal_pair();
    let place = |i: u32| 2.0 * RADIUS * ((f64::from(i) + 0.5) / 24.0 - 0.5);
    let rays = (0..576).map(|i| {
        let middle = MIDDLE + u * place(i % 24) + v * place(i / 24);
        volume.transmittance(middle - w, middle + w, level)
    });
    rays.sum::<f64>() / 576.0
}

fn directions() -> [DVec3; 4] {
    [DVec3::X, DVec3::Z, DVec3::new(1.0, 1.0, 0.0), DVec3::new(0.3, -0.5, 0.8)].map(DVec3::normalize)
}

fn amount(volume: &Volume) -> f64 {
    let mut sum = 0.0;
    volume.for_each(0, |_, texel| sum += f64::from(texel.density));
    sum * volume.cell_width(0).powi(3)
}

/// Volumes of the ball by every way, each with a name.
fn balls(mode: Mode) -> Vec<(&'static str, Volume)> {
    vec![
        ("painted", painted(mode)),
        ("field", baked(mode, Inside::Full)),
        ("mesh", meshed(mode, Inside::Full)),
    ]
}

/// A quarter of the surface (Cauchy), in all ways.
#[test]
fn a_ball_has_the_amount_of_its_shadow() {
    let exact = std::f64::consts::PI * RADIUS * RADIUS;
    for (way, volume) in balls(Mode::Sggx) {
        let error = amount(&volume) / exact - 1.0;
        assert!(error.abs() < 0.02, "{way}: {error}");
    }
}

/// At the finest level and at cells an eighth of the cube wide; 1 − π/4 of the square is free, less what cells of the border
/// hide too much.
#[test]
fn a_ball_passes_the_same_light_whatever_made_it() {
    for mode in [Mode::Sggx, Mode::Neyret1995] {
        let balls = balls(mode);
        for w in directions() {
            for (level, allowed) in [(0.0, 0.01), (3.0, 0.005)] {
                let of_the_painted = transmittance(&balls[0].1, w, level);
                for (way, volume) in &balls {
                    let found = transmittance(volume, w, level);
                    let error = found - of_the_painted;
                    assert!(error.abs() < allowed, "{mode:?} {way} at {level} along {w}: {error}");
                }
            }
        }
    }
}
