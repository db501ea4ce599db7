//! How much one pass and one march may do.
//!
//! Mesa's llvmpipe leaves a loop of a shader in silence once all loops of the shader together
//! have taken 65,536 turns, nested ones included. So the turns that an iteration of a scene may
//! take at most are counted here, and nowhere else: over the iterations of a pass, the steps
//! of a march, the lists of cells and the copies of repetitions. From that follow the
//! iterations of a pass and, where a single march could take more, its steps: what is given up
//! at the step limit is counted and reported.

use super::programs::march_options;
use super::{
    Algorithm, MAX_COPY_STEPS, MAX_FIELD_STEPS, MAX_STEPS, MarchOptions, Settings, ThesisOptions,
};
use crate::kernel::{self, Lists, Loops, SceneCells};
use crate::scene::Scene;

/// Turns of all loops of a shader together at most.
const MOST_TURNS: u64 = 65_535;

/// Turns of the loops in `marchFields` for one step: an inner and an outer one.
const FIELD_TURNS: u64 = 2;

/// Steps that a march is left with, however long the lists of its cells are: what takes more
/// grazes a surface. A single march of such a scene may run out of turns.
const LEAST_STEPS: u64 = 128;

/// What a frame's passes may do: the same on every renderer, so that results do not depend on
/// it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Budget {
    /// Iterations in one pass.
    pub iterations_per_pass: u32,
    /// Steps of one march among the basic shapes, or in `thesis` among all.
    pub steps: u32,
    /// Steps of one march of the fields.
    pub field_steps: u32,
    /// Turns of all traversals of long rows of copies in one flight.
    pub copy_steps: u32,
    /// Evaluations of a surface that a wave may take in an iteration.
    pub(super) evaluations: u64,
}

impl Budget {
    /// The budget of a scene in its current state.
    pub fn of(scene: &Scene, settings: &Settings) -> Budget {
        let lists = lists(settings);
        let layout = kernel::Layout::of(&scene.surfaces, lists);
        let cells = SceneCells::new(scene, &layout, lists);
        Budget::with_cells(scene, settings, cells.as_ref())
    }

    /// The same for callers that have the scene's cells.
    pub(super) fn with_cells(
        scene: &Scene,
        settings: &Settings,
        cells: Option<&SceneCells>,
    ) -> Budget {
        let loops = kernel::loops(scene, cells, lists(settings));
        let asked = settings.iterations_per_pass;
        match &settings.algorithm {
            Algorithm::Hybrid(_) => hybrid(&loops, kernel::marches_fields(scene, false), asked),
            Algorithm::March(of) => march(of, &loops, kernel::marches_fields(scene, true), asked),
            Algorithm::Thesis(of) => thesis(of, settings.max_distance, &loops, asked),
        }
    }
}

/// The lists of cells that frames with these settings read.
pub(super) fn lists(settings: &Settings) -> Lists {
    march_options(settings).algorithm.lists()
}

/// Differences that a normal of the thesis is taken from.
const DIFFERENCES: u64 = 6;

fn thesis(options: &ThesisOptions, max_distance: f32, loops: &Loops, asked: u32) -> Budget {
    // The thesis' steps are as many as its distances ask for.
    let steps = u64::from(options.step_limit(max_distance));
    let work = Work {
        turns: steps * (1 + loops.distance) + DIFFERENCES * loops.distance,
        evaluations: (steps + DIFFERENCES) * (1 + loops.unrolled + loops.distance),
    };
    work.budget(asked, [steps, 0, 0])
}

fn march(options: &MarchOptions, loops: &Loops, marches_fields: bool, asked: u32) -> Budget {
    let differences = match options.variant.difference_normals {
        None => 0,
        Some(_) => DIFFERENCES * loops.distance,
    };
    let rest = 1 + loops.projection + differences;
    let field_turns = if marches_fields { loops.all_fields } else { 0 };
    let left = MOST_TURNS.saturating_sub(rest);
    // Where there are fields the basic shapes may use half of what there is; the fields have what
    // these leave.
    let share = if marches_fields { 2 } else { 1 };
    let steps = held(MAX_STEPS, left / share, 1 + loops.directed);
    let left = left.saturating_sub(steps * (1 + loops.directed));
    let field_steps = match marches_fields {
        true => held(MAX_FIELD_STEPS, left, FIELD_TURNS + field_turns),
        false => 0,
    };
    let objects = 1 + loops.unrolled;
    let work = Work {
        turns: rest - 1 + steps * (1 + loops.directed) + field_steps * (FIELD_TURNS + field_turns),
        evaluations: steps * (objects + loops.directed) + field_steps * (objects + field_turns),
    };
    work.budget(asked, [steps, field_steps, 0])
}

fn hybrid(loops: &Loops, marches_fields: bool, asked: u32) -> Budget {
    let rest = 1 + loops.line + loops.projection;
    let left = MOST_TURNS.saturating_sub(rest);
    let copy_steps = match loops.copy_step {
        0 => 0,
        turns => held(MAX_COPY_STEPS, left, turns),
    };
    let traversals = copy_steps * loops.copy_step;
    let left = left.saturating_sub(traversals);
    let field_steps = match marches_fields {
        true => held(MAX_FIELD_STEPS, left, FIELD_TURNS + loops.other_fields),
        false => 0,
    };
    let objects = 1 + loops.unrolled;
    let work = Work {
        turns: rest - 1 + traversals + field_steps * (FIELD_TURNS + loops.other_fields),
        evaluations: objects
            + loops.line
            + traversals
            + field_steps * (objects + loops.other_fields),
    };
    work.budget(asked, [0, field_steps, copy_steps])
}

