//! The cases to run in each scene.
//!
//! For basic shapes, the exact reference evaluates a few formulas per flight. For a field, it marches in `f64` with
//! several hundred evaluations, which takes a hundred times as long. The reference is also slow for many surfaces.
//! Scenes with a slow reference get the short sweep: fewer directions for the limit, fewer waves compared one by one,
//! and fewer seeds for the twin bias. The report states the resulting uncertainty beside each figure.

use super::gyroid::GYROID;
use super::sweep::{Case, full, quick, short};
use echomarch::internals::shader::{Layout, Lists};
use echomarch::scene::{Scene, Surface};

/// The scenes of the thesis' tables, on which the targets are based.
pub const ROOMS: [&str; 2] = ["corner", "obstacles"];

/// The default scenes: the thesis' rooms, a scene of marched fields, one with a user's field, and one with cells. All
/// except [`GYROID`] are built in.
pub const DEFAULT_SCENES: [&str; 5] = [ROOMS[0], ROOMS[1], "cave", GYROID, "glasshouse"];

/// Exponents of two for the numbers of waves at which the slope of the panning error is measured.
const SLOPE_POWERS: std::ops::RangeInclusive<u32> = 10..=18;
const SHORT_SLOPE_POWERS: std::ops::RangeInclusive<u32> = 10..=14;

/// Maximum number of waves in a row that are compared one by one.
const COMPARED: u32 = 65_536;
const SHORT_COMPARED: u32 = 8192;

/// Number of wave pairs for measuring chaos.
const CHAOS_PAIRS: u64 = 16_384;
const SHORT_CHAOS_PAIRS: u64 = 1024;

/// Number of directions for the limit of many waves, if the exact reference is slow.
const SHORT_LIMIT_DIRECTIONS: u64 = 200_000;

/// Number of seeds for the twin bias, if the exact reference is slow.
const SHORT_TWIN_SEEDS: u32 = 4;

/// A scene with its cases.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The scene.
    pub scene: Scene,
    /// The settings.
    pub cases: Vec<Case>,
    /// Number of directions for the limit of many waves.
    pub limit_directions: u64,
    /// Maximum number of waves in a row that are compared one by one.
    pub compared_waves: u32,
    /// Maximum number of seeds for the twin bias. The first seeds are used.
    pub twin_seeds: u32,
    /// Number of wave pairs for measuring chaos.
    pub chaos_pairs: u64,
    /// The numbers of waves at which the slope of the panning error is measured.
    pub slope_waves: Vec<u32>,
}

impl Plan {
    /// Changes one setting at a time. Uses the short sweep if the exact reference is slow.
    pub fn quick(scene: Scene) -> Plan {
        if is_slow(&scene) {
            return Plan::short(scene);
        }
        Plan {
            cases: quick(),
            limit_directions: 4_000_000,
            ..Plan::full(scene)
        }
    }

    fn short(scene: Scene) -> Plan {
        Plan {
            cases: short(Layout::of(&scene.surfaces, Lists::Lines).has_cells()),
            limit_directions: SHORT_LIMIT_DIRECTIONS,
            compared_waves: SHORT_COMPARED,
            twin_seeds: SHORT_TWIN_SEEDS,
            chaos_pairs: SHORT_CHAOS_PAIRS,
            slope_waves: counts(SHORT_SLOPE_POWERS),
            scene,
        }
    }

    /// Runs all combinations of settings.
    pub fn full(scene: Scene) -> Plan {
        Plan {
            scene,
            cases: full(),
            limit_directions: 16_000_000,
            compared_waves: COMPARED,
            twin_seeds: u32::MAX,
            chaos_pairs: CHAOS_PAIRS,
            slope_waves: counts(SLOPE_POWERS),
        }
    }
}

/// Returns two to the power of every second exponent in a range.
fn counts(powers: std::ops::RangeInclusive<u32>) -> Vec<u32> {
    powers.step_by(2).map(|power| 1 << power).collect()
}

/// Whether the exact reference is slow for a scene.
fn is_slow(scene: &Scene) -> bool {
    let is_field = |surface: &Surface| surface.shape.field().is_some();
    Layout::of(&scene.surfaces, Lists::Lines).has_cells() || scene.surfaces.iter().any(is_field)
}

#[cfg(test)]
mod tests {
    use super::super::{SurfaceCounts, gyroid};
    use super::*;

    /// Protects the default run: its scenes have the properties that the documentation states.
    #[test]
    fn the_default_scenes_are_of_every_kind() {
        let scenes = DEFAULT_SCENES.map(|name| match name {
            GYROID => gyroid(),
            name => Scene::builtin(name).unwrap(),
        });
        let [corner, obstacles, cave, text, glasshouse] = &scenes;
        for room in [corner, obstacles] {
            let counts = SurfaceCounts::of(room);
            assert_eq!((counts.in_cells, counts.marched), (0, 0));
            assert!(!is_slow(room));
        }
        for marched in [cave, text].map(SurfaceCounts::of) {
            assert!(marched.marched > 0 && marched.in_cells == 0, "{marched:?}");
        }
        assert_eq!(
            (cave.user_fields().count(), text.user_fields().count()),
            (0, 1)
        );
        let cells = SurfaceCounts::of(glasshouse);
        assert!(
            2 * cells.in_cells > cells.all && cells.marched == 0,
            "{cells:?}"
        );
        assert!(is_slow(cave) && is_slow(text) && is_slow(glasshouse));
    }
}
