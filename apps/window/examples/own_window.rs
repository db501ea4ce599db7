//! A game with its own window and OpenGL context, made with winit and glutin. For each picture, the game begins or
//! continues a frame of waves on that context, draws the picture, and polls the result. Echomarch restores all GL state
//! that it changes.
//!
//! ```sh
//! cargo run --release -p echomarch-window --example own_window
//! cargo run --release -p echomarch-window --example own_window -- 60    # ends after 60 pictures
//! ```

use echomarch::audio::PanningLaw;
use echomarch::gl::{Context, MakeCurrent, glow};
use echomarch::{Scene, Settings, Tracer};
use glow::HasContext;
use glutin::config::ConfigTemplateBuilder;
use glutin::context::{ContextApi, ContextAttributesBuilder, PossiblyCurrentContext, Version};
use glutin::display::{Display, DisplayApiPreference, GetGlDisplay};
use glutin::prelude::*;
use glutin::surface::{Surface, SurfaceAttributesBuilder, WindowSurface};
use std::error::Error;
use std::ffi::CString;
use std::num::NonZeroU32;
use winit::application::ApplicationHandler;
use winit::dpi::PhysicalSize;
use winit::event::WindowEvent;
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop};
use winit::raw_window_handle::{HasDisplayHandle, HasWindowHandle};
use winit::window::{Window, WindowId};

/// Milliseconds of each picture spent on the waves.
const WAVES_MS: f64 = 4.0;

/// Metres that the source moves per picture.
const STEP_M: f32 = 0.05;

/// The fields are dropped in declaration order: the tracer while the context is current, then the context, and finally
/// the window.
struct Game {
    tracer: Tracer,
    scene: Scene,
    settings: Settings,
    gl: glow::Context,
    surface: Surface<WindowSurface>,
    context: PossiblyCurrentContext,
    window: Window,
    heard: u32,
    pictures: u32,
}

impl Game {
    fn new(events: &ActiveEventLoop) -> Result<Game, Box<dyn Error>> {
        let window = events.create_window(Window::default_attributes().with_title("A game"))?;
        let (surface, context) = open_gl(events, &window)?;
        let display = context.display();
        let of_game = |name: &str| match CString::new(name) {
            Ok(name) => display.get_proc_address(&name),
            Err(_) => std::ptr::null(),
        };
        // SAFETY: the context is current, and the function pointers belong to it.
        let gl = unsafe { glow::Context::from_loader_function(of_game) };
        let display = context.display();
        let loader = move |name: &std::ffi::CStr| display.get_proc_address(name);
        // SAFETY: the functions belong to the game's context, which stays current on this thread until the program
        // ends.
        let shared = unsafe { Context::from_loader(loader, MakeCurrent::ByCaller) }?;
        println!("renderer: {}", shared.renderer());
        Ok(Game {
            tracer: Tracer::new(&shared)?,
            scene: Scene::builtin("open-field")?,
            settings: Settings::default().with_waves(16_384),
            gl,
            surface,
            context,
            window,
            heard: 0,
            pictures: 0,
        })
    }

    /// Draws one picture. Tracing the waves takes about `WAVES_MS` of its time.
    fn picture(&mut self) -> Result<(), Box<dyn Error>> {
        self.scene.sources[0].position.x += STEP_M;
        if !self.tracer.is_frame_pending() {
            self.tracer.frame_begin(&self.scene, &self.settings)?;
        }
        self.tracer.frame_advance(WAVES_MS)?;
        self.draw();
        if let Some(frame) = self.tracer.frame_poll()? {
            self.heard += 1;
            let gains = PanningLaw::ConstantPower.gains(frame.panning.pan() as f32);
            // A real game sets the gains of a voice in its audio engine here.
            let title = format!("left {:.3}, right {:.3}", gains.left, gains.right);
            self.window.set_title(&title);
        }
        self.surface.swap_buffers(&self.context)?;
        self.pictures += 1;
        Ok(())
    }

