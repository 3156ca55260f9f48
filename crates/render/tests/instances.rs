//! Solids that stand in many places, against the same solids with the motion written into their programs, and against
//! closed forms.

use fieldstone_field::{Bindings, Field, Graph, Input, NodeId};
use fieldstone_render::{RenderOptions, Rendered, render};
use fieldstone_scene::{
    Background, Blended, Bounds, Camera, Channel, Instance, Light, Lighting, Material, Method, NORMAL_INPUTS,
    Part, Pixel, Projection, Scene, Settings, Solid, Texture, Tree, linear_to_srgb,
};
use glam::{DAffine3, DMat3, DQuat, DVec3};

const SIZE: u32 = 96;

fn point(g: &mut Graph) -> [NodeId; 3] {
    [0, 1, 2].map(|i| g.input(Input::Coordinate(i)))
}

/// |x − centre|² − radius².
fn ball(g: &mut Graph, centre: DVec3, radius: f64) -> NodeId {
    let mut sum = g.constant(-radius * radius);
    for (axis, x) in point(g).into_iter().enumerate() {
        let c = g.constant(centre[axis]);
        let d = g.sub(x, c);
        let square = g.square(d);
        sum = g.add(sum, square);
    }
    sum
}

/// A ball with half the radius of a cube of side 1.5 around it taken away from the cube: two parts.
fn hollow_cube() -> Field {
    let mut g = Graph::new();
    let half = g.constant(0.75);
    let sides = point(&mut g).map(|x| {
        let size = g.abs(x);
        g.sub(size, half)
    });
    let side = g.max(sides[0], sides[1]);
    let cube = g.max(side, sides[2]);
    let ball = ball(&mut g, DVec3::ZERO, 0.95);
    let outside = g.neg(ball);
    let value = g.max(cube, outside);
    Field::new(g, value, vec![cube, ball])
}

fn of_two_parts(field: Field, bounds: Bounds) -> Solid {
    let part = |number: usize, colour| Part {
        name: format!("part {number}"),
        field: Some(number),
        materials: vec![Blended {
            material: Material::new(colour, 0.2, 10.0).expect("the material is sound"),
            share: None,
        }],
        back: None,
    };
    let tree = Tree::Intersection(vec![Tree::Part(0), Tree::Complement(Box::new(Tree::Part(1)))]);
    let solid = Solid::new(field, Bindings::new(), bounds);
    solid.with_parts(vec![part(0, DVec3::X), part(1, DVec3::Y)], tree).expect("the parts are there")
}

fn cube(half: f64) -> Bounds {
    Bounds::new(DVec3::splat(-half), DVec3::splat(half)).expect("the bounds are sound")
}

/// The field with the motion written into its program.
fn moved(field: &Field, object_from_world: &DAffine3) -> Field {
    let mut graph = Graph::new();
    let world = point(&mut graph);
    let object = [0, 1, 2].map(|row| {
        let mut sum = graph.constant(object_from_world.translation[row]);
        for (column, x) in world.into_iter().enumerate() {
            let factor = graph.constant(object_from_world.matrix3.col(column)[row]);
            let product = graph.mul(factor, x);
            sum = graph.add(sum, product);
        }
        sum
    });
    let outputs: Vec<NodeId> =
        std::iter::once(field.value()).chain(field.attributes().iter().copied()).collect();
    let copies = graph.import(field.graph(), &outputs, |graph, input| match input {
        Input::Coordinate(axis) => object[usize::from(axis)],
        other => graph.input(other),
    });
    Field::new(graph, copies[0], copies[1..].to_vec())
}

fn camera(eye: DVec3, target: DVec3) -> Camera {
    let projection = Projection::Perspective { vertical_fov_radians: 0.6 };
    Camera::look_at(eye, target, DVec3::Z, projection).expect("the camera is sound")
}

fn sunlit() -> Lighting {
    let sun = Light::directional(DVec3::new(0.3, -0.5, 1.0), DVec3::ONE).expect("the light is sound");
    let background = Background::plain(DVec3::ZERO);
    Lighting { lights: vec![sun], ambient: DVec3::splat(0.1), background, ..Lighting::default() }
}

fn settings() -> Settings {
    Settings { size: (SIZE, SIZE), samples: 1, method: Method::Affine, ..Settings::default() }
}

fn draw(scene: &Scene) -> Rendered {
    render(scene, &RenderOptions::default()).expect("threads start")
}

fn pixels(rendered: &Rendered) -> impl Iterator<Item = (u32, u32, Pixel)> + '_ {
    (0..SIZE * SIZE)
        .map(|i| (i % SIZE, i / SIZE, rendered.film.pixel(i % SIZE, i / SIZE).expect("the pixel is there")))
}

