//! A game with many moving sources, doors and spawned objects, and the times that its threads spend on sound.
//!
//! The game's loop moves its objects, commits the world, and reads what is heard. An audio thread mixes all sources in
//! blocks of 512 samples. The program prints the median and the 99th percentile of each.
//!
//! ```sh
//! cargo run --release --features audio,simulator --example game [SECONDS]
//! ```

use echomarch::audio::Sound;
use echomarch::glam::{Quat, Vec3};
use echomarch::scene::shape::{Cuboid, Room, Sphere};
use echomarch::simulator::{
    EarsSpec, Mix, Pose, Simulator, SimulatorSettings, SimulatorState, SourceId, SurfaceId,
};
use echomarch::{Error, Source, Surface};
use std::collections::HashMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

/// Duration of a picture at 60 pictures per second.
const PICTURE: Duration = Duration::from_micros(16_667);

const RATE_HZ: u32 = 48_000;

/// Frames in a block of the audio thread.
const BLOCK: usize = 512;

/// Objects that are spawned in one run.
const SPAWNED: usize = 20;

/// The case that a run measures.
#[derive(Clone, Copy)]
struct Case {
    /// Number of moving sources.
    sources: usize,
    /// Whether two walls with doors part the house into three rooms. Without them, every source has the maximum number of
    /// echoes.
    has_doors: bool,
    /// Whether objects are spawned.
    spawns: bool,
}

/// A house of one room, or of three rooms side by side with a doorway in each of the two walls between them. Returns the
/// doors.
fn house(simulator: &mut Simulator, has_doors: bool) -> Result<Vec<SurfaceId>, Error> {
    let shell = Surface::new(Room {
        size: Vec3::new(18.0, 3.0, 8.0),
    });
    simulator.add_surface(shell.with_material("plasterboard"))?;
    if !has_doors {
        return Ok(Vec::new());
    }
    for x in [-3.0, 3.0] {
        for z in [-2.25, 2.25] {
            let wall = Cuboid {
                size: Vec3::new(0.2, 3.0, 3.5),
            };
            let wall = Surface::new(wall).at([x, 0.0, z]).with_material("brick");
            simulator.add_surface(wall)?;
        }
    }
    let mut door = |x: f32| {
        let door = Cuboid {
            size: Vec3::new(0.1, 3.0, 1.0),
        };
        simulator.add_surface(Surface::new(door).at([x, 0.0, 0.0]).with_material("door"))
    };
    Ok(vec![door(-3.0)?, door(3.0)?])
}

/// Position of source `number` of `count` at a time: on a circle in one of the rooms.
fn on_circle(number: usize, count: usize, seconds: f64) -> Pose {
    let room = (number % 3) as f32 * 6.0 - 6.0;
    let turn = (seconds * 0.8) as f32 + number as f32 / count as f32 * std::f32::consts::TAU;
    let radius = 1.0 + (number % 5) as f32 * 0.3;
    Pose::at([room + radius * turn.cos(), -0.2, radius * turn.sin()])
        .turned(Quat::from_rotation_y(-turn))
}

/// Times in milliseconds.
#[derive(Default)]
struct Times(Vec<f64>);

impl Times {
    fn measure<T>(&mut self, work: impl FnOnce() -> T) -> T {
        let began = Instant::now();
        let result = work();
        self.0.push(1e3 * began.elapsed().as_secs_f64());
        result
    }

    /// Like [`Times::measure`], in processor time of this thread.
    fn measure_processor<T>(&mut self, work: impl FnOnce() -> T) -> T {
        let began = processor_ms();
        let result = work();
        self.0.push(processor_ms() - began);
        result
    }

    /// The median, the 99th percentile and the maximum.
    fn summary(&mut self) -> String {
        self.0.sort_by(f64::total_cmp);
        let at = |share: f64| {
            let index = (share * self.0.len() as f64) as usize;
            self.0
                .get(index.min(self.0.len().saturating_sub(1)))
                .copied()
                .unwrap_or(0.0)
        };
        format!("{:8.4} {:8.4} {:8.4}", at(0.5), at(0.99), at(1.0))
    }
}

/// Processor time of this thread in milliseconds: on a busy machine the clock on the wall counts other programs too.
#[cfg(target_os = "linux")]
fn processor_ms() -> f64 {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    1e3 * time.tv_sec as f64 + 1e-6 * time.tv_nsec as f64
}

/// The clock on the wall, in milliseconds.
#[cfg(not(target_os = "linux"))]
fn processor_ms() -> f64 {
    use std::sync::LazyLock;
    static BEGAN: LazyLock<Instant> = LazyLock::new(Instant::now);
    1e3 * BEGAN.elapsed().as_secs_f64()
}

/// Mixes in real time until a stop is requested, and returns the times of its blocks.
fn audio(mut mix: Mix, stop: Arc<AtomicBool>) -> JoinHandle<Times> {
    thread::spawn(move || {
        // The sounds of the game: one second of noise in a loop, whose begin is repeated at the end.
        let mut noise = vec![0.0; RATE_HZ as usize];
        if let Ok(mut sound) = Sound::parse("noise", RATE_HZ) {
            sound.fill(&mut noise);
        }
        noise.extend_from_within(..BLOCK);
        let mut played: HashMap<SourceId, usize> = HashMap::with_capacity(256);
        let mut stereo = vec![0.0; 2 * BLOCK];
        let mut times = Times::default();
        let mut next = Instant::now();
        while !stop.load(Ordering::Relaxed) {
            times.measure_processor(|| {
                mix.process(&mut stereo, |id, mono| {
                    let at = played.entry(id).or_insert(0);
                    mono.copy_from_slice(&noise[*at..][..mono.len()]);
                    *at = (*at + mono.len()) % RATE_HZ as usize;
                });
            });
            next += Duration::from_secs_f64(BLOCK as f64 / f64::from(RATE_HZ));
            thread::sleep(next.saturating_duration_since(Instant::now()));
        }
        times
    })
}

