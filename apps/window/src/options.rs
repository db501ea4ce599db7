//! The initial options of the window.

use echomarch::audio::PanningLaw;
use echomarch::auralisation::Listen;
use echomarch::tracer::Settings;
use std::path::PathBuf;

/// The default scene: its first view shows many near and far objects. (In `corner` and `obstacles`
/// the listener faces a wall, as in the thesis.)
pub const OPENING_SCENE: &str = "open-pillars";

/// The initial options of the window; every choice can be changed in it.
#[derive(Clone, Debug)]
pub struct DemoOptions {
    /// Built-in scene or scene file.
    pub scene: String,
    /// Named values of the scene in the unit of its file. They are also set in scenes opened later
    /// that have values of the same names.
    pub values: Vec<(String, f32)>,
    /// How waves are traced.
    pub settings: Settings,
    /// Number of pictures per frame of waves.
    pub trace_every: u32,
    /// Whether the number of waves follows the frame time.
    pub adapt_waves: bool,
    /// Milliseconds that a frame may take.
    pub frame_milliseconds: f64,
    /// Ratio of the picture's resolution to the window's along a side; `None` to adapt the ratio to
    /// the frame time.
    pub picture_scale: Option<f32>,
    /// Width of the window in pixels, before display scaling.
    pub width: u32,
    /// Height of the window in pixels, before display scaling.
    pub height: u32,
    /// The sound, as [`Sound::parse`](echomarch::audio::Sound::parse) takes it.
    pub sound: String,
    /// Loudness, 0 to 1.
    pub volume: f32,
    /// The listening mode; none for the profile's default ([`Listen::for_profile`]).
    pub listen: Option<Listen>,
    /// The law from pan to gains; `None` for the profile's default ([`PanningLaw::for_profile`]).
    pub law: Option<PanningLaw>,
    /// The sound device's name; none for the default device.
    pub device: Option<String>,
    /// Buffer size of the sound device in samples.
    pub buffer: u32,
    /// A WAV file for the recording.
    pub record: Option<PathBuf>,
    /// The file to save the scene to; none for the next free name.
    pub save: Option<PathBuf>,
    /// A file for a picture of the window at the end.
    pub screenshot: Option<PathBuf>,
    /// Ends after this number of frames.
    pub frames: Option<u64>,
    /// Ends after this number of seconds.
    pub seconds: Option<f64>,
    /// Whether the help is open at the start.
    pub help: bool,
    /// Whether GL errors are queried after every frame; in debug builds they always are.
    pub check_gl: bool,
    /// Returns whether the window must close; called at every frame.
    pub is_asked_to_end: fn() -> bool,
    /// Receives every frame as a line of JSON, for programs that control the window.
    pub log_frames: Option<fn(&str)>,
    /// Receives every line that the user may want to keep, such as the `trace` call of a scene just
    /// saved.
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
