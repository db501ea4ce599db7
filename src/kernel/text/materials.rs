//! Which material a wave meets.

use super::link::Part;
use super::scene_text::Text;
use crate::kernel::cells::Lists;
use crate::scene::{Scene, WALL_COUNT};
use std::fmt::Write;

/// `copyMaterials()` and `materialAt(object, turned)`: the number of the material
/// ([`Materials`](crate::kernel::Materials)) of the object that turns a wave by so much. `rooms` are
/// the rooms whose walls differ.
pub fn materials_parts(scene: &Scene, lists: Lists, rooms: &[usize]) -> Vec<Part> {
    let text = Text::new(scene, lists);
    let is_room = |tag: &str| rooms.iter().any(|room| (room + 1).to_string() == tag);
    let count = |tag: &str| if is_room(tag) { WALL_COUNT } else { 1 };
    let values: usize = text.unrolled.iter().map(|named| count(&named.tag)).sum();
    let (mut declarations, mut copies) = (String::new(), String::new());
    if values > 0 {
        let _ = writeln!(
            declarations,
            "uniform vec4 uMaterials[{}];",
            values.div_ceil(4)
        );
    }
    for place in 0..values {
        let component = ["x", "y", "z", "w"][place % 4];
        let _ = writeln!(declarations, "float material{place} = 0.0;");
        let _ = writeln!(
            copies,
            "    material{place} = uMaterials[{}].{component};",
            place / 4
        );
    }
    let mut place = 0;
    let mut choice = String::new();
    for named in &text.unrolled {
        let material = match is_room(&named.tag) {
            true => {
                let walls: Vec<String> = (0..3)
                    .map(|axis| place + 2 * axis)
                    .map(|low| format!("vec2(material{low}, material{})", low + 1))
                    .collect();
                format!(
                    "materialOfWall({}, {})",
                    named.vector("turned"),
                    walls.join(", ")
                )
            }
            false => format!("material{place}"),
        };
        let _ = writeln!(
            choice,
            "    // {}\n    material = {} ? {material} : material;",
            named.label,
            named.is_met()
        );
        place += count(&named.tag);
    }
    if !text.instanced.is_empty() {
        choice += &in_cells(&text);
    }
    let written = format!(
        "{declarations}\n// Copies for the loops: a uniform may be loaded again at each use.\n\
         void copyMaterials() {{\n{copies}}}\n\n\
         // The material of the object that turns a wave by so much.\n\
         float materialAt(float object, vec3 turned) {{\n    float material = 0.0;\n{choice}    \
         return material;\n}}\n\n"
    );
    let mut parts = Vec::new();
    text.add(&mut parts, "the materials", written);
    parts
}

fn in_cells(text: &Text) -> String {
    let others = text.not_unrolled();
    format!("    if (object > 0.0{others}) {{\n        material = entryOf(object).w;\n    }}\n")
}
