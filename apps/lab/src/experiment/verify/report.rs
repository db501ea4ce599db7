//! The results of the hard cases as plain data.

use super::rounding::{END_ROUNDING, LENGTH_ROUNDING, START_ROUNDING};
use crate::columns;
use crate::report::{Column, Document, Report, Row, Table, significant};
use echomarch::tracer::Profile;
use serde::Serialize;

/// The results of all cases that were run.
#[derive(Clone, Debug, Serialize)]
pub struct VerifyReport {
    /// Name of the renderer.
    pub renderer: String,
    /// The cases, in the order of [`all`](super::all).
    pub cases: Vec<CaseReport>,
}

/// One case with every profile.
#[derive(Clone, Debug, Serialize)]
pub struct CaseReport {
    /// The case's name.
    pub name: String,
    /// The difficulty, as text.
    pub hard: String,
    /// The exact answer, as text.
    pub exact: String,
    /// The bound, as text.
    pub bound: String,
    /// The results, in the order of [`Profile::ALL`].
    pub results: Vec<ProfileResult>,
}

/// The result of one profile.
#[derive(Clone, Debug, Default, Serialize)]
pub struct ProfileResult {
    /// Name of the profile.
    pub profile: String,
    /// Whether the profile meets all requirements of the case.
    pub passed: bool,
    /// Number of traced waves; 0 for input that must be rejected.
    pub waves: usize,
    /// Number of waves without a right answer: they hit other objects, or their end is outside the bound.
    pub off: usize,
    /// Number of wrong waves that are dead although the exact wave is not dead.
    pub lost: usize,
    /// Number of heard waves.
    pub heard: usize,
    /// Number of exact waves that are heard.
    pub heard_exactly: usize,
    /// Median distance in metres between the ends of the wrong waves and of the exact waves, over waves for which both
    /// ends exist.
    pub median_off: f64,
    /// Largest distance between a right wave and its nearest right answer, in metres.
    pub error: f64,
    /// The largest such distance as a share of the scene's extent.
    pub relative_error: f64,
    /// Number of states that contain a NaN or an infinite number.
    pub not_finite: usize,
    /// Number of waves that were inside a solid after some iteration.
    pub inside: usize,
    /// The largest depth inside a solid, in metres.
    pub deepest: f64,
    /// Number of marches that reached the step limit.
    pub step_limit_reached: u64,
    /// Largest difference between the length of a direction and 1.
    pub length_error: f64,
    /// Number of marches that ended at distance 0.
    pub zero_length_passes: u64,
    /// A note that does not affect the verdict.
    pub note: String,
}

impl ProfileResult {
    /// The verdict and its figures, as text.
    pub fn verdict(&self) -> String {
        let verdict = if self.passed { "ok" } else { "fails" };
        let mut all = vec![verdict.to_owned()];
        if self.off > 0 {
            let waves = plural(self.waves as u64, "wave");
            all.push(format!("{} of {waves} off", self.off));
        }
        if self.lost > 0 {
            all.push(format!("{} lost", self.lost));
        }
        if self.off > 0 && self.heard != self.heard_exactly {
            all.push(format!("{} heard of {}", self.heard, self.heard_exactly));
        }
        if self.median_off > 0.0 {
            all.push(format!("median {} m", short(self.median_off)));
        }
        if self.off == 0 && self.waves > 0 {
            all.push(format!("error {}", short(self.relative_error)));
        }
        if self.not_finite > 0 {
            all.push(plural(self.not_finite as u64, "NaN"));
        }
        if self.inside > 0 {
            let deepest = short(self.deepest);
            all.push(format!("{} in a solid, {deepest} m deep", self.inside));
        }
        if self.step_limit_reached > 0 {
            all.push(format!(
                "step limit reached {} times",
                self.step_limit_reached
            ));
        }
        if self.length_error > LENGTH_ROUNDING {
            all.push(format!("length off by {}", short(self.length_error)));
        }
        if !self.note.is_empty() {
            all.push(self.note.clone());
        }
        all.join(", ")
    }
}

impl CaseReport {
    /// The result of a profile.
    pub fn of(&self, profile: Profile) -> Option<&ProfileResult> {
        let name = profile.to_string();
        self.results.iter().find(|result| result.profile == name)
    }

    /// Whether `hybrid` and `march` pass the case. `thesis` need not pass.
    pub fn passed(&self) -> bool {
        [Profile::Hybrid, Profile::March]
            .iter()
            .all(|&profile| self.of(profile).is_some_and(|result| result.passed))
    }
}

impl VerifyReport {
    /// Number of cases that the given profile passes.
    pub fn passes(&self, profile: Profile) -> usize {
        let of = |case: &&CaseReport| case.of(profile).is_some_and(|result| result.passed);
        self.cases.iter().filter(of).count()
    }
}

fn plural(count: u64, noun: &str) -> String {
    let ending = if count == 1 { "" } else { "s" };
    format!("{count} {noun}{ending}")
}

fn short(value: f64) -> String {
    significant(value, 2)
}

impl Row for &CaseReport {
    fn columns() -> Vec<Column<Self>> {
        let verdict = |profile: Profile| {
            let name = profile.to_string();
            Column::new(&name, &name, move |case: &&CaseReport| {
                case.of(profile).map(ProfileResult::verdict)
            })
            .text()
        };
        let mut columns = columns! { case: &CaseReport;
            ("name", "case") => &case.name, text();
            ("hard", "what is hard") => &case.hard, text();
            ("exact", "exact") => &case.exact, text();
            ("bound", "bound") => &case.bound, text();
        };
        columns.extend(Profile::ALL.map(verdict));
        columns
    }
}

impl Report for VerifyReport {
    const NAME: &'static str = "verify";

    fn document(&self) -> Document {
        let mut document = Document::default();
        document.table(&self.cases);
        let passes = Profile::ALL.map(|profile| format!("{profile} {}", self.passes(profile)));
        document.paragraph(format!(
            "{}: of {} cases pass: {}.",
            self.renderer,
            self.cases.len(),
            passes.join(", ")
        ));
        document.paragraph(format!(
            "spread: within twice the effect that a start {START_ROUNDING:.1e} off (of the extent, and \
             in radians) has on the exact end, plus {END_ROUNDING:.1e} of the extent, plus one unit in \
             the last place of a world coordinate, which is the error of the read-back as f32. error: \
             the largest error of right waves, as a share of the extent or, if it is longer, of the \
             path. off: waves that hit other objects or end outside the bound; lost: waves that are \
             dead but should not be; heard of: heard waves out of those that should be heard; median: \
             median distance from the exact end."
        ));
        document
    }

    fn table(&self) -> Table {
        Table::of(&self.cases)
    }
}
