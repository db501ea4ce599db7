//! `echomarch view`: draws what the listener sees.

use super::impulse::pairs::first;
use super::numbers::{count, real};
use super::options::{Common, check_ending};
use super::print;
use super::scene::SceneAtTime;
use clap::Args;
use echomarch::internals::file_output::check_file;
use echomarch::picture::{ViewOptions, first_person, save_png};
use serde_json::json;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  echomarch view corner -o corner.png
  echomarch view open-pillars -o look.png --image-width 1920 --image-height 1080 --time 2.5";

/// Arguments of `view`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    #[command(flatten)]
    scene: SceneAtTime,
    /// The picture file to write
    #[arg(short, long, value_name = "FILE.png")]
    output: PathBuf,
    /// Width in pixels
    #[arg(long, default_value_t = 960, value_name = "PIXELS", value_parser = count::<u32>)]
    image_width: u32,
    /// Height in pixels
    #[arg(long, default_value_t = 540, value_name = "PIXELS", value_parser = count::<u32>)]
    image_height: u32,
    /// Vertical field of view
    #[arg(long, default_value_t = 70.0, value_name = "DEGREES", value_parser = real::<f32>)]
    fov: f32,
    /// Renamed to --image-width
    #[arg(long, hide = true, value_name = "PIXELS")]
    width: Option<String>,
    /// Renamed to --image-height
    #[arg(long, hide = true, value_name = "PIXELS")]
    height: Option<String>,
}

/// Runs the subcommand.
pub fn run(arguments: &Arguments, common: &Common) -> anyhow::Result<()> {
    check_ending(&arguments.output, "png")?;
    let scene = common.scene_at_time(&arguments.scene)?;
    check_file(&arguments.output)?;
    let context = common.context()?;
    let options = ViewOptions {
        width: arguments.image_width,
        height: arguments.image_height,
        field_of_view: arguments.fov.to_radians(),
    };
    let picture = first_person(&context, first(&scene)?, &options)?;
    common.warn_checked(&scene);
    save_png(&arguments.output, &picture)?;
    let output = arguments.output.display().to_string();
    if common.json {
        let renderer = context.renderer();
        let (width, height) = picture.dimensions();
        return print::json(&json!({
            "scene": scene.name, "renderer": renderer, "output": output,
            "width": width, "height": height,
        }));
    }
    print::line(&output)
}
