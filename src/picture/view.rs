//! The listener's view: as one picture, and frame by frame in a window.
//!
//! A window's picture is drawn at a share of the window's size and stretched. While nothing moves, the last picture is
//! shown again. After some frames without movement the picture is redrawn at full size, some rows per frame.

use super::PictureError;
use super::slice::{Kind, check_size, draw, prepare};
use crate::error::Error;
use crate::gl::{Context, GpuTimer, Picture, Program, ProgramCache, full_screen_pass_rows};
use crate::platform;
use crate::scene::{IntoPair, Listener, Path, Scene, SceneError, Surface, Viewpoint};
use crate::shader::{self, Structure, StructureKey};
use crate::tracer::GpuScene;
use glam::{Vec2, Vec3};
use image::RgbaImage;
use std::num::NonZeroUsize;
use std::rc::Rc;

/// Radius of the ball that represents the source, as a share of the listener's radius. That radius is the only length
/// that gives a scene a scale.
pub const SOURCE_SHARE: f32 = 0.12;

/// Options of a view.
#[derive(Clone, Debug, PartialEq)]
pub struct ViewOptions {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Vertical field of view in radians, above 0 and below π.
    pub field_of_view: f32,
}

impl Default for ViewOptions {
    /// A view of 960 × 540 pixels, 70° from top to bottom.
    fn default() -> ViewOptions {
        ViewOptions {
            width: 960,
            height: 540,
            field_of_view: 70f32.to_radians(),
        }
    }
}

/// The scene as seen from a listener's position along its viewing direction, with a source. The listener is not drawn.
/// The source is a glowing ball that lights everything that it can reach. A scene without a source is also drawn.
///
/// # Errors
/// [`Error::Picture`] for an impossible size or field of view, [`Error::Scene`] and
/// [`Error::Trace`] for a scene that cannot be drawn, [`Error::Gpu`] when the renderer fails.
pub fn first_person<'a>(
    context: &Context,
    pair: impl IntoPair<'a>,
    options: &ViewOptions,
) -> Result<RgbaImage, Error> {
    let seen = pair.viewpoint()?;
    let eye = Eye::of(seen)?;
    let (width, height) = (options.width, options.height);
    check_size(context, width, height)?;
    let half_height = (0.5 * options.field_of_view).tan();
    let possible = 0.0 < options.field_of_view && options.field_of_view < std::f32::consts::PI;
    if !(possible && half_height.is_finite() && half_height > 0.0) {
        let degrees = options.field_of_view.to_degrees();
        return Err(PictureError::FieldOfView { degrees }.into());
    }
    let shader = prepare(context, seen.scene, Kind::View)?;
    aim(
        &shader.program,
        &eye,
        eye.ball_m(),
        [width, height],
        half_height,
    );
    draw(context, &shader, width, height)
}

/// Vertical field of view in radians.
const FIELD_OF_VIEW: f32 = 70.0 / 180.0 * std::f32::consts::PI;

/// Minimum distance of the listener at which the source's ball is drawn, in multiples of the ball's radius.
const NEAREST: f32 = 2.0;

/// Number of frames without movement before the picture is refined.
const STILL: u32 = 8;

/// Time per frame for refining, in milliseconds.
const REFINING: f64 = 12.0;

/// Minimum number of rows refined per frame.
const LEAST_ROWS: u32 = 4;

/// Number of rows refined per frame if their time cannot be measured. At a window's usual width these rows have about
/// as many pixels as a coarse picture.
const UNTIMED_ROWS: u32 = 8;

/// Maximum predicted time of a picture in seconds, before any time has been measured.
const FIRST_PICTURE: f64 = 1.0;

/// Maximum predicted time of refining per frame, in seconds.
const REFINED: f64 = 0.1;

/// Typical number of evaluations per pixel: the steps of its ray, and of the shadow ray at its end.
const EVALUATIONS_PER_PIXEL: f64 = 30.0;

/// Maximum number of cached programs. The programs of the most recent scenes are cached.
const PROGRAMS_KEPT: NonZeroUsize = NonZeroUsize::new(4).unwrap();

/// The inputs of the picture, which is redrawn only when they change.
struct Shown {
    eye: Eye,
    surfaces: Vec<Surface>,
    /// Size in pixels of the coarse picture, and of the window.
    size: [u32; 2],
    full: [u32; 2],
}

/// Draws the listener's view in a window, and caches programs and pictures.
pub struct View {
    context: Context,
    programs: ProgramCache<Rc<StructureKey>>,
    scene: GpuScene,
    timer: GpuTimer,
    coarse: Option<Picture>,
    fine: Option<Picture>,
    shown: Option<Shown>,
    still: u32,
    /// Number of rows of the fine picture already drawn.
    refined: u32,
    /// Number of fine rows drawn per millisecond.
    rows_per_ms: f64,
    /// The part of a picture whose drawing time has been measured but not yet read.
    marked: Option<Marked>,
    /// Measured drawing time of the last picture, in milliseconds.
    took: f64,
}

