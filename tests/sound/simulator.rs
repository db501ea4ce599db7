//! The ears of a simulator: no allocations in the callback, silence before the first trace, levels, and no clicks.

use crate::measures::largest_step;
use assert_no_alloc::assert_no_alloc;
use echomarch::audio::Sound;
use echomarch::glam::{DVec3, Quat, Vec3};
use echomarch::hrtf::{HrirSet, MeasuredHrir};
use echomarch::simulator::{
    EarsFormat, EarsSpec, Mix, Pose, Simulator, SimulatorSettings, SourceId,
};
use echomarch::{Listener, Scene, Source};
use std::sync::Arc;
use std::time::{Duration, Instant};

const RATE_HZ: u32 = 48_000;

/// Maximum time to wait for the workers, many times what they take on a busy machine.
const LONGEST: Duration = Duration::from_secs(120);

fn wait_until(what: &str, mut is_so: impl FnMut() -> bool) {
    let began = Instant::now();
    while !is_so() {
        assert!(began.elapsed() < LONGEST, "{what}");
        std::thread::sleep(Duration::from_millis(2));
    }
}

fn simulator() -> Simulator {
    Simulator::new(SimulatorSettings::default().with_waves(1024)).unwrap()
}

fn has_traces(simulator: &Simulator, id: SourceId, commit: u64) -> bool {
    let heard = simulator.updates(id);
    heard.is_some_and(|heard| heard.traces > 0 && heard.commit >= commit)
}

/// The next frames of a mix whose sources all play a tone of 200 Hz, without allocations. 480
/// frames are whole periods, and begin and end with the largest amplitude.
fn play(mix: &mut Mix, frames: usize) -> Vec<f32> {
    let mut stereo = vec![f32::NAN; 2 * frames];
    let step = std::f32::consts::TAU * 200.0 / RATE_HZ as f32;
    for (number, block) in stereo.chunks_mut(2 * 480).enumerate() {
        let mut at = 480 * number;
        assert_no_alloc(|| {
            mix.process(block, |_, mono| {
                for sample in &mut *mono {
                    *sample = (at as f32 * step).cos();
                    at += 1;
                }
            });
        });
    }
    stereo
}

fn loudest(stereo: &[f32]) -> f32 {
    stereo
        .iter()
        .fold(0.0, |loudest, sample| loudest.max(sample.abs()))
}

/// Protects the audio callback and the level: a source in the open 2 m ahead is silent before it is traced, fades in
/// without a click, then has half of its amplitude in the middle; turning the head moves it to the left ear; a removed
/// source fades out. The callback allocates and frees no memory.
#[test]
fn a_source_fades_in_turns_and_fades_out() {
    let mut simulator = simulator();
    let mut mix = simulator
        .mix(&EarsSpec::new(RATE_HZ).with_sources(2))
        .unwrap();
    assert_eq!(loudest(&play(&mut mix, 4800)), 0.0);
    let id = simulator.add_source(Source::at([0.0, 0.0, -2.0])).unwrap();
    let commit = simulator.commit();
    wait_until("a trace", || has_traces(&simulator, id, commit));
    let mut heard = Vec::new();
    wait_until("sound", || {
        heard.extend(play(&mut mix, 480));
        loudest(&heard) > 0.0
    });
    heard.extend(play(&mut mix, 9600));
    let middle = 0.5 * std::f32::consts::FRAC_1_SQRT_2;
    let last = &heard[heard.len() - 9600..];
    assert!(
        (loudest(last) / middle - 1.0).abs() < 0.02,
        "{}",
        loudest(last)
    );
    // The largest step of the tone is 2.6 % of its amplitude.
    let left: Vec<f32> = heard.iter().step_by(2).copied().collect();
    assert!(largest_step(&left) < 0.035 * middle);
    let right = Quat::from_rotation_y(-std::f32::consts::FRAC_PI_2);
    simulator
        .place_listener(Pose::at(Vec3::ZERO).turned(right))
        .unwrap();
    let commit = simulator.commit();
    wait_until("another commit", || has_traces(&simulator, id, commit));
    let mut last = Vec::new();
    wait_until("sound at the left ear", || {
        last = play(&mut mix, 4800);
        let right: Vec<f32> = last.iter().skip(1).step_by(2).copied().collect();
        loudest(&right[4000..]) < 0.01
    });
    assert!((loudest(&last[8000..]) / 0.5 - 1.0).abs() < 0.02);
    simulator.remove_source(id).unwrap();
    simulator.commit();
    let mut end = Vec::new();
    wait_until("silence", || {
        end.extend(play(&mut mix, 4800));
        loudest(&end[end.len() - 9600..]) == 0.0
    });
    let left: Vec<f32> = end.iter().step_by(2).copied().collect();
    assert!(largest_step(&left) < 0.035 * 0.5, "{}", largest_step(&left));
    assert_eq!(mix.source_count(), 0);
}

