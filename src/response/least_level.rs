//! The least level of a source: energy that is added so that a hidden source does not vanish.

use super::omnidirectional_path::Path;
use super::source_sound::{HeardPath, Medium, PathKind};
use super::{Response, ResponseSettings};
use crate::bands::{self, BAND_COUNT, Bands};
use crate::scene::Pair;

/// Adds a path with the energy that is missing in bands below the least level of the settings, if any.
pub(super) fn raise(
    response: &mut Response,
    pair: Pair,
    medium: &Medium,
    settings: &ResponseSettings,
) {
    let Some(least_db) = settings.least_level_db else {
        return;
    };
    let Some(straight) = straight(pair, medium) else {
        return;
    };
    let share = 10_f64.powf(least_db / 10.0);
    let heard = response.energy();
    let missing: Bands =
        std::array::from_fn(|band| (share * straight.energy[band] - heard[band]).max(0.0));
    if missing.iter().all(|energy| *energy == 0.0) {
        return;
    }
    let added = HeardPath {
        kind: PathKind::Added,
        energy: missing,
        in_samples: [1.0; BAND_COUNT],
        errors_db: [0.0; BAND_COUNT],
        ..strongest(&response.paths).cloned().unwrap_or(straight)
    };
    if added.delay_s > response.seconds {
        return;
    }
    let is_before = |path: &HeardPath| path.delay_s <= added.delay_s;
    let at = response.paths.partition_point(is_before);
    response.paths.insert(at, added);
}

fn strongest(paths: &[HeardPath]) -> Option<&HeardPath> {
    let mean = |path: &HeardPath| bands::mean(&path.energy);
    paths.iter().max_by(|a, b| mean(a).total_cmp(&mean(b)))
}

/// The direct sound in the open; `None` if the source is at the listener's centre, where its energy is infinite.
fn straight(pair: Pair, medium: &Medium) -> Option<HeardPath> {
    let ends = (pair.source.position, pair.listener.position);
    let ends = (ends.0.as_dvec3(), ends.1.as_dvec3());
    Some(Path::straight(PathKind::Direct, ends)?.heard(pair, medium))
}
