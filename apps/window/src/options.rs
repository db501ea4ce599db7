//! The initial options of the window.

use echomarch::audio::PanningLaw;
use echomarch::auralisation::Listen;
use echomarch::tracer::Settings;
use echomarch_walk::Parts;
use std::path::PathBuf;

/// The default scene. The initial view of this scene shows many near and far objects. (In `corner` and `obstacles` the
/// listener faces a wall, as in the thesis.)
pub const OPENING_SCENE: &str = "open-pillars";

/// The initial options of the window. The user can change every choice in the window.
#[derive(Clone, Debug)]
pub struct DemoOptions {
    /// Built-in scene or scene file.
    pub scene: String,
    /// Named values of the scene, in the units of its file. The values are also applied to scenes opened later that
    /// have values with the same names.
    pub values: Vec<(String, f32)>,
    /// The settings of the waves.
    pub settings: Settings,
    /// Number of pictures per frame of waves.
    pub trace_every: u32,
    /// Whether the number of waves follows the frame time.
    pub adapt_waves: bool,
    /// Target time of a frame, in milliseconds.
    pub frame_milliseconds: f64,
    /// The picture's resolution divided by the window's, along one side; `None` to adapt this ratio to the frame time.
    pub picture_scale: Option<f32>,
    /// Width of the window in pixels, before display scaling.
    pub width: u32,
    /// Height of the window in pixels, before display scaling.
    pub height: u32,
    /// The size of texts and panels, relative to the size for the screen, 0.75 to 2.5.
    pub text_size: f32,
    /// The sound, in the syntax of [`Sound::parse`](echomarch::audio::Sound::parse).
    pub sound: String,
    /// Loudness, 0 to 1.
    pub volume: f32,
    /// The listening mode; `None` for the profile's default ([`Listen::for_profile`]).
    pub listen: Option<Listen>,
    /// The parts of the sound in full listening.
    pub parts: Parts,
    /// The panning law; `None` for the profile's default ([`PanningLaw::for_profile`]).
    pub law: Option<PanningLaw>,
    /// The sound device's name; `None` for the default device.
    pub device: Option<String>,
    /// Buffer size of the sound device in samples.
    pub buffer: u32,
    /// A WAV file for the recording.
    pub record: Option<PathBuf>,
    /// The file to save the scene to; `None` for the next free name.
    pub save: Option<PathBuf>,
    /// The file for a screenshot at the end.
    pub screenshot: Option<PathBuf>,
    /// Number of frames after which the window closes.
    pub frames: Option<u64>,
    /// Number of seconds after which the window closes.
    pub seconds: Option<f64>,
    /// Whether the help is open at the start.
    pub help: bool,
    /// Whether GL errors are queried after every frame. Debug builds always query them.
    pub check_gl: bool,
    /// Returns whether the window must close. The function is called in every frame.
    pub is_asked_to_end: fn() -> bool,
    /// Receives a line of JSON for every frame, for programs that control the window.
    pub log_frames: Option<fn(&str)>,
    /// Receives the lines that the user may want to keep, such as the `trace` call of a saved scene.
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
            text_size: 1.0,
            sound: "speech".into(),
            volume: 0.5,
            listen: None,
            parts: Parts::default(),
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
