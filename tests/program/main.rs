//! The program as a user uses it: commands, untrusted files, the form, the window.
#![cfg(feature = "cli")]

#[path = "../common/mod.rs"]
mod common;

mod answers;
mod bad_input;
mod cli;
mod cli_options;
mod cost;
mod demo_scenes;
mod demo_window;
mod gpu_report;
mod impulse;
mod impulse_binaural;
mod interrupted;
mod levels;
mod localise;
mod localise_form;
mod localise_score;
mod own_window;
mod page;
mod render_full;
mod strange_egl;
mod study;
mod untrusted;
mod webdriver;
