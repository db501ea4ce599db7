//! The report as a document for people.

use super::columns::Line;
use super::recommend::ITERATIONS as COMPARED_ITERATIONS;
use super::report::{AccuracyReport, Chaos, Limit, Recommendation, SceneReport, Slope};
use super::{SurfaceCounts, plot::plot_svg};
use crate::report::{Document, PlotError, Report, Table, significant};

const LEGEND: &str = "\
    frame: median time of a frame. M/s: millions of waves × iterations per second. eval/flight: \
    distance evaluations per flight of a wave. In hybrid and march they count the evaluations of \
    each marched field, without those for the normal at the end; with surfaces in cells, those of \
    the fields in the cell. status, sequence: share of the compared waves whose final status, or \
    whose sequence of surfaces, differs from that of the exact waves. end: distance from the exact \
    wave's end in metres (median, 99 %, maximum); within: the same (99 %, maximum) for waves within \
    the horizon of chaos. Hits: heard waves minus heard exact waves, by order of reflection, \
    without waves that thesis hears after they died. limit bias: the mean minus the limit of many \
    waves; twin bias: the mean minus the exact panning of the same start directions; ± twin: its \
    standard error; spread: standard deviation over the seeds; rms: root of the mean square error \
    relative to the limit, MSE = (mean − limit)² + spread²; efficiency: 1 / (MSE × seconds).";

const SAMPLED: &str = "the exact waves are traced in samples of a user's field: the errors below include those of the samples";

const RESPONSES: &str = "\
    Compared with image sources, in a room of 8 × 3 × 5 m whose walls absorb 0.1 to 0.43 by band: the \
    largest error of the bands that have the figure. Just noticeable differences are 5 % for T30 and \
    EDT, and 1 dB for C80 and G.";

impl AccuracyReport {
    fn lines<'a>(&'a self, scene: &'a SceneReport) -> impl Iterator<Item = Line<'a>> {
        scene.rows.iter().map(move |row| Line {
            report: self,
            scene,
            row,
        })
    }
}

impl Report for AccuracyReport {
    const NAME: &'static str = "accuracy";
    const HAS_PLOT: bool = true;

    fn document(&self) -> Document {
        let mut document = Document::default();
        document.heading(1, "Speed against error");
        document.paragraph(format!(
            "{} (times: {}, median of {}; {:.0} s in total)",
            self.renderer, self.clock, self.seeds, self.seconds
        ));
        for scene in &self.scenes {
            document.heading(2, scene.scene.clone());
            let mut facts = vec![surfaces(scene.surfaces)];
            facts.extend(scene.reference_is_sampled.then(|| SAMPLED.to_owned()));
            facts.extend(scene.limits.iter().map(limit));
            facts.extend(chaos(scene));
            facts.push(compared(scene));
            document.list(facts);
            document.table(self.lines(scene));
            document.list(scene.slopes.iter().map(slope).collect());
            document.paragraph(recommendation(scene, self.stated_error));
        }
        document.paragraph(LEGEND);
        if !self.targets.is_empty() {
            document.heading(2, "Against its targets");
            document.table(&self.targets);
        }
        if !self.responses.is_empty() {
            document.heading(2, "Impulse responses");
            document.table(&self.responses);
            document.paragraph(RESPONSES);
        }
        document
    }

    fn table(&self) -> Table {
        Table::of(self.scenes.iter().flat_map(|scene| self.lines(scene)))
    }

    fn plot_svg(&self) -> Result<String, PlotError> {
        plot_svg(self)
    }
}

/// The numbers of compared waves and of seeds.
fn compared(scene: &SceneReport) -> String {
    let rows = || scene.rows.iter();
    let waves = rows().map(|row| row.waves.compared).max().unwrap_or(0);
    let seeds = rows().map(|row| row.panning.twin_seeds).max().unwrap_or(0);
    format!("compared wave by wave: at most {waves} waves per row; twin bias: from {seeds} seeds")
}