    fn resize(&self, size: PhysicalSize<u32>) {
        let side = |pixels| NonZeroU32::new(pixels).unwrap_or(NonZeroU32::MIN);
        self.surface
            .resize(&self.context, side(size.width), side(size.height));
    }

    /// Draws the game's picture: one colour that brightens and darkens.
    fn draw(&self) {
        let light = (self.pictures % 60) as f32 / 60.0;
        // SAFETY: the game's context is current.
        unsafe {
            self.gl.clear_color(0.1, light, 0.3, 1.0);
            self.gl.clear(glow::COLOR_BUFFER_BIT);
        }
    }
}

/// Opens an OpenGL 3.3 context on the window, and makes it current.
fn open_gl(
    events: &ActiveEventLoop,
    window: &Window,
) -> Result<(Surface<WindowSurface>, PossiblyCurrentContext), Box<dyn Error>> {
    let handle = window.window_handle()?.as_raw();
    #[cfg(windows)]
    let preference = DisplayApiPreference::Wgl(Some(handle));
    #[cfg(target_os = "macos")]
    let preference = DisplayApiPreference::Cgl;
    #[cfg(all(unix, not(target_os = "macos")))]
    let preference = DisplayApiPreference::Egl;
    // SAFETY: the display connection lives as long as the event loop, and outlives everything created from it.
    let display = unsafe { Display::new(events.display_handle()?.as_raw(), preference) }?;
    let template = ConfigTemplateBuilder::new().compatible_with_native_window(handle);
    // SAFETY: the window is alive.
    let config = unsafe { display.find_configs(template.build()) }?.next();
    let config = config.ok_or("the display has no configuration for this window")?;
    let size = window.inner_size();
    let side = |pixels| NonZeroU32::new(pixels).unwrap_or(NonZeroU32::MIN);
    let (width, height) = (side(size.width), side(size.height));
    let surface = SurfaceAttributesBuilder::<WindowSurface>::new().build(handle, width, height);
    let attributes = ContextAttributesBuilder::new()
        .with_context_api(ContextApi::OpenGl(Some(Version::new(3, 3))))
        .build(Some(handle));
    // SAFETY: the window is alive, and is dropped after the surface and the context.
    let (surface, context) = unsafe {
        (
            display.create_window_surface(&config, &surface)?,
            display.create_context(&config, &attributes)?,
        )
    };
    let context = context.make_current(&surface)?;
    Ok((surface, context))
}

/// The event loop's view of the game.
struct Program {
    game: Option<Game>,
    pictures: Option<u32>,
    failed: Option<Box<dyn Error>>,
}

impl Program {
    fn end(&mut self, events: &ActiveEventLoop, with: Result<(), Box<dyn Error>>) {
        self.failed = with.err();
        if let Some(game) = self.game.take() {
            println!("{} pictures, {} frames of waves", game.pictures, game.heard);
        }
        events.exit();
    }
}

impl ApplicationHandler for Program {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        if self.game.is_some() {
            return;
        }
        events.set_control_flow(ControlFlow::Poll);
        match Game::new(events) {
            Ok(game) => self.game = Some(game),
            Err(error) => self.end(events, Err(error)),
        }
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        match (event, &self.game) {
            (WindowEvent::CloseRequested, _) => self.end(events, Ok(())),
            (WindowEvent::Resized(size), Some(game)) => game.resize(size),
            _ => (),
        }
    }

    fn about_to_wait(&mut self, events: &ActiveEventLoop) {
        let Some(game) = &mut self.game else {
            return;
        };
        let drawn = game.picture();
        let is_over = self.pictures.is_some_and(|most| game.pictures >= most);
        if drawn.is_err() || is_over {
            self.end(events, drawn);
        }
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let pictures = std::env::args().nth(1).map(|count| count.parse());
    let mut program = Program {
        game: None,
        pictures: pictures.transpose()?,
        failed: None,
    };
    EventLoop::new()?.run_app(&mut program)?;
    program.failed.map_or(Ok(()), Err)
}
