use super::*;

const WIDE: Projection = Projection::Perspective { vertical_fov_radians: 1.0 };

fn close(a: DVec3, b: DVec3) -> bool {
    a.distance(b) < 1e-12
}

fn boxes() -> [Bounds; 4] {
    [
        Bounds::new(-DVec3::ONE, DVec3::ONE).unwrap(),
        Bounds::new(DVec3::new(5.0, -2.0, 1.0), DVec3::new(5.1, 30.0, 2.0)).unwrap(),
        Bounds::new(DVec3::splat(300.0), DVec3::splat(300.001)).unwrap(),
        Bounds::new(DVec3::splat(-1000.0), DVec3::new(1000.0, -999.0, 500.0)).unwrap(),
    ]
}

/// The least and the greatest image coordinate of the corners, along u and v.
fn extent(camera: &Camera, bounds: &Bounds, aspect: f64) -> [(f64, f64); 2] {
    let places = bounds.corners().map(|c| camera.project(c, aspect).expect("in front of the eye"));
    let range = |f: fn(&(f64, f64)) -> f64| {
        let least = places.iter().map(f).fold(f64::INFINITY, f64::min);
        (least, places.iter().map(f).fold(f64::NEG_INFINITY, f64::max))
    };
    [range(|p| p.0), range(|p| p.1)]
}

#[test]
fn axes_follow_the_convention() {
    let camera = Camera::look_at(DVec3::new(0.0, -5.0, 0.0), DVec3::ZERO, DVec3::Z, WIDE).unwrap();
    assert!(close(camera.forward(), DVec3::Y));
    assert!(close(camera.right(), DVec3::X));
    assert!(close(camera.up(), DVec3::Z));
    let slanted = Camera::look_at(DVec3::splat(3.0), DVec3::X, DVec3::Y, WIDE).unwrap();
    assert!(close(slanted.right(), slanted.forward().cross(slanted.up())));
    assert!(slanted.up().y > 0.0 && slanted.up().dot(slanted.forward()).abs() < 1e-15);
}

#[test]
fn perspective_rays_span_the_angle() {
    let camera = Camera::look_at(DVec3::new(0.0, -5.0, 0.0), DVec3::ZERO, DVec3::Z, WIDE).unwrap();
    let (origin, middle) = camera.ray(0.5, 0.5, 2.0);
    assert!(close(origin, camera.eye()) && close(middle, DVec3::Y));
    let (_, top) = camera.ray(0.5, 0.0, 2.0);
    let (_, bottom) = camera.ray(0.5, 1.0, 2.0);
    assert!(top.z > 0.0 && bottom.z < 0.0);
    assert!((top.angle_between(bottom) - 1.0).abs() < 1e-12);
    let (_, right) = camera.ray(1.0, 0.5, 2.0);
    assert!((right.x / right.y - 2.0 * 0.5_f64.tan()).abs() < 1e-12);
    assert!(right.is_normalized());
}

#[test]
fn orthographic_rays_start_in_the_plane_of_the_eye() {
    let lens = Projection::Orthographic { height: 4.0 };
    let camera = Camera::look_at(DVec3::new(0.0, 0.0, 9.0), DVec3::ZERO, DVec3::Y, lens).unwrap();
    let (corner, direction) = camera.ray(0.0, 0.0, 1.5);
    assert!(close(corner, DVec3::new(-3.0, 2.0, 9.0)));
    assert!(close(direction, -DVec3::Z));
}

#[test]
fn projecting_undoes_the_ray() {
    for lens in [WIDE, Projection::Orthographic { height: 3.0 }] {
        let camera = Camera::look_at(DVec3::new(4.0, 1.0, 2.0), DVec3::Y, DVec3::Z, lens).unwrap();
        for (u, v) in [(0.1, 0.9), (0.5, 0.5), (0.75, 0.2)] {
            let (origin, direction) = camera.ray(u, v, 1.6);
            let (u2, v2) = camera.project(origin + direction * 3.7, 1.6).unwrap();
            assert!((u - u2).abs() < 1e-12 && (v - v2).abs() < 1e-12);
        }
    }
    let camera = Camera::look_at(DVec3::ZERO, DVec3::X, DVec3::Z, WIDE).unwrap();
    assert_eq!(camera.project(-DVec3::X, 1.0), None);
}

