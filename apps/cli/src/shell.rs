//! `echomarch completions` and `echomarch man`: files for shells and manuals, for packages of the program.

use super::exit::BadInput;
use super::print;
use clap::{Args, Command};
use clap_complete::Shell;
use clap_mangen::Man as ManPage;
use echomarch::internals::file_output::{check_file, prepare_folder, write_whole};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// The name of the program in its manuals and completions.
const NAME: &str = "echomarch";

/// Arguments of `completions`.
#[derive(Args, Debug)]
#[command(
    after_help = "Examples:\n  echomarch completions bash > ~/.local/share/bash-completion/completions/echomarch"
)]
pub struct Completions {
    /// The shell: bash, elvish, fish, powershell or zsh
    shell: Shell,
}

/// Arguments of `man`.
#[derive(Args, Debug)]
#[command(after_help = "Examples:\n  echomarch man | man -l -\n  echomarch man -o man1")]
pub struct Man {
    /// Write a page for each command into this folder: echomarch.1, echomarch-trace.1 and so on
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
}

/// Prints the completions of a shell.
pub fn completions(arguments: &Completions, mut program: Command) -> anyhow::Result<()> {
    let mut text = Vec::new();
    clap_complete::generate(arguments.shell, &mut program, NAME, &mut text);
    to_stdout(&text)
}

/// Prints the man page of the program, or writes those of all commands.
pub fn man(arguments: &Man, program: Command) -> anyhow::Result<()> {
    let Some(folder) = &arguments.output else {
        return to_stdout(&page(program)?);
    };
    prepare_folder(folder)?;
    // Building the program adds the common options to each command.
    let mut program = program.disable_help_subcommand(true);
    program.build();
    let commands = program
        .get_subcommands()
        .filter(|command| !command.is_hide_set());
    for command in commands {
        let name = format!("{NAME}-{}", command.get_name());
        // clap keeps names for the whole run of a program.
        let name: &'static str = Box::leak(name.into_boxed_str());
        write_page(folder, name, command.clone().name(name).display_name(name))?;
    }
    write_page(folder, NAME, program)
}

fn write_page(folder: &Path, name: &str, command: Command) -> anyhow::Result<()> {
    let file = folder.join(format!("{name}.1"));
    check_file(&file)?;
    let text = page(command)?;
    Ok(write_whole(&file, |out| out.write_all(&text))?)
}

/// The text of a man page.
fn page(command: Command) -> anyhow::Result<Vec<u8>> {
    let mut text = Vec::new();
    let rendered = ManPage::new(command).render(&mut text);
    rendered.map_err(|error| BadInput(format!("cannot write the man page: {error}")))?;
    Ok(text)
}

fn to_stdout(text: &[u8]) -> anyhow::Result<()> {
    let mut out = io::stdout();
    out.write_all(text)
        .and_then(|()| out.flush())
        .map_err(print::unwritten)
}
