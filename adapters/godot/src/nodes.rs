//! The classes that Godot sees. They run in games, not in the editor.
//!
//! They follow notifications, not virtual methods: a script of a node would replace those, such as `_process`. A node's
//! notification comes after the `_process` of its script.

use crate::acoustics::{Acoustics, NodeId, pose};
use echomarch::Error;
use echomarch::simulator::{Pose, SimulatorSettings, SimulatorState};
use godot::classes::notify::{Node3DNotification, NodeNotification};
use godot::classes::{
    AudioServer, AudioStream, AudioStreamGenerator, AudioStreamGeneratorPlayback,
    AudioStreamPlayback, AudioStreamPlayer,
};
use godot::prelude::*;

/// After the nodes of the game have moved, and their sources have their samples.
const LATE: i32 = 1_000;

/// Owns the simulator, and plays what is heard. Its descendants are heard.
#[derive(GodotClass)]
#[class(init, base=Node)]
pub struct EchomarchWorld {
    /// Materials beside the built-in ones, such as `"door": Material(absorption: 0.1)`.
    #[export(multiline)]
    materials: GString,
    /// The sound that is made ahead, in seconds. Pictures that last longer cause gaps.
    #[export]
    #[init(val = 0.1)]
    buffer_s: f32,
    /// The level of the output in decibels, without a limiter.
    #[export]
    volume_db: f32,
    /// The audio bus of the output.
    #[export]
    #[init(val = "Master".into())]
    bus: StringName,
    acoustics: Option<Acoustics>,
    /// Plays the output. The engine pauses it while the world is outside the tree.
    player: Option<Gd<AudioStreamPlayer>>,
    playback: Option<Gd<AudioStreamGeneratorPlayback>>,
    /// Frames of the output that stay free: its length is a power of two, more than `buffer_s`.
    spare: i32,
    /// The length of the next block, once it is known.
    frames: Option<usize>,
    stereo: Vec<f32>,
    base: Base<Node>,
}

#[godot_api]
impl INode for EchomarchWorld {
    fn on_notification(&mut self, what: NodeNotification) {
        match what {
            NodeNotification::READY => {
                self.base_mut().set_process_priority(LATE);
                self.base_mut().set_process(true);
                self.start();
            }
            // Children are in the tree here. The player exists from READY on.
            NodeNotification::POST_ENTER_TREE => self.play_output(),
            NodeNotification::PROCESS => self.play(),
            _ => (),
        }
    }
}

#[godot_api]
impl EchomarchWorld {
    /// `""` while everything is heard, `"compiling"`, or why the last surfaces are not heard.
    #[func]
    fn trouble(&self) -> GString {
        let Some(acoustics) = &self.acoustics else {
            return "no simulator".into();
        };
        match acoustics.state() {
            SimulatorState::Compiling => "compiling".into(),
            SimulatorState::Failed(error) => (&error.to_string()).into(),
            _ => GString::new(),
        }
    }

    fn start(&mut self) {
        let rate_hz = AudioServer::singleton().get_mix_rate();
        let settings = SimulatorSettings::default();
        match Acoustics::start(settings, &self.materials.to_string(), rate_hz as u32) {
            Ok(acoustics) => self.acoustics = Some(acoustics),
            Err(error) => {
                godot_error!("EchomarchWorld is silent: {error}");
                return;
            }
        }
        let mut generator = AudioStreamGenerator::new_gd();
        generator.set_mix_rate(rate_hz);
        generator.set_buffer_length(self.buffer_s);
        let mut player = AudioStreamPlayer::new_alloc();
        player.set_stream(&generator);
        player.set_volume_db(self.volume_db);
        player.set_bus(&self.bus);
        self.base_mut().add_child(&player);
        self.player = Some(player);
        self.play_output();
        let frames = (self.buffer_s * rate_hz) as i32;
        self.spare = self.free() - frames.clamp(0, self.free());
    }

    /// Starts the player anew, so that sound from before the world left the tree is not heard.
    fn play_output(&mut self) {
        let Some(player) = &mut self.player else {
            return;
        };
        player.play();
        let playback = player.get_stream_playback();
        self.playback = playback.and_then(|playback| playback.try_cast().ok());
    }