/// A head that delays and attenuates sound from the other side, at 44.1 kHz.
fn head() -> Arc<HrirSet> {
    let measured = |from: DVec3| {
        let ear = |side: f64| -> Vec<f32> {
            let towards = side * from.y;
            let onset = (12.0 - 10.0 * towards) as usize;
            let level = 1.0 + 0.5 * towards;
            (0..400)
                .map(|at| if at == onset { level as f32 } else { 0.0 })
                .collect()
        };
        MeasuredHrir {
            from,
            ears: [ear(1.0), ear(-1.0)],
            delays_s: [0.0; 2],
        }
    };
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    let directions = axes.into_iter().flat_map(|axis| [axis, -axis]);
    Arc::new(HrirSet::new(44_100, directions.map(measured).collect()).unwrap())
}

/// Protects headphones: a source 2 m to the left has the level of the head's left ear there, and that of the right ear
/// after the head is turned. The callback allocates and frees no memory, and nothing clicks.
#[test]
fn a_head_is_heard_at_another_rate() {
    let mut simulator = simulator();
    let spec = EarsSpec::new(RATE_HZ).with_sources(2).with_head(head());
    let mut mix = simulator.mix(&spec).unwrap();
    let id = simulator.add_source(Source::at([-2.0, 0.0, 0.0])).unwrap();
    let commit = simulator.commit();
    wait_until("a trace", || has_traces(&simulator, id, commit));
    let levels = |stereo: &[f32]| {
        [0, 1].map(|ear| {
            let samples = stereo.iter().skip(ear).step_by(2);
            samples.fold(0.0_f32, |loudest, sample| loudest.max(sample.abs()))
        })
    };
    let mut heard = Vec::new();
    let mut settles = |mix: &mut Mix, near: usize| {
        wait_until("the level of the head", || {
            let last = play(mix, 9600);
            let found = levels(&last[9600..]);
            heard.extend(last);
            // Between directions 3° apart, the mean of this head's levels changes by 0.02.
            let is_near = |level: f32, exact: f32| (level - exact).abs() < 0.03;
            is_near(found[near], 0.75) && is_near(found[1 - near], 0.25)
        });
    };
    settles(&mut mix, 0);
    let behind = Quat::from_rotation_y(std::f32::consts::PI);
    simulator.head_tracker().turn(behind).unwrap();
    settles(&mut mix, 1);
    // The largest step of the tone is 2.6 % of its amplitude, which changes by 0.5 within 10 ms.
    for ear in [0, 1] {
        let samples: Vec<f32> = heard.iter().skip(ear).step_by(2).copied().collect();
        assert!(largest_step(&samples) < 0.035 * 0.75 + 0.5 / 480.0);
    }
}

/// Protects the sound after a pause: a mix that takes no messages while its source moves plays the last place
/// afterwards, although nothing moves any more.
#[test]
fn a_paused_mix_catches_up() {
    let mut simulator = simulator();
    let mut mix = simulator
        .mix(&EarsSpec::new(RATE_HZ).with_sources(1))
        .unwrap();
    let id = simulator.add_source(Source::at([0.0, 0.0, -1.0])).unwrap();
    for step in 0..12 {
        let far = -1.0 - step as f32 / 11.0;
        let pose = Pose::at([0.0, 0.0, far]);
        simulator.place_source(id, pose).unwrap();
        let commit = simulator.commit();
        wait_until("a trace", || has_traces(&simulator, id, commit));
    }
    let middle = 0.5 * std::f32::consts::FRAC_1_SQRT_2;
    wait_until("the last place", || {
        let last = play(&mut mix, 4800);
        (loudest(&last) / middle - 1.0).abs() < 0.02
    });
}

/// Protects mixes with fewer places than sources: a much louder source takes the place of another one.
#[test]
fn the_louder_source_is_heard() {
    let mut simulator = simulator();
    let mut mix = simulator
        .mix(&EarsSpec::new(RATE_HZ).with_sources(1))
        .unwrap();
    let mut heard = |what: &str, wanted: SourceId| {
        wait_until(what, || {
            let (mut stereo, mut last) = ([0.0; 2], None);
            mix.process(&mut stereo, |id, _| last = Some(id));
            last == Some(wanted)
        });
    };
    let far = simulator.add_source(Source::at([0.0, 0.0, -20.0])).unwrap();
    simulator.commit();
    heard("the far source", far);
    let near = simulator.add_source(Source::at([0.0, 0.0, -2.0])).unwrap();
    simulator.commit();
    heard("the near source", near);
    simulator
        .place_source(far, Pose::at([0.0, 0.0, -1.9]))
        .unwrap();
    let commit = simulator.commit();
    wait_until("a trace", || has_traces(&simulator, far, commit));
    // Hardly louder: no change.
    heard("the same source", near);
    simulator.enable_source(near, false).unwrap();
    simulator.commit();
    heard("the other source", far);
}

