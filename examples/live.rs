//! Plays a sound that moves from left to right on a sound device:
//!
//! ```sh
//! cargo run --release --features live --example live -- --sound speech --seconds 10
//! ```

use echomarch::audio::live::{Live, LiveOptions, list_devices};
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::{Duration, Instant};

const USAGE: &str = "\
usage: live [--sound SOUND] [--seconds N] [--steps N] [--device NAME] [--buffer FRAMES]
            [--law LAW] [--record FILE.wav] [--list-devices]

  --sound SOUND    sine:HERTZ, noise, speech, or a WAV file [default: speech]
  --seconds N      duration [default: 10]
  --steps N        stop at N positions instead of moving continuously
  --device NAME    an output device from --list-devices
  --buffer FRAMES  number of frames per request of the device [default: 1024]
  --law LAW        linear or constant-power [default: constant-power]
  --record FILE    write the played sound to a file";

type Failure = Box<dyn std::error::Error>;

struct Arguments {
    sound: String,
    seconds: f64,
    steps: Option<u32>,
    record: Option<PathBuf>,
    options: LiveOptions,
}

fn main() -> ExitCode {
    match read_arguments().and_then(|arguments| arguments.map_or(Ok(()), play)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn play(arguments: Arguments) -> Result<(), Failure> {
    let live = Live::start(arguments.sound.parse()?, arguments.options);
    if let Some(path) = &arguments.record {
        live.start_recording(path)?;
    }
    let start = Instant::now();
    let mut next_line = 0.0;
    loop {
        let time = start.elapsed().as_secs_f64();
        if time >= arguments.seconds {
            break;
        }
        let along = place(time / arguments.seconds, arguments.steps);
        // Left and right sums, as a tracer returns them.
        live.set_panning(1.0 - along, along);
        if time >= next_line {
            next_line += 0.25;
            print_line(&live, time, along);
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    print_line(&live, arguments.seconds, 1.0);
    if arguments.record.is_some() {
        let frames = live.stop_recording()?;
        let dropped = live.status().dropped_frames;
        println!("recorded {frames} frames, dropped {dropped}");
    }
    Ok(())
}

/// The position of the sound, from 0 (left) to 1 (right).
fn place(along: f64, steps: Option<u32>) -> f64 {
    match steps {
        Some(steps) if steps > 1 => {
            let last = f64::from(steps - 1);
            (along * f64::from(steps)).floor().min(last) / last
        }
        _ => along,
    }
}

fn print_line(live: &Live, time: f64, along: f64) {
    let status = live.status();
    let [left, right] = live.levels();
    let latency = status
        .latency_ms
        .map_or_else(|| "?".to_owned(), |ms| format!("{ms:.1}"));
    println!(
        "{time:6.2} s: pan {:+.2}, levels {left:.3} {right:.3}, device {}, {} Hz, buffer {}, \
         latency {latency} ms, under-runs {}, late {}, restarts {}{}",
        2.0 * along - 1.0,
        status.device.as_deref().unwrap_or("none"),
        status.sample_rate,
        status.buffer_frames,
        status.under_runs,
        status.late_callbacks,
        status.restarts,
        status
            .last_error
            .map_or_else(String::new, |error| format!(", last error: {error}")),
    );
}

/// Returns `None` if the program has nothing to play, for example after `--help`.
fn read_arguments() -> Result<Option<Arguments>, Failure> {
    let mut arguments = Arguments {
        sound: "speech".to_owned(),
        seconds: 10.0,
        steps: None,
        record: None,
        options: LiveOptions::default(),
    };
    let mut words = std::env::args().skip(1);
    while let Some(flag) = words.next() {
        if flag == "--list-devices" {
            print_devices();
            return Ok(None);
        }
        if flag == "--help" {
            println!("{USAGE}");
            return Ok(None);
        }
        let value = words.next().ok_or(USAGE)?;
        match flag.as_str() {
            "--sound" => arguments.sound = value,
            "--seconds" => arguments.seconds = value.parse()?,
            "--steps" => arguments.steps = Some(value.parse()?),
            "--record" => arguments.record = Some(value.into()),
            "--device" => arguments.options.device = Some(value),
            "--buffer" => arguments.options.buffer_frames = value.parse()?,
            "--law" => arguments.options.law = value.parse()?,
            _ => return Err(USAGE.into()),
        }
    }
    Ok(Some(arguments))
}

fn print_devices() {
    let devices = list_devices();
    if devices.is_empty() {
        println!("no sound devices");
    }
    for device in devices {
        println!(
            "{}{} ({}): {} channels, {} to {} Hz",
            if device.default { "* " } else { "  " },
            device.name,
            device.id,
            device.channels,
            device.rates.start(),
            device.rates.end(),
        );
    }
}
