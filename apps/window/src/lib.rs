//! The window: an interactive walk through a scene with its sound.
//!
//! The picture is sphere traced with the distance function that the waves march through, and its camera is the
//! listener. Waves are traced beside the pictures, in parts if tracing takes long, and read back without waiting
//! ([`Tracer::frame_begin`](echomarch::Tracer::frame_begin)); the resulting panning goes to the sound thread. Panels
//! show the plan, the levels and the frame times, and contain the controls.
//!
//! | file | what it does |
//! | --- | --- |
//! | `app` | events in, frames out |
//! | `actions` | the actions of keys and buttons |
//! | `frame` | one frame, part by part |
//! | `window`, `display`, `mouse` | the window, its context, the renderer of the panels; the X server; the pointer |
//! | `overlay/` | the panels |
//! | `state`, `keys` | the choices, the table of keys |
//! | `adapt` | adapts the picture's resolution and the number of waves to the frame time |
//! | `latency`, `report`, `summary` | measurements and reports |
//! | `scenes`, `files` | the choice of the scene, the selectable files |
//! | `save` | writes scene files and `trace` calls |
//! | `reload`, `follower` | reloads a scene file when it changes |
//! | `sound` | the speakers |
//! | `ears`, `listening` | full listening on a thread of its own; its connection to the speakers |
//!
//! Walking, the picture, the plan and its paths are shared with the page in a browser: see [`echomarch_walk`].
//!
//! Threads: the picture is drawn and the waves are traced on the thread that calls [`run`], which must be the process'
//! first. Full listening is traced on a thread and a context of its own.

mod actions;
mod adapt;
mod app;
mod display;
mod ears;
mod error;
mod fields;
mod files;
mod follower;
mod frame;
mod keys;
mod latency;
mod listening;
mod mouse;
mod options;
mod overlay;
mod reload;
mod report;
mod save;
mod scenes;
mod sound;
mod state;
mod summary;
mod waves;
mod window;

pub use echomarch_walk::{BODY, EarsStatus, MoveInput, Walker};
pub use error::DemoError;
pub use latency::Parts as Latency;
pub use options::{DemoOptions, OPENING_SCENE};
pub use report::{EndPose, FrameTimes, Memory, PanAt, Report, Reread};
pub use sound::SoundStatus;

/// Opens the window and returns when it is closed.
///
/// # Errors
/// [`DemoError`]: a scene that cannot be traced, no display, no OpenGL.
pub fn run(options: DemoOptions) -> Result<Report, DemoError> {
    let mut app = app::App::new(options)?;
    let events = window::event_loop()?;
    app.connection = display::Connection::of(&events);
    let Some(connection) = app.connection.clone() else {
        let ran = events.run_app(&mut app);
        return app.result(ran);
    };
    match connection.outlive(|| events.run_app(&mut app)) {
        Some(ran) => app.result(ran),
        None => {
            app.close();
            app.result(Ok(()))
        }
    }
}
