//! The limits of a pass and of a march, from the number of loop turns that they may take.
//!
//! A *turn* is one execution of a loop's body. Mesa's llvmpipe silently ends a shader's loops once all loops together,
//! nested ones included, have taken 65,536 turns. The maximum turns of one iteration of a wave are therefore counted
//! here, and nowhere else: over the steps of a march, the lists of cells, the cells that a line crosses, the copies of
//! repetitions and the cells of copies. If one loop contains another, the turns of both count. A loop in a user's text
//! counts with its turns if it counts to a constant end, and as at most 60 if it may also end before. A call of a text with other loops counts as [`USER_TURNS`].
//!
//! The count determines the [`Budget`]: the number of iterations in a pass and, if a single march could exceed the
//! limit, the number of steps in a march. Waves that reach the step limit are counted and reported.

use super::cells::{Lists, SceneCells};
use super::pass_texts::AlgorithmText;
use super::text::field::{cells_crossed, has_closed_form, is_bounded, leaps};
use super::text::{Marched, Named, Text};
use crate::scene::shape::User;
use crate::scene::{Copies, Node, Shape, UserField};

/// Maximum evaluations of the distance in one march.
///
/// Every step of the march of `thesis` has at least the minimum length, so with the constants of the thesis no wave
/// takes more than 300 / 0.1 = 3000 steps. The limit is above this number, and prevents other settings from hanging the
/// GPU.
pub(crate) const MAX_STEPS: u32 = 4096;

/// Maximum evaluations of the fields in one march. Relaxed steps, and Newton steps at the end, take some tens of
/// evaluations. A march that takes far more evaluations grazes a surface.
const MAX_FIELD_STEPS: u32 = 1024;

/// Maximum turns in which `hybrid` traces a line past copies in one flight, for repetitions that are infinite or have
/// more than 1,024 cells. Two flights of this length fit in a pass on llvmpipe. Among rotated boxes 3 m to 4 m apart,
/// 10 of 524,288 waves reach the limit. Other waves still hit a box after hundreds of kilometres, where a float
/// resolves positions to a few centimetres.
pub(crate) const MAX_COPY_STEPS: u32 = 32_000;

/// Number of turns that is counted for a call of a user's field with loops whose ends are not constant.
const USER_TURNS: u64 = 60;

/// Maximum calls of a user's text in one projection if normals are computed by differences. The gradient takes seven
/// calls. The normal takes one call for the value, and six for each of nine step lengths
/// (`glsl/user/differences.glsl`).
const CALLS_OF_DIFFERENCES: u64 = 62;

/// Cells whose lists the distance to a mesh reads (`glsl/shape/mesh.glsl`).
const CELLS_OF_DISTANCE: u64 = 8;

/// Maximum turns that are counted for a line through a mesh. The count takes the longest list in each cell on a line along
/// the diagonal of the grid, and no line meets that many triangles.
const MOST_MESH_TURNS: u64 = 16_000;

/// Turns of the loop over the step lengths.
const TURNS_OF_DIFFERENCES: u64 = 7;

/// Maximum calls of a user's text in one projection if the text states its gradient or is differentiated: at each of
/// three sheets (`glsl/common/onto_field.glsl`) the value and the gradient, and the gradient once more where it is
/// undefined (`glsl/user/gradient.glsl`, `glsl/user/derivative.glsl`).
const CALLS_OF_GRADIENT: u64 = 9;

/// Maximum turns of the loops in one evaluation, for each evaluated function. The number is 0 without loops.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Loops {
    /// The distance to all objects.
    pub distance: u64,
    /// The distance to the basic shapes ahead.
    pub directed: u64,
    /// The values of all fields, and the gradient of one field; `None` without fields.
    pub all_fields: Option<u64>,
    /// The values of the fields without a closed form, and the gradient of one of them; `None` without such fields.
    pub other_fields: Option<u64>,
    /// The value of one surface of a kind whose surfaces are marched one at a time; `None` without such kinds.
    pub kind_fields: Option<u64>,
    /// The intersection of a line with closed forms, except traversals with a step limit.
    pub line: u64,
    /// The intersection of a line with all meshes.
    pub meshes: u64,
    /// One step of a traversal that has a step limit.
    pub copy_step: u64,
    /// The projection onto a surface: the gradient and the normal of one field.
    pub projection: u64,
    /// Number of unrolled surfaces, which are all evaluated every time.
    pub unrolled: u64,
}