/// Steps of so many turns each that fit what is left.
fn held(most: u32, left: u64, turns: u64) -> u64 {
    (left / turns).max(LEAST_STEPS).min(most.into())
}

/// What one iteration may take.
struct Work {
    /// Turns of the loops in it.
    turns: u64,
    evaluations: u64,
}

impl Work {
    /// The budget of so many iterations in a pass, if they fit, with these steps: of a march, of
    /// the fields, past copies.
    fn budget(&self, asked: u32, steps: [u64; 3]) -> Budget {
        let [steps, field_steps, copy_steps] = steps.map(|steps| steps as u32);
        // The iteration itself is a turn.
        let fit = (MOST_TURNS / (1 + self.turns)).max(1);
        Budget {
            iterations_per_pass: u64::from(asked).min(fit) as u32,
            steps,
            field_steps,
            copy_steps,
            evaluations: self.evaluations,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::shape::Sphere;
    use crate::scene::{Node, Shape, Surface};
    use crate::trace::Profile;
    use glam::Vec3;

    /// Every profile, with as many iterations in a pass as may be requested.
    fn asked(profile: Profile) -> Settings {
        Settings::new(profile).with_iterations_per_pass(super::super::MAX_ITERATIONS)
    }

    fn balls(count: usize) -> Scene {
        let mut scene = Scene::builtin("corner").unwrap();
        let place = |i: usize| Vec3::new((i % 7) as f32, (i / 7 % 7) as f32, (i / 49) as f32);
        let ball = |i| Surface::new(Node::Sphere(Sphere { radius: 0.3 })).at(1.5 * place(i));
        scene.surfaces = (0..count).map(ball).collect();
        scene
    }

    /// Protects the defaults of the built-in rooms: their passes are as long as they ever were.
    #[test]
    fn the_rooms_of_the_thesis_run_as_they_did() {
        let corner = Scene::builtin("corner").unwrap();
        for profile in Profile::ALL {
            let settings = Settings::new(profile);
            let budget = Budget::of(&corner, &settings);
            assert_eq!(budget.iterations_per_pass, settings.iterations_per_pass);
        }
        let march = Budget::of(&corner, &Settings::march());
        assert_eq!((march.steps, march.field_steps), (MAX_STEPS, 0));
        let closed = Budget::of(&corner, &asked(Profile::Hybrid));
        assert_eq!(closed.iterations_per_pass, super::super::MAX_ITERATIONS);
    }

    /// Protects slow fields from being given up early in `march`: what the few steps of the basic
    /// shapes leave is theirs, and all loops together still keep to the limit.
    #[test]
    fn fields_have_what_the_basic_shapes_leave() {
        let menger = Scene::builtin("menger").unwrap();
        let march = Budget::of(&menger, &Settings::march());
        let hybrid = Budget::of(&menger, &Settings::hybrid());
        assert_eq!(march.steps, MAX_STEPS);
        let share = f64::from(march.field_steps) / f64::from(hybrid.field_steps);
        assert!(share > 0.9 && share < 1.0, "{march:?}, {hybrid:?}");
        let loops = kernel::loops(&menger, None, Lists::Overlapping);
        let turns = u64::from(march.steps) * (1 + loops.directed)
            + u64::from(march.field_steps) * (FIELD_TURNS + loops.all_fields);
        assert!(turns + loops.projection < MOST_TURNS, "{turns} turns");
    }

    /// Protects traversals of copies without end from more turns than a driver takes, whatever is
    /// repeated, and two flights of them in a pass.
    #[test]
    fn traversals_without_end_fit_a_pass() {
        let ball = Shape::from(Sphere { radius: 0.1 });
        let endless = ball.clone().repeat(Vec3::splat(1.0), [0; 3]);
        let few = ball.repeat(Vec3::splat(0.3), [3; 3]);
        let nested = few.repeat(Vec3::splat(2.0), [0; 3]);
        for (field, steps, passes) in [(endless, MAX_COPY_STEPS, 2), (nested, 6_553, 1)] {
            let mut scene = Scene::builtin("corner").unwrap();
            scene.surfaces = vec![Surface::new(field)];
            let budget = Budget::of(&scene, &asked(Profile::Hybrid));
            assert_eq!(
                (budget.copy_steps, budget.iterations_per_pass),
                (steps, passes)
            );
            assert_eq!((budget.steps, budget.field_steps), (0, 0));
            assert_eq!(Budget::of(&scene, &asked(Profile::March)).copy_steps, 0);
        }
    }

    /// Protects the lists of cells from being left out of the count.
    #[test]
    fn lists_make_for_shorter_passes() {
        for profile in Profile::ALL {
            let settings = asked(profile);
            let few = Budget::of(&balls(9), &settings).iterations_per_pass;
            let many = Budget::of(&balls(40), &settings).iterations_per_pass;
            let crowd = Budget::of(&balls(1000), &settings).iterations_per_pass;
            assert!(few > many, "{profile}: {few}, {many}");
            assert!(few > crowd && crowd >= 1, "{profile}: {few}, {crowd}");
        }
    }
}
