//! Tests of the program: commands, untrusted files, the form, the window.

mod common;

mod answers;
mod bad_input;
mod cli;
mod cli_options;
mod cost;
#[cfg(feature = "demo")]
mod demo_scenes;
#[cfg(all(feature = "demo", feature = "audio"))]
mod demo_sound;
#[cfg(feature = "demo")]
mod demo_window;
mod first_visit;
mod gpu_report;
mod heard_paths;
mod impulse;
mod impulse_binaural;
mod impulse_directed;
mod impulse_sofa;
mod interrupted;
mod levels;
mod localise;
mod localise_form;
mod localise_score;
#[path = "../../../../tests/sound/measures.rs"]
mod measures;
#[cfg(feature = "demo")]
mod own_window;
mod page;
mod panning;
mod render_full;
#[cfg(feature = "audio")]
#[path = "../../../../tests/sound/sound_server/mod.rs"]
mod sound_server;
mod strange_egl;
mod study;
mod untrusted;
mod user_fields;
mod validation;
mod webdriver;