/// Turns that depend only on the structure of a scene. The lists of its cells add further turns.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct StructureTurns {
    /// The values of all unrolled surfaces.
    unrolled_values: u64,
    /// The value of the kind with the most turns.
    kind_values: u64,
    all_fields: Option<FieldTurns>,
    other_fields: Option<FieldTurns>,
    unrolled_hits: u64,
    meshes: u64,
    /// The intersection of a line with one surface of each kind.
    kind_hits: Vec<u64>,
    /// One step of a march to a surface of each kind without a closed form.
    kind_steps: Vec<Option<u64>>,
    copy_step: u64,
    projection: u64,
    unrolled: u64,
}

/// Turns of marched fields.
#[derive(Clone, Debug, PartialEq)]
struct FieldTurns {
    unrolled: u64,
    /// The maximum turns of a kind in cells.
    of_kind: Option<u64>,
    /// The gradient of one field.
    gradient: u64,
}

impl StructureTurns {
    /// The turns of the loops in the text of a scene.
    pub fn of(text: &Text) -> StructureTurns {
        let value = |named: &Named| named.field().map_or(0, of_value);
        let projection = |named: &Named| named.field().map_or(0, of_projection);
        let hit = |named: &Named| named.field().map_or(0, of_hit);
        let step = |named: &Named| named.field().map_or(0, of_copy_step);
        let closed = text.unrolled.iter().filter(|n| n.has_closed_form());
        StructureTurns {
            unrolled_values: text.unrolled.iter().map(value).sum(),
            kind_values: text.instanced.iter().map(value).max().unwrap_or(0),
            all_fields: FieldTurns::of(text, Marched::All),
            other_fields: FieldTurns::of(text, Marched::Others),
            unrolled_hits: closed.map(hit).sum(),
            meshes: {
                let meshes = text.unrolled.iter().filter(|named| named.is_mesh());
                meshes.map(hit).sum()
            },
            kind_hits: text.instanced.iter().map(hit).collect(),
            kind_steps: text.instanced.iter().map(step_alone).collect(),
            copy_step: text.all().map(step).max().unwrap_or(0),
            projection: text.all().map(projection).max().unwrap_or(0),
            unrolled: text.unrolled.len() as u64,
        }
    }

    /// The turns of the loops in the text, including those over the lists of these cells, if the scene has cells.
    pub fn loops(&self, cells: Option<&SceneCells>, lists: Lists) -> Loops {
        let listed_cells = cells.and_then(SceneCells::lists);
        let in_list = listed_cells.map_or(0, |cells| cells.longest(lists) as u64);
        let listed = |turns: u64| in_list * (1 + turns);
        let fields = |fields: &FieldTurns| {
            fields.unrolled + fields.of_kind.map_or(0, listed) + fields.gradient
        };
        let outside = listed_cells.map_or(0, |cells| {
            let surfaces: usize = cells.groups().iter().map(|g| g.surfaces.len()).sum();
            cells.groups().len() as u64 + surfaces as u64 * (1 + self.kind_values)
        });
        // Each turn of the traversal visits one record: the record of a cell, or a record of the list that the cell
        // refers to.
        let kind_hits = cells
            .map_or(&[][..], SceneCells::kinds)
            .iter()
            .map(|(kind, cells)| {
                // Each record of a marched kind may end the inner loop, which looks for the next surface.
                let per_record = match self.kind_steps[*kind] {
                    Some(_) => 2,
                    None => 1 + self.kind_hits[*kind],
                };
                cells.records_on_line(lists) * per_record
            });
        let marched = cells
            .map_or(&[][..], SceneCells::kinds)
            .iter()
            .filter_map(|(kind, _)| self.kind_steps[*kind]);
        Loops {
            kind_fields: marched.max(),
            distance: self.unrolled_values + listed(self.kind_values).max(outside),
            directed: in_list,
            all_fields: self.all_fields.as_ref().map(fields),
            other_fields: self.other_fields.as_ref().map(fields),
            line: self.unrolled_hits + kind_hits.sum::<u64>(),
            meshes: self.meshes,
            copy_step: self.copy_step,
            projection: self.projection,
            unrolled: self.unrolled,
        }
    }
}

