use super::parse_jsurf;
use crate::diagnostic::Source;
use crate::model::Model;
use crate::presentation::{Finish, Lens};
use fieldstone_field::Bindings;

const PLAIN: &str = "surface_equation=x^2+y^2+z^2-1\n";

fn read(text: &str) -> Result<Model, String> {
    parse_jsurf(&Source::new("a.jsurf", text)).map_err(|errors| errors.to_string())
}

/// The model of a text that has this one warning, or none if it is empty.
#[track_caller]
fn model(text: &str) -> Model {
    let model = read(text).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(model.warnings, []);
    model
}

fn close(a: [f64; 3], b: [f64; 3]) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12)
}

#[test]
fn an_equation_with_parameters() {
    let model = model("surface_equation=a*x^2 - b\nsurface_parameter_b=3\nsurface_parameter_a=2.0\n");
    let parameters: Vec<_> = model.parameters.iter().map(|p| (p.name.as_str(), p.default)).collect();
    assert_eq!(parameters, [("a", 2.0), ("b", 3.0)]);
    let mut bindings = Bindings::new();
    model.parameters.iter().for_each(|p| bindings.set(p.input, p.default));
    assert_eq!(model.field.at(&[2.0, 0.0, 0.0], &bindings), [5.0]);
    assert!(model.presentation.surface);
}

#[test]
fn parameters_hide_built_in_names() {
    let model = model("surface_equation=e*x+t\nsurface_parameter_e=2\nsurface_parameter_t=1");
    let mut bindings = Bindings::new();
    model.parameters.iter().for_each(|p| bindings.set(p.input, p.default));
    assert_eq!(model.field.at(&[3.0, 0.0, 0.0], &bindings), [7.0]);
}

#[test]
fn the_scale_is_a_power_of_ten() {
    let sphere = |text: &str| model(&format!("{PLAIN}{text}")).presentation.clip_sphere;
    assert_eq!(sphere(""), Some(([0.0; 3], 1.0)));
    let Some((_, radius)) = sphere("scale_factor=-0.3010299956639812") else { panic!("a ball") };
    assert!((radius - 0.5).abs() < 1e-12);
}

#[test]
fn the_usual_camera_looks_down_z_with_y_up() {
    let view = model(&format!("{PLAIN}scale_factor=1")).presentation.view.unwrap();
    assert!(close(view.target, [0.0; 3]) && close(view.up, [0.0, 1.0, 0.0]), "{view:?}");
    assert!(view.eye[2] > 10.0 && view.eye[..2] == [0.0, 0.0]);
    let Lens::Parallel { height } = view.lens else { panic!("parallel") };
    assert!((height - 20.0).abs() < 1e-12);
}

#[test]
fn a_rotation_turns_the_surface_and_not_the_camera() {
    // Takes the x axis of the view to the z axis of the model, and so the −z that it looks along to x.
    let text = format!("{PLAIN}rotation_matrix=0 0 -1 0  0 1 0 0  1 0 0 0  0 0 0 1");
    let view = model(&text).presentation.view.unwrap();
    assert!(view.eye[0] < -1.0 && view.eye[1..] == [0.0, 0.0], "{view:?}");
    assert!(close(view.up, [0.0, 1.0, 0.0]));
}

#[test]
fn a_perspective_camera_stands_where_it_says() {
    let text = format!(
        "{PLAIN}camera_type=PERSPECTIVE_CAMERA\ncamera_fov_y=90\n\
         camera_transform=1 0 0 0  0 1 0 0  0 0 1 -5  0 0 0 1"
    );
    let view = model(&text).presentation.view.unwrap();
    assert!(close(view.eye, [0.0, 0.0, 5.0]));
    assert_eq!(view.lens, Lens::Perspective { vertical_fov_radians: 90_f64.to_radians() });
}

#[test]
fn colours_of_both_sides_and_of_nothing() {
    let text = format!(
        "{PLAIN}front_material_color=0.1 0.2 0.3\nfront_material_shininess=7\n\
         front_material_specular_iIntensity=0.25\nbackground_color=1 1 1\n"
    );
    let shown = model(&text).presentation;
    let front =
        Finish { colour: [0.1, 0.2, 0.3], ambient: 0.4, diffuse: 0.8, specular: 0.25, shininess: 7.0 };
    assert_eq!((shown.front, shown.back), (Some(front), None));
    assert_eq!(shown.background, Some([1.0; 3]));
}

#[test]
fn lights_that_are_on_turn_with_the_view() {
    let text = format!(
        "{PLAIN}light_status_0=ON\nlight_position_0=0 0 100\nlight_intensity_0=0.5\nlight_status_1=OFF\n\
         light_position_1=1 1 1\nrotation_matrix=0 0 -1 0  0 1 0 0  1 0 0 0  0 0 0 1"
    );
    let lamps = model(&text).presentation.lamps.unwrap();
    assert_eq!(lamps.len(), 1);
    assert!(close(lamps[0].to_light, [-1.0, 0.0, 0.0]), "{lamps:?}");
    assert_eq!((lamps[0].colour, lamps[0].intensity), ([1.0; 3], 0.5));
    assert_eq!(model(PLAIN).presentation.lamps, None);
}

#[test]
fn what_is_not_taken_into_account_is_named_with_its_line() {
    let model =
        read(&format!("{PLAIN}surface_alpha=0.5\nlight_colour_0=1 1 1\nscale_factor=0\nscale_factor=0"));
    let source = Source::new(
        "a.jsurf",
        format!("{PLAIN}surface_alpha=0.5\nlight_colour_0=1 1 1\nscale_factor=0\nscale_factor=0"),
    );
    let warnings: Vec<String> = model.unwrap().warnings.iter().map(|w| w.render(&source)).collect();
    assert_eq!(warnings.len(), 3);
    assert!(warnings[0].contains("a.jsurf:2:1") && warnings[0].contains("`surface_alpha` has no meaning"));
    assert!(warnings[1].contains("a.jsurf:3:1") && warnings[1].contains("did you mean `light_color_0`?"));
    assert!(warnings[2].contains("a.jsurf:5:1") && warnings[2].contains("given again"));
}

#[test]
fn values_out_of_range_are_warnings() {
    let text = format!(
        "{PLAIN}background_color=2 0 0\nfront_material_shininess=0\ncamera_height=-1\n\
         rotation_matrix=2 0 0 0  0 1 0 0  0 0 1 0  0 0 0 1\nlight_status_0=ON\nlight_status_1=MAYBE\n\
         light_status_2=ON\nlight_position_2=1 1 1"
    );
    let model = read(&text).unwrap();
    assert_eq!(model.warnings.len(), 7, "{:#?}", model.warnings);
    assert_eq!(model.presentation.background, Some([1.0, 0.0, 0.0]));
}

#[test]
fn huge_files_are_refused() {
    let error = read(&"k=1\n".repeat(300_000)).unwrap_err();
    assert!(error.starts_with("error: the file is larger than 1 MiB") && error.len() < 200, "{error}");
}

#[test]
fn errors_point_into_the_file() {
    insta::assert_snapshot!(read("# nothing\nscale_factor=0.1\n").unwrap_err());
    let text = "surface_equation=x^2\\\n  +b*y)\nscale_factor=x\nrotation_matrix=1 2 3\nsurface_parameter_x=1\n\
                camera_type=FISHEYE\nbackground_color=0 nan 1\nsurface_transform_matrix=\
                0 0 0 0  0 0 0 0  0 0 0 0  0 0 0 1";
    insta::assert_snapshot!(read(text).unwrap_err());
}
