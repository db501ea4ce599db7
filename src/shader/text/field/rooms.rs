//! The hit of a line with the walls of rooms, in closed form: the end of its way through the boxes of air.
//!
//! The chords of all boxes are computed once. A loop then follows the line from box to box. The f64 reference intersects
//! the line with the triangles of the walls instead.

use super::{Writer, literal};
use crate::scene::shape::Rooms;
use std::fmt::Write as _;

/// The coordinates of a box as literals.
fn corners(numbers: &[String]) -> [String; 2] {
    [&numbers[..3], &numbers[3..]].map(|corner| format!("vec3({})", corner.join(", ")))
}

impl Writer<'_> {
    /// Writes the hit of the line from `p` along `d`, and returns its name. `numbers` are the coordinates of the boxes.
    pub(super) fn hit_rooms(
        &mut self,
        [p, d, error_bound, limit]: [&str; 4],
        numbers: &[String],
    ) -> String {
        self.line(&format!("vec3 heading = headingSigns({d});"));
        self.line(&format!("vec3 slowness = inverseSpeeds({d});"));
        self.line(&format!("vec3 ahead = heading * {p};"));
        self.line("float begin = -NO_HIT;");
        let boxes = numbers.chunks_exact(NUMBERS_A_BOX);
        let count = boxes.len();
        for (index, of) in boxes.enumerate() {
            let [from, to] = corners(of);
            self.line(&format!(
                "vec2 air{index} = chordOfAir({from}, {to}, ahead, heading, slowness, {error_bound}, begin);"
            ));
        }
        self.line("float t = begin;");
        self.line(&format!("for (int i = 0; i < {count}; ++i) {{"));
        self.line("    float before = t;");
        for index in 0..count {
            self.line(&format!(
                "    t = staysInAir(air{index}, t) ? air{index}.y : t;"
            ));
        }
        self.line("    if (t == before) { break; }");
        self.line("}");
        // If several boxes end there, the first of them has the wall.
        self.line("float left = 0.0;");
        for index in (1..count).rev() {
            let number = literal(index as f64);
            self.line(&format!(
                "left = leavesAir(air{index}, t) ? {number} : left;"
            ));
        }
        if count > 1 {
            self.line("left = leavesAir(air0, t) ? 0.0 : left;");
        }
        self.line("t = begin > -NO_HIT ? max(t, 0.0) : NO_HIT;");
        self.line(&format!("airBox = t < {limit} ? left : airBox;"));
        "t".to_owned()
    }
}

/// Coordinates of a box in [`Rooms::corners`](crate::scene::shape::Rooms).
const NUMBERS_A_BOX: usize = 6;

/// The statements that project the end of the line from `from` along `d` onto the wall that it hits, as the point `q`
/// and the `normal`.
pub(in crate::shader) fn projection(rooms: &Rooms, from: &str, d: &str) -> Vec<String> {
    let numbers: Vec<String> = rooms.corners().into_iter().map(literal).collect();
    let mut low = String::new();
    let mut high = String::new();
    for (index, of) in numbers.chunks_exact(NUMBERS_A_BOX).enumerate() {
        let corners = corners(of);
        match index {
            0 => (low, high) = corners.into(),
            _ => {
                let is_met = format!("airBox == {}", literal(index as f64));
                let _ = write!(low, ";\n        low = {is_met} ? {} : low", corners[0]);
                let _ = write!(high, ";\n        high = {is_met} ? {} : high", corners[1]);
            }
        }
    }
    vec![
        format!("vec3 low = {low};"),
        format!("vec3 high = {high};"),
        format!("projectAirBox({from}, {d}, low, high, q, normal);"),
    ]
}
