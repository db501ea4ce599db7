//! Measures the cost of each surface, the waves that meet it, and the audible change without it.

use super::Bench;
use super::change::Change;
use super::pair::{Case, Timing, pair};
use super::shader::ShaderReport;
use echomarch::Error;
use echomarch::internals::shader::{Layout, Lists};
use echomarch::scene::Scene;
use echomarch::tracer::Tracer;
use serde::Serialize;

/// Maximum number of surfaces that are measured one by one. Larger scenes are measured by kind of surface.
pub const MOST_SURFACES: usize = 32;

/// Maximum number of waves traced with all their states, and maximum number of states read back.
const MOST_FOLLOWED: u32 = 16_384;
const MOST_STATES: u32 = 1 << 21;

/// A surface, or all surfaces of one kind.
#[derive(Clone, Debug, Serialize)]
pub struct SurfaceRow {
    /// The row's name, for use in a sentence.
    pub name: String,
    /// The numbers of the surfaces, counted from 1.
    pub surfaces: Vec<usize>,
    /// Number of traced waves that met one of these surfaces.
    pub met: u32,
    /// `met` in percent of the traced waves.
    pub met_percent: f64,
    /// Number of shader lines saved without the surfaces; `None` if no surface would remain.
    pub lines: Option<i64>,
    /// March time saved without the surfaces; `None` if no surface would remain.
    pub march: Option<Timing>,
    /// Time of the whole frame saved without the surfaces; `None` if no surface would remain.
    pub total: Option<Timing>,
    /// The audible change; also `None` if no wave is heard in the complete scene.
    pub change: Option<Change>,
    /// Whether the remaining surfaces are too few to be put into cells.
    pub leaves_cells: bool,
    /// Whether the surfaces can be left out.
    pub verdict: Verdict,
}

/// The verdict on leaving surfaces out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The effect of another seed is at least as large as the change.
    CanBeLeftOut,
    /// The change is audible.
    IsHeard,
    /// No surface would remain in the scene.
    LeavesNothing,
    /// No wave is heard in the complete scene, so surfaces cannot be judged.
    NothingHeard,
}

/// The rows, each with its name and the indices of its surfaces.
pub(super) fn rows(scene: &Scene) -> Vec<(String, Vec<usize>)> {
    let surfaces = scene.surfaces.iter().enumerate();
    if scene.surfaces.len() <= MOST_SURFACES {
        return surfaces
            .map(|(index, surface)| (surface.label(index), vec![index]))
            .collect();
    }
    let mut kinds: Vec<(String, Vec<usize>)> = Vec::new();
    for (index, surface) in surfaces {
        let name = surface.shape.name();
        match kinds.iter_mut().find(|(kind, _)| kind == name) {
            Some((_, of_kind)) => of_kind.push(index),
            None => kinds.push((name.to_owned(), vec![index])),
        }
    }
    for (name, of_kind) in &mut kinds {
        *name = format!("all {} of {name}", of_kind.len());
    }
    kinds
}

/// The number of waves that met the surfaces of each row.
pub(super) struct Met {
    pub followed: u32,
    by_row: Vec<u32>,
}

/// Traces the waves of a frame, or fewer if there are too many, and counts the waves that meet the surfaces of each
/// row.
pub(super) fn met(
    tracer: &mut Tracer,
    base: Case,
    rows: &[(String, Vec<usize>)],
) -> Result<Met, Error> {
    let most = (MOST_STATES / (base.settings.iterations + 1)).min(MOST_FOLLOWED);
    let settings = base.settings.clone().with_count_evaluations(false);
    let followed = settings.waves.min(most);
    let states = tracer.paths(base.scene, &settings.with_waves(followed))?;
    let mut row_of = vec![0; base.scene.surfaces.len()];
    for (row, (_, surfaces)) in rows.iter().enumerate() {
        for &surface in surfaces {
            row_of[surface] = row;
        }
    }
    let mut by_row = vec![0; rows.len()];
    let mut seen = vec![false; rows.len()];
    for wave in 0..followed as usize {
        seen.fill(false);
        for state in states.iter().skip(1) {
            let status = state.get(wave).map_or(-1.0, |wave| wave.status.round());
            // Surface numbers start at 1. A status of 0 or less belongs to a dead, heard or unmoved wave and to no
            // surface.
            let number = status.max(0.0) as usize;
            if let Some(&row) = number.checked_sub(1).and_then(|index| row_of.get(index)) {
                seen[row] = true;
            }
        }
        for (count, &seen) in by_row.iter_mut().zip(&seen) {
            *count += u32::from(seen);
        }
    }
    Ok(Met { followed, by_row })
}

/// Measures every row: the surfaces of one row at a time are left out.
pub(super) fn measure(
    tracer: &mut Tracer,
    bench: &Bench,
    rows: &[(String, Vec<usize>)],
    met: &Met,
    step: &mut dyn FnMut(),
) -> Result<Vec<SurfaceRow>, Error> {
    let lines = ShaderReport::of(bench.base.scene, bench.base.settings).lines;
    let mut measured = Vec::new();
    for ((name, surfaces), &met_by) in rows.iter().zip(&met.by_row) {
        let mut row = SurfaceRow {
            name: name.clone(),
            surfaces: surfaces.iter().map(|index| index + 1).collect(),
            met: met_by,
            met_percent: 100.0 * f64::from(met_by) / f64::from(met.followed.max(1)),
            lines: None,
            march: None,
            total: None,
            change: None,
            leaves_cells: false,
            verdict: Verdict::LeavesNothing,
        };
        let rest = without(bench.base.scene, surfaces);
        if !rest.surfaces.is_empty() {
            leave_out(tracer, bench, &rest, &mut row)?;
            let rest_lines = ShaderReport::of(&rest, bench.base.settings).lines;
            row.lines = Some(lines as i64 - rest_lines as i64);
        }
        measured.push(row);
        step();
    }
    Ok(measured)
}

fn leave_out(
    tracer: &mut Tracer,
    bench: &Bench,
    rest: &Scene,
    row: &mut SurfaceRow,
) -> Result<(), Error> {
    let settings = bench.base.settings;
    let changed = Case {
        scene: rest,
        settings,
    };
    let frames = pair(tracer, bench.base, changed, bench.runs)?;
    row.march = Some(frames.march(bench.control_percent));
    row.total = Some(frames.total(bench.control_total_percent));
    row.change = Change::of(
        (&frames.base, settings.waves),
        (&frames.changed, settings.waves),
    );
    row.verdict = match row.change {
        None => Verdict::NothingHeard,
        Some(change) if change.is_within(bench.noise) => Verdict::CanBeLeftOut,
        Some(_) => Verdict::IsHeard,
    };
    let has_cells = |scene: &Scene| Layout::of(&scene.surfaces, Lists::Lines).has_cells();
    row.leaves_cells = has_cells(bench.base.scene) && !has_cells(rest);
    Ok(())
}

fn without(scene: &Scene, left_out: &[usize]) -> Scene {
    let mut rest = scene.clone();
    let mut index = 0;
    rest.surfaces.retain(|_| {
        index += 1;
        !left_out.contains(&(index - 1))
    });
    rest
}
