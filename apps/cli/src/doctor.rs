//! `echomarch doctor`: what this machine has, and how to install what it lacks.

use super::options::Common;
use super::print;
use anyhow::anyhow;
use clap::Args;
use echomarch::Tracer;
use echomarch::scene::Scene;
use echomarch::tracer::Settings;
use serde::Serialize;
use std::path::Path;

const EXAMPLES: &str = "\
Examples:
  echomarch doctor                           OpenGL and its speed, sound, memory
  echomarch doctor --gl osmesa
  echomarch doctor --json > machine.json";

/// Arguments of `doctor`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {}

/// One property of the machine.
#[derive(Serialize)]
struct Check {
    name: &'static str,
    /// Whether the machine has what the program needs.
    ok: bool,
    /// The property, or the reason why it cannot be used.
    found: String,
    /// The command that installs what is missing, or other advice.
    #[serde(skip_serializing_if = "Option::is_none")]
    advice: Option<String>,
}

impl Check {
    fn passed(name: &'static str, found: String) -> Check {
        Check {
            name,
            ok: true,
            found,
            advice: None,
        }
    }

    fn failed(name: &'static str, found: String, advice: String) -> Check {
        Check {
            name,
            ok: false,
            found,
            advice: Some(advice),
        }
    }
}

/// Number of timed frames. The median of this number is steady to a few per cent on an idle machine.
const TIMED_FRAMES: usize = 9;

/// Memory in bytes below which large scenes and many waves fail: a frame of 16,777,216 waves takes 1,280 MiB.
const LEAST_MEMORY: u64 = 2 << 30;

/// Runs the subcommand. Without OpenGL the exit code is 1. Sound is needed only by `demo`.
pub fn run(_: &Arguments, common: &Common) -> anyhow::Result<()> {
    let mut checks = opengl(common);
    let has_opengl = checks.iter().all(|check| check.ok);
    checks.push(sound());
    checks.push(memory());
    if common.json {
        print::json(&checks)?;
    } else {
        for check in &checks {
            print_check(check)?;
        }
    }
    match has_opengl {
        true => Ok(()),
        false => Err(anyhow!("tracing needs OpenGL")),
    }
}

fn print_check(check: &Check) -> anyhow::Result<()> {
    let state = if check.ok { "ok" } else { "missing" };
    print::line(&format!("{:8}{state:9}{}", check.name, check.found))?;
    match &check.advice {
        Some(advice) => print::line(&format!("{:17}{advice}", "")),
        None => Ok(()),
    }
}

/// The renderer, and its speed.
fn opengl(common: &Common) -> Vec<Check> {
    let opened = echomarch::gl::Context::headless(&common.context_options());
    let context = match opened {
        Ok(context) => context,
        Err(error) => {
            let advice = install(
                "libegl1 libegl-mesa0 libgl1-mesa-dri",
                "a driver with OpenGL 3.3 and EGL",
            );
            return vec![Check::failed("OpenGL", error.to_string(), advice)];
        }
    };
    let kind = if context.is_software() {
        "software"
    } else {
        "hardware"
    };
    let found = format!("{}, {} ({kind})", context.renderer(), context.version());
    let opengl = Check::passed("OpenGL", found);
    let speed = match Tracer::new(&context).and_then(|mut tracer| speed(&mut tracer)) {
        Ok(found) => Check::passed("speed", found),
        Err(error) => {
            let advice = "try --gl gles or --gl osmesa, or another driver".to_owned();
            Check::failed("speed", error.to_string(), advice)
        }
    };
    vec![opengl, speed]
}

/// The time of a frame in an empty room.
fn speed(tracer: &mut Tracer) -> Result<String, echomarch::Error> {
    let scene = Scene::builtin("shoebox")?;
    let settings = Settings::default();
    // The first frame compiles the shaders.
    tracer.frame(&scene, &settings)?;
    let mut milliseconds = Vec::new();
    for _ in 0..TIMED_FRAMES {
        milliseconds.push(tracer.frame(&scene, &settings)?.milliseconds.total);
    }
    let median = echomarch_lab::stats::median(milliseconds);
    let flights = f64::from(settings.waves) * f64::from(settings.iterations);
    Ok(format!(
        "{} waves of {} iterations in a room in {median:.1} ms: {:.0} million iterations per second",
        settings.waves,
        settings.iterations,
        flights / median / 1e3
    ))
}

#[cfg(feature = "audio")]
fn sound() -> Check {
    let devices = echomarch::audio::live::list_devices();
    let default = devices.iter().find(|device| device.default);
    match default.or(devices.first()) {
        Some(device) => Check::passed("sound", device.name.clone()),
        None => {
            let advice = install("libasound2 pulseaudio", "a sound server");
            let found = "no output device; only demo and examples/live need sound".to_owned();
            Check::failed("sound", found, advice)
        }
    }
}

#[cfg(not(feature = "audio"))]
fn sound() -> Check {
    let advice = "build the program with its feature audio".to_owned();
    Check::failed("sound", "not compiled in".to_owned(), advice)
}

fn memory() -> Check {
    const GIBIBYTE: f64 = (1_u64 << 30) as f64;
    let Some(available) = available_memory() else {
        return Check::passed("memory", "unknown on this system".to_owned());
    };
    let found = format!("{:.1} GiB available", available as f64 / GIBIBYTE);
    match available >= LEAST_MEMORY {
        true => Check::passed("memory", found),
        false => Check::failed(
            "memory",
            found,
            "use fewer waves: 80 bytes are needed for each".to_owned(),
        ),
    }
}

/// The memory in bytes that new programs can use; `None` if unknown.
#[cfg(target_os = "linux")]
fn available_memory() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = text
        .lines()
        .find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let kibibytes: u64 = line.split_whitespace().next()?.parse().ok()?;
    Some(kibibytes << 10)
}

#[cfg(not(target_os = "linux"))]
fn available_memory() -> Option<u64> {
    None
}

/// The command that installs Debian packages, or on other systems what to install.
fn install(packages: &str, otherwise: &str) -> String {
    match Path::new("/etc/debian_version").exists() {
        true => format!("sudo apt-get install {packages}"),
        false => format!("install {otherwise}"),
    }
}