/// Turns of one step of a march, which evaluates the value, or the bound along the line.
fn of_step(named: &Named) -> u64 {
    let bounds = named.field().filter(|field| is_bounded(field));
    named.field().map_or(0, of_value) + bounds.map_or(0, leaps)
}

/// Turns of one step of a march to one surface of a kind; `None` if the kind has a closed form.
fn step_alone(named: &Named) -> Option<u64> {
    let is_marched = Marched::Others.takes(named);
    is_marched.then(|| of_step(named) + named.field().map_or(0, of_value))
}

impl FieldTurns {
    /// The turns of the fields that are marched together, if there are any.
    fn of(text: &Text, marched: Marched) -> Option<FieldTurns> {
        let value = |named: &Named| named.field().map_or(0, of_value);
        let step = of_step;
        if !text.marches(marched) {
            return None;
        }
        let unrolled = || text.unrolled.iter().filter(|named| marched.takes(named));
        let in_cells = text.marches_kinds(marched);
        let takes = |named: &&Named| in_cells && marched.takes(named);
        let instanced = text.instanced.iter().filter(takes);
        let of_kind = instanced.map(step).max();
        let gradient = unrolled().map(value).max().max(of_kind);
        Some(FieldTurns {
            unrolled: unrolled().map(step).sum(),
            of_kind,
            gradient: gradient.unwrap_or(0),
        })
    }
}

/// Turns in one evaluation of a field's value, or of its gradient.
fn of_value(field: &Shape) -> u64 {
    of_copies(field, &of_call)
}

/// Turns of the projection onto a field, which evaluates its gradient and its normal.
fn of_projection(field: &Shape) -> u64 {
    if field.mesh().is_some() {
        return 0;
    }
    of_copies(
        field,
        &|user| match user.states_gradient() || user.is_differentiated() {
            true => CALLS_OF_GRADIENT * of_call(user),
            false => TURNS_OF_DIFFERENCES + CALLS_OF_DIFFERENCES * of_call(user),
        },
    )
}

/// Turns in one call of a user's text.
fn of_call(user: &UserField) -> u64 {
    match user.has_loops() {
        true => user.loop_turns().unwrap_or(USER_TURNS),
        false => 0,
    }
}

/// Turns of the loops over the copies of repetitions, plus the turns that `of_user` returns for users' fields.
fn of_copies(field: &Shape, of_user: &dyn Fn(&UserField) -> u64) -> u64 {
    let below: u64 = field
        .children
        .iter()
        .map(|child| of_copies(child, of_user))
        .sum();
    match &field.node {
        Node::Repeat(_) => {
            // Shapes that cannot be repeated were rejected before.
            let copies = field.copies().unwrap_or([Copies::None; 3]);
            let along = copies.iter().map(|copies| u64::from(copies.count()));
            let nested = |turns: u64, count: u64| match count {
                1 => turns,
                count => count * (1 + turns),
            };
            along.rev().fold(below, nested)
        }
        Node::User(User { field }) => of_user(field),
        _ => match field.mesh() {
            // The nearest triangle is looked for in the lists of eight cells.
            Some(mesh) => CELLS_OF_DISTANCE * (1 + mesh.cells().longest_list as u64),
            None => below,
        },
    }
}

/// Turns of the intersection of a line with a field that has a closed form, except traversals with a step limit.
fn of_hit(field: &Shape) -> u64 {
    let below: u64 = field.children.iter().map(of_hit).sum();
    match &field.node {
        // The last turn of a traversal with a step limit takes no step.
        Node::Repeat(_) => cells_crossed(field).map_or(1, |cells| cells * (1 + below)),
        Node::Rooms(rooms) => rooms.boxes().len() as u64,
        _ => match field.mesh() {
            Some(mesh) => mesh.cells().turns_on_line().min(MOST_MESH_TURNS),
            None => below,
        },
    }
}

/// Turns of one step of a traversal that has a step limit; 0 without such a traversal.
fn of_copy_step(field: &Shape) -> u64 {
    if !has_closed_form(field) {
        return 0;
    }
    let below = field.children.iter().map(of_copy_step).max().unwrap_or(0);
    match cells_crossed(field) {
        Some(_) => below,
        None => below.max(1 + of_hit(&field.children[0])),
    }
}

