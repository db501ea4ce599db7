//! The columns of the rows and of the targets.

use super::report::{AccuracyReport, PanningError, Row, SceneReport, Target, WaveErrors};
use crate::report::{self, Cell, Column, significant};

/// A row with its context.
pub(super) struct Line<'a> {
    pub report: &'a AccuracyReport,
    pub scene: &'a SceneReport,
    pub row: &'a Row,
}

type LineColumn<'a> = Column<Line<'a>>;

impl report::Row for Line<'_> {
    /// Times in milliseconds, distances in metres; shares from 0 to 1 for programs.
    fn columns() -> Vec<Column<Self>> {
        let mut columns = settings();
        columns.extend(waves());
        columns.extend(panning());
        columns.push(Column::for_programs("renderer", |line: &Line| {
            &line.report.renderer
        }));
        columns.push(Column::for_programs("clock", |line: &Line| {
            &line.report.clock
        }));
        columns
    }
}

fn settings<'a>() -> Vec<LineColumn<'a>> {
    vec![
        Column::for_programs("scene", |line: &Line| &line.scene.scene),
        Column::new("setting", "setting", |line: &Line| &line.row.label).label(),
        Column::for_programs("profile", |line: &Line| &line.row.case.profile),
        Column::for_programs("min_distance", |line: &Line| line.row.case.min_distance),
        Column::new("iterations", "it.", |line: &Line| line.row.case.iterations).key(),
        Column::new("waves", "waves", |line: &Line| line.row.case.waves).key(),
        Column::for_programs("directions", |line: &Line| &line.row.case.directions),
        Column::for_programs("fused", |line: &Line| line.row.case.fused),
        Column::for_programs("sum_on_gpu", |line: &Line| line.row.case.sum_on_gpu),
        Column::new("total_ms", "frame", |line: &Line| line.row.speed.total_ms)
            .unit("ms")
            .fixed(2),
        Column::for_programs("march_ms", |line: &Line| line.row.speed.march_ms),
        Column::new(
            "million_wave_iterations_per_second",
            "M/s",
            |line: &Line| line.row.speed.million_per_second,
        )
        .fixed(1),
        Column::new("evaluations_per_segment", "eval", |line: &Line| {
            line.row.speed.evaluations_per_segment
        })
        .fixed(1),
        Column::for_programs("frames", |line: &Line| line.row.speed.frames),
    ]
}

fn waves<'a>() -> Vec<LineColumn<'a>> {
    fn new<'a, C: Into<Cell> + 'static>(
        name: &str,
        heading: &str,
        of: fn(&WaveErrors) -> C,
    ) -> LineColumn<'a> {
        Column::new(name, heading, move |line: &Line| of(&line.row.waves))
    }
    fn metres<'a>(name: &str, heading: &str, of: fn(&WaveErrors) -> f64) -> LineColumn<'a> {
        new(name, heading, of).unit("m").significant(2)
    }
    let by_order = |name: &str, of: fn(&WaveErrors) -> &Vec<u64>| {
        Column::for_programs(name, move |line: &Line| {
            let hits = of(&line.row.waves).iter().map(u64::to_string);
            hits.collect::<Vec<String>>().join(" ")
        })
    };
    vec![
        Column::for_programs("compared", |line: &Line| line.row.waves.compared),
        new("status_differs", "status", |waves| waves.status_differs).percent(3),
        new("sequence_differs", "sequence", |waves| {
            waves.sequence_differs
        })
        .percent(3),
        new("not_finite", "NaN", |waves| waves.not_finite),
        metres("end_median", "end: median", |waves| waves.end.median),
        metres("end_p99", "99 %", |waves| waves.end.p99),
        metres("end_max", "largest", |waves| waves.end.max),
        Column::for_programs("within_horizon_median", |line: &Line| {
            line.row.waves.end_within_horizon.median
        }),
        metres("within_horizon_p99", "within: 99 %", |waves| {
            waves.end_within_horizon.p99
        }),
        metres("within_horizon_max", "largest", |waves| {
            waves.end_within_horizon.max
        }),
        Column::for_programs("beyond_horizon", |line: &Line| {
            line.row.waves.beyond_horizon
        }),
        by_order("hits_by_order", |waves| &waves.hits),
        by_order("exact_hits_by_order", |waves| &waves.exact_hits),
        Column::for_people("exact hits", |line: &Line| {
            line.row.waves.exact_hits.iter().sum::<u64>()
        }),
        Column::for_people("hits, less exact by order", |line: &Line| {
            hits_less_exact(&line.row.waves)
        }),
    ]
}

/// The difference of the waves heard from the exact number, by order of reflection.
fn hits_less_exact(waves: &WaveErrors) -> String {
    let pairs = waves.hits.iter().zip(&waves.exact_hits);
    let off = pairs.map(|(&hits, &exact)| match hits as i128 - exact as i128 {
        0 => "0".to_owned(),
        off => format!("{off:+}"),
    });
    off.collect::<Vec<String>>().join(" ")
}

fn panning<'a>() -> Vec<LineColumn<'a>> {
    fn new<'a>(name: &str, heading: &str, of: fn(&PanningError) -> f64) -> LineColumn<'a> {
        Column::new(name, heading, move |line: &Line| of(&line.row.panning))
    }
    let limit = |line: &Line| {
        let mut limits = line.scene.limits.iter();
        let limit = limits.find(|limit| limit.iterations == line.row.case.iterations);
        limit.map(|limit| limit.pan)
    };
    vec![
        new("pan_mean", "pan", |panning| panning.mean).signed(4),
        Column::for_programs("pan_limit", limit),
        new("pan_limit_bias", "limit bias", |panning| panning.limit_bias).signed(4),
        new("pan_twin_bias", "twin bias", |panning| panning.twin_bias).signed(4),
        new("pan_twin_bias_error", "± twin", |panning| {
            panning.twin_bias_error
        })
        .fixed(4),
        Column::for_programs("pan_twin_seeds", |line: &Line| {
            u64::from(line.row.panning.twin_seeds)
        }),
        new("pan_spread", "spread", |panning| panning.spread).fixed(4),
        new("pan_rms", "rms", |panning| panning.rms).fixed(4),
        new("efficiency", "efficiency", |panning| panning.efficiency).fixed(0),
        Column::new("sum_error", "GPU sum off by", |line: &Line| {
            line.row.panning.sum_error
        })
        .significant(1),
    ]
}

impl report::Row for &Target {
    fn columns() -> Vec<Column<Self>> {
        let bound = |target: &&Target| {
            let relation = if target.at_least { "≥" } else { "≤" };
            target
                .bound
                .map(|bound| format!("{relation} {}", significant(bound, 2)))
        };
        let verdict = |target: &&Target| match target.met {
            Some(true) => "met",
            Some(false) => "not met",
            None => "for information",
        };
        vec![
            Column::new("what", "target", |target: &&Target| &target.what).label(),
            Column::new("measured", "measured", |target: &&Target| target.measured).significant(2),
            Column::for_people("bound", bound),
            Column::for_people("verdict", verdict).text(),
        ]
    }
}
