//! `echomarch shader`: the shader text generated from a scene.

use super::exit::BadInput;
use super::options::Common;
use super::print;
use clap::{Args, ValueEnum};
use echomarch::gl::header;
use echomarch::internals::file_output::{check_file, write_whole};
use echomarch::picture::{self, Kind};
use echomarch::scene::Scene;
use echomarch::tracer::{self, Directions, Pass, Profile, Settings};
use serde_json::json;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  echomarch shader corner
  echomarch shader my.ron --profile march --gl gles -o march.frag
  echomarch shader my.ron --pass view";

/// Arguments of `shader`.
#[derive(Args, Clone, Debug, PartialEq)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    /// Built-in scene or scene file
    scene: String,
    /// The shader to print
    #[arg(long, value_enum, default_value_t = Which::March, value_name = "NAME")]
    pass: Which,
    /// The algorithm: hybrid (closed form), march (accurate sphere tracing), thesis
    #[arg(long, default_value_t = Profile::Hybrid, value_name = "NAME")]
    profile: Profile,
    /// Start directions: random (the thesis), fibonacci (an even lattice)
    #[arg(long, default_value_t = Directions::Random, value_name = "NAME")]
    directions: Directions,
    /// Add code that counts evaluations of the distance function
    #[arg(long)]
    count_evaluations: bool,
    /// Write to a file
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

/// A shader of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Which {
    /// Initialises the waves at the source
    Initialise,
    /// Traces the waves through the scene
    March,
    /// Computes the contribution of each wave to left and right
    Pan,
    /// Draws the listener's view
    View,
    /// Draws the plan from above
    Slice,
}

/// Runs the subcommand. The subcommand opens no OpenGL context, because it only prints the text of the shader.
pub fn run(arguments: &Arguments, common: &Common) -> anyhow::Result<()> {
    let scene = common.scene(&arguments.scene)?;
    if let Some(path) = &arguments.output {
        check_file(path)?;
    }
    let text = header(common.gl).to_owned() + &body(arguments, &scene);
    check_effects(arguments, &scene)?;
    if let Some(path) = &arguments.output {
        write_whole(path, |out| out.write_all(text.as_bytes()))?;
        return print::line(&path.display().to_string());
    }
    if common.json {
        return print::json(&json!({ "scene": scene.name, "text": text }));
    }
    print::line(text.trim_end())
}

/// Rejects options that would not change the shader's text.
fn check_effects(arguments: &Arguments, scene: &Scene) -> Result<(), BadInput> {
    let usual = |change: fn(&mut Arguments)| {
        let mut usual = arguments.clone();
        change(&mut usual);
        usual
    };
    let options: [(&str, Arguments); 3] = [
        ("--profile", usual(|a| a.profile = Profile::Hybrid)),
        ("--directions", usual(|a| a.directions = Directions::Random)),
        (
            "--count-evaluations",
            usual(|a| a.count_evaluations = false),
        ),
    ];
    let text = body(arguments, scene);
    for (option, without) in options {
        if without != *arguments && body(&without, scene) == text {
            let text = format!("{option} changes nothing in this shader: omit it");
            return Err(BadInput(text));
        }
    }
    Ok(())
}

fn body(arguments: &Arguments, scene: &Scene) -> String {
    let settings = Settings::new(arguments.profile)
        .with_directions(arguments.directions)
        .with_count_evaluations(arguments.count_evaluations);
    let of_waves = |pass| tracer::shader_text(scene, &settings, pass);
    match arguments.pass {
        Which::Initialise => of_waves(Pass::Initialise),
        Which::March => of_waves(Pass::March),
        Which::Pan => of_waves(Pass::Pan),
        Which::View => picture::shader_text(scene, Kind::View),
        Which::Slice => picture::shader_text(scene, Kind::Slice),
    }
}
