//! Sounds through kira's renderer, without a sound card.

use assert_no_alloc::{AllocDisabler, assert_no_alloc};
use echomarch::scene::shape::Room;
use echomarch::simulator::{EarsSpec, Pose, Simulator, SimulatorSettings, SourceId};
use echomarch::{Error, Source, Surface};
use echomarch_kira::{Heard, World};
use kira::backend::{Backend, Renderer};
use kira::sound::static_sound::{StaticSoundData, StaticSoundSettings};
use kira::track::TrackBuilder;
use kira::{AudioManager, AudioManagerSettings, Frame};
use std::sync::Arc;
use std::time::{Duration, Instant};

#[global_allocator]
static ALLOCATOR: AllocDisabler = AllocDisabler;

const RATE_HZ: u32 = 48_000;

/// Frames in a block.
const BLOCK: usize = 256;

/// Time that a test waits for the first trace.
const LIMIT: Duration = Duration::from_secs(60);

/// A backend whose output is at hand.
struct Offline(Option<Renderer>);

impl Backend for Offline {
    type Settings = ();
    type Error = ();

    fn setup((): (), _: usize) -> Result<(Offline, u32), ()> {
        Ok((Offline(None), RATE_HZ))
    }

    fn start(&mut self, renderer: Renderer) -> Result<(), ()> {
        self.0 = Some(renderer);
        Ok(())
    }
}

impl Offline {
    /// The loudest samples on both sides of the next block.
    fn loudest(&mut self) -> [f32; 2] {
        let renderer = self.0.as_mut().expect("a started backend");
        let mut block = [0.0; 2 * BLOCK];
        renderer.on_start_processing();
        assert_no_alloc(|| renderer.process(&mut block, 2));
        let frames = block.as_chunks::<2>().0.iter();
        frames.fold([0.0; 2], |most: [f32; 2], frame| {
            assert!(frame.iter().all(|sample| sample.is_finite()), "{frame:?}");
            [0, 1].map(|side| most[side].max(frame[side].abs()))
        })
    }
}

/// A room with a source to the right of the listener.
fn world() -> Result<(Simulator, SourceId), Error> {
    let mut simulator = Simulator::new(SimulatorSettings::default().with_seconds(0.3, 0.3))?;
    let size = [8.0, 3.0, 6.0].into();
    simulator.add_surface(Surface::new(Room { size }).with_material("plasterboard"))?;
    let source = simulator.add_source(Source::at([2.0, 0.0, 0.0]))?;
    simulator.place_listener(Pose::at([0.5, 0.0, 0.0]))?;
    simulator.commit();
    Ok((simulator, source))
}

fn manager() -> AudioManager<Offline> {
    AudioManager::new(AudioManagerSettings::<Offline>::default()).expect("a manager")
}

/// Renders until both sides are heard, and checks that the right one, where the source is, is louder.
fn hear_from_the_right(manager: &mut AudioManager<Offline>) {
    let began = Instant::now();
    let mut loudest = [0.0; 2];
    while loudest[1] < 0.1 && began.elapsed() < LIMIT {
        loudest = manager.backend_mut().loudest();
        std::thread::sleep(Duration::from_millis(2));
    }
    assert!(loudest[1] >= 0.1, "{loudest:?}");
    assert!(loudest[1] > loudest[0], "{loudest:?}");
}

/// Protects games that use kira: what a track plays is heard from where its source is, without allocation.
#[test]
fn a_track_is_heard_from_its_source() -> Result<(), Error> {
    let (mut simulator, source) = world()?;
    let ears = simulator.ears(source, &EarsSpec::new(RATE_HZ))?;
    let mut manager = manager();
    let builder = TrackBuilder::new().with_effect(Heard::new(ears));
    let mut track = manager.add_sub_track(builder).expect("a track");
    let tone = (0..RATE_HZ).map(|index| Frame::from_mono((index as f32 * 0.06).sin()));
    let tone = StaticSoundData {
        sample_rate: RATE_HZ,
        frames: Arc::from_iter(tone),
        settings: StaticSoundSettings::new().loop_region(..),
        slice: None,
    };
    track.play(tone).expect("a sound");
    hear_from_the_right(&mut manager);
    Ok(())
}

/// Protects games that play all sources as one sound: it is heard, and ends with its handle.
#[test]
fn a_world_is_heard_until_its_handle_is_dropped() -> Result<(), Error> {
    let (simulator, source) = world()?;
    let mix = simulator.mix(&EarsSpec::new(RATE_HZ))?;
    let mut manager = manager();
    let mut time = 0.0_f32;
    let world = World::new(mix, move |id, samples| {
        assert_eq!(id, source);
        for sample in samples {
            time += 0.06;
            *sample = time.sin();
        }
    });
    let handle = manager.play(world).expect("a sound");
    hear_from_the_right(&mut manager);
    drop(handle);
    for _ in 0..3 {
        manager
            .backend_mut()
            .0
            .as_mut()
            .expect("started")
            .on_start_processing();
        manager.backend_mut().loudest();
    }
    assert_eq!(manager.backend_mut().loudest(), [0.0; 2]);
    Ok(())
}
