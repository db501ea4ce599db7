//! `echomarch verify`: runs the hard cases.

use super::exit::BadInput;
use super::options::Common;
use super::report::{print_report, with_progress};
use anyhow::bail;
use clap::Args;
use echomarch_lab::experiment::verify::{self, Case};

const EXAMPLES: &str = "\
Examples:
  echomarch verify                           every hard case, as a table
  echomarch verify --case convex-vertex --case grazing-89.99
  echomarch verify --case sinai              all cases whose names begin with sinai
  echomarch verify --json > verify.json

Exit code: 0 if hybrid and march pass every case, else 1. The thesis' profile fails many,
which is shown and does not count.";

/// Arguments of `verify`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    /// Run only the case with this name, or all cases whose names begin with it
    #[arg(long = "case", value_name = "NAME")]
    cases: Vec<String>,
}

/// Runs the subcommand.
pub fn run(arguments: &Arguments, common: &Common) -> anyhow::Result<()> {
    let cases = chosen(&arguments.cases)?;
    let mut tracer = common.tracer()?;
    let report = with_progress(common, "cases", |progress| {
        verify::run(&mut tracer, &cases, progress)
    })?;
    print_report(common, &report)?;
    let failed: Vec<&str> = report
        .cases
        .iter()
        .filter(|case| !case.passed())
        .map(|case| case.name.as_str())
        .collect();
    if !failed.is_empty() {
        bail!("hybrid or march fails: {}", failed.join(", "));
    }
    Ok(())
}

/// Returns the case with exactly this name, or otherwise the cases whose names begin with it.
fn chosen(names: &[String]) -> Result<Vec<Case>, BadInput> {
    let all = verify::all();
    if names.is_empty() {
        return Ok(all);
    }
    if names.iter().any(String::is_empty) {
        return Err(BadInput("--case needs the name of a case".to_owned()));
    }
    for name in names {
        if !all.iter().any(|case| case.name.starts_with(name)) {
            return Err(BadInput(no_such_case(name, &all)));
        }
    }
    let exact = |name: &String| all.iter().any(|case| case.name == *name);
    let wanted = |case: &Case| {
        names.iter().any(|name| {
            case.name == *name || (!exact(name) && case.name.starts_with(name.as_str()))
        })
    };
    let chosen = all.iter().filter(|case| wanted(case)).cloned();
    Ok(chosen.collect())
}

/// The error for an unknown name, with the most similar names.
fn no_such_case(name: &str, all: &[Case]) -> String {
    /// Maximum number of names printed, so that they fit on one line.
    const TOLD: usize = 5;
    let mut known: Vec<&str> = all.iter().map(|case| case.name.as_str()).collect();
    let typed = name.to_lowercase();
    let likeness = |known: &str| strsim::jaro_winkler(known, &typed);
    known.sort_by(|a, b| likeness(b).total_cmp(&likeness(a)));
    let nearest = known[..TOLD.min(known.len())].join(", ");
    let count = all.len();
    format!("there is no case {name:?} among the {count}; the nearest are {nearest}")
}