    fn play(&mut self) {
        let frames = self.frames();
        self.frames = None;
        let (Some(acoustics), Some(playback)) = (&mut self.acoustics, &mut self.playback) else {
            return;
        };
        acoustics.commit();
        self.stereo.resize(2 * frames, 0.0);
        acoustics.play(&mut self.stereo);
        let stereo = self.stereo.as_chunks::<2>().0.iter();
        let frames = stereo.map(|[left, right]| Vector2::new(*left, *right));
        playback.push_buffer(&frames.collect());
    }

    fn free(&self) -> i32 {
        let playback = self.playback.as_ref();
        playback.map_or(0, |playback| playback.get_frames_available())
    }

    /// The frames that this picture adds to the output.
    fn frames(&mut self) -> usize {
        let frames = self.free() - self.spare;
        *self.frames.get_or_insert(frames.max(0) as usize)
    }
}

/// A node of a world.
#[derive(Default)]
struct Place {
    world: Option<Gd<EchomarchWorld>>,
    node: NodeId,
    /// The fault that was printed last.
    fault: String,
}

impl Place {
    /// The place of a node in the nearest world above it.
    fn of(node: &Gd<Node3D>) -> Place {
        let mut above = node.get_parent();
        while let Some(next) = above {
            above = next.get_parent();
            if let Ok(world) = next.try_cast() {
                return Place {
                    world: Some(world),
                    node: node.instance_id().to_i64(),
                    fault: String::new(),
                };
            }
        }
        godot_error!("{} is not below an EchomarchWorld", node.get_path());
        Place::default()
    }

    /// Does something with the world's acoustics. `None` if it has none.
    fn with<T>(&mut self, what: impl FnOnce(&mut Acoustics, NodeId) -> T) -> Option<T> {
        let mut world = self.world.as_mut()?.bind_mut();
        Some(what(world.acoustics.as_mut()?, self.node))
    }

    /// Changes the node's object, and prints a fault unless it was printed in the picture before.
    fn change(&mut self, what: impl FnOnce(&mut Acoustics, NodeId) -> Result<(), Error>) {
        let fault = match self.with(what) {
            Some(Err(error)) => error.to_string(),
            _ => String::new(),
        };
        if !fault.is_empty() && fault != self.fault {
            let node = InstanceId::from_i64(self.node);
            let path = Gd::<Node>::from_instance_id(node).get_path();
            godot_error!("{path}: {fault}");
        }
        self.fault = fault;
    }

    fn leave(&mut self) {
        self.with(Acoustics::remove);
        self.world = None;
    }

    /// Samples of a source that the next block lacks.
    fn wanted(&mut self) -> usize {
        let waiting = self.with(|acoustics, node| acoustics.waiting(node));
        match (waiting.flatten(), &mut self.world) {
            (Some(waiting), Some(world)) => world.bind_mut().frames().saturating_sub(waiting),
            _ => 0,
        }
    }
}

/// Lets the nodes of a class follow their world.
macro_rules! in_a_world {
    ($class:ident) => {
        #[godot_api]
        impl INode3D for $class {
            fn on_notification(&mut self, what: Node3DNotification) {
                match what {
                    Node3DNotification::ENTER_TREE => {
                        self.place = Place::of(&self.base());
                        self.base_mut().set_process(true);
                    }
                    Node3DNotification::PROCESS => self.follow(),
                    Node3DNotification::EXIT_TREE => self.place.leave(),
                    _ => (),
                }
            }
        }
    };
}

fn pose_of(node: &Gd<Node3D>) -> Pose {
    let transform = node.get_global_transform();
    let columns = transform.basis.to_cols();
    pose(
        columns.map(|column| column.to_array()),
        transform.origin.to_array(),
    )
}

/// A surface that reflects sound, at its transform.
#[derive(GodotClass)]
#[class(init, base=Node3D)]
pub struct EchomarchSurface {
    /// The shape and the material as in scene files: `Surface(shape: Box(size: (1, 2, 3)), material: "brick")`.
    #[export(multiline)]
    #[init(val = "Surface(shape: Box(size: (1, 1, 1)))".into())]
    surface: GString,
    /// Whether it will turn, so that its first turn compiles nothing.
    #[export]
    turns: bool,
    place: Place,
    base: Base<Node3D>,
}

