//! Sounds, the panning law, and live sound: without a device, and with a sound server.

#[path = "../common/mod.rs"]
mod common;

#[cfg(feature = "audio")]
mod live_audio;
#[cfg(feature = "audio")]
mod live_audio_server;
#[cfg(feature = "audio")]
mod live_player;
#[cfg(feature = "audio")]
mod live_sources;
#[cfg(feature = "audio")]
mod simulator;
#[cfg(feature = "audio")]
mod sound_server;

mod measures;
mod panning;
mod sounds;
mod speech;
