//! The conclusions of the report, as sentences.

use super::change::Change;
use super::surfaces::{SurfaceRow, Verdict};
use super::{CostReport, OptionRow};

/// Noise of the number of heard waves, in percent, above which it hides audible changes.
const MUCH_NOISE: f64 = 5.0;

pub(super) fn sentences(report: &CostReport) -> Vec<String> {
    if report.noise.heard <= 0.0 {
        return vec![
            "Nothing is heard in the complete scene, so the report cannot tell which surfaces can be left out; \
             the times are valid."
                .to_owned(),
        ];
    }
    let mut all = vec![of_surfaces(report)];
    all.extend(of_options(report));
    if report.noise.heard_percent > MUCH_NOISE {
        all.push(format!(
            "Only {:.0} waves are heard (another seed changes this by {:.0} %): use more --waves for a \
             clearer result.",
            report.noise.heard, report.noise.heard_percent
        ));
    }
    all
}

fn saved_of_frame(row: &SurfaceRow) -> f64 {
    let beyond = row.total.filter(|total| total.beyond_noise);
    beyond.map_or(0.0, |total| total.saved_percent)
}

fn of_surfaces(report: &CostReport) -> String {
    let spare = |row: &&SurfaceRow| row.verdict == Verdict::CanBeLeftOut;
    let spares: Vec<&SurfaceRow> = report.surfaces.iter().filter(spare).collect();
    let by_saved =
        |a: &&SurfaceRow, b: &&SurfaceRow| saved_of_frame(a).total_cmp(&saved_of_frame(b));
    if let Some(best) = spares.iter().copied().max_by(by_saved) {
        let saved = saved_of_frame(best);
        let takes = match saved > 0.0 {
            true => format!("takes {saved:.0} % of a frame"),
            false => "takes no time that could be measured".to_owned(),
        };
        let met = match best.met {
            0 => ", no wave meets it".to_owned(),
            _ => String::new(),
        };
        let more = match spares.len() {
            1 => String::new(),
            count => format!(
                " {} more can be left out as well, one at a time.",
                count - 1
            ),
        };
        return format!(
            "{} {takes}{met}, and leaving it out changes nothing beyond noise.{more}",
            capitalised(&best.name)
        );
    }
    let heard = |row: &&SurfaceRow| row.verdict == Verdict::IsHeard;
    match report.surfaces.iter().filter(heard).max_by(by_saved) {
        Some(dearest) if saved_of_frame(dearest) > 0.0 => format!(
            "No surface can be left out without an audible change. The most expensive is {}: \
             {:.0} % of a frame; {}.",
            dearest.name,
            saved_of_frame(dearest),
            dearest.change.map_or(String::new(), in_words)
        ),
        Some(_) => "No surface can be left out without an audible change, and none saves a \
                    measurable time."
            .to_owned(),
        None => "The scene has only this surface, so it cannot be left out.".to_owned(),
    }
}

/// Returns the name with a capital first letter, for the beginning of a sentence.
fn capitalised(name: &str) -> String {
    let mut letters = name.chars();
    let first = letters.next().map(|c| c.to_ascii_uppercase());
    first.into_iter().chain(letters).collect()
}

fn in_words(change: Change) -> String {
    format!(
        "without it {:+.1} % of the waves are heard, and the pan moves by {:+.3}",
        change.heard_percent.mean, change.pan.mean
    )
}

/// Returns a sentence about the options that save time without an audible change; `None` if there are none.
fn of_options(report: &CostReport) -> Option<String> {
    let saves =
        |row: &&OptionRow| row.within_noise && row.total.beyond_noise && row.total.saved_ms > 0.0;
    let mut saving: Vec<&OptionRow> = report.options.iter().filter(saves).collect();
    saving.sort_by(|a, b| b.total.saved_percent.total_cmp(&a.total.saved_percent));
    if saving.is_empty() {
        return None;
    }
    let told: Vec<String> = saving
        .iter()
        .map(|row| format!("{} ({:.0} %)", row.name, row.total.saved_percent))
        .collect();
    Some(format!(
        "Options that save time without an audible change (percent of a frame): {}.",
        told.join(", ")
    ))
}