/// Turned, stretched, mirrored, small and large.
fn motions() -> Vec<DAffine3> {
    let turn = DQuat::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 0.8);
    let affine = |scale: DVec3, turn: DQuat, place: DVec3| {
        DAffine3::from_scale_rotation_translation(scale, turn, place)
    };
    let skew = DAffine3 {
        matrix3: DMat3::from_cols(DVec3::X, DVec3::new(0.5, 1.0, 0.0), DVec3::new(0.0, 0.3, 1.0)),
        translation: DVec3::new(-3.5, 0.0, -2.0),
    };
    vec![
        affine(DVec3::ONE, turn, DVec3::new(3.0, 0.0, 0.5)),
        affine(DVec3::new(1.5, 0.5, 1.0), turn, DVec3::new(-3.0, 1.0, 1.0)),
        affine(DVec3::new(-1.0, 1.0, 1.0), DQuat::IDENTITY, DVec3::new(0.0, 0.0, 3.0)),
        affine(DVec3::splat(0.2), turn, DVec3::new(0.0, -2.5, -1.0)),
        affine(DVec3::splat(3.0), DQuat::from_rotation_z(0.5), DVec3::new(2.0, 9.0, -2.0)),
        skew,
        DAffine3::IDENTITY,
    ]
}

#[test]
fn instances_are_their_solid_moved() {
    let (field, bounds) = (hollow_cube(), cube(0.8));
    let motions = motions();
    let instances: Vec<Instance> =
        motions.iter().map(|motion| Instance::new(0, *motion).expect("it can be moved back")).collect();
    let solids = instances
        .iter()
        .map(|i| of_two_parts(moved(&field, i.object_from_world()), i.world_bounds(&bounds)))
        .collect();
    let camera = camera(DVec3::new(1.0, -14.0, 6.0), DVec3::new(0.0, 0.0, 0.5));
    let written = Scene::new(solids, camera, sunlit(), settings()).expect("the scene is sound");
    let solid = of_two_parts(field, bounds);
    let instanced = Scene::with_instances(vec![solid], instances, camera, sunlit(), settings());
    let instanced = instanced.expect("the scene is sound");
    let (written, instanced) = (draw(&written), draw(&instanced));
    let (mut hits, mut of_part, mut shades) = (0, [0; 2], 0);
    for ((x, y, a), (.., b)) in pixels(&instanced).zip(pixels(&written)) {
        assert_eq!(a.depth.is_finite(), b.depth.is_finite(), "{x}, {y}");
        if !a.depth.is_finite() {
            continue;
        }
        hits += 1;
        assert!((a.depth - b.depth).abs() < 1e-5, "{x}, {y}: {} and {}", a.depth, b.depth);
        let [n, m] = [a.normal, b.normal].map(|n| DVec3::from_array(n.map(f64::from)));
        assert!((n - m).length() < 1e-4 && (n.length() - 1.0).abs() < 1e-6, "{x}, {y}: {n} and {m}");
        assert_eq!(a.part, b.part % 2.0, "{x}, {y}");
        assert_eq!(a.certificate, 1.0, "{x}, {y}");
        of_part[a.part as usize] += 1;
        // At the very edge of a shadow a rounding decides.
        let off = a.colour.iter().zip(b.colour).any(|(p, q)| (p - q).abs() > 1e-4);
        shades += u32::from(off);
    }
    assert!(hits > 1500 && of_part[1] > 100 && shades <= 2, "{hits} {of_part:?} {shades}");
}

/// Numbers between 0 and 1, evenly and without a pattern.
fn chance(seed: &mut u64) -> f64 {
    *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*seed >> 11) as f64 / (1u64 << 53) as f64
}

/// Balls of many sizes all over a cube.
fn balls(count: usize) -> Vec<(DVec3, f64)> {
    let mut seed = 7;
    let mut next = || chance(&mut seed);
    (0..count)
        .map(|_| (10.0 * DVec3::new(next() - 0.5, next() - 0.5, next() - 0.5), 0.02 + 0.1 * next()))
        .collect()
}

fn scene_of(balls: &[(DVec3, f64)], camera: Camera) -> Scene {
    let mut g = Graph::new();
    let value = ball(&mut g, DVec3::ZERO, 1.0);
    let solid = Solid::new(Field::new(g, value, Vec::new()), Bindings::new(), cube(1.1));
    let place = |&(centre, radius): &(DVec3, f64)| {
        let motion = DAffine3::from_scale_rotation_translation(DVec3::splat(radius), DQuat::IDENTITY, centre);
        Instance::new(0, motion).expect("it can be moved back")
    };
    let instances = balls.iter().map(place).collect();
    let lighting = Lighting { lights: Vec::new(), ..sunlit() };
    Scene::with_instances(vec![solid], instances, camera, lighting, settings()).expect("the scene is sound")
}

/// Where a ray crosses a ball.
fn crossings(ray: (DVec3, DVec3), (centre, radius): (DVec3, f64)) -> Option<[f64; 2]> {
    let to_centre = centre - ray.0;
    let nearest = to_centre.dot(ray.1);
    let apart = (to_centre - nearest * ray.1).length_squared();
    let half = (radius * radius - apart).sqrt();
    (half >= 0.0).then_some([nearest - half, nearest + half])
}

