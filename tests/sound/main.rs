//! Sounds, the panning law, and live sound: without a device, and with a sound server.

#[path = "../common/mod.rs"]
mod common;

#[cfg(feature = "live")]
mod live_audio;
#[cfg(feature = "live")]
mod live_audio_server;
#[cfg(feature = "live")]
mod live_player;
#[cfg(feature = "live")]
mod live_sources;
#[cfg(feature = "simulator")]
mod simulator;
#[cfg(feature = "live")]
mod sound_server;

mod measures;
mod panning;
mod sounds;
mod speech;
