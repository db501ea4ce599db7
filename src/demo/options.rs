//! What the window is started with.

use crate::audio::PanningLaw;
use crate::auralisation::Listen;
use crate::trace::Settings;
use std::path::PathBuf;

/// The scene that the window opens with where none is named: its first view shows many
/// things near and far. (In `corner` and `obstacles` the listener faces a wall, as the thesis
/// has it.)
pub const OPENING_SCENE: &str = "open-pillars";

/// What the window is started with; every choice can be changed in it.
#[derive(Clone, Debug)]
pub struct DemoOptions {
    /// Built-in scene or scene file.
    pub scene: String,
    /// Named values of the scene in the unit of its file; those of the same name in scenes
    /// that are opened later are set too.
    pub values: Vec<(String, f32)>,
    /// How waves are traced.
    pub settings: Settings,
    /// A frame of waves for every so many pictures.
    pub trace_every: u32,
    /// Whether the number of waves follows the frame's time.
    pub adapt_waves: bool,
    /// Milliseconds that a frame may take.
    pub frame_milliseconds: f64,
    /// Pixels drawn for each of the window's along a side; none to follow the frame's time.
    pub picture_scale: Option<f32>,
    /// Width of the window in pixels, before the screen's own scale.
    pub width: u32,
    /// Height of the window in pixels, before the screen's own scale.
    pub height: u32,
    /// The sound, as [`Sound::parse`](crate::audio::Sound::parse) takes it.
    pub sound: String,
    /// Loudness, 0 to 1.
    pub volume: f32,
    /// What is listened to; none for what the profile is listened to by ([`Listen::for_profile`]).
    pub listen: Option<Listen>,
    /// From pan to gains; none for the law of the profile
    /// ([`PanningLaw::for_profile`]).
    pub law: Option<PanningLaw>,
    /// The sound device's name; none for the usual one.
    pub device: Option<String>,
    /// Samples that the sound device takes at a time.
    pub buffer: u32,
    /// A WAV file of what is heard.
    pub record: Option<PathBuf>,
    /// The scene file that is saved to; none for the next free name.
    pub save: Option<PathBuf>,
    /// A picture of the window at the end.
    pub screenshot: Option<PathBuf>,
    /// Ends after so many frames.
    pub frames: Option<u64>,
    /// Ends after so many seconds.
    pub seconds: Option<f64>,
    /// Whether the help is open at the start.
    pub help: bool,
    /// Whether GL errors are queried after every frame; in debug builds they always are.
    pub check_gl: bool,
    /// Whether the window is to be closed, checked at every frame.
    pub is_asked_to_end: fn() -> bool,
    /// Receives every frame as a line of JSON, for programs that control the window and need
    /// its progress.
    pub log_frames: Option<fn(&str)>,
    /// Receives every line that the user may want to keep, such as the `trace` call of a
    /// scene just saved.
    pub announce: fn(&str),
}

impl Default for DemoOptions {
    fn default() -> DemoOptions {
        DemoOptions {
            scene: OPENING_SCENE.into(),
            values: Vec::new(),
            settings: Settings::default(),
            trace_every: 1,
            adapt_waves: true,
            frame_milliseconds: 1000.0 / 30.0,
            picture_scale: None,
            width: 960,
            height: 540,
            sound: "speech".into(),
            volume: 0.5,
            listen: None,
            law: None,
            device: None,
            buffer: 1024,
            record: None,
            save: None,
            screenshot: None,
            frames: None,
            seconds: None,
            help: true,
            check_gl: false,
            is_asked_to_end: || false,
            log_frames: None,
            announce: |_| {},
        }
    }
}
