//! POV-Ray's isosurfaces: the same solids, views, sizes and light.
//!
//! POV-Ray steps along rays by a bound of the gradient that its users find by trial: too small, and there are holes; too
//! large, and it is slow. Here it is the least power of two with which its picture is that of our certified hits, which
//! is more care than users can take.

mod expression;
mod process;

use crate::error::BenchError;
use crate::frames::files_in;
use crate::gallery::{FEW, LONG};
use crate::ours::Prepared;
use crate::plan::Plan;
use crate::report::{PovRow, Report};
use crate::timing::Times;
use fieldstone::glam::DVec3;
use fieldstone::{
    Background, Bounds, Camera, Film, Light, Lighting, Material, Projection, RenderOptions, Scene, Settings,
    Up, render, write_png,
};
use process::{Job, Pov};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// The light comes from the right, from above and from behind the camera.
const TO_LIGHT: [f64; 3] = [0.45, 0.65, 0.6];
const COLOUR: f64 = 0.7;
const LIGHT: f64 = 0.9;
const AMBIENT: f64 = 0.25;

/// The size at which the bound of the gradient is sought, and how long a picture may take there, in seconds.
const TRIAL: (u32, f64) = (128, 20.0);
/// Pictures agree if no more of their pixels differ: edges fall on either side of pixel centres.
const AGREE: f64 = 0.001;
/// The largest bound of the gradient that is tried.
const STEEPEST: f64 = 65536.0;

/// Measures the solids of Table 1 that the plan wants.
///
/// # Errors
/// A solid that cannot be drawn by us; a POV-Ray that fails. Where it is not installed, that is noted only.
pub(crate) fn measure(
    plan: &Plan,
    report: &mut Report,
    progress: &mut dyn FnMut(&str),
) -> Result<(), BenchError> {
    let Some(pov) = Pov::find() else {
        report.skipped.push("POV-Ray: it is not installed (apt-get install povray)".to_owned());
        return Ok(());
    };
    for file in files_in(&plan.gallery.join("table1"), &["txt"])? {
        let name = file.strip_prefix(&plan.gallery).unwrap_or(&file).display().to_string();
        if !plan.wants(&name) {
            continue;
        }
        progress(&format!("{name} with POV-Ray"));
        let subject = Subject::read(&pov, &name, &file)?;
        match subject.steepness()? {
            None => report.skipped.push(format!(
                "POV-Ray, {name}: no bound of the gradient up to {STEEPEST} draws it whole within {} s at {}²",
                TRIAL.1, TRIAL.0
            )),
            Some(steepness) => {
                for &threads in &plan.threads {
                    for shadow in [false, true] {
                        report.povray.push(subject.row(plan, steepness, (threads, shadow))?);
                    }
                }
            }
        }
    }
    Ok(())
}

/// A solid in both programs.
struct Subject<'p> {
    pov: &'p Pov,
    name: &'p str,
    prepared: Prepared,
    camera: Camera,
    function: String,
}

impl<'p> Subject<'p> {
    fn read(pov: &'p Pov, name: &'p str, file: &Path) -> Result<Self, BenchError> {
        let prepared = Prepared::read(file)?;
        let solid = &prepared.scene().solids()[0];
        let function = expression::expression(solid.field(), solid.bindings())?;
        let camera = Camera::fitted(solid.bounds(), Up::Z, 1.0);
        Ok(Self { pov, name, camera, function, prepared })
    }

    fn bounds(&self) -> &Bounds {
        self.prepared.scene().solids()[0].bounds()
    }

    fn to_light(&self) -> DVec3 {
        let [right, up, back] = TO_LIGHT;
        (right * self.camera.right() + up * self.camera.up() - back * self.camera.forward()).normalize()
    }

