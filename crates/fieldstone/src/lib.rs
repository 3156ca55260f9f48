//! See solids that are defined by functions.
//!
//! A model is a function of space that says where a solid is: a formula, a HyperFun program, or a `.vm` program. To
//! fieldstone it is data, so that rays are traced with proofs: nothing thin is missed, and every pixel says what it
//! rests on.
//!
//! # A picture in four steps
//! ```
//! use fieldstone::{RenderOptions, RenderRequest, Settings, formula, render, write_exr, write_png};
//!
//! // 1. A model; `load("model.hf", …)` reads files.
//! let loaded = formula("(1 - sqrt(x^2 + y^2))^2 + z^2 - 0.125")?;
//!
//! // 2. What to draw: bounds, camera and light are chosen to suit the solid unless given.
//! let settings = Settings { size: (32, 24), ..Settings::default() };
//! let request = RenderRequest { settings, ..RenderRequest::default() };
//! let resolved = request.resolve(&loaded.model)?;
//! assert!(resolved.warnings.is_empty());
//!
//! // 3. The picture, with distances, normals and certificates of every pixel.
//! let rendered = render(&resolved.scene, &RenderOptions::default())?;
//! assert!(rendered.film.layer("Z").is_some());
//!
//! // 4. Files. A PNG is what one sees, an EXR is everything.
//! let folder = std::env::temp_dir().join(format!("fieldstone-doc-{}", std::process::id()));
//! std::fs::create_dir_all(&folder)?;
//! write_png(&rendered.film, &resolved.scene.lighting().background, &folder.join("torus.png"))?;
//! write_exr(&rendered.film, &folder.join("torus.exr"))?;
//! # std::fs::remove_dir_all(&folder)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Values
//! An [`Evaluator`] gives the values of a model at many points, in the sign of its file:
//! ```
//! use fieldstone::{Evaluator, Inputs, formula};
//!
//! let ball = formula("r = 2; x^2 + y^2 + z^2 - r^2")?;
//! let inputs = Inputs { parameters: vec![("r".to_owned(), 3.0)], ..Inputs::default() };
//! let mut evaluator = Evaluator::new(&ball.model, &inputs)?;
//! let mut values = Vec::new();
//! evaluator.evaluate(&[0.0, 0.0, 0.0, /* second point */ 3.0, 4.0, 0.0], &mut values);
//! assert_eq!(values, [-9.0, 16.0]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Planes and other languages
//! A [`SliceRequest`] draws a model on a plane, with a count of the pixels that are proved to be inside or outside;
//! [`convert`] writes a model in another language:
//! ```
//! use fieldstone::{Inputs, Plane, SliceRequest, Syntax, convert, draw_slice, formula};
//!
//! let ball = formula("x^2 + y^2 + z^2 - 1")?;
//! let plane = Some(Plane { axis: 2, at: 0.6 });
//! let request = SliceRequest { plane, size: (64, 64), ..SliceRequest::default() };
//! let (slice, warning) = request.resolve(&ball.model)?;
//! let picture = draw_slice(&slice, None)?;
//! assert!(warning.is_none() && picture.stats.inside > 1500);
//!
//! let program = convert(&ball.model, &Inputs::default(), Syntax::Vm)?;
//! assert!(program.text.contains("\n_0 var-x\n_1 square _0\n"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod access;
mod convert;
mod data;
mod document;
mod endless;
mod evaluate;
mod extent;
mod eye;
mod frames;
mod inputs;
mod load;
mod measure;
mod output;
mod picture;
mod plot;
mod presentation;
mod request;
mod slice;
mod texel;

pub use access::FileAccess;
pub use convert::{ConvertError, convert};
pub use data::{
    DataError, MAX_DATA_BYTES, NumberType, Placement, RawLayout, load_nrrd, load_points, load_raw, load_scan,
    load_voxels,
};
pub use document::{Document, ResolvedDocument, SceneRequest, scene_schema};
pub use endless::{LoopError, settle_loops};
pub use evaluate::Evaluator;
pub use frames::{Frames, FramesError, MAX_FRAMES};
pub use inputs::{InputError, Inputs};
pub use load::{LoadError, LoadOptions, Loaded, MAX_FILE_BYTES, MAX_OPERATIONS, formula, load};
pub use measure::{MeasureError, MeasureRequest, Measured};
pub use output::{
    OutputError, check_writable, write_beside, write_exr, write_png, write_png_toned, write_rgb,
};
pub use picture::{PictureFileError, read_picture};
pub use plot::{
    AffineForm, FirstHit, PictureError, PlotError, PlotRequest, PlottedSpan, RayChoice, RayPlot, Root,
    SpanChoice, Verdict,
};
pub use request::{RenderRequest, RequestError, Resolved, Warning};
pub use slice::{Plane, SliceRequest, SliceRequestError, SliceWarning};
pub use texel::{
    Cut, CutContent, CutPicture, MAX_CUT_PIXELS, Recipe, TexelError, load_volume, recipe_schema, write_volume,
};

pub use fieldstone_field::{Bindings, Field, Graph, Input, NodeId};
pub use fieldstone_lang::{
    Diagnostic, Diagnostics, Dialect, FileSign, Finish, Lamp, Lens, Model, Object, Parameter, Presentation,
    PrintError, Printed, Severity, Signature, Source, Syntax, UpAxis, Viewpoint, hyperfun_functions,
    print_model,
};
pub use fieldstone_render::{
    FoundWindow, MAX_SLICE_PIXELS, RenderError, RenderOptions, Rendered, Sight, Slice, SliceError,
    SlicePicture, SliceStats, SliceStyle, Stats, Viewer, Window, WindowExtent, draw_slice, find_window,
    render,
};
pub use fieldstone_scene::{
    Aperture, Appearance, Background, Ball, BallError, Blended, Bounds, BoundsError, CHANNELS, Camera,
    CameraError, Channel, Condition, Environment, EnvironmentError, ExposureError, Face, Film, Image,
    ImageError, Instance, Light, LightError, LightSource, Lighting, MAX_BOUNCES, MAX_IMAGE_PIXELS,
    MAX_LIGHT_SAMPLES, Material, MaterialError, Method, NORMAL_INPUTS, Part, Pixel, Projection, Rgb, Scene,
    SceneError, Settings, Shading, Solid, Surroundings, TexelBox, Texture, Tone, ToneCurve, Tree, Up, View,
    Wrap, linear_to_srgb, srgb_to_linear,
};
pub use fieldstone_solids::{Interpolation, PointCloud, PointError, Reconstruction, VoxelArray, VoxelError};
pub use fieldstone_space::{
    Census, DEFAULT_BOUNDS, Enclosure, Extent, FoundBounds, Lattice, MeasureOptions, Measures, Octree,
    OctreeMemory, Walker, solid_bounds,
};
pub use fieldstone_texel::{Fidelity, FileError, Mode, Phong, Sggx, Size, Texel, Volume};
pub use fieldstone_trace::Certificate;
pub use glam;