/// Maximum turns of all loops of a shader together.
const MOST_TURNS: u64 = 65_535;

/// Turns of the loop in `marchFields` itself for one step.
const FIELD_TURNS: u64 = 1;

/// Minimum step limit of a march, even if the lists of its cells are long. A march that takes more steps grazes a
/// surface. In a scene with such lists a single march may exceed the maximum turns.
const LEAST_STEPS: u64 = 128;

/// The settings that limit the loops in a pass.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LoopsAsked {
    /// The algorithm that finds the next hit of a wave.
    pub algorithm: AlgorithmText,
    /// Steps of a march in `thesis`, as its distances require.
    pub thesis_steps: u32,
    /// Maximum iterations in a pass.
    pub iterations_per_pass: u32,
    /// Number of spheres that each flight may cross; 0 in frames, which count no crossings. A loop of at most one turn
    /// records the crossing of a sphere. With more than one sphere, a loop goes through them.
    pub detectors: u32,
}

impl LoopsAsked {
    /// Turns of the loops over the detectors and their crossings in an iteration.
    fn detector_turns(&self) -> u64 {
        match self.detectors {
            0 | 1 => self.detectors.into(),
            detectors => 2 * u64::from(detectors),
        }
    }
}

/// The limits of a frame's passes. They are the same on every renderer, so that results do not depend on the renderer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Budget {
    /// Iterations in one pass.
    pub iterations_per_pass: u32,
    /// Maximum steps of one march among the basic shapes, or in `thesis` among all surfaces.
    pub steps: u32,
    /// Maximum steps of one march through the fields.
    pub field_steps: u32,
    /// Maximum turns of all traversals of long rows of copies in one flight.
    pub copy_steps: u32,
    /// Maximum evaluations of surfaces by a wave in an iteration.
    pub evaluations: u64,
}

impl Budget {
    /// The budget of a scene with these loops.
    pub(super) fn new(asked: &LoopsAsked, loops: &Loops) -> Budget {
        match asked.algorithm {
            AlgorithmText::Hybrid => hybrid(loops, asked),
            AlgorithmText::March => march(loops, asked),
            AlgorithmText::Thesis => thesis(asked, loops),
        }
    }
}

/// Number of differences from which a normal of `thesis` is computed.
const DIFFERENCES: u64 = 6;

fn thesis(asked: &LoopsAsked, loops: &Loops) -> Budget {
    let steps = u64::from(asked.thesis_steps);
    let work = Work {
        turns: steps * (1 + loops.distance) + DIFFERENCES * loops.distance,
        evaluations: (steps + DIFFERENCES) * (1 + loops.unrolled + loops.distance),
    };
    work.budget(asked.iterations_per_pass, [steps, 0, 0])
}

fn march(loops: &Loops, asked: &LoopsAsked) -> Budget {
    let rest = 1 + loops.projection + loops.meshes + asked.detector_turns();
    let left = MOST_TURNS.saturating_sub(rest);
    // With fields, the basic shapes may use half of the turns, and the fields use the rest.
    let share = if loops.all_fields.is_some() { 2 } else { 1 };
    let steps = held(MAX_STEPS, left / share, 1 + loops.directed);
    let left = left.saturating_sub(steps * (1 + loops.directed));
    let (field_steps, field_turns) = field_steps(loops.all_fields, left);
    let objects = 1 + loops.unrolled;
    let work = Work {
        turns: rest - 1 + steps * (1 + loops.directed) + field_steps * (FIELD_TURNS + field_turns),
        evaluations: steps * (objects + loops.directed) + field_steps * (objects + field_turns),
    };
    work.budget(asked.iterations_per_pass, [steps, field_steps, 0])
}

fn hybrid(loops: &Loops, asked: &LoopsAsked) -> Budget {
    let rest = 1 + loops.line + loops.projection + asked.detector_turns();
    let left = MOST_TURNS.saturating_sub(rest);
    let copy_steps = match loops.copy_step {
        0 => 0,
        turns => held(MAX_COPY_STEPS, left, turns),
    };
    let traversals = copy_steps * loops.copy_step;
    // Fields that are marched together, and surfaces that are marched one at a time, each have this step limit.
    let fields = loops.other_fields.into_iter().chain(loops.kind_fields);
    let fields = fields.reduce(|a, b| a + FIELD_TURNS + b);
    let (field_steps, field_turns) = field_steps(fields, left.saturating_sub(traversals));
    let objects = 1 + loops.unrolled;
    let work = Work {
        turns: rest - 1 + traversals + field_steps * (FIELD_TURNS + field_turns),
        evaluations: objects + loops.line + traversals + field_steps * (objects + field_turns),
    };
    work.budget(asked.iterations_per_pass, [0, field_steps, copy_steps])
}

