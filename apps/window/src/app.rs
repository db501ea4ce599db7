//! The state of the window, and its event loop.

use super::adapt::{Control, FirstFrames, LEAST_WAVES, SCALES, WaveTime, step_of};
use super::display::Connection;
use super::ears::Ears;
use super::fields::Fields;
use super::files::Files;
use super::follower::{Before, Coming, Follower};
use super::keys::{PressedKeys, action};
use super::latency::Latency;
use super::mouse::Mouse;
use super::overlay::Plan;
use super::report::{Recorder, Report};
use super::sound::{SoundStatus, Speaker};
use super::state::{Choices, InFull, Measured};
use super::window::DemoWindow;
use super::{DemoError, DemoOptions, overlay};
use echomarch::picture::{Drawn, View};
use echomarch::tracer::{Frame, Settings, Tracer};
use echomarch_walk::{EarsStatus, Paths, World};
use std::path::PathBuf;
use std::time::{Duration, Instant, SystemTime};
use winit::application::ApplicationHandler;
use winit::error::EventLoopError;
use winit::event::{ElementState, KeyEvent, MouseButton, StartCause, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow};
use winit::keyboard::{KeyCode, PhysicalKey};
use winit::window::WindowId;

/// The default minimum interval between two frames: most screens refresh at 60 Hz.
const LEAST_INTERVAL: Duration = Duration::from_micros(16_600);

/// Radians that the gaze turns per pixel of mouse movement.
const MOUSE: f64 = 0.0025;

/// The initial scale of the picture on a software renderer.
const FIRST_SCALE: f32 = 0.4;

/// Everything that needs the window. Fields are dropped in declaration order, so the window is dropped last.
pub(super) struct Stage {
    pub view: View,
    pub tracer: Tracer,
    /// Traces the waves whose paths are shown. The number of these waves differs from the number in a frame.
    pub path_tracer: Tracer,
    pub window: DemoWindow,
}

/// The state of the window.
pub(super) struct App {
    pub options: DemoOptions,
    pub choices: Choices,
    pub world: World,
    /// The previous scene, kept until the current scene has been drawn once.
    pub previous: Option<Before>,
    /// The most recently chosen scene, until it is ready to be shown.
    pub coming: Option<Coming>,
    /// Watches the scene's file; `None` for a built-in scene.
    pub follower: Option<Follower>,
    /// The scene files that the user can choose.
    pub files: Files,
    pub pressed: PressedKeys,
    pub mouse_looks: bool,
    mouse: Mouse,
    /// The pointer's position in pixels.
    pointer: Option<[f64; 2]>,
    /// The positions of mouse presses since the last layout of the panels.
    pub presses: Vec<[f64; 2]>,
    pub plan: Plan,
    pub paths: Paths,
    pub heard: Option<Frame>,
    /// The settings of the frame of waves begun last.
    pub under_way: Settings,
    /// Whether the frame of waves in progress belongs to a replaced scene.
    pub begins_anew: bool,
    /// Milliseconds spent on the last frame of waves.
    pub on_waves: f64,
    /// Number of consecutive frames in which the waves exceeded their time limit.
    pub late: u32,
    pub drawn: Drawn,
    /// GL_RENDERER, once the window is open.
    pub renderer: String,
    /// The window's size in pixels at the last drawing.
    pub window: [u32; 2],
    pub scale_step: usize,
    pub scale_control: Control,
    pub wave_control: Control,
    /// The scene and the settings for which the first frames of waves are or were measured.
    pub measured: Option<Measured>,
    /// The first frames of waves; `None` once the number of waves is chosen.
    pub first_frames: Option<FirstFrames>,
    /// The time of a frame of waves, as predicted from the first frames.
    pub wave_time: Option<WaveTime>,
    /// The number of waves to trace if it fits the frame time.
    pub asked_waves: u32,
    /// The minimum number of waves while the number adapts to the frame time.
    pub least_waves: u32,
    pub fields: Fields,
    /// Whether the cost of the current scene's fields must be measured.
    pub fields_are_due: bool,
    pub latency: Latency,
    pub recorder: Recorder,
    pub speaker: Speaker,
    /// The thread for full listening; `None` until full listening is requested.
    pub ears: Option<Ears>,
    /// The properties of the player while it plays full listening.
    pub in_full: Option<InFull>,
    pub ears_status: EarsStatus,
    pub sound: SoundStatus,
    pub message: Option<(String, Instant)>,
    pub picture_wanted: Option<PathBuf>,
    pub saved: Vec<String>,
    pub stage: Option<Stage>,
    pub started: Instant,
    pub last: Instant,
    /// The start time of the last frame. The window's events were processed just before it.
    pub looked: Instant,
    next: Instant,
    is_over: bool,
    /// The connection to the display; `None` if the program cannot survive the loss of the display server.
    pub connection: Option<Connection>,
    outcome: Result<Report, DemoError>,
}