/// The numbers of surfaces, of those in cells, and of those that are marched.
fn surfaces(counts: SurfaceCounts) -> String {
    let SurfaceCounts {
        all,
        in_cells,
        marched,
    } = counts;
    let many = if all == 1 { "surface" } else { "surfaces" };
    let mut told = format!("{all} {many}");
    if in_cells > 0 {
        told += &format!(", {in_cells} in cells");
    }
    if marched > 0 {
        told += &format!(", {marched} marched, also by hybrid");
    }
    told
}

fn limit(limit: &Limit) -> String {
    format!(
        "{} iterations, exact waves: pan {:+.5} ± {:.5}, {:.3} % of the waves heard ({} directions)",
        limit.iterations,
        limit.pan,
        limit.uncertainty,
        100.0 * limit.heard,
        limit.directions
    )
}

fn chaos(scene: &SceneReport) -> Vec<String> {
    let Chaos {
        growth, horizon, ..
    } = scene.chaos;
    let Some(growth) = growth else {
        return vec!["chaos: none, no wave meets two curved surfaces".to_owned()];
    };
    let steps = scene.chaos.steps.iter();
    let steps = steps.map(|step| {
        let separation = significant(step.separation, 2);
        format!("{separation} ({} waves)", step.pairs)
    });
    let steps: Vec<String> = steps.collect();
    let mut beyond: Vec<(u32, f64)> = scene
        .rows
        .iter()
        .map(|row| (row.case.iterations, 100.0 * row.waves.beyond_horizon))
        .collect();
    beyond.sort_by_key(|of| of.0);
    beyond.dedup_by_key(|of| of.0);
    let beyond = beyond.iter();
    let beyond = beyond.map(|(iterations, share)| format!("{share:.3} % in {iterations}"));
    let beyond: Vec<String> = beyond.collect();
    vec![
        format!(
            "chaos: separations in metres per radian at the 1st, 2nd … curved surface: {}",
            steps.join(", ")
        ),
        format!(
            "chaos: growth × {growth:.1} per curved hit; f32 rounding reaches 1 cm after {:.1} such hits; \
             waves past that horizon: {} iterations",
            horizon.unwrap_or(f64::INFINITY),
            beyond.join(", ")
        ),
    ]
}

fn slope(slope: &Slope) -> String {
    let points = slope.points.iter();
    let points = points.map(|point| format!("{}: {:.5}", point.waves, point.rms));
    let points: Vec<String> = points.collect();
    let left_out = slope.points.iter().filter(|point| !point.fitted);
    let left_out: Vec<String> = left_out.map(|point| point.waves.to_string()).collect();
    let left_out = match left_out.is_empty() {
        true => String::new(),
        false => format!(
            "; not fitted, because almost no wave is heard: {}",
            left_out.join(", ")
        ),
    };
    let law = match (slope.slope, slope.standard_error) {
        (Some(power), Some(error)) => format!("∝ waves^({power:.2} ± {error:.2})"),
        (Some(power), None) => format!("∝ waves^{power:.2}"),
        (None, _) => "no power law fitted".to_owned(),
    };
    format!(
        "hybrid, {} directions: rms panning error {law} ({}{left_out})",
        slope.directions,
        points.join(", ")
    )
}

fn recommendation(scene: &SceneReport, error: f64) -> String {
    let tell = |row: &Recommendation| {
        let (label, waves) = (&row.label, row.case.waves);
        let (time, rms) = (row.total_ms, row.rms);
        format!("{label}, {waves} waves: {time:.2} ms, rms {rms:.4}")
    };
    let wanted = format!("a panning error of at most {error} at {COMPARED_ITERATIONS} iterations");
    match (&scene.recommendation, &scene.best) {
        (Some(fastest), _) => format!(
            "recommended: the fastest with {wanted} is {}",
            tell(fastest)
        ),
        (None, Some(best)) => format!("recommended: none has {wanted}; the best is {}", tell(best)),
        (None, None) => format!(
            "recommended: none; no setting hears anything at {COMPARED_ITERATIONS} iterations"
        ),
    }
}
