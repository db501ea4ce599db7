//! The fragment shader that takes waves past a transparent listener and records their crossings.

use super::passes::{AlgorithmText, Directions, marches_fields, start};
use super::text::{
    ListenerText, Part, Source, closed_form_parts, directed_parts, join, link, parts, source,
};
use crate::scene::Scene;
use std::fmt::Write;

/// What the text depends on beside the structure of the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct ArrivalsText {
    /// How a wave finds what it meets. There is no such text of `thesis`.
    pub algorithm: AlgorithmText,
    /// How waves start.
    pub directions: Directions,
    /// Crossings that a pass records of a wave.
    pub records: u32,
}

impl ArrivalsText {
    /// The output that is the tally, behind two of the wave's state.
    pub const TALLY: u32 = 2;

    /// The first output that is a record.
    pub const FIRST_RECORD: u32 = 3;

    /// Textures that a pass of so many records writes to.
    pub fn outputs(records: u32) -> u32 {
        ArrivalsText::FIRST_RECORD + records
    }
}

/// The text of the pass, for a scene that should have been [checked](super::check).
pub(crate) fn arrivals_text(scene: &Scene, text: ArrivalsText) -> String {
    let (fly, marches, mut library) = flight(scene, text.algorithm);
    let options = format!(
        "#define EXACT_NORMALS 1\n#define LANDING 1\n#define MARCHES_FIELDS {}\n\
         #define COUNT_EVALUATIONS(n)\n",
        u8::from(marches)
    );
    library.extend(parts(Source::new("the records", records(text))));
    let mut roots = vec![source!("wave.glsl"), Source::new("options", options), fly];
    roots.extend(start(text.directions));
    roots.extend([
        source!("arrivals/flight.glsl"),
        source!("arrivals/chunk.frag"),
    ]);
    join(&link(roots, library))
}

/// What finds the next surface, whether that marches fields, and the parts that it calls.
fn flight(scene: &Scene, algorithm: AlgorithmText) -> (Source, bool, Vec<Part>) {
    let listener = ListenerText::Transparent;
    match algorithm {
        AlgorithmText::Hybrid => {
            let mut library = closed_form_parts(scene, listener);
            library.extend(parts(source!("iterate_hybrid.glsl")));
            let fly = source!("arrivals/fly_hybrid.glsl");
            (fly, marches_fields(scene, false), library)
        }
        AlgorithmText::March { .. } | AlgorithmText::Thesis => {
            let mut library = directed_parts(scene, listener, false);
            library.extend(parts(source!("iterate_march.glsl")));
            let fly = source!("arrivals/fly_march.glsl");
            (fly, marches_fields(scene, true), library)
        }
    }
}

/// The outputs of the records, and what keeps them until they are written.
fn records(text: ArrivalsText) -> String {
    let (mut outputs, mut keep, mut write) = (String::new(), String::new(), String::new());
    for record in 0..text.records {
        let output = ArrivalsText::FIRST_RECORD + record;
        // Writing to a String cannot fail.
        let _ = writeln!(
            outputs,
            "layout(location = {output}) out vec4 outRecord{record};"
        );
        let _ = writeln!(outputs, "vec4 record{record} = vec4(0.0);");
        let _ = writeln!(
            keep,
            "    record{record} = place == {record}.0 ? record : record{record};"
        );
        let _ = writeln!(write, "    outRecord{record} = record{record};");
    }
    format!(
        "{outputs}// Keeps the record at its place, if it has that place.\n\
         void keepRecord(float place, vec4 record) {{\n{keep}}}\n\n\
         void writeRecords() {{\n{write}}}\n\n"
    )
}