impl App {
    pub fn new(options: DemoOptions) -> Result<App, DemoError> {
        let mut world = World::load(&options.scene).map_err(echomarch::Error::from)?;
        for (name, value) in &options.values {
            world.set(name, *value).map_err(echomarch::Error::from)?;
        }
        let mut files = Files::default();
        files.add(&options.scene);
        options
            .settings
            .validate()
            .map_err(echomarch::Error::from)?;
        let now = Instant::now();
        let speaker = Speaker::start(&options);
        Ok(App {
            choices: Choices::of(&options),
            world,
            previous: None,
            coming: None,
            follower: None,
            files,
            pressed: PressedKeys::default(),
            mouse_looks: false,
            mouse: Mouse::default(),
            pointer: None,
            presses: Vec::new(),
            plan: Plan::default(),
            paths: Paths::default(),
            heard: None,
            under_way: options.settings.clone(),
            begins_anew: true,
            on_waves: 0.0,
            late: 0,
            drawn: Drawn::default(),
            renderer: String::new(),
            window: [0; 2],
            scale_step: SCALES.len() - 1,
            scale_control: Control::default(),
            wave_control: Control::default(),
            measured: None,
            first_frames: None,
            wave_time: None,
            asked_waves: options.settings.waves,
            least_waves: LEAST_WAVES,
            fields: Fields::default(),
            fields_are_due: true,
            latency: Latency::default(),
            recorder: Recorder::default(),
            sound: speaker.status(),
            speaker,
            ears: None,
            in_full: None,
            ears_status: EarsStatus::default(),
            message: None,
            picture_wanted: None,
            saved: Vec::new(),
            stage: None,
            started: now,
            last: now,
            looked: now,
            next: now,
            is_over: false,
            connection: None,
            outcome: Ok(Report::default()),
            options,
        })
    }

    /// Returns the result of the run. Called after the event loop has ended.
    pub fn result(self, ran: Result<(), EventLoopError>) -> Result<Report, DemoError> {
        let report = self.outcome?;
        ran.map_err(|error| DemoError::NoWindow {
            reason: error.to_string(),
        })?;
        Ok(report)
    }

    /// Shows a message in the window for a few seconds.
    pub fn say(&mut self, text: impl Into<String>) {
        self.message = Some((text.into(), Instant::now()));
    }

    /// Whether GL errors are queried after every frame.
    pub fn checks_gl(&self) -> bool {
        self.options.check_gl || cfg!(debug_assertions)
    }

    /// Number of frames after which GL reported an error; `None` if errors are not queried.
    pub fn gl_errors(&self) -> Option<u64> {
        self.checks_gl().then_some(self.recorder.gl_errors)
    }

    /// Seconds since the start.
    pub fn seconds(&self) -> f64 {
        self.started.elapsed().as_secs_f64()
    }