/// The part of a picture drawn between two marks.
#[derive(Clone, Copy)]
enum Marked {
    /// The whole coarse picture.
    Coarse,
    /// The given number of rows of the fine picture.
    Rows(u32),
}

/// The result of drawing a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Drawn {
    /// Size of the drawn picture in pixels, horizontally and vertically.
    pub size: [u32; 2],
    /// Whether the picture was redrawn, not just shown again.
    pub anew: bool,
    /// Drawing time in milliseconds. On a graphics card the time arrives later, so it is the time of the previous
    /// picture.
    pub milliseconds: f64,
}

impl View {
    /// Creates a view in its initial state.
    ///
    /// # Errors
    /// [`Error::Gpu`] when the renderer fails.
    pub fn new(context: &Context) -> Result<View, Error> {
        Ok(View {
            context: context.clone(),
            programs: ProgramCache::new(PROGRAMS_KEPT),
            scene: GpuScene::new(context)?,
            timer: GpuTimer::new(context),
            coarse: None,
            fine: None,
            shown: None,
            still: 0,
            refined: 0,
            rows_per_ms: 2.0,
            marked: None,
            took: 0.0,
        })
    }

    /// Compiles the program for the scene, without drawing.
    ///
    /// # Errors
    /// The errors of [`draw`](View::draw).
    pub fn check(&mut self, scene: &Scene) -> Result<(), Error> {
        self.program(scene).map(drop)
    }

    /// Draws the scene into the window as a listener sees it, with a source, at `scale` of the window's size. `refines`
    /// allows a finer picture while nothing moves.
    ///
    /// # Errors
    /// [`Error::Trace`] for a scene that does not fit, [`Error::Gpu`] when the renderer fails.
    pub fn draw<'a>(
        &mut self,
        pair: impl IntoPair<'a>,
        size: [u32; 2],
        scale: (f32, bool),
    ) -> Result<Drawn, Error> {
        let seen = pair.viewpoint()?;
        self.draw_seen(seen.scene, Eye::of(seen)?, size, scale)
    }

    fn draw_seen(
        &mut self,
        scene: &Scene,
        eye: Eye,
        [width, height]: [u32; 2],
        (scale, refines): (f32, bool),
    ) -> Result<Drawn, Error> {
        // On a graphics card the last drawing is one picture old, so this call waits only if the card lags behind.
        self.take_time();
        let scale = scale.min(foreseen_scale(scene, [width, height]));
        let side = |pixels: u32| ((pixels as f32 * scale).round() as u32).clamp(1, pixels.max(1));
        let size = [side(width), side(height)];
        let full = [width, height];
        let same = |shown: &Shown| {
            (shown.size, shown.full) == (size, full)
                && shown.eye == eye
                && shown.surfaces == scene.surfaces
        };
        let anew = !self.shown.as_ref().is_some_and(same);
        let mut drawn = Drawn {
            size,
            anew,
            milliseconds: 0.0,
        };
        if anew {
            let program = self.program(scene)?;
            let picture = sized(&self.context, &mut self.coarse, size)?;
            aim_in_window(&program, &eye, size);
            self.timer.restart()?;
            full_screen_pass_rows(
                &self.context,
                &program,
                picture,
                size[0],
                size[1],
                0..size[1],
            )?;
            self.mark_end(Marked::Coarse)?;
            self.shown = Some(Shown {
                eye: eye.clone(),
                surfaces: scene.surfaces.clone(),
                size,
                full,
            });
            (self.still, self.refined) = (0, 0);
        } else {
            self.still += 1;
        }
        let bears = pixels_foreseen(scene, REFINED) >= f64::from(LEAST_ROWS * width);
        let refines = refines && bears && self.still > STILL && scale < 1.0;
        let is_refined = refines && self.refined < height;
        if is_refined {
            self.refine(scene, &eye, full)?;
        }
        let is_fine = refines && self.refined >= height;
        let picture = if is_fine { &self.fine } else { &self.coarse };
        let is_due = anew || is_refined || !platform::KEEPS_PICTURE;
        if let Some(picture) = picture.as_ref().filter(|_| is_due) {
            picture.show(width, height)?;
        }
        if is_fine {
            drawn.size = full;
        }
        if anew {
            drawn.milliseconds = self.took;
        }
        Ok(drawn)
    }

    /// Draws the next rows at full size.
    fn refine(&mut self, scene: &Scene, eye: &Eye, full: [u32; 2]) -> Result<(), Error> {
        let program = self.program(scene)?;
        let picture = sized(&self.context, &mut self.fine, full)?;
        aim_in_window(&program, eye, full);
        let rows = match platform::CAN_WAIT_FOR_GL {
            true => ((REFINING * self.rows_per_ms) as u32).max(LEAST_ROWS),
            // The time per row is unknown.
            false => UNTIMED_ROWS,
        };
        let band = self.refined..self.refined + rows;
        self.timer.restart()?;
        full_screen_pass_rows(&self.context, &program, picture, full[0], full[1], band)?;
        self.mark_end(Marked::Rows(rows))?;
        self.refined += rows;
        Ok(())
    }

    /// Ends the time measurement of `what`, which was drawn after the first timer mark.
    fn mark_end(&mut self, what: Marked) -> Result<(), Error> {
        self.timer.mark()?;
        self.marked = Some(what);
        if self.timer.waits() {
            self.take_time();
        }
        Ok(())
    }

    /// Reads the time of the most recently measured part.
    fn take_time(&mut self) {
        let Some(what) = self.marked.take() else {
            return;
        };
        let took: f64 = self.timer.milliseconds().iter().sum();
        match what {
            Marked::Coarse => self.took = took,
            Marked::Rows(rows) => self.rows_per_ms = f64::from(rows) / took.max(0.05),
        }
    }

    /// The program for the scene's structure, with the surface data set.
    fn program(&mut self, scene: &Scene) -> Result<Rc<Program>, Error> {
        let context = &self.context;
        let structure = GpuScene::picture_structure(scene);
        let compile = || {
            let label = format!("the view of {}", scene.name);
            let text = || text(scene, &structure);
            GpuScene::picture_program(context, scene, &structure, &label, text)
        };
        let key = Rc::clone(&structure.key);
        let program = self.programs.get_or_compile(key, compile)?;
        self.scene.set_picture(scene, structure, &program)?;
        Ok(program)
    }

    /// Makes the next frame redraw the picture, after a change of the window's size or the scene.
    pub fn forget(&mut self) {
        self.shown = None;
    }
}