in_a_world!(EchomarchSurface);

impl EchomarchSurface {
    fn follow(&mut self) {
        let (pose, text) = (pose_of(&self.base()), self.surface.to_string());
        let turns = self.turns;
        self.place
            .change(|acoustics, node| acoustics.surface(node, &text, turns, pose));
    }
}

/// A source of sound at its transform, which plays a stream or the samples of a script.
#[derive(GodotClass)]
#[class(init, base=Node3D)]
pub struct EchomarchSource {
    /// The level and the directivity as in scene files: `Source(level_db: -6, directivity: Cardioid)`.
    #[export]
    #[init(val = "Source()".into())]
    source: GString,
    /// What [`EchomarchSource::play`] plays: both channels as one.
    #[export]
    stream: Option<Gd<AudioStream>>,
    /// Plays the stream with the next picture, and is then false.
    #[export]
    autoplay: bool,
    playback: Option<Gd<AudioStreamPlayback>>,
    place: Place,
    base: Base<Node3D>,
}

in_a_world!(EchomarchSource);

#[godot_api]
impl EchomarchSource {
    /// Plays the stream from its beginning.
    #[func]
    fn play(&mut self) {
        let stream = self.stream.as_mut();
        self.playback = stream.and_then(|stream| stream.instantiate_playback());
        if let Some(playback) = &mut self.playback {
            playback.start();
        }
    }

    /// Ends the stream.
    #[func]
    fn stop(&mut self) {
        self.playback = None;
    }

    #[func]
    fn is_playing(&self) -> bool {
        self.playback.is_some()
    }

    /// Number of samples that the next block lacks.
    #[func]
    fn samples_wanted(&mut self) -> i64 {
        self.place.wanted() as i64
    }

    /// Adds samples at the rate of the audio server, without a stream. Returns how many were taken: at most a second of
    /// them waits.
    #[func]
    fn push_samples(&mut self, samples: PackedFloat32Array) -> i64 {
        let samples = samples.as_slice().iter().copied();
        let pushed = self
            .place
            .with(|acoustics, node| acoustics.push(node, samples));
        pushed.unwrap_or(0) as i64
    }

    /// The last update: `is_in_sight`; `visibility`, 0 to 1; `delay_s`; and in eight octave bands, 63 Hz to 8 kHz, `direct`
    /// and `reverb`, the gains of the direct way and of all other sound, which are 1 for the direct sound at 1 m. Empty
    /// until the source is traced.
    #[func]
    fn heard(&mut self) -> VarDictionary {
        let heard = self.place.with(|acoustics, node| acoustics.heard(node));
        let Some(heard) = heard.flatten().filter(|heard| heard.traces > 0) else {
            return VarDictionary::new();
        };
        let direct = &heard.direct;
        vdict! {
            "is_in_sight" => direct.is_in_sight,
            "visibility" => direct.visibility,
            "delay_s" => direct.delay_s,
            "direct" => &PackedFloat64Array::from(&direct.gain),
            "reverb" => &PackedFloat64Array::from(&heard.reverb.gain),
        }
    }

    fn follow(&mut self) {
        if std::mem::take(&mut self.autoplay) {
            self.play();
        }
        let (pose, text) = (pose_of(&self.base()), self.source.to_string());
        self.place
            .change(|acoustics, node| acoustics.source(node, &text, pose));
        let wanted = self.place.wanted();
        let Some(playback) = &mut self.playback else {
            return;
        };
        let frames = playback.mix_audio(1.0, wanted as i32);
        let mono = frames
            .as_slice()
            .iter()
            .map(|frame| 0.5 * (frame.x + frame.y));
        self.place
            .with(|acoustics, node| acoustics.push(node, mono));
        if !playback.is_playing() {
            self.playback = None;
        }
    }
}

/// The listener, at its transform. If there are several, the last one in the tree hears.
#[derive(GodotClass)]
#[class(init, base=Node3D)]
pub struct EchomarchListener {
    place: Place,
    base: Base<Node3D>,
}

in_a_world!(EchomarchListener);

impl EchomarchListener {
    fn follow(&mut self) {
        let pose = pose_of(&self.base());
        self.place.change(|acoustics, _| acoustics.listener(pose));
    }
}
