//! How many turns the loops of a scene's text may take.
//!
//! The text has loops of its own: over the lists of cells, over the cells that a line crosses,
//! over the copies of a repetition, and over the cells of copies that a line crosses. Where one
//! stands in another the turns of both count. What a user's text loops over is not known: a
//! call of one that has loops is taken for [`USER_TURNS`].

use super::cells::{Lists, SceneCells};
use super::text::field::{cells_crossed, has_closed_form, is_bounded, leaps};
use super::text::fields_ahead::Marched;
use super::text::scene_text::Text;
use super::text::surface_names::Named;
use crate::scene::shape::User;
use crate::scene::{Copies, Node, Scene, Shape, UserField};

/// Turns that a call of a user's field with loops in it is taken for. Compilers unroll loops of
/// a few dozen turns whose number is known, so that few texts have as many left.
const USER_TURNS: u64 = 60;

/// Calls of a user's text in one projection at most, where normals are differences: seven for
/// the gradient, and for the normal a value and six over each of nine distances
/// (`glsl/user/differences.glsl`).
const CALLS_OF_DIFFERENCES: u64 = 62;

/// Turns of the loop over these distances.
const TURNS_OF_DIFFERENCES: u64 = 7;

/// Calls in one projection where the text states its gradient: value and gradient, twice, and once
/// more where there is none (`glsl/user/gradient.glsl`).
const CALLS_OF_GRADIENT: u64 = 6;

/// Turns at most of the loops within one evaluation, by what is evaluated; 0 where there is
/// no loop.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Loops {
    /// The distance to everything.
    pub distance: u64,
    /// The distance to the basic shapes ahead.
    pub directed: u64,
    /// The values of all fields, and the gradient of one.
    pub all_fields: u64,
    /// The values of the fields without a closed form, and the gradient of one.
    pub other_fields: u64,
    /// Where a line intersects what has a closed form, but for traversals with a step limit.
    pub line: u64,
    /// One step of a traversal that has a step limit.
    pub copy_step: u64,
    /// Projecting onto a surface: the gradient and the normal of one field.
    pub projection: u64,
    /// Surfaces that have their own lines of text, each evaluated every time.
    pub unrolled: u64,
}

/// The loops of the scene's text that reads these lists. `cells` are those of the scene, if it has
/// any.
pub fn loops(scene: &Scene, cells: Option<&SceneCells>, lists: Lists) -> Loops {
    let text = Text::new(scene, lists);
    let listed_cells = cells.and_then(SceneCells::lists);
    let in_list = listed_cells.map_or(0, |cells| cells.longest(lists) as u64);
    let listed = |turns: u64| in_list * (1 + turns);
    let value = |named: &Named| named.field().map_or(0, of_value);
    let projection = |named: &Named| named.field().map_or(0, of_projection);
    // A march asks for the value or for the bound along the line.
    let marched = |named: &Named| {
        let bounds = named.field().filter(|field| is_bounded(field));
        value(named) + bounds.map_or(0, leaps)
    };
    let hit = |named: &Named| named.field().map_or(0, of_hit);
    let step = |named: &Named| named.field().map_or(0, of_copy_step);
    let is_other = |named: &Named| Marched::Others.takes(named);
    let is_field = |named: &Named| Marched::All.takes(named);
    let fields = |wanted: &dyn Fn(&Named) -> bool| {
        let unrolled: u64 = wanted_of(&text.unrolled, wanted).map(marched).sum();
        let of_kind = wanted_of(&text.instanced, wanted).map(marched).max();
        let in_cells = of_kind.map_or(0, listed);
        let gradient = wanted_of(&text.unrolled, wanted)
            .map(value)
            .max()
            .max(of_kind);
        unrolled + in_cells + gradient.unwrap_or(0)
    };
    let unrolled_values: u64 = text.unrolled.iter().map(value).sum();
    let kind_values = text.instanced.iter().map(value).max().unwrap_or(0);
    let outside = listed_cells.map_or(0, |cells| {
        let surfaces: usize = cells.groups().iter().map(|g| g.surfaces.len()).sum();
        cells.groups().len() as u64 + surfaces as u64 * (1 + kind_values)
    });
    let closed = |named: &Named| named.has_closed_form();
    let unrolled_hits: u64 = wanted_of(&text.unrolled, &closed).map(hit).sum();
    // A turn of the traversal is a record: of a cell, or of a list that it says the place of.
    let kind_hits = cells
        .map_or(&[][..], SceneCells::kinds)
        .iter()
        .map(|(kind, cells)| cells.records_on_line(lists) * (1 + hit(&text.instanced[*kind])));
    Loops {
        distance: unrolled_values + listed(kind_values).max(outside),
        directed: in_list,
        all_fields: fields(&is_field),
        other_fields: fields(&is_other),
        line: unrolled_hits + kind_hits.sum::<u64>(),
        copy_step: text.all().map(step).max().unwrap_or(0),
        projection: text.all().map(projection).max().unwrap_or(0),
        unrolled: text.unrolled.len() as u64,
    }
}

fn wanted_of<'a, 'b>(
    named: &'b [Named<'a>],
    wanted: &'b dyn Fn(&Named) -> bool,
) -> impl Iterator<Item = &'b Named<'a>> {
    named.iter().filter(|named| wanted(named))
}

/// Turns in one evaluation of a field's value, or of its gradient.
fn of_value(field: &Shape) -> u64 {
    of_copies(field, &of_call)
}

/// Turns in projecting onto a field: of its gradient, and of its normal.
fn of_projection(field: &Shape) -> u64 {
    of_copies(field, &|user| match user.states_gradient() {
        true => CALLS_OF_GRADIENT * of_call(user),
        false => TURNS_OF_DIFFERENCES + CALLS_OF_DIFFERENCES * of_call(user),
    })
}

/// Turns in one call of a user's text.
fn of_call(user: &UserField) -> u64 {
    if user.has_loops() { USER_TURNS } else { 0 }
}

/// Turns over the copies of repetitions, and over what `of_user` gives for users' fields.
fn of_copies(field: &Shape, of_user: &dyn Fn(&UserField) -> u64) -> u64 {
    let below: u64 = field
        .children
        .iter()
        .map(|child| of_copies(child, of_user))
        .sum();
    match &field.node {
        Node::Repeat(_) => {
            // What cannot be repeated is refused before it comes here.
            let copies = field.copies().unwrap_or([Copies::None; 3]);
            let along = copies.iter().map(|copies| u64::from(copies.count()));
            let nested = |turns: u64, count: u64| match count {
                1 => turns,
                count => count * (1 + turns),
            };
            along.rev().fold(below, nested)
        }
        Node::User(User { field }) => of_user(field),
        _ => below,
    }
}

/// Turns in finding where a line intersects a field that has a closed form, but for traversals
/// with a step limit.
fn of_hit(field: &Shape) -> u64 {
    let below: u64 = field.children.iter().map(of_hit).sum();
    match &field.node {
        // The last turn of a traversal with a step limit takes no step.
        Node::Repeat(_) => cells_crossed(field).map_or(1, |cells| cells * (1 + below)),
        _ => below,
    }
}

/// Turns in one step of a traversal that has a step limit; 0 where there is none.
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
