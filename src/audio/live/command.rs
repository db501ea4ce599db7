//! Commands to the supervising thread.

use crate::audio::{SoundSource, StereoSource};

/// A command to the supervising thread.
#[derive(Debug)]
pub(super) enum Command {
    /// Fade to another sound.
    Sound(SoundSource),
    /// Fade to a caller's own channels; `None` for the mono sound and its pan.
    Stereo(Option<StereoSource>),
    /// Play on another device.
    Device(Option<String>),
    /// Take the recording that waits in the state.
    Record,
    /// An event on another thread to report.
    Notice(String),
    /// A stream broke off.
    Lost { generation: u64, reason: String },
    /// End the thread.
    Stop,
}
