//! The window: one walks through a scene and hears it.
//!
//! The picture is sphere traced with the very distance function that the waves march
//! through, its camera is the listener. Waves are traced beside the pictures, a part at a time
//! where they take long, and read back without waiting
//! ([`Tracer::frame_begin_in_parts`](crate::Tracer::frame_begin_in_parts)); what was heard goes
//! to the sound's thread. Panels show the plan, the levels, where the time
//! goes, and hold the controls.
//!
//! | file | what it does |
//! | --- | --- |
//! | `app` | events in, frames out |
//! | `act` | what keys and buttons ask for |
//! | `frame` | one frame, part by part |
//! | `window`, `display`, `mouse` | the window, its context, what draws the panels; the X server; the pointer |
//! | `view` | the picture |
//! | `overlay/` | the panels |
//! | `state`, `walk`, `keys` | what was chosen, where one stands, which key does what |
//! | `adapt` | how coarse the picture and how many waves, by the frame's time |
//! | `latency`, `report`, `summary` | what is measured, and told |
//! | `scenes`, `values` | the scenes to choose from, their named values |
//! | `paths` | the waves that the plan shows |
//! | `save`, `text` | scene files and `trace` calls |
//! | `reload` | a scene file that changes while one walks in it |
//! | `sound` | the speakers |
//! | `question` | the localisation experiment |
//!
//! Threads: everything that draws and traces is on the thread that calls [`run`], which
//! must be the process' first.

mod act;
mod adapt;
mod app;
mod display;
mod error;
mod frame;
mod keys;
mod latency;
mod mouse;
mod options;
mod overlay;
mod paths;
mod question;
mod reload;
mod report;
mod save;
mod scenes;
mod sound;
mod state;
mod summary;
mod text;
mod values;
mod view;
mod walk;
mod window;

pub use error::DemoError;
pub use latency::Parts as Latency;
pub use options::{DemoOptions, OPENING_SCENE};
pub use report::{FrameTimes, Memory, PanAt, Report, Reread, Standing};
pub use save::{Moved, SaveError, save, text_of, trace_call, with_places, with_values};
pub use sound::SoundStatus;
pub use walk::{BODY, Walker, Wish};

use crate::experiment::localise::sitting::Sitting;

/// Opens the window and stays until it is closed.
///
/// # Errors
/// [`DemoError`]: a scene that cannot be traced, no display, no OpenGL.
pub fn run(options: DemoOptions) -> Result<Report, DemoError> {
    stay(app::App::new(options)?)
}

/// Opens the window on a sitting of the localisation experiment, whose sounds play for
/// `seconds` each time, and stays until it is closed. Each answer is in the sitting's file
/// as soon as it is locked.
///
/// # Errors
/// [`DemoError`]: as of [`run`], and a file that cannot be written.
pub fn run_sitting(
    options: DemoOptions,
    sitting: Sitting,
    seconds: f64,
) -> Result<Report, DemoError> {
    // Nothing is heard before it is asked for.
    let volume = options.volume;
    let silent = DemoOptions {
        volume: 0.0,
        adapt_waves: false,
        ..options
    };
    let mut app = app::App::new(silent)?;
    app.choices.volume = volume;
    app.question = Some(question::Question::new(sitting, seconds));
    app.stand();
    stay(app)
}

fn stay(mut app: app::App) -> Result<Report, DemoError> {
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
