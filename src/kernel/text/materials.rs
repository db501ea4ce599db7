//! Which material a wave meets.

use super::link::Part;
use super::scene_text::Text;
use crate::kernel::cells::Lists;
use crate::kernel::materials::Materials;
use crate::scene::{Scene, WALL_COUNT};
use std::fmt::Write;

/// `copyMaterials()` and `materialAt(object, turned)`: the number of the material
/// ([`Materials`](crate::kernel::Materials)) of the object that turns a wave by so much. `rooms` are
/// the rooms whose walls differ.
pub fn materials_parts(scene: &Scene, lists: Lists, rooms: &[usize]) -> Vec<Part> {
    let text = Text::new(scene, lists);
    let written = match Materials::fit_uniforms(text.unrolled.len(), rooms.len()) {
        true => by_uniforms(&text, rooms),
        false => by_table(&text, rooms),
    };
    let mut parts = Vec::new();
    text.add(&mut parts, "the materials", written);
    parts
}

/// The numbers of unrolled surfaces as uniforms, those of others in the directory.
fn by_uniforms(text: &Text, rooms: &[usize]) -> String {
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
        choice += &in_cells(text);
    }
    format!(
        "{declarations}\n// Copies for the loops: a uniform may be loaded again at each use.\n\
         void copyMaterials() {{\n{copies}}}\n\n\
         // The material of the object that turns a wave by so much.\n\
         float materialAt(float object, vec3 turned) {{\n    float material = 0.0;\n{choice}    \
         return material;\n}}\n\n"
    )
}

/// All numbers in a table of the scene's data ([`Materials::table`]). What is met is a surface, or nothing, of which the
/// number is not used.
fn by_table(text: &Text, rooms: &[usize]) -> String {
    let is_room = |tag: &str| rooms.iter().any(|room| (room + 1).to_string() == tag);
    let mut own_axes = String::new();
    for named in text.unrolled.iter().filter(|named| is_room(&named.tag)) {
        let turned = named.vector("turned");
        if turned != "turned" {
            let (met, label) = (named.is_met(), &named.label);
            let _ = writeln!(
                own_axes,
                "    // {label}\n    own = {met} ? {turned} : own;"
            );
        }
    }
    let of_walls = match rooms.is_empty() {
        true => "    return entry.x;\n".to_owned(),
        false => format!(
            "    int walls = int(entry.y);\n    vec4 four = sceneData(walls);\n    \
             vec4 two = sceneData(walls + 1);\n    vec3 own = turned;\n{own_axes}    \
             float ofWall = materialOfWall(own, four.xy, four.zw, two.xy);\n    \
             return entry.y > 0.0 ? ofWall : entry.x;\n"
        ),
    };
    format!(
        "uniform int uMaterialTable;   // index of the first surface's entry in the scene's data\n\n\
         void copyMaterials() {{}}\n\n\
         // The material of the object that turns a wave by so much.\n\
         float materialAt(float object, vec3 turned) {{\n    \
         vec4 entry = sceneData(uMaterialTable + int(max(object, 1.0)) - 1);\n{of_walls}}}\n\n"
    )
}

fn in_cells(text: &Text) -> String {
    let others = text.not_unrolled();
    format!("    if (object > 0.0{others}) {{\n        material = entryOf(object).w;\n    }}\n")
}
