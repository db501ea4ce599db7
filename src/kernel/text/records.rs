//! Text about the kinds that have cells of their own: which of their surfaces a line meets.

use super::scene_text::Text;
use super::surface_names::Named;
use crate::kernel::cell_record::Record;
use crate::kernel::layout::GRID_VECTORS;
use crate::scene::Node;
use std::fmt::Write;

/// What all kinds share: their grids, and the axes of these.
pub(super) fn grids_text(text: &Text) -> String {
    let kinds = own_kinds(text).count();
    if kinds == 0 {
        return String::new();
    }
    let axes: String = ["x", "y", "z"]
        .iter()
        .zip(text.unbounded_axes)
        .filter(|(_, unbounded)| !unbounded)
        .map(|(axis, _)| *axis)
        .collect();
    let vector = ["float", "vec2", "vec3"][axes.len().max(1) - 1];
    format!(
        "#define CELL_VECTOR {vector}\n\n#define CELL_AXES {axes}\n\n\
         uniform vec4 uGrids[{}];\n\n",
        GRID_VECTORS * kinds
    )
}

/// The kinds that have cells of their own, with the numbers of their kinds.
fn own_kinds<'a>(text: &'a Text) -> impl Iterator<Item = (usize, &'a Named<'a>)> {
    let kinds = text.instanced.iter().enumerate();
    kinds.filter(|(_, named)| named.has_closed_form())
}

/// The calls for all kinds, nearest hit by nearest hit.
pub(super) fn calls(text: &Text) -> String {
    own_kinds(text)
        .map(|(kind, _)| format!("    closestOfKind{kind}(p, d, last, nearest, object);\n"))
        .collect()
}

/// `closestOfKindN(p, d, last, nearest, object)` for each kind.
pub(super) fn closest_of_kinds(text: &Text) -> String {
    let kinds = own_kinds(text).enumerate();
    kinds
        .map(|(place, (kind, named))| closest_of_kind(named, kind, GRID_VECTORS * place))
        .collect()
}

fn closest_of_kind(named: &Named, kind: usize, grid: usize) -> String {
    let record = Record::of(named.surface);
    let (vectors, tag) = (record.vectors, record.component());
    let data = if record.has_head { "at + 1" } else { "at" };
    let (shared, candidate) = candidate(named);
    let is_left = match named.surface.shape.is_convex() {
        true => " && number != last",
        false => "",
    };
    let mut out = String::new();
    let _ = write!(
        out,
        "// The nearest surface of {} that the line intersects, if it is nearer than what is known.\n\
         void closestOfKind{kind}(vec3 p, vec3 d, float last, inout float nearest, inout float object) {{\n    \
         vec4 origin = uGrids[{grid}];\n    \
         vec4 size = uGrids[{}];\n    \
         CELL_VECTOR strides = uGrids[{}].CELL_AXES;\n    \
         int turns = int(uGrids[{}].w);   // no line has as many\n    \
         int first = int(origin.w);\n    \
         int most = int(size.w);\n    \
         vec3 inverse = safeInverse(d);\n    \
         GridLine line = gridLine(p.CELL_AXES, d.CELL_AXES, inverse.CELL_AXES, origin.CELL_AXES, \
         size.CELL_AXES, uGrids[{}].CELL_AXES, uGrids[{}].CELL_AXES);\n\
         {shared}    \
         CELL_VECTOR place = line.place;\n    \
         float t = line.enters;\n    \
         float known = min(nearest, line.leaves);\n    \
         float end = known;\n    \
         int listed = 0;   // the next record of a cell's list, or 0\n    \
         for (; turns > 0 && t < end; --turns) {{\n        \
         int at = listed > 0 ? listed : first + {vectors} * clamp(int(dot(place, strides)), 0, most);\n        \
         float tag = sceneData(at).{tag};\n        \
         float number = abs(tag);\n        \
         int data = {data};\n        \
         float candidate = {candidate};\n        \
         bool isNearer = number > 0.0{is_left} && candidate < end;\n        \
         end = isNearer ? candidate : end;\n        \
         object = isNearer ? number : object;\n        \
         listed = tag < 0.0 ? at + {vectors} : number > 0.0 ? 0 : int(sceneData(at).x);\n        \
         CELL_VECTOR faces = (place + line.ahead) * line.between + line.offset;\n        \
         float next = least(faces);\n        \
         t = listed > 0 ? t : next;\n        \
         place = listed > 0 ? place : nextCell(place, line, faces);\n    \
         }}\n    \
         nearest = end < known ? end : nearest;\n\
         }}\n\n",
        named.label,
        grid + 1,
        grid + 4,
        grid + 4,
        grid + 2,
        grid + 3,
    );
    out
}

/// What is computed once a line, and where the line intersects the surface of a record.
fn candidate(named: &Named) -> (&'static str, String) {
    let turned = named.surface.has_rotation();
    match named.surface.shape.node {
        Node::Cylinder(_) if !turned => (
            "    vec3 heading = planeHeading(d);\n",
            "enterCircle(p.xz - sceneData(data).xz, heading.xy, heading.z, \
             sceneData(data).w * sceneData(data).w)"
                .to_owned(),
        ),
        Node::Cuboid(_) if !turned => (
            "    vec3 heading = headingSigns(d);\n    vec3 slowness = inverseSpeeds(d);\n",
            "enterBox(p - sceneData(data).xyz, heading, slowness, sceneData(data + 1))".to_owned(),
        ),
        _ => ("", named.hit("p", "d", "end")),
    }
}