    fn open(&mut self, events: &ActiveEventLoop) -> Result<(), DemoError> {
        let window = DemoWindow::open(events, &self.options)?;
        overlay::set_style(window.egui());
        let context = window.gl.context().clone();
        if context.is_software() {
            self.scale_step = step_of(&SCALES, FIRST_SCALE);
        }
        self.renderer = context.renderer().to_owned();
        let mut tracer = Tracer::new(&context)?;
        self.follow_first(&mut tracer)?;
        self.stage = Some(Stage {
            view: View::new(&context)?,
            path_tracer: tracer.with_shared_programs()?,
            tracer,
            window,
        });
        if let Some(path) = self.options.record.clone() {
            self.record(Some(path));
        }
        self.started = Instant::now();
        (self.last, self.next) = (self.started, self.started);
        self.looked = self.started;
        Ok(())
    }

    /// Whether the next frame reaches the requested duration or number of frames.
    pub fn is_last_frame(&self) -> bool {
        let frames = self.options.frames;
        let seconds = self.options.seconds;
        self.is_over
            || (self.options.is_asked_to_end)()
            || frames.is_some_and(|frames| self.recorder.frames + 1 >= frames)
            || seconds.is_some_and(|seconds| self.seconds() >= seconds)
    }

    /// Closes the window after the next frame.
    pub fn quit(&mut self) {
        self.is_over = true;
    }

    /// Handles a key press or release. If `is_synthetic` is true, the key was already down when the window received the
    /// keyboard focus. A synthetic press triggers no action, because it was meant for another window. A held movement
    /// key does move the listener.
    fn key(&mut self, event: &KeyEvent, is_synthetic: bool) {
        let PhysicalKey::Code(key) = event.physical_key else {
            return;
        };
        if event.state == ElementState::Released {
            self.pressed.release(key);
            return;
        }
        if event.repeat || self.pressed.is_down(key) {
            return;
        }
        self.pressed.press(key);
        if is_synthetic {
            return;
        }
        let asked = action(key, self.pressed.control());
        if asked.is_some() || !self.pressed.input().is_rest() {
            self.latency.input(self.looked);
        }
        if let Some(asked) = asked {
            self.act(asked);
        }
    }

    /// Starts or ends mouse look.
    pub fn look_by_mouse(&mut self, wanted: bool) {
        if let Some(stage) = &self.stage
            && wanted != self.mouse_looks
        {
            self.mouse_looks = stage.window.capture_mouse(wanted);
        }
    }

    /// Handles a pointer movement.
    fn point(&mut self, to: [f64; 2]) {
        self.pointer = Some(to);
        let Some(stage) = &self.stage else {
            return;
        };
        let moved = self.mouse.moved(to, stage.window.size(), self.mouse_looks);
        if let Some(place) = moved.put {
            stage.window.put_pointer(place);
        }
        let [right, down] = moved.by;
        if right != 0.0 || down != 0.0 {
            self.latency.input(self.looked);
            let turn = |pixels: f64| (MOUSE * pixels) as f32;
            self.world.look(turn(right), -turn(down));
        }
    }

    /// Handles a press of the left mouse button. The press either goes to a panel or starts mouse look. Panels receive
    /// the new pointer position only in the next frame.
    fn press(&mut self) {
        if self.mouse_looks {
            self.look_by_mouse(false);
            return;
        }
        let Some((at, stage)) = self.pointer.zip(self.stage.as_ref()) else {
            return;
        };
        if !stage.window.is_panel_at(at) {
            self.presses.push(at);
        }
    }

    /// Whether the display server is known to have gone.
    pub fn is_display_gone(&self) -> bool {
        self.connection.as_ref().is_some_and(Connection::is_gone)
    }

