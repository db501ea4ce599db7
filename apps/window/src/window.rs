//! The window, and the OpenGL context shared by waves, picture and panels.

use super::{DemoError, DemoOptions};
use echomarch::gl::{WindowContext, WindowDisplay};
use egui_glow::Painter;
use egui_glow::egui_winit::{EventResponse, State};
use std::sync::Arc;
use winit::dpi::{LogicalSize, PhysicalPosition, PhysicalSize};
use winit::event::WindowEvent;
use winit::event_loop::{ActiveEventLoop, EventLoop};
use winit::window::{CursorGrabMode, Window, WindowAttributes};

/// The renderer of the panels.
struct Panels {
    context: egui::Context,
    state: State,
    painter: Painter,
}

/// A window with its context. Fields are dropped in declaration order, so the window is dropped last.
pub struct DemoWindow {
    panels: Panels,
    /// The context and the surface.
    pub gl: WindowContext,
    /// The window.
    pub window: Arc<Window>,
}

/// Opens the connection to the display.
///
/// # Errors
/// [`DemoError::NoDisplay`].
pub fn event_loop() -> Result<EventLoop<()>, DemoError> {
    new_event_loop().map_err(|reason| DemoError::NoDisplay { reason })
}

/// Returns an X11 event loop if there is an X11 display, otherwise one for Wayland.
#[cfg(all(unix, not(target_os = "macos")))]
fn new_event_loop() -> Result<EventLoop<()>, String> {
    use winit::platform::wayland::EventLoopBuilderExtWayland;
    use winit::platform::x11::EventLoopBuilderExtX11;
    let variable = |name| std::env::var(name).unwrap_or_default();
    let (x11, wayland) = (variable("DISPLAY"), variable("WAYLAND_DISPLAY"));
    let mut builder = EventLoop::builder();
    let place = match (x11.is_empty(), wayland.is_empty()) {
        (true, true) => return Err("neither DISPLAY nor WAYLAND_DISPLAY is set".into()),
        (false, _) => {
            builder.with_x11();
            format!("DISPLAY is {x11}")
        }
        (true, false) => {
            builder.with_wayland();
            format!("WAYLAND_DISPLAY is {wayland}")
        }
    };
    builder
        .build()
        .map_err(|_| format!("{place}, which does not answer"))
}

/// The event loop of the system's own window interface.
#[cfg(not(all(unix, not(target_os = "macos"))))]
fn new_event_loop() -> Result<EventLoop<()>, String> {
    EventLoop::new().map_err(|error| error.to_string())
}

/// Sets the X11 visual that EGL needs.
#[cfg(all(unix, not(target_os = "macos")))]
fn with_visual(attributes: WindowAttributes, display: &WindowDisplay) -> WindowAttributes {
    use winit::platform::x11::WindowAttributesExtX11;
    match display.x11_visual() {
        Some(visual) => attributes.with_x11_visual(visual as u32),
        None => attributes,
    }
}

/// Returns the attributes unchanged, because EGL needs no visual on this system.
#[cfg(not(all(unix, not(target_os = "macos"))))]
fn with_visual(attributes: WindowAttributes, _: &WindowDisplay) -> WindowAttributes {
    attributes
}

impl DemoWindow {
    /// Opens the window.
    ///
    /// # Errors
    /// [`DemoError::NoWindow`], [`DemoError::Failed`].
    pub fn open(events: &ActiveEventLoop, options: &DemoOptions) -> Result<DemoWindow, DemoError> {
        let display = WindowDisplay::of(events.owned_display_handle())?;
        let attributes = WindowAttributes::default()
            .with_title("Echomarch")
            .with_inner_size(LogicalSize::new(options.width, options.height))
            .with_min_inner_size(PhysicalSize::new(320, 180));
        let window = events.create_window(with_visual(attributes, &display));
        let window = window.map_err(|error| DemoError::NoWindow {
            reason: error.to_string(),
        })?;
        let window = Arc::new(window);
        let size = window.inner_size();
        let gl = display.context(window.clone(), size.width, size.height)?;
        gl.do_not_wait_for_refresh();
        let panels = Panels::new(events, &gl)?;
        Ok(DemoWindow { panels, gl, window })
    }

    /// Width and height in pixels; 0 if the window is not visible.
    pub fn size(&self) -> [u32; 2] {
        self.window.inner_size().into()
    }

    /// Captures and hides the mouse, or releases it. Returns whether the mouse is captured.
    pub fn capture_mouse(&self, wanted: bool) -> bool {
        let confine = || self.window.set_cursor_grab(CursorGrabMode::Confined);
        let grabbed = wanted && confine().is_ok();
        if !grabbed {
            // An error while releasing the mouse cannot be handled.
            let _ = self.window.set_cursor_grab(CursorGrabMode::None);
        }
        self.window.set_cursor_visible(!grabbed);
        grabbed
    }

    /// Moves the pointer to a position in the window, in pixels.
    pub fn put_pointer(&self, [x, y]: [f64; 2]) {
        // If this call fails, the pointer stays where it is, and stops at the window's edge.
        let _ = self.window.set_cursor_position(PhysicalPosition::new(x, y));
    }

    /// Whether a panel covered this position, in pixels, in the last layout.
    pub fn is_panel_at(&self, [x, y]: [f64; 2]) -> bool {
        let context = &self.panels.context;
        let scale = f64::from(context.pixels_per_point());
        let at = egui::pos2((x / scale) as f32, (y / scale) as f32);
        let layer = context.layer_id_at(at);
        layer.is_some_and(|layer| layer.order != egui::Order::Background)
    }

    /// Passes an event to the panels. `consumed` in the result means that the panels used the event.
    pub fn on_event(&mut self, event: &WindowEvent) -> EventResponse {
        self.panels.state.on_window_event(&self.window, event)
    }

    /// The egui context of the panels.
    pub fn egui(&self) -> &egui::Context {
        &self.panels.context
    }

    /// Lays out the panels and draws them over the window's content.
    pub fn draw_panels(&mut self, layout: impl FnMut(&mut egui::Ui)) {
        // The passes of the waves draw into other frame buffers. The painter of egui draws into the bound frame buffer.
        self.gl.aim();
        let size = self.size();
        self.panels.draw(&self.window, size, layout);
    }

    /// Frees the panels' GL resources before the context is dropped.
    pub fn close(&mut self) {
        self.gl.context().gl();
        self.panels.painter.destroy();
    }
}

impl Panels {
    fn new(events: &ActiveEventLoop, gl: &WindowContext) -> Result<Panels, DemoError> {
        let painter = Painter::new(gl.functions()?, "", None, false);
        let painter = painter.map_err(|error| DemoError::NoWindow {
            reason: error.to_string(),
        })?;
        let context = egui::Context::default();
        let side = Some(painter.max_texture_side());
        let root = egui::ViewportId::ROOT;
        let state = State::new(context.clone(), root, events, None, None, side);
        Ok(Panels {
            context,
            state,
            painter,
        })
    }

    fn draw(&mut self, window: &Window, size: [u32; 2], layout: impl FnMut(&mut egui::Ui)) {
        let input = self.state.take_egui_input(window);
        let mut output = self.context.run_ui(input, layout);
        self.state
            .handle_platform_output(window, output.platform_output);
        let scale = output.pixels_per_point;
        let shapes = self.context.tessellate(output.shapes, scale);
        self.painter
            .paint_and_update_textures(size, scale, &shapes, &mut output.textures_delta);
    }
}
