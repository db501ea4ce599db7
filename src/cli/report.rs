//! What the experiments have in common on the command line: progress, files, print-out.

use super::options::Common;
use super::print;
use crate::output::{check_file, prepare_folder, write_whole};
use crate::trace::Tracer;
use anyhow::anyhow;
use serde::Serialize;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

type PlotError = Box<dyn std::error::Error + Send + Sync>;

/// One experiment: how its report becomes text, CSV and a plot.
pub struct Experiment<R> {
    /// Stem of the files.
    pub name: &'static str,
    /// What its progress is counted in.
    pub unit: &'static str,
    pub print: fn(&R) -> anyhow::Result<()>,
    pub write_csv: fn(&R, &mut dyn Write) -> io::Result<()>,
    pub plot_svg: fn(&R) -> Result<String, PlotError>,
}

impl<R: Serialize> Experiment<R> {
    /// Proves that the folder can be written to, runs the experiment with a progress bar,
    /// writes its files, and prints its report.
    pub fn run(
        &self,
        common: &Common,
        folder: Option<&Path>,
        work: impl FnOnce(&mut Tracer, &mut dyn FnMut(u64, u64)) -> Result<R, crate::Error>,
    ) -> anyhow::Result<()> {
        if let Some(folder) = folder {
            prepare_folder(folder)?;
            for ending in ["csv", "json", "svg"] {
                check_file(&self.file(folder, ending))?;
            }
        }
        let mut tracer = common.tracer()?;
        let bar = print::progress(common.quiet, 0, self.unit);
        let report = work(&mut tracer, &mut |done, total| {
            bar.set_length(total);
            bar.set_position(done);
        })?;
        bar.finish_and_clear();
        if let Some(folder) = folder {
            self.write_files(folder, &report)?;
        }
        if common.json {
            return print::json(&report);
        }
        (self.print)(&report)?;
        if let Some(folder) = folder {
            let (folder, name) = (folder.display(), self.name);
            print::line(&format!("\nwritten: {folder}/{name}.csv, .json, .svg"))?;
        }
        Ok(())
    }

    fn file(&self, folder: &Path, ending: &str) -> PathBuf {
        folder.join(format!("{}.{ending}", self.name))
    }

    fn write_files(&self, folder: &Path, report: &R) -> anyhow::Result<()> {
        let file = |ending: &str| self.file(folder, ending);
        write_whole(&file("csv"), |out| (self.write_csv)(report, out))?;
        write_whole(&file("json"), |out| {
            Ok(serde_json::to_writer_pretty(out, report)?)
        })?;
        let svg = (self.plot_svg)(report).map_err(|e| anyhow!("cannot draw the plot: {e}"))?;
        write_whole(&file("svg"), |out| out.write_all(svg.as_bytes()))?;
        Ok(())
    }
}
