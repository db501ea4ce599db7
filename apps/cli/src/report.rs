//! Common parts of the experiments on the command line: progress bar, files, printed reports.

use super::options::Common;
use super::print;
use anyhow::anyhow;
use echomarch::internals::file_output::{check_inside, prepare_folder, write_inside};
use echomarch::tracer::Tracer;
use echomarch_lab::report::Report;
use std::path::{Path, PathBuf};

/// Checks that the folder is writable, runs the experiment with a progress bar that counts `unit`, writes its files,
/// and prints its report.
pub fn run<R: Report>(
    common: &Common,
    folder: Option<&Path>,
    unit: &str,
    work: impl FnOnce(&mut Tracer, &mut dyn FnMut(u64, u64)) -> Result<R, echomarch::Error>,
) -> anyhow::Result<()> {
    if let Some(folder) = folder {
        check::<R>(folder)?;
    }
    let mut tracer = common.tracer()?;
    let report = with_progress(common, unit, |progress| work(&mut tracer, progress))?;
    write_and_print(common, folder, &report)
}

/// Runs a long job with a progress bar that counts `unit`.
pub fn with_progress<R, E>(
    common: &Common,
    unit: &str,
    work: impl FnOnce(&mut dyn FnMut(u64, u64)) -> Result<R, E>,
) -> Result<R, E> {
    let bar = print::progress(common.quiet, 0, unit);
    let done = work(&mut |done, total| {
        bar.set_length(total);
        bar.set_position(done);
    })?;
    bar.finish_and_clear();
    Ok(done)
}

/// Checks that all files of a report can be written.
pub fn check<R: Report>(folder: &Path) -> anyhow::Result<()> {
    prepare_folder(folder)?;
    for ending in endings::<R>() {
        check_inside(&file::<R>(folder, ending))?;
    }
    Ok(())
}

/// Writes the files of a report if a folder is given, and prints the report.
pub fn write_and_print<R: Report>(
    common: &Common,
    folder: Option<&Path>,
    report: &R,
) -> anyhow::Result<()> {
    if let Some(folder) = folder {
        write_files(folder, report)?;
    }
    print_report(common, report)?;
    match folder {
        Some(folder) if !common.json => {
            let first = file::<R>(folder, "csv");
            let others = endings::<R>()[1..].join(", .");
            print::line(&format!("\nwritten: {}, .{others}", first.display()))
        }
        _ => Ok(()),
    }
}

/// Prints a report, as JSON if requested.
pub fn print_report<R: Report>(common: &Common, report: &R) -> anyhow::Result<()> {
    match common.json {
        true => print::json(report),
        false => print::line(&report.document().terminal()),
    }
}

/// The file name extensions of a report's files. The first is that of the table.
fn endings<R: Report>() -> &'static [&'static str] {
    match R::HAS_PLOT {
        true => &["csv", "json", "md", "svg"],
        false => &["csv", "json", "md"],
    }
}

fn file<R: Report>(folder: &Path, ending: &str) -> PathBuf {
    folder.join(format!("{}.{ending}", R::NAME))
}

fn write_files<R: Report>(folder: &Path, report: &R) -> anyhow::Result<()> {
    let file = |ending: &str| file::<R>(folder, ending);
    let mut text = report.document().markdown();
    if R::HAS_PLOT {
        text += &format!("\n![{0}]({0}.svg)\n", R::NAME);
        let svg = report.plot_svg();
        let svg = svg.map_err(|error| anyhow!("cannot draw the plot: {error}"))?;
        write_inside(&file("svg"), |out| out.write_all(svg.as_bytes()))?;
    }
    write_inside(&file("csv"), |out| report.table().write_csv(out))?;
    write_inside(&file("json"), |out| {
        Ok(serde_json::to_writer_pretty(out, report)?)
    })?;
    write_inside(&file("md"), |out| out.write_all(text.as_bytes()))?;
    Ok(())
}
