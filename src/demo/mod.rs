//! The window: one walks through a scene and hears it.
//!
//! The picture is sphere traced with the very distance function that the waves march
//! through, its camera is the listener. Waves are traced beside the pictures, a part at a time
//! where they take long, and read back without waiting
//! ([`Tracer::frame_begin`](crate::Tracer::frame_begin)); what was heard goes
//! to the sound's thread. Panels show the plan, the levels, where the time
//! goes, and hold the controls.
//!
//! | file | what it does |
//! | --- | --- |
//! | `app` | events in, frames out |
//! | `act` | what keys and buttons ask for |
//! | `frame` | one frame, part by part |
//! | `window`, `display`, `mouse` | the window, its context, what draws the panels; the X server; the pointer |
//! | `overlay/` | the panels |
//! | `state`, `keys` | what was chosen, which key does what |
//! | `adapt` | how coarse the picture and how many waves, by the frame's time |
//! | `latency`, `report`, `summary` | what is measured and reported |
//! | `scenes`, `files` | another scene, the files to choose from |
//! | `save` | scene files and `trace` calls |
//! | `reload`, `follower` | a scene file that changes while one walks in it |
//! | `sound` | the speakers |
//! | `ears`, `listening` | what is heard in full, on a thread of its own; and how it gets to the speakers |
//!
//! Walking, the picture, the plan and its paths are those of a page in a browser too: see
//! [`walkthrough`](crate::walkthrough).
//!
//! Threads: everything that is seen is drawn and traced on the thread that calls [`run`], which must be
//! the process' first. What is heard in full is traced on a thread and a context of its own.

mod actions;
mod adapt;
mod app;
mod display;
mod ears;
mod error;
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
mod window;

pub use crate::walkthrough::{BODY, MoveInput, Walker};
pub use error::DemoError;
pub use latency::Parts as Latency;
pub use options::{DemoOptions, OPENING_SCENE};
pub use report::{EndPose, FrameTimes, InFullReport, Memory, PanAt, Report, Reread};
pub use sound::SoundStatus;

/// Opens the window and stays until it is closed.
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