/// Runs the game.
fn run(case: Case, seconds: f64) -> Result<(), Error> {
    let count = case.sources;
    let mut simulator = Simulator::new(SimulatorSettings::default())?;
    let doors = house(&mut simulator, case.has_doors)?;
    simulator.place_listener(Pose::at([-5.0, -0.2, 2.5]))?;
    let mut ids = Vec::new();
    for number in 0..count {
        let at = on_circle(number, count, 0.0).position;
        ids.push(simulator.add_source(Source::at(at))?);
    }
    let mix = simulator.mix(&EarsSpec::new(RATE_HZ).with_sources(count))?;
    simulator.commit();
    while simulator
        .updates(ids[0])
        .is_none_or(|heard| heard.traces == 0)
    {
        if let SimulatorState::Failed(error) = simulator.state() {
            eprintln!("the simulator failed: {error}");
            std::process::exit(1);
        }
        thread::sleep(PICTURE);
    }
    let stop = Arc::new(AtomicBool::new(false));
    let audio = audio(mix, Arc::clone(&stop));
    let [
        mut edits,
        mut commit,
        mut updates,
        mut frame,
        mut processor,
        mut would,
    ] = std::array::from_fn(|_| Times::default());
    let began = Instant::now();
    let traces = |simulator: &Simulator| -> u64 {
        let all = ids.iter().filter_map(|id| simulator.updates(*id));
        all.map(|heard| heard.traces).sum()
    };
    let before = traces(&simulator);
    let (mut spawned, mut pictures, mut compiling) = (0, 0_u32, 0_u32);
    while began.elapsed().as_secs_f64() < seconds {
        let now = began.elapsed().as_secs_f64();
        let (picture, used_ms) = (Instant::now(), processor_ms());
        edits.measure(|| -> Result<(), Error> {
            for (number, id) in ids.iter().enumerate() {
                simulator.place_source(*id, on_circle(number, count, now))?;
            }
            for (number, door) in doors.iter().enumerate() {
                let open = 0.5 - 0.5 * (now + number as f64).cos();
                let at = [6.0 * number as f32 - 3.0, 0.0, open as f32];
                simulator.place_surface(*door, Pose::at(at))?;
            }
            if case.spawns && spawned < SPAWNED && pictures % 6 == 0 {
                let at = Vec3::new(spawned as f32 * 0.8 - 7.6, -1.2, 3.2);
                let ball = Surface::new(Sphere { radius: 0.25 }).at(at);
                simulator.add_surface(ball.with_material("brick"))?;
                spawned += 1;
            }
            Ok(())
        })?;
        commit.measure(|| simulator.commit());
        let heard = || ids.iter().filter(|id| simulator.updates(**id).is_some());
        let heard = updates.measure(|| heard().count());
        assert!(heard <= count);
        frame.0.push(1e3 * picture.elapsed().as_secs_f64());
        processor.0.push(processor_ms() - used_ms);
        compiling += u32::from(matches!(simulator.state(), SimulatorState::Compiling));
        if pictures % 30 == 0 {
            would.measure(|| simulator.would_compile());
        }
        pictures += 1;
        thread::sleep(PICTURE.saturating_sub(picture.elapsed()));
    }
    let took = began.elapsed().as_secs_f64();
    let after = traces(&simulator);
    stop.store(true, Ordering::Relaxed);
    let what = match case {
        Case { spawns: true, .. } => format!("{count} sources, {SPAWNED} objects spawned"),
        Case {
            has_doors: false, ..
        } => format!("{count} sources in one room"),
        _ => format!("{count} sources"),
    };
    let rate = (after - before) as f64 / took;
    let echoes = ids.iter().filter_map(|id| simulator.updates(*id));
    let echoes: usize = echoes.map(|heard| heard.echoes.len()).sum();
    println!(
        "{what}, {echoes} echoes: {pictures} pictures, {compiling} of them while compiling, {rate:.1} traces a second"
    );
    for (name, times) in [
        ("edits", &mut edits),
        ("commit", &mut commit),
        ("updates", &mut updates),
        ("all of a picture", &mut frame),
        ("  processor time", &mut processor),
        ("would_compile", &mut would),
    ] {
        println!("  {name:16} {} ms", times.summary());
    }
    if let Ok(mut times) = audio.join() {
        let block_ms = 1e3 * BLOCK as f64 / f64::from(RATE_HZ);
        let mean = times.0.iter().sum::<f64>() / times.0.len() as f64;
        println!(
            "  {:14} {} ms, {:.1} % of a core",
            "mix of a block",
            times.summary(),
            100.0 * mean / block_ms
        );
    }
    Ok(())
}

fn main() -> Result<(), Error> {
    let seconds = std::env::args()
        .nth(1)
        .and_then(|text| text.parse().ok())
        .unwrap_or(5.0);
    let simulator = Simulator::new(SimulatorSettings::default())?;
    println!("renderer: {}", simulator.renderer());
    drop(simulator);
    println!("                     median     99 %  maximum");
    let case = |sources, has_doors, spawns| Case {
        sources,
        has_doors,
        spawns,
    };
    for case in [
        case(3, true, false),
        case(16, true, false),
        case(64, true, false),
        case(64, false, false),
        case(16, true, true),
    ] {
        run(case, seconds)?;
    }
    Ok(())
}