/// Returns the fragment shader of the picture, without `#version`.
pub fn view_text(scene: &Scene) -> String {
    text(scene, &GpuScene::picture_structure(scene))
}

fn text(scene: &Scene, structure: &Structure) -> String {
    let sources = shader::first_person(shader::source!("view/shading_fast.glsl"));
    shader::picture_text(scene, structure, sources)
}

/// Predicted number of pixels drawn in `seconds` seconds. It is limited only for users' fields, whose speed is
/// measured.
fn pixels_foreseen(scene: &Scene, seconds: f64) -> f64 {
    match scene.evaluation_seconds() {
        Some(evaluation) => seconds / (evaluation * EVALUATIONS_PER_PIXEL),
        None => f64::INFINITY,
    }
}

/// The share of the window's size at which the first picture does not block the window for long.
fn foreseen_scale(scene: &Scene, [width, height]: [u32; 2]) -> f32 {
    let whole = f64::from(width) * f64::from(height);
    (pixels_foreseen(scene, FIRST_PICTURE) / whole.max(1.0))
        .sqrt()
        .min(1.0) as f32
}

/// The picture of the given size, created if it does not exist.
fn sized<'a>(
    context: &Context,
    picture: &'a mut Option<Picture>,
    [width, height]: [u32; 2],
) -> Result<&'a Picture, Error> {
    let fits = |p: &Picture| (p.width(), p.height()) == (width, height);
    if !picture.as_ref().is_some_and(fits) {
        *picture = None;
    }
    match picture {
        Some(picture) => Ok(picture),
        None => Ok(picture.insert(Picture::new(context, width, height)?)),
    }
}

/// The listener of a picture, and the position of its source.
#[derive(Clone, Debug, PartialEq)]
struct Eye {
    /// The listener without its name and path, which a picture does not show.
    listener: Listener,
    source: Option<Vec3>,
}

impl Eye {
    fn of(seen: Viewpoint) -> Result<Eye, SceneError> {
        Ok(Eye {
            listener: Listener {
                name: None,
                path: Path::default(),
                ..seen.listener()?.clone()
            },
            source: seen.source.map(|source| source.position),
        })
    }

    /// Radius of the source's ball in metres; 0 without a source.
    fn ball_m(&self) -> f32 {
        self.source
            .map_or(0.0, |_| SOURCE_SHARE * self.listener.radius)
    }
}

/// Sets viewing direction, source and size in the program. The source is a ball of `ball` metres, and the picture's
/// upper half is `half_height` high at a distance of 1.
fn aim(program: &Program, eye: &Eye, ball: f32, [width, height]: [u32; 2], half_height: f32) {
    let listener = &eye.listener;
    program.set_vec4("uListener", listener.position.extend(listener.radius));
    program.set_vec3("uRight", listener.right());
    program.set_vec3("uUp", listener.up());
    program.set_vec3("uForward", listener.forward());
    let source = eye.source.unwrap_or(listener.position);
    program.set_vec4("uSource", source.extend(ball));
    program.set_vec2("uSize", Vec2::new(width as f32, height as f32));
    program.set_f32("uPixel", 2.0 * half_height / height as f32);
}

/// Sets viewing direction, source and size for the picture of a window.
fn aim_in_window(program: &Program, eye: &Eye, size: [u32; 2]) {
    let radius = eye.ball_m();
    let place = eye.listener.position;
    let distance = eye.source.map_or(0.0, |source| source.distance(place));
    // From a point in or near the ball, the ball would fill the picture.
    let ball = if distance < NEAREST * radius {
        0.0
    } else {
        radius
    };
    aim(program, eye, ball, size, (0.5 * FIELD_OF_VIEW).tan());
}
