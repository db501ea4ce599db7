//! The command line, with one file per subcommand. Each subcommand parses its arguments, calls the library and prints
//! the result.
//!
//! Exit codes: 0 success, 1 failure, 2 invalid input. Results go to standard output (as JSON with `--json`). All other
//! output goes to standard error.

mod accuracy;
mod cost;
#[cfg(feature = "demo")]
mod demo;
mod doctor;
mod exit;
mod field_trial;
mod figures;
mod import;
mod impulse;
mod info;
#[cfg(unix)]
mod interrupt;
/// On systems without these signals, the system ends the program.
#[cfg(not(unix))]
mod interrupt {
    pub fn install() -> std::io::Result<()> {
        Ok(())
    }

    #[cfg(feature = "demo")]
    pub fn ask_from_now_on() {}

    #[cfg(feature = "demo")]
    pub fn is_asked() -> bool {
        false
    }

    pub fn asked() -> Option<u8> {
        None
    }
}
mod localise;
mod numbers;
mod option_hints;
mod options;
mod print;
mod refused_options;
mod render;
mod report;
mod scene;
mod shader;
mod shell;
mod slice;
mod study;
mod trace;
mod verify;
mod view;

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use std::process::ExitCode;

const EXAMPLES: &str = "\
Examples:
  echomarch demo                             the window: walk and listen
  echomarch figures -o out                   the thesis' four tables, CSV and plot
  echomarch accuracy -o out                  speed and error of each profile
  echomarch cost corner                      what each surface and option costs
  echomarch trace corner                     one frame of a built-in scene
  echomarch trace my.ron --waves 1048576 --json
  echomarch impulse whispering-gallery       the room's response: figures, early paths, -o a WAV
  echomarch render open-field -o out.wav     what the listener hears
  echomarch view corner -o view.png          what the listener sees
  echomarch slice corner --paths 200 -o plan.png
  echomarch shader corner                    the shader that is generated from a scene
  echomarch verify                           the hard cases, pass or fail
  echomarch study map.ron -o out             a sweep or a map of many points, here or on a cluster
  echomarch localise form -o form            where is the source? a form for people
  echomarch import level.glb -o level.ron    a scene of a triangle mesh
  echomarch info                             the renderers there are
  echomarch doctor                           what this machine has and lacks

Scenes: corner, obstacles, open-field, open-pillars, shoebox, whispering-gallery, parabolic-mirrors,
colonnade, cave, morphing-room, menger, glasshouse, or a file (.ron).";

/// The output without arguments. Each command takes a few seconds and needs no file.
const FIRST_VISIT: &str = "\
Echomarch traces sound through rooms and worlds of implicit surfaces. Three commands to try:

  echomarch impulse shoebox                  echoes of an empty room whose walls reflect all sound
  echomarch render open-pillars -o out.wav   the sound on a walk between pillars
  echomarch view menger -o view.png          a world made of one formula

echomarch doctor checks OpenGL, sound and memory of this machine. echomarch help lists all commands and scenes.";

/// Traces sound waves through signed distance functions on the GPU: Sjöberg's 2011
/// thesis as OpenGL fragment shaders.
#[derive(Debug, Parser)]
#[command(name = "echomarch", version, about, after_help = EXAMPLES)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    common: options::Common,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Open the window: walk through a scene and hear it
    #[cfg(feature = "demo")]
    Demo(demo::Arguments),
    /// Trace one frame: waves at the listener, panning and time
    Trace(trace::Arguments),
    /// Compute impulse responses: room acoustic figures, exact early paths, a WAV for convolution
    Impulse(impulse::Arguments),
    /// Render a WAV of what the listener hears
    Render(render::Arguments),
    /// Draw what the listener sees, with the distance function that the waves use
    View(view::Arguments),
    /// Draw the plan of the scene from above, optionally with the paths of waves
    Slice(slice::Arguments),
    /// Print a shader that is generated from a scene
    Shader(shader::Arguments),
    /// Repeat the performance experiment: figures 11.1 to 11.4 beside the thesis' own
    Figures(figures::Arguments),
    /// Compare speed and error of every profile and option with exact waves
    Accuracy(accuracy::Arguments),
    /// Measure the cost of each surface and option, and find what could be removed
    Cost(cost::Arguments),
    /// Run the hard cases: every profile compared with exact results
    Verify(verify::Arguments),
    /// Run the localisation experiment, with an observer model or with people
    Localise(localise::Arguments),
    /// Compute sweeps and maps of many points; shards can be interrupted, resumed and merged
    Study(study::Arguments),
    /// Check a triangle mesh (OBJ, glTF), and write a scene that uses it
    Import(import::Arguments),
    /// Try users' fields for another process of this program
    #[command(hide = true)]
    FieldTrial,
    /// List the version, all renderers regardless of --gl and --gpu, and their limits
    Info(info::Arguments),
    /// Check OpenGL and its speed, sound and memory; print the commands that install what is missing
    Doctor(doctor::Arguments),
    /// Print the completions of a shell
    #[command(hide = true)]
    Completions(shell::Completions),
    /// Print the man page of the program, or write the man pages of all commands
    #[command(hide = true)]
    Man(shell::Man),
}

fn main() -> ExitCode {
    let parsed = Cli::command()
        .try_get_matches()
        .and_then(|matches| Ok((Cli::from_arg_matches(&matches)?, matches)));
    let (cli, matches) = match parsed {
        Ok(parsed) => parsed,
        Err(mut error) => return exit::refuse_arguments(&mut error),
    };
    if let Err(error) = refused_options::check(&matches) {
        return exit::report(&error.into());
    }
    let Some(command) = &cli.command else {
        return match print::line(FIRST_VISIT) {
            Ok(()) => ExitCode::SUCCESS,
            Err(error) => exit::report(&error),
        };
    };
    if matches!(command, Command::FieldTrial) {
        return field_trial::answer(&cli.common);
    }
    if let Err(error) = interrupt::install() {
        print::tell(&format!("warning: cannot handle signals: {error}"));
    }
    field_trial::choose(&cli.common);
    let result = match command {
        #[cfg(feature = "demo")]
        Command::Demo(arguments) => demo::run(arguments, &cli.common),
        Command::Trace(arguments) => trace::run(arguments, &cli.common),
        Command::Impulse(arguments) => impulse::run(arguments, &cli.common),
        Command::Render(arguments) => render::run(arguments, &cli.common),
        Command::View(arguments) => view::run(arguments, &cli.common),
        Command::Slice(arguments) => slice::run(arguments, &cli.common),
        Command::Shader(arguments) => shader::run(arguments, &cli.common),
        Command::Figures(arguments) => figures::run(arguments, &cli.common),
        Command::Accuracy(arguments) => accuracy::run(arguments, &cli.common),
        Command::Cost(arguments) => cost::run(arguments, &cli.common),
        Command::Verify(arguments) => verify::run(arguments, &cli.common),
        Command::Localise(arguments) => localise::run(arguments, &cli.common),
        Command::Study(arguments) => study::run(arguments, &cli.common),
        Command::Import(arguments) => import::run(arguments, &cli.common),
        Command::Info(arguments) => info::run(arguments, &cli.common),
        Command::Doctor(arguments) => doctor::run(arguments, &cli.common),
        Command::Completions(arguments) => shell::completions(arguments, Cli::command()),
        Command::Man(arguments) => shell::man(arguments, Cli::command()),
        Command::FieldTrial => Ok(()),
    };
    let code = match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => exit::report(&error),
    };
    interrupt::asked().map_or(code, ExitCode::from)
}