    /// Finishes the run: reports the measurements while the window still exists.
    pub fn close(&mut self) {
        let stage = self.stage.take();
        let is_gone = self.is_display_gone();
        if matches!(self.outcome, Err(DemoError::DisplayGone { .. })) || stage.is_none() && !is_gone
        {
            return;
        }
        if is_gone {
            // If the display server is gone, it is the cause of all other errors.
            let report = Box::new(self.report());
            self.outcome = Err(DemoError::DisplayGone { report });
        } else if self.outcome.is_ok() {
            self.outcome = Ok(self.report());
        }
        self.end_recording();
        if let Some(mut stage) = stage {
            stage.window.close();
        }
    }

    /// Completes a recording in progress, or reports the reason for a failure.
    fn end_recording(&mut self) {
        if self.speaker.status().is_recording
            && let Err(reason) = self.speaker.record(None)
            && self.outcome.is_ok()
        {
            self.outcome = Err(DemoError::Recording { reason });
        }
    }
}

/// Whether the event is a press. The matching release goes to the same receiver as the press.
fn begins_something(event: &WindowEvent) -> bool {
    match event {
        WindowEvent::KeyboardInput { event, .. } => event.state == ElementState::Pressed,
        WindowEvent::MouseInput { state, .. } => *state == ElementState::Pressed,
        WindowEvent::CursorMoved { .. } | WindowEvent::MouseWheel { .. } => true,
        _ => false,
    }
}

impl ApplicationHandler for App {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        if self.stage.is_none()
            && let Err(error) = self.open(events)
        {
            self.outcome = Err(error);
            events.exit();
        }
    }

    fn new_events(&mut self, events: &ActiveEventLoop, _: StartCause) {
        if self.is_display_gone() {
            events.exit();
        }
    }

    fn window_event(&mut self, _: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let Some(stage) = &mut self.stage else {
            return;
        };
        let is_tab = matches!(&event, WindowEvent::KeyboardInput { event, .. }
            if event.physical_key == PhysicalKey::Code(KeyCode::Tab));
        // Tab would move the keyboard focus into egui, which would then consume all keys.
        let hides_from_panels = is_tab || self.mouse_looks && begins_something(&event);
        let is_theirs = !hides_from_panels && stage.window.on_event(&event).consumed;
        match event {
            WindowEvent::CloseRequested => self.quit(),
            WindowEvent::CursorMoved { position, .. } => self.point(position.into()),
            WindowEvent::Resized(size) => {
                stage.window.gl.resize(size.width, size.height);
                stage.view.forget();
                self.scale_control.forget();
            }
            WindowEvent::Focused(false) => {
                self.pressed.clear();
                self.look_by_mouse(false);
            }
            // Key releases are always processed, even if a panel received the press.
            WindowEvent::KeyboardInput {
                event,
                is_synthetic,
                ..
            } if !is_theirs || event.state == ElementState::Released => {
                self.key(&event, is_synthetic);
            }
            WindowEvent::MouseInput {
                state: ElementState::Pressed,
                button: MouseButton::Left,
                ..
            } => self.press(),
            WindowEvent::DroppedFile(file) => self.open_file(&file),
            _ => {}
        }
    }

    fn about_to_wait(&mut self, events: &ActiveEventLoop) {
        let now = Instant::now();
        if self.is_display_gone() {
            events.exit();
        } else if now >= self.next && self.stage.is_some() && !events.exiting() {
            let asked = Duration::from_secs_f64(1e-3 * self.options.frame_milliseconds);
            self.next = (self.next + LEAST_INTERVAL.min(asked)).max(now);
            let is_last = self.is_last_frame();
            let began = SystemTime::now();
            let drawn = self.frame(is_last);
            self.log_frame(began);
            if let Err(error) = drawn {
                self.outcome = Err(error);
                events.exit();
            } else if is_last {
                events.exit();
            }
        }
        events.set_control_flow(ControlFlow::WaitUntil(self.next));
    }

    fn exiting(&mut self, _: &ActiveEventLoop) {
        // The connection to the display is dropped after this call. The window must be dropped before the connection.
        self.close();
    }
}