    /// Our scene: the solid in one colour, one light.
    fn scene(&self, size: u32, shadow: bool) -> Result<Scene, BenchError> {
        let failed = |reason: String| BenchError::model(self.name, reason);
        let light =
            Light::directional(self.to_light(), DVec3::splat(LIGHT)).map_err(|e| failed(e.to_string()))?;
        let material = Material::new(DVec3::splat(COLOUR), 0.0, 1.0).map_err(|e| failed(e.to_string()))?;
        let solid = self.prepared.scene().solids()[0].clone();
        let solid = solid.with_material(material).map_err(|e| failed(e.to_string()))?;
        let lighting = Lighting {
            lights: vec![if shadow { light } else { light.without_shadow() }],
            ambient: DVec3::splat(AMBIENT),
            background: Background::plain(DVec3::ZERO),
            environment: None,
        };
        let settings = Settings { size: (size, size), samples: 1, ..Settings::default() };
        Scene::new(vec![solid], self.camera, lighting, settings).map_err(|e| failed(e.to_string()))
    }

    fn ours(&self, scene: &Scene, threads: usize) -> Result<Film, BenchError> {
        let options = RenderOptions { threads: Some(threads), ..RenderOptions::default() };
        render(scene, &options).map(|r| r.film).map_err(|e| BenchError::model(self.name, e))
    }

    /// The scene in the language of POV-Ray. Its camera has its axes given, so that it does not matter that space is
    /// left-handed there.
    fn text(&self, steepness: f64, shadow: bool) -> String {
        let vector = |v: DVec3| format!("<{:?},{:?},{:?}>", v.x, v.y, v.z);
        let (camera, bounds) = (&self.camera, self.bounds());
        let width = match camera.projection() {
            Projection::Perspective { vertical_fov_radians } => 2.0 * (0.5 * vertical_fov_radians).tan(),
            Projection::Orthographic { height } => height,
        };
        let towards = bounds.centre() + self.to_light() * (100.0 * bounds.longest_side());
        let shadowless = if shadow { "" } else { " shadowless" };
        format!(
            "#version 3.7;\nglobal_settings {{ assumed_gamma 1 ambient_light rgb 1 }}\n\
             camera {{ perspective location {} direction {} right {} up {} }}\n\
             light_source {{ {} color rgb {LIGHT:?} parallel point_at {}{shadowless} }}\n\
             isosurface {{ function {{ {} }} contained_by {{ box {{ {}, {} }} }} max_gradient {steepness:?}\n\
             pigment {{ color rgb {COLOUR:?} }} finish {{ ambient {AMBIENT:?} diffuse 1 }} }}\n",
            vector(camera.eye()),
            vector(camera.forward()),
            vector(camera.right() * width),
            vector(camera.up() * width),
            vector(towards),
            vector(bounds.centre()),
            self.function,
            vector(bounds.min()),
            vector(bounds.max()),
        )
    }

    /// The least power of two that draws the whole solid with its shadow; `None` if that takes too long.
    fn steepness(&self) -> Result<Option<f64>, BenchError> {
        let ours = self.ours(&self.scene(TRIAL.0, false)?, 2)?;
        let shadowed = self.ours(&self.scene(TRIAL.0, true)?, 2)?;
        let mut steepness = 1.0;
        while steepness <= STEEPEST {
            match (self.differs(steepness, false, &ours)?, self.differs(steepness, true, &shadowed)?) {
                (Some(plain), Some(shadow)) if plain.max(shadow) <= AGREE => {
                    return Ok(Some(steepness));
                }
                (Some(_), Some(_)) => steepness *= 2.0,
                _ => return Ok(None),
            }
        }
        Ok(None)
    }

    /// In which part of the pixels of a small picture POV-Ray's differs; `None` if it takes too long.
    fn differs(&self, steepness: f64, shadow: bool, ours: &Film) -> Result<Option<f64>, BenchError> {
        let (size, limit_seconds) = TRIAL;
        let job = Job { text: self.text(steepness, shadow), size, threads: 2, limit_seconds };
        self.pov.draw(&job)?.map(|drawn| different(ours, &drawn.picture)).transpose()
    }