#[test]
fn impossible_cameras_are_errors() {
    let look = |eye, target, up, lens| Camera::look_at(eye, target, up, lens).unwrap_err();
    let (eye, origin) = (DVec3::new(0.0, 0.0, 3.0), DVec3::ZERO);
    assert_eq!(look(eye, eye, DVec3::Z, WIDE), CameraError::NoDirection(eye));
    assert!(matches!(look(eye, origin, DVec3::Z, WIDE), CameraError::Up { .. }));
    assert!(matches!(look(eye, origin, DVec3::ZERO, WIDE), CameraError::Up { .. }));
    assert!(matches!(look(eye, DVec3::NAN, DVec3::Y, WIDE), CameraError::NotFinite { .. }));
    for fov in [0.0, -1.0, PI, f64::NAN] {
        let lens = Projection::Perspective { vertical_fov_radians: fov };
        assert!(matches!(look(eye, origin, DVec3::Y, lens), CameraError::FieldOfView(_)));
    }
    for height in [0.0, -2.0, f64::INFINITY] {
        let lens = Projection::Orthographic { height };
        assert_eq!(look(eye, origin, DVec3::Y, lens), CameraError::Height(height));
    }
}

#[test]
fn the_default_view_fills_the_image_up_to_the_margin() {
    for bounds in boxes() {
        for (up, aspect) in [(Up::Y, 1.0), (Up::Z, 2.5), (Up::Z, 0.4)] {
            let camera = Camera::fitted(&bounds, up, aspect);
            let spans = extent(&camera, &bounds, aspect);
            for (least, greatest) in spans {
                // The eye is far from small boxes, where the coordinates lose digits.
                assert!(least >= MARGIN - 1e-9 && greatest <= 1.0 - MARGIN + 1e-9, "{spans:?}");
                assert!((least + greatest - 1.0).abs() < 1e-6, "in the middle: {spans:?}");
            }
            assert!(spans.iter().any(|s| (s.1 - s.0 - FILL).abs() < 1e-6), "{spans:?}");
        }
    }
}

#[test]
fn the_default_view_is_from_the_front_the_right_and_above() {
    let bounds = boxes()[0];
    let z_up = Camera::fitted(&bounds, Up::Z, 1.0).eye();
    assert!(z_up.x > 1.0 && z_up.y < -1.0 && z_up.z > 1.0 && -z_up.y > z_up.x);
    let y_up = Camera::fitted(&bounds, Up::Y, 1.0).eye();
    assert!(y_up.x > 1.0 && y_up.z > 1.0 && y_up.y > 1.0 && y_up.z > y_up.x);
    assert!(Up::Y.three_quarter().is_normalized() && Up::Z.three_quarter().is_normalized());
}

#[test]
fn from_a_fixed_eye_the_angle_is_fitted() {
    let bounds = boxes()[0];
    for distance in [4.0, 1000.0] {
        let view = View { eye: Some(DVec3::new(0.0, -distance, 0.3)), ..View::default() };
        let camera = Camera::framing(&bounds, &view, Up::Z, 1.3).unwrap();
        let spans = extent(&camera, &bounds, 1.3);
        assert!(spans.iter().all(|s| s.0 >= MARGIN - 1e-9 && s.1 <= 1.0 - MARGIN + 1e-9), "{spans:?}");
        assert!(spans.iter().any(|s| s.0.min(1.0 - s.1) <= MARGIN + 1e-9), "{spans:?}");
    }
    // From within the box nothing fits.
    let view = View { eye: Some(DVec3::splat(0.5)), ..View::default() };
    let camera = Camera::framing(&bounds, &view, Up::Z, 1.0).unwrap();
    assert_eq!(camera.projection(), Projection::Perspective { vertical_fov_radians: WIDEST_FITTED_FOV });
}

