use super::*;
use fieldstone_field::{Bindings, Field, Graph, Input, NodeId};
use fieldstone_scene::{
    Blended, Bounds, Camera, Lighting, Material, Method, Part, Settings, Solid, Tree, Up,
};
use glam::DAffine3;

fn coordinate(g: &mut Graph, axis: u16) -> NodeId {
    g.input(Input::Coordinate(axis))
}

/// |x|² − 1.
fn ball() -> Field {
    let mut g = Graph::new();
    let mut sum = g.constant(-1.0);
    for axis in 0..3 {
        let x = coordinate(&mut g, axis);
        let square = g.square(x);
        sum = g.add(sum, square);
    }
    Field::new(g, sum, Vec::new())
}

fn cube(half: f64) -> Bounds {
    Bounds::new(DVec3::splat(-half), DVec3::splat(half)).unwrap()
}

fn solid() -> Solid {
    Solid::new(ball(), Bindings::new(), cube(1.5))
}

fn scene(solids: Vec<Solid>, instances: Vec<Instance>) -> Scene {
    let camera = Camera::fitted(&cube(1.0), Up::Z, 1.0);
    Scene::with_instances(solids, instances, camera, Lighting::default(), Settings::default()).unwrap()
}

fn at(x: f64) -> Instance {
    Instance::new(0, DAffine3::from_translation(DVec3::new(x, 0.0, 0.0))).unwrap()
}

fn along_x(x: f64) -> [(DVec3, DVec3); 1] {
    [(DVec3::new(x, 0.0, 0.0), DVec3::X)]
}

/// With and without a hierarchy.
fn scenes() -> [Scene; 2] {
    [scene(vec![solid()], vec![Instance::unmoved(0)]), scene(vec![solid()], vec![at(0.0), at(10.0)])]
}

#[test]
fn nothing_is_found_behind_the_furthest_distance() {
    for scene in scenes() {
        let prepared = Prepared::new(&scene, &OctreeMemory::default());
        let mut asker = Asker::default();
        let rays = along_x(-4.0);
        for (distance, found) in [(2.9, false), (3.1, true), (100.0, true)] {
            let distance = [distance];
            let nearest = prepared.blockers(&mut asker, &rays, &distance)[0].surface;
            let blocker = prepared.blockers(&mut asker, &rays, &distance)[0].surface;
            for surface in [nearest, blocker] {
                assert_eq!(surface.map(|s| (s.t * 1e6).round()), found.then_some(3e6));
            }
            assert_eq!(prepared.blocked(&mut asker, &rays, &distance), [found]);
        }
    }
}

#[test]
fn ways_out_are_seen_from_inside() {
    for scene in scenes() {
        let prepared = Prepared::new(&scene, &OctreeMemory::default());
        let mut asker = Asker::default();
        let surface = prepared.surfaces(&mut asker, &along_x(0.25))[0].surface.unwrap();
        assert!(surface.from_inside && (surface.t - 0.75).abs() < 1e-6);
        assert!(surface.before.x < 1.0 && surface.behind.x > 1.0 && surface.behind.x < 1.0 + 1e-6);
        assert_eq!(prepared.normals(&mut asker, &[(surface, DVec3::X)])[0].x, -1.0);
    }
}

#[test]
fn ways_out_through_caps_are_seen_from_inside() {
    let cut = Solid::new(ball(), Bindings::new(), cube(0.5));
    for scene in
        [scene(vec![cut.clone()], vec![Instance::unmoved(0)]), scene(vec![cut], vec![at(0.0), at(10.0)])]
    {
        let prepared = Prepared::new(&scene, &OctreeMemory::default());
        let mut asker = Asker::default();
        let surface = prepared.surfaces(&mut asker, &along_x(0.25))[0].surface.unwrap();
        assert!(surface.from_inside && (surface.t - 0.25).abs() < 1e-9);
        assert!(surface.before.x < 0.5 && surface.behind.x > 0.5);
        let outside = prepared.surfaces(&mut asker, &along_x(-3.0))[0].surface.unwrap();
        assert!(!outside.from_inside && (outside.t - 2.5).abs() < 1e-9);
        assert!(outside.before.x < -0.5 && outside.behind.x > -0.5);
    }
}

#[test]
fn of_solids_in_the_same_place_the_first_instance_is_seen() {
    let instances = vec![at(5.0), at(0.0), at(0.0), at(-2.0 + 1e-12), at(-2.0)];
    let scene = scene(vec![solid()], instances);
    let prepared = Prepared::new(&scene, &OctreeMemory::default());
    let mut asker = Asker::default();
    let seen = |asker: &mut Asker, x| prepared.surfaces(asker, &along_x(x))[0].surface.unwrap().instance;
    assert_eq!(seen(&mut asker, -9.0), 3);
    assert_eq!(seen(&mut asker, 0.5), 1);
    assert_eq!(seen(&mut asker, 3.0), 0);
}

#[test]
fn solids_have_their_own_method_and_tolerance() {
    let sampled = solid().with_method(Some(Method::Sampled { step: None }), None).unwrap();
    let coarse = solid().with_method(None, Some(1e-4)).unwrap();
    let bracket = |solid: Solid| {
        let scene = scene(vec![solid], vec![Instance::unmoved(0)]);
        let answer = Prepared::new(&scene, &OctreeMemory::default())
            .surfaces(&mut Asker::default(), &along_x(-4.0))[0];
        let surface = answer.surface.unwrap();
        (answer.certificate, surface.behind.x - surface.before.x)
    };
    let (certificate, width) = bracket(solid());
    assert!(certificate == Certificate::Certified && width < 1e-7, "{width}");
    assert_eq!(bracket(sampled).0, Certificate::Tolerance);
    assert!(bracket(coarse).1 > 1e-5);
}

/// Parts −x and +x on either side of a wall, of which the solid is the blend that fills the gap of 0.2 between them.
#[test]
fn where_no_part_begins_the_closest_owns_the_place() {
    let mut g = Graph::new();
    let x = coordinate(&mut g, 0);
    let y = coordinate(&mut g, 1);
    let tenth = g.constant(0.1);
    let left = g.add(x, tenth);
    let minus = g.neg(x);
    let right = g.add(minus, tenth);
    let field = Field::new(g, y, vec![left, right]);
    let part = |number: usize| Part {
        name: "side".into(),
        field: Some(number),
        materials: vec![Blended { material: Material::default(), share: None }],
        back: None,
    };
    let tree = Tree::Union(vec![Tree::Part(0), Tree::Part(1)]);
    let blend = Solid::new(field, Bindings::new(), cube(1.0)).with_parts(vec![part(0), part(1)], tree);
    let scene = scene(vec![solid(), blend.unwrap()], vec![Instance::unmoved(1)]);
    let prepared = Prepared::new(&scene, &OctreeMemory::default());
    let rays = [-0.05, 0.05].map(|x| (DVec3::new(x, 2.0, 0.0), -DVec3::Y));
    let answers = prepared.surfaces(&mut Asker::default(), &rays);
    // The parts of the first solid are counted before these.
    assert_eq!(answers.iter().map(|a| a.surface.unwrap().part).collect::<Vec<_>>(), [1, 2]);
}