/// Protects the reverberation: in a room, the sound goes on after the source has stopped, and its level falls by 60 dB
/// in the stated decay time, to 10 %.
#[test]
fn a_room_goes_on_to_sound() {
    let mut simulator = simulator();
    let source = Source::at([-2.0, 0.0, -1.5]);
    let listener = Listener::at([2.0, -0.3, 1.5], 0.3);
    let scene = Scene::shoebox([8.0, 3.0, 5.0], &[[0.15; 8]; 6], source, listener);
    let id = simulator.add_scene(&scene).unwrap().sources[0];
    let mut ears = simulator.ears(id, &EarsSpec::new(RATE_HZ)).unwrap();
    simulator.commit();
    wait_until("four traces", || {
        simulator.updates(id).is_some_and(|heard| heard.traces >= 4)
    });
    let decay_s = simulator.updates(id).unwrap().reverb.decay_s[5];
    let mut noise = vec![0.0; 48_000];
    Sound::parse("noise", RATE_HZ).unwrap().fill(&mut noise);
    let mut stereo = vec![0.0; 2 * noise.len()];
    let rms = |stereo: &[f32]| -> f64 {
        let squares = stereo.iter().map(|s| f64::from(*s).powi(2));
        (squares.sum::<f64>() / stereo.len() as f64).sqrt()
    };
    for _ in 0..2 {
        assert_no_alloc(|| ears.process(&noise, &mut stereo)).unwrap();
    }
    assert!(rms(&stereo[48_000..]) > 0.01);
    let silence = vec![0.0; noise.len()];
    assert_no_alloc(|| ears.process(&silence, &mut stereo)).unwrap();
    // From 0.1 to 0.1 s + half of the decay time.
    let window = 4800;
    let level = |seconds: f64| {
        let first = 2 * (seconds * f64::from(RATE_HZ)) as usize;
        20.0 * rms(&stereo[first..first + window]).log10()
    };
    let half_s = (0.5 * decay_s).min(0.7);
    let fall_db = level(0.1) - level(0.1 + half_s);
    let expected_db = 60.0 * half_s / decay_s;
    assert!(
        (fall_db / expected_db - 1.0).abs() < 0.1,
        "{fall_db} dB, not {expected_db}"
    );
}

/// Protects head trackers and surround sound: a turn of the head is complete within 20 ms of sound, without a commit and
/// without a click, in all formats; frames have the channels of the format.
#[test]
fn a_turn_of_the_head_is_heard_at_once() {
    let mut simulator = simulator();
    let id = simulator.add_source(Source::at([0.0, 0.0, -2.0])).unwrap();
    let order = echomarch::response::AmbisonicOrder::new(2).unwrap();
    // The channel of sound from ahead, and that of sound from the left, with their gains.
    let left_of_stereo = std::f32::consts::FRAC_1_SQRT_2;
    for (format, channels, ahead, left) in [
        (EarsFormat::Stereo, 2, (1, left_of_stereo), (0, 1.0)),
        (EarsFormat::Ambisonics(order), 9, (3, 1.0), (1, 1.0)),
        (EarsFormat::Surround51, 6, (2, 1.0), (4, 0.93)),
        (EarsFormat::Surround71, 8, (2, 1.0), (6, 1.0)),
    ] {
        let spec = EarsSpec::new(RATE_HZ).with_format(format);
        let mut ears = simulator.ears(id, &spec).unwrap();
        let head = simulator.head_tracker();
        assert_eq!(ears.channels(), channels);
        simulator.commit();
        let step = std::f32::consts::TAU * 200.0 / RATE_HZ as f32;
        let mut at = 0;
        let mut play = |turn: Quat, frames: usize| -> Vec<f32> {
            let mono: Vec<f32> = (at..at + frames).map(|i| (i as f32 * step).sin()).collect();
            at += frames;
            let mut out = vec![f32::NAN; channels * frames];
            assert_no_alloc(|| {
                head.turn(turn).unwrap();
                ears.process(&mono, &mut out).unwrap();
            });
            out
        };
        let of = |out: &[f32], channel: usize| -> Vec<f32> {
            out.iter()
                .skip(channel)
                .step_by(channels)
                .copied()
                .collect()
        };
        wait_until("sound", || loudest(&play(Quat::IDENTITY, 480)) > 0.0);
        play(Quat::IDENTITY, 9600);
        let before = play(Quat::IDENTITY, 4800);
        let level = loudest(&of(&before, ahead.0));
        assert!((level / (0.5 * ahead.1) - 1.0).abs() < 0.03, "{level}");
        // The head turns to the right, so that the source is to the left.
        let right = Quat::from_rotation_y(-std::f32::consts::FRAC_PI_2);
        let during = play(right, 960);
        let after = play(right, 4800);
        let level = loudest(&of(&after, left.0));
        assert!((level / (0.5 * left.1) - 1.0).abs() < 0.03, "{level}");
        for channel in 0..channels {
            let all = [&before[..], &during, &after].concat();
            assert!(largest_step(&of(&all, channel)) < 0.035 * 0.5, "{channel}");
        }
    }
}
