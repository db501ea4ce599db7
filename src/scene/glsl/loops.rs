//! How many turns the loops of a scene's text may take.
//!
//! The text has loops of its own: over the lists of cells, over the cells that a line crosses,
//! over the copies of a repetition, and over the cells of copies that a line crosses. Where one
//! stands in another the turns of both count. What a user's text loops over is not known: a
//! call of one that has loops is taken for [`USER_TURNS`].

use super::fields_ahead::Marched;
use super::{Named, Text};
use crate::scene::cells::{Cells, Lists};
use crate::scene::{Copies, Field, Node, Scene};

/// Turns that a call of a user's field with loops in it is taken for. Compilers unroll loops of
/// a few dozen turns whose number is known, so that few texts have as many left.
const USER_TURNS: u64 = 60;

/// Turns at the most of the loops within one evaluation, by what is evaluated; 0 where there is
/// no loop.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Loops {
    /// The distance to everything.
    pub distance: u64,
    /// The distance to the basic shapes ahead.
    pub ahead: u64,
    /// The values of all fields, and the gradient of one.
    pub all_fields: u64,
    /// The values of the fields without a closed form, and the gradient of one.
    pub other_fields: u64,
    /// Where a line meets what has a closed form.
    pub line: u64,
    /// Landing on a surface: the gradient of one field.
    pub landing: u64,
    /// Surfaces that have their own lines of text, each evaluated every time.
    pub unrolled: u64,
}

/// The loops of the scene's text. `cells` are those of the scene, if it has any, with the lists
/// `lists`.
pub fn loops(scene: &Scene, cells: Option<&Cells>, lists: Lists) -> Loops {
    let text = Text::new(scene);
    let in_list = cells.map_or(0, |cells| cells.longest(lists) as u64);
    let listed = |turns: u64| in_list * (1 + turns);
    let value = |named: &Named| named.field().map_or(0, of_value);
    let hit = |named: &Named| named.field().map_or(0, of_hit);
    let is_other = |named: &Named| Marched::Others.takes(named);
    let is_field = |named: &Named| Marched::All.takes(named);
    let fields = |wanted: &dyn Fn(&Named) -> bool| {
        let loose: u64 = wanted_of(&text.loose, wanted).map(value).sum();
        let of_kind = wanted_of(&text.kinds, wanted).map(value).max();
        let in_cells = of_kind.map_or(0, listed);
        let gradient = wanted_of(&text.loose, wanted).map(value).max().max(of_kind);
        loose + in_cells + gradient.unwrap_or(0)
    };
    let loose_values: u64 = text.loose.iter().map(value).sum();
    let kind_values = text.kinds.iter().map(value).max().unwrap_or(0);
    let outside = cells.map_or(0, |cells| {
        let surfaces: usize = cells.groups().iter().map(|g| g.surfaces.len()).sum();
        cells.groups().len() as u64 + surfaces as u64 * (1 + kind_values)
    });
    let closed = |named: &Named| named.has_closed_form();
    let loose_hits: u64 = wanted_of(&text.loose, &closed).map(hit).sum();
    let kind_hits = wanted_of(&text.kinds, &closed).map(hit).max();
    let across = cells.map_or(0, |cells| u64::from(cells.grid().count.element_sum()));
    Loops {
        distance: loose_values + listed(kind_values).max(outside),
        ahead: in_list,
        all_fields: fields(&is_field),
        other_fields: fields(&is_other),
        line: loose_hits + kind_hits.map_or(0, |turns| across * (1 + listed(turns))),
        landing: text.all().map(value).max().unwrap_or(0),
        unrolled: text.loose.len() as u64,
    }
}

fn wanted_of<'a, 'b>(
    named: &'b [Named<'a>],
    wanted: &'b dyn Fn(&Named) -> bool,
) -> impl Iterator<Item = &'b Named<'a>> {
    named.iter().filter(|named| wanted(named))
}

/// Turns in one evaluation of a field's value, or of its gradient.
fn of_value(field: &Field) -> u64 {
    let below: u64 = field.of.iter().map(of_value).sum();
    match &field.node {
        Node::Repeat { .. } => {
            // What cannot be repeated is refused before it comes here.
            let copies = field.copies().unwrap_or([Copies::None; 3]);
            let along = copies.iter().map(|copies| u64::from(copies.count()));
            let nested = |turns: u64, count: u64| match count {
                1 => turns,
                count => count * (1 + turns),
            };
            along.rev().fold(below, nested)
        }
        Node::User { field } if field.has_loops() => USER_TURNS,
        _ => below,
    }
}

/// Turns in finding where a line meets a field that has a closed form.
fn of_hit(field: &Field) -> u64 {
    let below: u64 = field.of.iter().map(of_hit).sum();
    match &field.node {
        Node::Repeat { period, count } => {
            let cells = (0..3).map(|axis| match period[axis] > 0.0 {
                true => u64::from(count[axis]),
                false => 1,
            });
            cells.sum::<u64>() * (1 + below)
        }
        _ => below,
    }
}