#[test]
fn the_nearest_of_ten_thousand_balls_is_seen() {
    let balls = balls(10_000);
    let outside = camera(DVec3::new(3.0, -20.0, 6.0), DVec3::ZERO);
    // Among them, and inside of the first.
    let among = camera(balls[0].0, DVec3::ZERO);
    for (camera, inside) in [(outside, false), (among, true)] {
        let scene = scene_of(&balls, camera);
        let rendered = draw(&scene);
        let (mut hits, mut wrong) = (0, 0);
        for (x, y, pixel) in pixels(&rendered) {
            let ray = scene.ray(f64::from(x) + 0.5, f64::from(y) + 0.5);
            let first = balls.iter().filter_map(|&ball| crossings(ray, ball)).flatten().filter(|t| *t > 0.0);
            let first = first.fold(f64::INFINITY, f64::min);
            hits += u32::from(first.is_finite());
            let depth = f64::from(pixel.depth);
            // Grazing rays are decided by rounding.
            let right = depth == first || (depth - first).abs() < 2e-5;
            wrong += u32::from(!right || pixel.certificate != 1.0);
        }
        assert!(wrong <= 1 && hits > 4000, "{wrong} wrong of {hits}, inside {inside}");
    }
}

/// From inside of several solids at once the nearest of their boundaries is seen, from whatever it is the way out.
#[test]
fn rays_from_inside_of_several_solids_find_the_nearest_way_out() {
    let balls: Vec<(DVec3, f64)> =
        (0..12).map(|i| (DVec3::new(0.1 * f64::from(i), 0.0, 0.0), 1.5 + 0.2 * f64::from(i % 5))).collect();
    let scene = scene_of(&balls, camera(DVec3::new(0.2, 0.1, 0.0), DVec3::new(5.0, 1.0, 0.3)));
    for (x, y, pixel) in pixels(&draw(&scene)) {
        let ray = scene.ray(f64::from(x) + 0.5, f64::from(y) + 0.5);
        let ends = balls.iter().filter_map(|&ball| crossings(ray, ball)).map(|[_, end]| end);
        let nearest = ends.fold(f64::INFINITY, f64::min);
        assert!((f64::from(pixel.depth) - nearest).abs() < 1e-5, "{x}, {y}: {} {nearest}", pixel.depth);
        assert!(DVec3::from_array(pixel.normal.map(f64::from)).dot(ray.1) < 0.0, "{x}, {y}");
    }
}

/// A texture that is the normal: of the solid as it is in its own space, outward even where one looks from within.
#[test]
fn textures_read_the_outward_normal_in_the_space_of_the_solid() {
    let mut g = Graph::new();
    let value = ball(&mut g, DVec3::ZERO, 1.0);
    let half = g.constant(0.5);
    let colours =
        NORMAL_INPUTS.map(|input| g.input(input)).map(|n| g.mul(n, half)).map(|n| g.add(n, half)).to_vec();
    let texture = Texture { channel: Channel::Colour, first: 0, srgb: true };
    let solid = Solid::new(Field::new(g, value, colours), Bindings::new(), cube(1.1));
    let solid = solid.with_material(Material::default().with_texture(texture)).expect("three attributes");
    let turn = DQuat::from_axis_angle(DVec3::new(0.3, -1.0, 0.4).normalize(), 1.1);
    let scale = DVec3::new(1.0, 2.0, 0.5);
    let motion = DAffine3::from_scale_rotation_translation(scale, turn, DVec3::new(0.5, 0.2, 0.1));
    let instance = Instance::new(0, motion).expect("it can be moved back");
    let lighting = Lighting { lights: Vec::new(), ambient: DVec3::ONE, ..sunlit() };
    for eye in [DVec3::new(0.0, -8.0, 1.0), DVec3::new(0.55, 0.2, 0.1)] {
        let camera = camera(eye, DVec3::new(0.5, 0.3, 0.0));
        let scene =
            Scene::with_instances(vec![solid.clone()], vec![instance], camera, lighting.clone(), settings());
        let scene = scene.expect("the scene is sound");
        let rendered = draw(&scene);
        for (x, y, pixel) in pixels(&rendered).filter(|(.., pixel)| pixel.depth.is_finite()) {
            let ray = scene.ray(f64::from(x) + 0.5, f64::from(y) + 0.5);
            let place = ray.0 + f64::from(pixel.depth) * ray.1;
            let normal = instance.object_from_world().transform_point3(place);
            let seen = DVec3::from_array(pixel.colour.map(|c| linear_to_srgb(f64::from(c))));
            let expected = 0.5 * (normal + DVec3::ONE);
            assert!((seen - expected).abs().max_element() < 1e-3, "{x}, {y}: {seen} {expected}");
        }
        assert!(rendered.stats.hits > 500, "{}", rendered.stats.hits);
    }
}
