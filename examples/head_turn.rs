//! Measures how long a turn of the head takes until it is heard. A tone stands to the left; the head turns by 180°, so
//! that the tone is louder in the other channel, and the program records what the sound card plays. For comparison, the
//! callback exchanges both channels itself: that is the latency of the sound card and of the recording alone.
//!
//! The default input must record the default output, as the monitor of a null sink of PulseAudio does:
//!
//! ```sh
//! pactl load-module module-null-sink rate=48000 channels=2
//! cargo run --release --features live,simulator --example head_turn [TURNS]
//! ```

use cpal::traits::{DeviceTrait, HostTrait, StreamTrait};
use cpal::{BufferSize, Stream, StreamConfig};
use echomarch::simulator::{EarsSpec, Mix, Simulator, SimulatorSettings};
use echomarch::{Source, glam::Quat};
use std::error::Error;
use std::f32::consts::{PI, TAU};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

const RATE_HZ: u32 = 48_000;

/// Frames of a block of the sound card.
const BLOCK: u32 = 256;

/// Frequency of the tone: a window of one period has a constant level.
const TONE_HZ: u32 = 1000;
const WINDOW: usize = (RATE_HZ / TONE_HZ) as usize;

/// Least level of a window with sound, as a mean square.
const AUDIBLE: f32 = 1e-4;

/// Recorded frames, and the time at which their last one was received.
type Recorded = Vec<(Instant, Vec<[f32; 2]>)>;

/// A change of the louder channel.
struct Change {
    requested: Instant,
    /// Whether the head turned; otherwise the callback exchanged the channels.
    by_head: bool,
}

fn config() -> StreamConfig {
    StreamConfig {
        channels: 2,
        sample_rate: RATE_HZ,
        buffer_size: BufferSize::Fixed(BLOCK),
    }
}

fn fail(error: cpal::Error) {
    eprintln!("the sound card failed: {error}");
}

/// Plays the mix of a tone, with its channels exchanged while `exchanged` is set.
fn play(mut mix: Mix, exchanged: Arc<AtomicBool>) -> Result<Stream, Box<dyn Error>> {
    let device = cpal::default_host().default_output_device();
    let device = device.ok_or("there is no output device")?;
    let mut at = 0_u32;
    let fill = move |out: &mut [f32], _: &_| {
        mix.process(out, |_, mono| {
            for sample in mono {
                *sample = 0.5 * (TAU * at as f32 / WINDOW as f32).sin();
                at = (at + 1) % WINDOW as u32;
            }
        });
        if exchanged.load(Ordering::Relaxed) {
            out.as_chunks_mut::<2>()
                .0
                .iter_mut()
                .for_each(|pair| pair.reverse());
        }
    };
    let stream = device.build_output_stream(config(), fill, fail, None)?;
    stream.play()?;
    Ok(stream)
}

fn record(recorded: Arc<Mutex<Recorded>>) -> Result<Stream, Box<dyn Error>> {
    let device = cpal::default_host().default_input_device();
    let device = device.ok_or("there is no input device")?;
    let take = move |samples: &[f32], _: &_| {
        let block = (Instant::now(), samples.as_chunks::<2>().0.to_vec());
        recorded
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .push(block);
    };
    let stream = device.build_input_stream(config(), take, fail, None)?;
    stream.play()?;
    Ok(stream)
}

/// The times at which the other channel became louder.
fn exchanges(recorded: &Recorded) -> Vec<Instant> {
    let frame_s = 1.0 / f64::from(RATE_HZ);
    let frames: Vec<(Instant, [f32; 2])> = recorded
        .iter()
        .flat_map(|(end, frames)| {
            let time =
                |index| *end - Duration::from_secs_f64((frames.len() - index) as f64 * frame_s);
            frames
                .iter()
                .enumerate()
                .map(move |(index, frame)| (time(index), *frame))
        })
        .collect();
    let mut found = Vec::new();
    let mut was_left = None;
    for window in frames.windows(WINDOW) {
        let level = |channel: usize| {
            let squares = window.iter().map(|(_, frame)| frame[channel].powi(2));
            squares.sum::<f32>() / WINDOW as f32
        };
        let (left, right) = (level(0), level(1));
        if left.max(right) < AUDIBLE {
            continue;
        }
        let is_left = left > right;
        if was_left.is_some_and(|was_left| was_left != is_left) {
            found.push(window[WINDOW - 1].0);
        }
        was_left = Some(is_left);
    }
    found
}

fn summary(name: &str, mut latencies_ms: Vec<f64>) {
    latencies_ms.sort_by(f64::total_cmp);
    let at = |share: f64| {
        let last = latencies_ms.len().saturating_sub(1);
        latencies_ms
            .get((share * last as f64) as usize)
            .copied()
            .unwrap_or(f64::NAN)
    };
    println!(
        "{name:<24} {:3} heard: median {:6.1} ms, 90 % {:6.1} ms, maximum {:6.1} ms",
        latencies_ms.len(),
        at(0.5),
        at(0.9),
        at(1.0)
    );
}

fn main() -> Result<(), Box<dyn Error>> {
    let turns = std::env::args()
        .nth(1)
        .map_or(Ok(50), |text| text.parse())?;
    let mut simulator = Simulator::new(SimulatorSettings::default())?;
    simulator.add_source(Source::at([-2.0, 0.0, 0.0]))?;
    let mix = simulator.mix(&EarsSpec::new(RATE_HZ).with_sources(1))?;
    simulator.commit();
    let exchanged = Arc::new(AtomicBool::new(false));
    let recorded = Arc::new(Mutex::new(Recorded::new()));
    let _playing = play(mix, Arc::clone(&exchanged))?;
    let _recording = record(Arc::clone(&recorded))?;
    thread::sleep(Duration::from_secs(2));
    let head = simulator.head_tracker();
    let mut changes = Vec::new();
    let mut is_turned = false;
    for turn in 0..2 * turns {
        let by_head = turn % 2 == 0;
        let requested = Instant::now();
        if by_head {
            is_turned = !is_turned;
            head.turn(Quat::from_rotation_y(if is_turned { PI } else { 0.0 }))?;
        } else {
            exchanged.fetch_xor(true, Ordering::Relaxed);
        }
        changes.push(Change { requested, by_head });
        // The pauses fall on all phases of the blocks.
        thread::sleep(Duration::from_micros(250_000 + 1370 * (turn % 17)));
    }
    let recorded = recorded.lock().unwrap_or_else(PoisonError::into_inner);
    let heard = exchanges(&recorded);
    for (name, by_head) in [("turn of the head", true), ("exchange of channels", false)] {
        let ends = changes
            .iter()
            .skip(1)
            .map(|next| Some(next.requested))
            .chain([None]);
        let of_kind = changes
            .iter()
            .zip(ends)
            .filter(|(change, _)| change.by_head == by_head);
        // A change that is not heard before the next one is lost.
        let latency_ms = |(change, end): (&Change, Option<Instant>)| {
            let next = *heard.iter().find(|at| **at > change.requested)?;
            let is_own = end.is_none_or(|end| next < end);
            is_own.then(|| 1e3 * (next - change.requested).as_secs_f64())
        };
        summary(name, of_kind.filter_map(latency_ms).collect());
    }
    Ok(())
}
