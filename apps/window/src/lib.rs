//! The window: an interactive walk through a scene with sound.
//!
//! The picture is sphere traced with the same distance function as the waves, and its camera is the listener. Waves are
//! traced in addition to the picture, in parts if a frame of waves takes long, and are read back without waiting
//! ([`Tracer::frame_begin`](echomarch::Tracer::frame_begin)). The resulting panning goes to the sound thread. The
//! panels show the plan, the levels and the frame times, and contain the controls.
//!
//! | file | content |
//! | --- | --- |
//! | `app` | the event loop and the state |
//! | `actions` | performs the actions of keys and buttons |
//! | `frame` | one frame: setup, waves, picture, panels, swap |
//! | `window`, `display`, `mouse` | the window with its context and panel renderer; the X server; mouse look |
//! | `overlay/` | the panels |
//! | `state`, `keys` | the user's choices, the table of keys |
//! | `adapt` | adapts the picture's resolution and the number of waves to the frame time |
//! | `latency`, `report`, `summary` | measurements and reports |
//! | `scenes`, `files` | the choice of the scene, the scene files to choose from |
//! | `save` | writes scene files and `trace` calls |
//! | `reload`, `follower` | reloads a scene file when it changes |
//! | `sound` | the speakers |
//! | `ears`, `listening` | full listening on its own thread; its connection to the speakers |
//!
//! The walk, the picture, the plan and its paths are shared with the browser page: see [`echomarch_walk`].
//!
//! Threads: the picture is drawn and the waves are traced on the thread that calls [`run`], which must be the main
//! thread of the process. Full listening is traced on its own thread, with its own context.

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

pub use echomarch_walk::{BODY, EarsStatus, MoveInput, Part, Parts, Walker};
pub use error::DemoError;
pub use latency::Parts as Latency;
pub use options::{DemoOptions, OPENING_SCENE};
pub use report::{EndPose, FrameTimes, Memory, PanAt, Report, Reread};
pub use sound::SoundStatus;

/// Opens the window, and returns after it is closed.
///
/// # Errors
/// [`DemoError`]: the scene cannot be traced, or there is no display or no OpenGL.
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