    fn row(
        &self,
        plan: &Plan,
        steepness: f64,
        (threads, shadow): (usize, bool),
    ) -> Result<PovRow, BenchError> {
        let scene = self.scene(plan.size, shadow)?;
        let job = Job { text: self.text(steepness, shadow), size: plan.size, threads, limit_seconds: 600.0 };
        let [mut ours, mut whole, mut trace, mut process] = [const { Vec::new() }; 4];
        let mut differ = 0.0;
        for run in 0..plan.runs {
            let start = Instant::now();
            let film = self.ours(&scene, threads)?;
            ours.push(start.elapsed().as_secs_f64());
            whole.push(self.prepared.seconds() + start.elapsed().as_secs_f64());
            let drawn = self.pov.draw(&job)?;
            let drawn = drawn.ok_or_else(|| BenchError::peer("POV-Ray", "it took more than ten minutes"))?;
            trace.push(drawn.trace_seconds);
            process.push(drawn.process_seconds);
            if run == 0 {
                differ = different(&film, &drawn.picture)?;
                self.keep(plan, (&film, &drawn.picture, &job.text), shadow)?;
            }
            if drawn.trace_seconds > LONG && run + 1 >= FEW {
                break;
            }
        }
        let runs = ours.len() as u32;
        let [ours, whole, trace, process] = [ours, whole, trace, process].map(Times::new);
        Ok(PovRow {
            file: self.name.to_owned(),
            shadow,
            threads,
            size: plan.size,
            runs,
            max_gradient: steepness,
            ours: ours.spread(),
            ours_whole: whole.spread(),
            trace: trace.spread(),
            process: process.spread(),
            ratio: ours.ratio(&trace),
            different: differ,
        })
    }

    /// Leaves both pictures, their difference and the text, if that is wished.
    fn keep(
        &self,
        plan: &Plan,
        (ours, theirs, text): (&Film, &[[f32; 3]], &str),
        shadow: bool,
    ) -> Result<(), BenchError> {
        let Some(folder) = &plan.pictures else { return Ok(()) };
        let name = Path::new(self.name).file_stem().map_or("solid".into(), |stem| stem.to_string_lossy());
        let path = |what: &str| -> PathBuf {
            folder.join(format!("{name}{}-{what}", if shadow { "-shadow" } else { "" }))
        };
        let failed = |e: fieldstone::OutputError| BenchError::peer("pictures", e);
        let background = Background::plain(DVec3::ZERO);
        std::fs::create_dir_all(folder).map_err(|e| BenchError::system(folder.display(), e))?;
        write_png(ours, &background, &path("ours.png")).map_err(failed)?;
        let size = (ours.width(), ours.height());
        let screen =
            |v: f32| (255.0 * fieldstone::linear_to_srgb(f64::from(v)).clamp(0.0, 1.0)).round() as u8;
        let bytes: Vec<u8> = theirs.iter().flatten().map(|&v| screen(v)).collect();
        fieldstone::write_rgb(size, &bytes, &path("pov.png")).map_err(failed)?;
        let apart =
            colours(ours).zip(theirs).flat_map(|(a, b)| [0, 1, 2].map(|i| screen((a[i] - b[i]).abs())));
        fieldstone::write_rgb(size, &apart.collect::<Vec<_>>(), &path("difference.png")).map_err(failed)?;
        let file = path("scene.pov");
        std::fs::write(&file, text).map_err(|e| BenchError::system(file.display(), e))
    }
}

/// The linear colours of a film, row by row from the top.
fn colours(film: &Film) -> impl Iterator<Item = [f32; 3]> + '_ {
    let places = (0..film.height()).flat_map(|y| (0..film.width()).map(move |x| (x, y)));
    places.map(|(x, y)| film.pixel(x, y).map_or([0.0; 3], |pixel| pixel.colour))
}

/// In which part of the pixels two pictures differ by more than a tenth of white.
fn different(ours: &Film, theirs: &[[f32; 3]]) -> Result<f64, BenchError> {
    let all = ours.width() as usize * ours.height() as usize;
    if theirs.len() != all {
        return Err(BenchError::peer("POV-Ray", "its picture has another size"));
    }
    let differ = |(a, b): &([f32; 3], &[f32; 3])| (0..3).any(|i| (a[i] - b[i]).abs() > 0.1);
    Ok(colours(ours).zip(theirs).filter(differ).count() as f64 / all as f64)
}
