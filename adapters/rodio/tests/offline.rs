//! The mix through rodio's mixer, without a sound card.

use assert_no_alloc::{AllocDisabler, assert_no_alloc};
use echomarch::scene::shape::Room;
use echomarch::simulator::{EarsSpec, Pose, Simulator, SimulatorSettings};
use echomarch::{Error, Source, Surface};
use echomarch_rodio::World;
use rodio::Source as _;
use std::time::{Duration, Instant};

#[global_allocator]
static ALLOCATOR: AllocDisabler = AllocDisabler;

const RATE_HZ: u32 = 48_000;

/// Time that a test waits for the first trace.
const LIMIT: Duration = Duration::from_secs(60);

/// Protects games that use rodio: the source is heard from the right, where it is, in two channels at the stated rate,
/// and playing allocates nothing.
#[test]
fn a_world_is_heard() -> Result<(), Error> {
    let mut simulator = Simulator::new(SimulatorSettings::default().with_seconds(0.3, 0.3))?;
    let size = [8.0, 3.0, 6.0].into();
    simulator.add_surface(Surface::new(Room { size }).with_material("plasterboard"))?;
    let voice = simulator.add_source(Source::at([2.0, 0.0, 0.0]))?;
    simulator.place_listener(Pose::at([0.5, 0.0, 0.0]))?;
    simulator.commit();
    let mut time = 0.0_f32;
    let mut world = World::new(&simulator, &EarsSpec::new(RATE_HZ), move |id, samples| {
        assert_eq!(id, voice);
        for sample in samples {
            time += 0.06;
            *sample = time.sin();
        }
    })?;
    assert_eq!(
        (world.channels().get(), world.sample_rate().get()),
        (2, RATE_HZ)
    );
    assert_eq!(
        (world.current_span_len(), world.total_duration()),
        (None, None)
    );
    let began = Instant::now();
    let mut loudest = [0.0_f32; 2];
    while loudest[1] < 0.1 && began.elapsed() < LIMIT {
        assert_no_alloc(|| {
            for index in 0..500 {
                let sample = world.next().unwrap_or(f32::NAN).abs();
                loudest[index % 2] = loudest[index % 2].max(sample);
            }
        });
        std::thread::sleep(Duration::from_millis(2));
    }
    assert!(loudest[1] >= 0.1 && loudest[1] > loudest[0], "{loudest:?}");
    Ok(())
}

/// Protects games that give a rate that no sound card has.
#[test]
fn a_bad_rate_is_refused() -> Result<(), Error> {
    let simulator = Simulator::new(SimulatorSettings::default())?;
    assert!(World::new(&simulator, &EarsSpec::new(0), |_, _| ()).is_err());
    Ok(())
}
