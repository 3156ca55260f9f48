use super::palette::{self, Colour};
use super::*;
use fieldstone_field::{Graph, NodeId};

type Build = fn(&mut Graph, NodeId, NodeId) -> NodeId;

fn slice(build: Build, half: f64, size: (u32, u32), style: SliceStyle) -> Slice {
    let mut graph = Graph::new();
    let [x, y] = [0, 1].map(|k| graph.input(Input::Coordinate(k)));
    let value = build(&mut graph, x, y);
    Slice {
        field: Field::new(graph, value, Vec::new()),
        bindings: Bindings::new(),
        axes: [0, 1],
        window: Window::centred(half),
        size,
        style,
        title: String::new(),
        positive_inside: false,
    }
}

fn disc(g: &mut Graph, x: NodeId, y: NodeId) -> NodeId {
    let (xx, yy, one) = (g.square(x), g.square(y), g.constant(1.0));
    let sum = g.add(xx, yy);
    g.sub(sum, one)
}

fn pixel(picture: &SlicePicture, x: u32, y: u32) -> [u8; 3] {
    let at = 3 * (y * picture.width + x) as usize;
    [picture.pixels[at], picture.pixels[at + 1], picture.pixels[at + 2]]
}

fn is(colour: Colour, pixel: [u8; 3]) -> bool {
    colour.iter().zip(pixel).all(|(a, b)| (a * 255.0 - f32::from(b)).abs() < 1.0)
}

#[test]
fn verdicts_hold_at_every_corner_and_the_areas_are_right() {
    let slice = slice(disc, 2.0, (100, 100), SliceStyle::Plain);
    let picture = draw_slice(&slice, None).unwrap();
    let SliceStats { pixels, inside, outside, boundary, undefined, evaluations } = picture.stats;
    assert_eq!((pixels, inside + outside + boundary, undefined), (10_000, 10_000, 0));
    // The disc has π of 16 units of area. Its boundary crosses 200 pixels, and touches 20 at a corner or an edge.
    let area = std::f64::consts::PI / 16.0 * 10_000.0;
    assert!((inside as f64) < area && area < (inside + boundary) as f64);
    assert!((180..=220).contains(&boundary), "{boundary}");
    // Tiles and blocks that are decided cost one evaluation.
    assert!(evaluations < 5_000, "{evaluations}");
    for (x, y, colour) in [(50, 50, palette::INSIDE), (2, 2, palette::OUTSIDE)] {
        assert!(is(colour, pixel(&picture, x, y)), "{x} {y}: {:?}", pixel(&picture, x, y));
    }
    assert!(pixel(&picture, 75, 50)[0] < 100, "the line is dark");
}

#[test]
fn an_edge_between_two_pixels_is_half_of_either() {
    // The boundary runs along x = 0, between pixels 31 and 32.
    let picture = draw_slice(&slice(|_, x, _| x, 1.0, (64, 64), SliceStyle::Plain), None).unwrap();
    let row: Vec<[u8; 3]> = (28..36).map(|x| pixel(&picture, x, 10)).collect();
    assert!(is(palette::INSIDE, row[0]) && is(palette::OUTSIDE, row[7]));
    assert!(row[3][0] < 100 && row[4][0] < 100, "{row:?}");
    // Up and down nothing changes.
    assert_eq!(pixel(&picture, 31, 10), pixel(&picture, 31, 60));
}

#[test]
fn a_hole_smaller_than_a_pixel_is_not_certified() {
    // max(-1, 1 - 1e8 r²) is outside in a disc of radius 1e-4, which no centre of a pixel sees.
    let build: Build = |g, x, y| {
        let (xx, yy, large, one) = (g.square(x), g.square(y), g.constant(1e8), g.constant(1.0));
        let sum = g.add(xx, yy);
        let product = g.mul(sum, large);
        let (hill, least) = (g.sub(one, product), g.constant(-1.0));
        g.max(hill, least)
    };
    let picture = draw_slice(&slice(build, 1.0, (64, 64), SliceStyle::Plain), None).unwrap();
    // It lies where four pixels meet.
    assert_eq!((picture.stats.inside, picture.stats.boundary), (64 * 64 - 4, 4));
}

