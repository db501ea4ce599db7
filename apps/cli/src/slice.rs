//! `echomarch slice`: the plan from above.

use super::impulse::pairs::first;
use super::numbers::{count, real};
use super::options::{Common, TraceOptions, check_ending, check_range};
use super::print;
use super::scene::SceneAtTime;
use clap::Args;
use echomarch::internals::file_output::check_file;
use echomarch::picture::{SliceOptions, save_png, slice};
use echomarch::tracer::HeardPaths;
use serde_json::json;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  echomarch slice obstacles -o plan.png
  echomarch slice corner -o paths.png --paths 300 --iterations 4
  echomarch slice cave -o heard.png --heard-paths 20";

const LEGEND: &str = "\
The picture: solid filled, air white with faint lines of equal distance; the source a dot, the
listener a circle with an arrow along its gaze, key-framed paths dashed, a scale bar. Paths of
waves: orange heard, grey travelling, green dead (a fading stub).
They are drawn wherever they are in height, so one may end inside the circle: above or below
the cut.";

/// Arguments of `slice`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES, after_long_help = format!("{LEGEND}\n\n{EXAMPLES}"))]
pub struct Arguments {
    #[command(flatten)]
    scene: SceneAtTime,
    /// The picture file to write
    #[arg(short, long, value_name = "FILE.png")]
    output: PathBuf,
    /// Width in pixels; the scene determines the height
    #[arg(long, default_value_t = 800, value_name = "PIXELS", value_parser = count::<u32>)]
    image_width: u32,
    /// Height of the cut above the world's origin [default: height of the listener]
    #[arg(long, value_name = "METRES", allow_hyphen_values = true, value_parser = real::<f32>)]
    cut_height: Option<f32>,
    /// Number of waves whose paths are drawn
    #[arg(long, default_value_t = 0, value_name = "N", value_parser = count::<u32>)]
    paths: u32,
    /// Number of waves that reach the listener whose paths are drawn: traces --waves waves (4096 to 262144), then waves
    /// of the next seeds, until enough are found (at most about 4194304 waves)
    #[arg(long, default_value_t = 0, value_name = "N", value_parser = count::<u32>)]
    heard_paths: u32,
    #[command(flatten)]
    options: TraceOptions,
    /// Renamed to --image-width
    #[arg(long, hide = true, value_name = "PIXELS")]
    width: Option<String>,
    /// Renamed to --cut-height
    #[arg(long, hide = true, value_name = "METRES", allow_hyphen_values = true)]
    height: Option<String>,
}

/// Runs the subcommand.
pub fn run(arguments: &Arguments, common: &Common) -> anyhow::Result<()> {
    let settings = arguments.options.settings()?;
    check_paths("--paths", arguments.paths, settings.iterations)?;
    check_paths("--heard-paths", arguments.heard_paths, settings.iterations)?;
    check_ending(&arguments.output, "png")?;
    let scene = common.scene_at_time(&arguments.scene)?;
    check_file(&arguments.output)?;
    let mut tracer = common.tracer()?;
    let wanted = arguments.heard_paths as usize;
    let mut searched = settings.clone();
    searched.waves = searched.waves.max(LEAST_SEARCHED);
    let found = tracer.heard_paths(first(&scene)?, &searched, wanted, MOST_TRACED)?;
    tell_missing(&found, wanted, common);
    let counts = (found.count(), found.traced);
    let options = SliceOptions {
        width: arguments.image_width,
        height: arguments.cut_height,
        paths: arguments.paths,
        also: found.paths,
        settings,
        ..SliceOptions::default()
    };
    let picture = slice(&mut tracer, first(&scene)?, &options)?;
    common.warn_checked(&scene);
    save_png(&arguments.output, &picture)?;
    let output = arguments.output.display().to_string();
    if common.json {
        let renderer = tracer.context().renderer();
        let (width, height) = picture.dimensions();
        return print::json(&json!({
            "scene": scene.name, "renderer": renderer, "output": output,
            "width": width, "height": height, "paths": arguments.paths,
            "heard_paths": counts.0, "traced_for_heard_paths": counts.1,
        }));
    }
    print::line(&output)
}

/// Minimum number of waves in one frame of the search for heard waves. A smaller frame takes equally long.
const LEAST_SEARCHED: u32 = 4096;

/// Maximum number of waves traced in the search for heard waves. Without a graphics card, this search takes half a
/// minute.
const MOST_TRACED: u64 = 1 << 22;

/// Prints a note if fewer heard waves were found than requested.
fn tell_missing(found: &HeardPaths, wanted: usize, common: &Common) {
    let count = found.count();
    if count < wanted {
        common.note(&format!(
            "note: only {count} of {wanted} heard paths found: no further wave of the {} traced reached the listener",
            found.traced
        ));
    }
}

/// Rejects too many path points. All points are kept in memory, and the picture is unreadable with too many paths.
fn check_paths(option: &str, paths: u32, iterations: u32) -> anyhow::Result<()> {
    const MOST_POINTS: f64 = 1e7;
    check_range(option, f64::from(paths), 0.0, 100_000.0)?;
    let points = f64::from(paths) * (f64::from(iterations) + 1.0);
    check_range(
        &format!("{option} times --iterations"),
        points,
        0.0,
        MOST_POINTS,
    )?;
    Ok(())
}