#[test]
fn a_fixed_angle_or_target_moves_the_eye() {
    let bounds = boxes()[0];
    let narrow = Projection::Perspective { vertical_fov_radians: 0.1 };
    let view = View { projection: Some(narrow), ..View::default() };
    let camera = Camera::framing(&bounds, &view, Up::Z, 1.0).unwrap();
    assert!(camera.eye().length() > 20.0 && camera.projection() == narrow);

    let target = DVec3::new(0.5, 0.0, 0.0);
    let view = View { target: Some(target), ..View::default() };
    let camera = Camera::framing(&bounds, &view, Up::Z, 1.0).unwrap();
    let (u, v) = camera.project(target, 1.0).unwrap();
    assert!((u - 0.5).abs() < 1e-12 && (v - 0.5).abs() < 1e-12);
    let spans = extent(&camera, &bounds, 1.0);
    assert!(spans.iter().all(|s| s.0 >= MARGIN - 1e-9 && s.1 <= 1.0 - MARGIN + 1e-9), "{spans:?}");
}

#[test]
fn a_parallel_view_has_the_box_before_it() {
    let view = View { projection: Some(Projection::Orthographic { height: 3.0 }), ..View::default() };
    for target in [None, Some(DVec3::splat(0.7))] {
        for bounds in boxes() {
            let camera = Camera::framing(&bounds, &View { target, ..view }, Up::Y, 1.0).unwrap();
            assert!(bounds.corners().iter().all(|&c| (c - camera.eye()).dot(camera.forward()) > 0.0));
        }
    }
}

#[test]
fn an_eye_out_of_this_world_is_refused() {
    let bounds = boxes()[0];
    for distance in [1e14, 1e154, 1e308, f64::INFINITY, f64::NAN] {
        let view = View { eye: Some(DVec3::X * distance), ..View::default() };
        let refused = Camera::framing(&bounds, &view, Up::Z, 1.0);
        assert!(
            matches!(refused, Err(CameraError::TooFar { .. } | CameraError::NotFinite { .. })),
            "{distance}: {refused:?}"
        );
    }
}

#[test]
fn an_up_vector_nobody_asked_for_gives_way() {
    let bounds = boxes()[0];
    let above = View { eye: Some(DVec3::new(0.0, 0.0, 8.0)), ..View::default() };
    let camera = Camera::framing(&bounds, &above, Up::Z, 1.0).unwrap();
    assert!(close(camera.up(), DVec3::Y) && close(camera.right(), DVec3::X));
    let asked = View { up: Some(DVec3::Z), ..above };
    assert!(matches!(Camera::framing(&bounds, &asked, Up::Z, 1.0), Err(CameraError::Up { .. })));
    let at_centre = View { eye: Some(DVec3::ZERO), ..View::default() };
    assert_eq!(Camera::framing(&bounds, &at_centre, Up::Z, 1.0), Err(CameraError::NoDirection(DVec3::ZERO)));
}

#[test]
fn rays_through_a_lens_meet_in_the_sharp_plane() {
    let lens = Aperture { radius: 0.25, focus_distance: 7.0 };
    for projection in
        [Projection::Perspective { vertical_fov_radians: 0.9 }, Projection::Orthographic { height: 3.0 }]
    {
        let camera = Camera::look_at(DVec3::new(1.0, -8.0, 3.0), DVec3::ZERO, DVec3::Z, projection).unwrap();
        let with_lens = camera.with_aperture(lens).unwrap();
        let (origin, direction) = camera.ray(0.2, 0.7, 1.5);
        let sharp = origin + direction * (7.0 / direction.dot(camera.forward()));
        for place in [(0.0, 0.0), (0.6, -0.8), (-1.0, 0.0)] {
            let (from, towards) = with_lens.lens_ray((0.2, 0.7), 1.5, place);
            assert!((sharp - from).cross(towards).length() < 1e-12 && towards.is_normalized());
            let aside = 0.25 * (place.0 * camera.right() + place.1 * camera.up());
            assert!((from - origin - aside).length() < 1e-12);
            assert_eq!(camera.lens_ray((0.2, 0.7), 1.5, place), (origin, direction));
        }
    }
    for (radius, focus_distance) in [(0.0, 1.0), (1.0, -1.0), (f64::NAN, 1.0), (1.0, f64::INFINITY)] {
        let camera = Camera::fitted(&Bounds::new(-DVec3::ONE, DVec3::ONE).unwrap(), Up::Z, 1.0);
        assert!(camera.with_aperture(Aperture { radius, focus_distance }).is_err());
    }
}