#[test]
fn undefined_places_have_their_own_tint() {
    let build: Build = |g, x, _| {
        let root = g.sqrt(x);
        let half = g.constant(0.5);
        g.sub(root, half)
    };
    let picture = draw_slice(&slice(build, 1.0, (64, 64), SliceStyle::Plain), None).unwrap();
    assert_eq!(picture.stats.undefined, 32 * 64);
    let left = pixel(&picture, 10, 10);
    assert!(is(palette::UNDEFINED, left) || is(palette::HATCH, left), "{left:?}");
}

#[test]
fn a_jump_is_a_boundary() {
    let build: Build = |g, x, _| {
        let (zero, half) = (g.constant(0.0), g.constant(0.5));
        let step = g.le(zero, x);
        g.sub(step, half)
    };
    let picture = draw_slice(&slice(build, 1.0, (64, 64), SliceStyle::Plain), None).unwrap();
    assert!((30..34).any(|x| is(palette::LINE, pixel(&picture, x, 20))));
    assert!(is(palette::INSIDE, pixel(&picture, 5, 20)) && is(palette::OUTSIDE, pixel(&picture, 60, 20)));
}

#[test]
fn pixels_are_squares_and_the_window_is_seen() {
    let window = Window { min: [0.0, 1.0], max: [4.0, 2.0] };
    let raster = Raster::new(window, (100, 100));
    assert_eq!((raster.window.min, raster.window.max), ([0.0, -0.5], [4.0, 3.5]));
    assert_eq!((raster.across(25.0), raster.upwards(0.0)), (1.0, 3.5));
}

#[test]
fn blocks_hold_every_pixel_once() {
    let all = Block { x: [3, 20], y: [5, 14] };
    let mut seen: Vec<_> = all.divided(8).into_iter().flat_map(Block::pixels).collect();
    assert_eq!(seen.len(), all.len());
    seen.sort_unstable();
    seen.dedup();
    assert_eq!(seen.len(), all.len());
}

#[test]
fn the_picture_does_not_depend_on_threads() {
    let slice = slice(disc, 2.0, (300, 260), SliceStyle::Contours);
    assert_eq!(draw_slice(&slice, Some(1)), draw_slice(&slice, Some(3)));
}

#[test]
fn impossible_slices_are_errors() {
    let with = |size, window| draw_slice(&Slice { window, ..slice(disc, 1.0, size, SliceStyle::Heat) }, None);
    assert_eq!(with((0, 5), Window::centred(1.0)), Err(SliceError::Size(0, 5)));
    assert_eq!(with((8192, 8192), Window::centred(1.0)), Err(SliceError::Size(8192, 8192)));
    for half in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-300] {
        assert!(matches!(with((9, 9), Window::centred(half)), Err(SliceError::Window { .. })), "{half}");
    }
}

fn found(build: Build) -> FoundWindow {
    let slice = slice(build, 1.0, (1, 1), SliceStyle::Plain);
    find_window(&slice.field, &slice.bindings, slice.axes)
}

#[test]
fn the_window_of_a_disc_is_a_little_larger() {
    let FoundWindow { window, extent } = found(disc);
    assert_eq!(extent, WindowExtent::Bounded);
    for k in 0..2 {
        assert!((-1.6..-1.1).contains(&window.min[k]) && (1.1..1.6).contains(&window.max[k]), "{window:?}");
    }
}

#[test]
fn far_small_endless_and_missing_sections() {
    let far: Build = |g, x, y| {
        let hundred = g.constant(100.0);
        let moved = g.sub(x, hundred);
        disc(g, moved, y)
    };
    let window = found(far).window;
    assert!(window.min[0] > 98.0 && window.max[0] < 102.0, "{window:?}");
    assert_eq!(found(|_, x, _| x).extent, WindowExtent::Unbounded);
    assert_eq!(found(|_, x, _| x).window, Window::centred(10.0));
    let nothing: Build = |g, x, _| {
        let (square, one) = (g.square(x), g.constant(1.0));
        g.add(square, one)
    };
    assert_eq!(found(nothing).extent, WindowExtent::Empty);
}