/// The steps of a march of the fields that fit in the remaining turns, and the turns of one step. Both are 0 without
/// fields.
fn field_steps(turns: Option<u64>, left: u64) -> (u64, u64) {
    match turns {
        Some(turns) => (held(MAX_FIELD_STEPS, left, FIELD_TURNS + turns), turns),
        None => (0, 0),
    }
}

/// The number of steps of `turns` turns each that fit in the remaining turns, at most `most`.
fn held(most: u32, left: u64, turns: u64) -> u64 {
    (left / turns).max(LEAST_STEPS).min(most.into())
}

/// The maximum work in one iteration.
struct Work {
    /// Turns of the loops in an iteration.
    turns: u64,
    evaluations: u64,
}

impl Work {
    /// The budget of a pass with at most `asked` iterations. `steps` are the step limits of a march, of a march of the
    /// fields, and of traversals of copies.
    fn budget(&self, asked: u32, steps: [u64; 3]) -> Budget {
        let [steps, field_steps, copy_steps] = steps.map(|steps| steps as u32);
        // The iteration itself counts as a turn.
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
    use crate::scene::{Node, Scene, Shape, Surface};
    use crate::shader::Structure;
    use crate::tracer::{Profile, Settings};
    use glam::Vec3;
    use std::sync::Arc;

    /// Settings of a profile with the maximum iterations in a pass.
    fn asked(profile: Profile) -> Settings {
        Settings::new(profile).with_iterations_per_pass(Settings::MAX_ITERATIONS)
    }

    fn balls(count: usize) -> Scene {
        let mut scene = Scene::builtin("corner").unwrap();
        let place = |i: usize| Vec3::new((i % 7) as f32, (i / 7 % 7) as f32, (i / 49) as f32);
        let ball = |i| Surface::new(Node::Sphere(Sphere { radius: 0.3 })).at(1.5 * place(i));
        scene.surfaces = (0..count).map(ball).collect();
        scene
    }

    /// Protects the defaults of the built-in rooms: their passes keep the full number of iterations.
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
        assert_eq!(closed.iterations_per_pass, Settings::MAX_ITERATIONS);
    }

    /// Protects slow fields from reaching the step limit early in `march`: they get all turns that the few steps of the
    /// basic shapes leave, and the loops together stay within the limit.
    #[test]
    fn fields_have_what_the_basic_shapes_leave() {
        let text = "float field(vec3 p) { float r = length(p) - 1.0;\n\
                    for (int i = 0; i < 60; ++i) { r += 0.001 * sin(p.x + float(i)); } return r; }";
        let field = UserField::new("slow.glsl", text.to_owned(), Vec3::splat(3.0), 1.1);
        let mut slow = Scene::builtin("menger").unwrap();
        slow.surfaces.push(Surface::new(Node::User(User {
            field: Arc::new(field),
        })));
        let march = Budget::of(&slow, &Settings::march());
        let hybrid = Budget::of(&slow, &Settings::hybrid());
        assert_eq!(march.steps, MAX_STEPS);
        let share = f64::from(march.field_steps) / f64::from(hybrid.field_steps);
        assert!(share > 0.9 && share < 1.0, "{march:?}, {hybrid:?}");
        let structure = Structure::of(&slow, Lists::Overlapping);
        let turns = StructureTurns::of(&Text::new(&slow, &structure));
        let loops = turns.loops(None, Lists::Overlapping);
        let field_turns = loops.all_fields.unwrap();
        let turns = u64::from(march.steps) * (1 + loops.directed)
            + u64::from(march.field_steps) * (FIELD_TURNS + field_turns);
        assert!(turns + loops.projection < MOST_TURNS, "{turns} turns");
    }

    /// Protects traversals of infinite repetitions from exceeding the turns that a driver allows, for any repeated
    /// shape. Two flights with such traversals fit in a pass.
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

    /// Protects the count from omitting the lists of cells.
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
