use super::*;
use crate::{Mode, Texel, Volume};
use fieldstone_field::{Graph, Input};

/// |p| − r: a distance.
fn ball(radius: f64) -> Field {
    let mut graph = Graph::new();
    let squares = [0, 1, 2].map(|i| {
        let x = graph.input(Input::Coordinate(i));
        graph.square(x)
    });
    let sum = graph.add(squares[0], squares[1]);
    let sum = graph.add(sum, squares[2]);
    let distance = graph.sqrt(sum);
    let radius = graph.constant(radius);
    let value = graph.sub(distance, radius);
    Field::new(graph, value, Vec::new())
}

fn volume(field: Option<&Field>, edge: u32, options: &HypertextureOptions) -> (Volume, Place) {
    let mut builder = Builder::new(edge).unwrap();
    let bindings = Bindings::new();
    let field = field.map(|field| (field, &bindings));
    let place = add_hypertexture(&mut builder, field, [[-1.0; 3], [1.0; 3]], options).unwrap();
    (builder.build(Mode::Sggx).unwrap(), place)
}

fn cells(volume: &Volume) -> Vec<Texel> {
    let n = volume.edge();
    (0..n.pow(3)).filter_map(|i| volume.texel(0, [i % n, i / n % n, i / n / n])).collect()
}

#[test]
fn a_soft_ball_holds_the_integral_of_its_density() {
    let options = HypertextureOptions { amplitude: 0.0, softness: 0.4, density: 5.0, ..Default::default() };
    let (volume, place) = volume(Some(&ball(0.6)), 32, &options);
    let cell = volume.cell_width(0).powi(3);
    let sum: f64 = cells(&volume).iter().map(|t| f64::from(t.density) * cell).sum();
    // ∫ ρ dV with ρ falling linearly from r₁ = 0.4 to r₂ = 0.8: π/3 (r₁ + r₂)(r₁² + r₂²) ρ₀.
    let (a, b) = (0.4f64, 0.8f64);
    let exact = 5.0 * std::f64::consts::PI / 3.0 * (a + b) * (a * a + b * b) * place.scale().powi(3);
    assert!((sum / exact - 1.0).abs() < 0.005, "{sum} {exact}");
}

#[test]
fn noise_stays_in_its_reach() {
    let options = HypertextureOptions { amplitude: 0.2, softness: 0.1, ..Default::default() };
    let (volume, place) = volume(Some(&ball(0.5)), 32, &options);
    let n = volume.edge();
    let width = volume.cell_width(0);
    let half_diagonal = 0.5 * 3f64.sqrt() * width / place.scale();
    let mut densities = std::collections::BTreeSet::new();
    for i in 0..n.pow(3) {
        let cell = [i % n, i / n % n, i / n / n];
        let centre = (DVec3::from_array(cell.map(f64::from)) + 0.5) * width;
        let distance = place.model_from_cube(centre).length() - 0.5;
        let density = volume.texel(0, cell).map_or(0.0, |texel| texel.density);
        if distance > 0.25 + half_diagonal {
            assert_eq!(density, 0.0, "{cell:?}");
        } else if distance < -0.25 - half_diagonal {
            assert!((density - 50.0).abs() < 0.2, "{cell:?}: {density}");
        } else {
            densities.insert(density.to_bits());
        }
    }
    assert!(densities.len() > 500);
}

#[test]
fn bias_and_gain_are_perlins() {
    for b in [0.2, 0.5, 0.9] {
        assert!((bias(b, 0.5) - b).abs() < 1e-12);
        assert_eq!((bias(b, 0.0), bias(b, 1.0)), (0.0, 1.0));
        assert!((gain(b, 0.5) - 0.5).abs() < 1e-12);
        assert!((gain(b, 0.25) + gain(b, 0.75) - 1.0).abs() < 1e-12);
    }
    assert!(gain(0.9, 0.25) < 0.25 && gain(0.1, 0.25) > 0.25);
}

#[test]
fn a_block_of_noise_is_half_full() {
    let options = HypertextureOptions { softness: 1e-3, density: 10.0, ..Default::default() };
    let (volume, place) = volume(None, 32, &options);
    let cell = volume.cell_width(0).powi(3);
    let sum: f64 = cells(&volume).iter().map(|t| f64::from(t.density) * cell).sum();
    let share = sum / (10.0 * (2.0 * place.scale()).powi(3));
    assert!((share - 0.5).abs() < 0.06, "{share}");
}

#[test]
fn options_out_of_range_are_refused() {
    let mut builder = Builder::new(4).unwrap();
    let mut message = |options: HypertextureOptions| {
        add_hypertexture(&mut builder, None, [[0.0; 3], [1.0; 3]], &options).unwrap_err().to_string()
    };
    let default = HypertextureOptions::default();
    assert_eq!(
        message(HypertextureOptions { softness: 0.0, ..default }),
        "`softness` is a number above 0, not 0"
    );
    let noise = Noise { octaves: 99, ..Noise::default() };
    let octaves = message(HypertextureOptions { noise, ..default });
    assert_eq!(octaves, "`noise.octaves` is a number from 1 to 16, not 99");
    let noise = Noise { frequency: f64::NAN, ..Noise::default() };
    assert!(message(HypertextureOptions { noise, ..default }).starts_with("`noise.frequency`"));
}
