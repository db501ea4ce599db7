//! The fragment shader that traces waves past a transparent listener and records their crossings of the listener's
//! sphere.

use super::materials::Materials;
use super::pass_texts::{AlgorithmText, Directions, StartOrderText, mesh_option, start};
use super::structure::Structure;
use super::text::{
    ListenerText, Marched, Part, Source, Text, closed_form_parts, directed_parts, fill, join, link,
    parts, source,
};
use crate::scene::Scene;
use crate::scene::shape::Room;
use std::fmt::Write;

/// Bits of a word of events: the largest word that a float can hold without a driver changing it.
pub(crate) const WORD_BITS: u32 = 30;

/// Number of words of events in the additional texture. One more word is in the tally.
const WORDS_IN_TEXTURE: u32 = 4;

/// Parameters of the text in addition to the structure of the scene.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(crate) struct ArrivalsText {
    /// The algorithm that finds the next surface of a wave. `thesis` has no such shader.
    pub algorithm: AlgorithmText,
    /// The choice of the start directions.
    pub directions: Directions,
    /// The wave that starts at a texel.
    pub order: StartOrderText,
    /// Maximum crossings of the listener's sphere that one pass records for a wave.
    pub records: u32,
    /// Bits of an event; 0 if no surface absorbs or scatters.
    pub event_bits: u32,
    /// Whether a texture for further words of events exists.
    pub has_words: bool,
    /// Whether surfaces scatter.
    pub scatters: bool,
    /// Whether passages through solids are recorded.
    pub transmits: bool,
    /// Whether the chords in a second, inner sphere are recorded.
    pub has_inner_sphere: bool,
    /// Number of spheres whose crossings are recorded.
    pub detectors: u32,
    /// Number of planes that limit each sphere.
    pub limits: u32,
    /// Rooms whose walls have different materials, by index.
    pub rooms: Vec<usize>,
    /// Whether faces of a mesh have different materials.
    pub has_groups: bool,
}

impl ArrivalsText {
    /// The index of the tally's output, which follows the two outputs of the wave's state. The words of events come
    /// next, if there are any, and then the records.
    pub const TALLY: u32 = 2;

    /// The parameters for a scene with these materials, with at most `records` records. `outputs` is the number of
    /// outputs that the driver allows, at least four.
    pub fn new(
        (algorithm, directions, order): (AlgorithmText, Directions, StartOrderText),
        materials: &Materials,
        records: u32,
        outputs: u32,
    ) -> ArrivalsText {
        let event_bits = materials.bits();
        let has_words = event_bits > 0 && outputs > ArrivalsText::TALLY + 2;
        let text = ArrivalsText {
            algorithm,
            directions,
            order,
            records: 0,
            event_bits,
            has_words,
            scatters: materials.scatter(),
            transmits: materials.transmit(),
            has_inner_sphere: false,
            detectors: 1,
            limits: 0,
            rooms: materials.rooms(),
            has_groups: materials.has_groups(),
        };
        ArrivalsText {
            records: records.min(outputs - text.first_record()),
            ..text
        }
    }

    /// The index of the first output that is a record.
    pub fn first_record(&self) -> u32 {
        ArrivalsText::TALLY + 1 + u32::from(self.has_words)
    }

    /// Number of uniform vectors of the detectors.
    pub fn detector_vectors(&self) -> usize {
        self.detectors as usize * (1 + usize::from(self.has_inner_sphere) + self.limits as usize)
    }

    /// Number of textures that a pass writes to.
    pub fn outputs(&self) -> u32 {
        self.first_record() + self.records
    }

    /// Number of words of events of a wave.
    pub fn words(&self) -> u32 {
        match (self.event_bits, self.has_words) {
            (0, _) => 0,
            (_, false) => 1,
            (_, true) => 1 + WORDS_IN_TEXTURE,
        }
    }

    /// Maximum iterations of a pass whose events fit in its words; `None` without events.
    pub fn most_iterations(&self) -> Option<u32> {
        (self.event_bits > 0).then(|| self.words() * self.events_in_word())
    }

    fn events_in_word(&self) -> u32 {
        WORD_BITS / self.event_bits.max(1)
    }
}

/// The text of the pass. The scene should have been [checked](Structure::check).
pub(crate) fn arrivals_text(scene: &Scene, structure: &Structure, text: &ArrivalsText) -> String {
    let scene = Text::new(scene, structure);
    let (fly, marches, mut library) = flight(&scene, text.algorithm);
    let options = format!(
        "#define MARCHES_FIELDS {}\n\
         #define COUNT_EVALUATIONS(n)\n#define EVENT_BITS {}\n#define EVENTS_IN_WORD {}\n\
         #define WORDS {}\n#define SCATTERS {}\n#define INNER_SPHERE {}\n#define DETECTORS {}\n\
         #define LIMITS {}\n",
        u8::from(marches),
        text.event_bits,
        text.events_in_word(),
        text.words(),
        u8::from(text.scatters),
        u8::from(text.has_inner_sphere),
        text.detectors,
        text.limits
    );
    if text.event_bits > 0 {
        library.extend(materials_parts(&scene, text));
        library.extend(parts(source!("arrivals/walls.glsl")));
    }
    if text.scatters {
        library.extend(parts(source!("arrivals/scatter.glsl")));
    }
    library.extend(parts(Source::new("outputs", written(text))));
    let mut roots = vec![source!("wave.glsl"), Source::new("options", options)];
    if text.algorithm == AlgorithmText::March {
        roots.push(mesh_option(&scene));
    }
    roots.push(fly);
    roots.extend(start(text.directions));
    let chunk = source!("arrivals/chunk.frag");
    let number = ("number", "number", "waveAt(texel)");
    let (pass, of_order) = text.order.fill(&chunk, number);
    library.extend(of_order);
    let (passing_wave, passage) = match text.transmits {
        true => {
            library.extend(parts(source!("arrivals/passages.glsl")));
            (
                "\n    passingWave = wave;",
                source!("template/record_passage.glsl").text,
            )
        }
        false => ("", "".into()),
    };
    roots.extend([
        filled(
            &source!("arrivals/flight.glsl"),
            ("passage", passage.trim_end()),
        ),
        filled(&pass, ("passing_wave", passing_wave)),
    ]);
    join(&link(roots, library))
}

/// A source with one of its placeholders replaced by a text.
fn filled(source: &Source, text: (&str, &str)) -> Source {
    Source::new(source.name.clone(), fill(source, &[text]))
}

/// Returns the source that finds the next surface, whether this source marches fields, and the parts that it calls.
fn flight(scene: &Text, algorithm: AlgorithmText) -> (Source, bool, Vec<Part>) {
    let listener = ListenerText::Transparent;
    match algorithm {
        AlgorithmText::Hybrid => {
            let mut library = closed_form_parts(scene, listener);
            library.extend(parts(source!("iterate_hybrid.glsl")));
            let fly = source!("arrivals/fly_hybrid.glsl");
            (fly, scene.marches(Marched::Others), library)
        }
        AlgorithmText::March | AlgorithmText::Thesis => {
            let mut library = directed_parts(scene, listener);
            library.extend(parts(source!("iterate_march.glsl")));
            let fly = source!("arrivals/fly_march.glsl");
            (fly, scene.marches(Marched::All), library)
        }
    }
}

/// The outputs of words and records, and the variables that hold their values until the end of the pass. (Writing to a
/// String cannot fail.)
fn written(text: &ArrivalsText) -> String {
    let (mut outputs, mut keep, mut write) = (String::new(), String::new(), String::new());
    for record in 0..text.records {
        let output = text.first_record() + record;
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
    if text.has_words {
        write.push_str("    outWords = vec4(word1, word2, word3, word4);\n");
    }
    let texts = [
        ("outputs", outputs.as_str()),
        ("keep", &keep),
        ("words", &words(text)),
        ("write", &write),
    ];
    fill(&source!("template/write_outputs.glsl"), &texts)
}

/// The variables that hold the words of events, and the functions that access them.
fn words(text: &ArrivalsText) -> String {
    if text.words() == 0 {
        return "float firstWord() { return 0.0; }\n\n".to_owned();
    }
    let (mut declared, mut keep) = (String::new(), String::new());
    if text.has_words {
        let output = ArrivalsText::TALLY + 1;
        let _ = writeln!(declared, "layout(location = {output}) out vec4 outWords;");
    }
    for word in 0..text.words() {
        let _ = writeln!(declared, "float word{word} = 0.0;");
        let _ = writeln!(
            keep,
            "    word{word} = place == {word} ? word : word{word};"
        );
    }
    let texts = [("declared", declared.as_str()), ("keep", &keep)];
    fill(&source!("template/keep_word.glsl"), &texts)
}

/// The parts of `copyMaterials()` and `materialAt(object, turned)`. The latter returns the material number
/// ([`Materials`]) of the object that changes a wave's direction by `turned`. `rooms` are the rooms whose walls have
/// different materials.
fn materials_parts(text: &Text, options: &ArrivalsText) -> Vec<Part> {
    let (rooms, has_groups) = (&options.rooms[..], options.has_groups);
    let fit = Materials::fit_uniforms(text.unrolled.len(), rooms.len());
    let written = match fit && !has_groups {
        true => by_uniforms(text, rooms),
        false => by_table(text, rooms, has_groups),
    };
    let mut parts = Vec::new();
    text.add(&mut parts, "the materials", written);
    parts
}

/// The shader text for few materials: the material numbers of unrolled surfaces are uniforms, and those of other
/// surfaces are in the directory.
fn by_uniforms(text: &Text, rooms: &[usize]) -> String {
    let is_room = |tag: &str| rooms.iter().any(|room| (room + 1).to_string() == tag);
    let count = |tag: &str| if is_room(tag) { Room::WALL_COUNT } else { 1 };
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
    let texts = [
        ("declarations", declarations.as_str()),
        ("copies", &copies),
        ("choice", &choice),
    ];
    fill(&source!("template/material_by_uniforms.glsl"), &texts)
}

/// The shader text for many materials: all material numbers are in a table of the scene's data ([`Materials::table`]).
/// Without a hit the looked-up number is not used.
fn by_table(text: &Text, rooms: &[usize], has_groups: bool) -> String {
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
        false => fill(
            &source!("template/material_of_walls.glsl"),
            &[("own_axes", &own_axes)],
        ),
    };
    let skeleton = source!("template/material_by_table.glsl");
    let of_groups = match has_groups {
        true => source!("template/material_of_groups.glsl").text,
        false => "".into(),
    };
    fill(
        &skeleton,
        &[("of_groups", &of_groups), ("of_walls", &of_walls)],
    )
}

fn in_cells(text: &Text) -> String {
    let others = text.not_unrolled();
    format!("    if (object > 0.0{others}) {{\n        material = entryOf(object).w;\n    }}\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bands::BAND_COUNT;
    use crate::scene::Surface;
    use crate::scene::shape::Cuboid;
    use glam::Vec3;

    /// Protects the speed of scenes without transmission: their shader has no text for passages.
    #[test]
    fn only_shaders_of_solids_that_transmit_record_passages() {
        let mut scene = Scene::builtin("shoebox").expect("a built-in scene");
        let glass = scene.surfaces.len();
        let size = Vec3::ONE;
        scene.surfaces.push(Surface::new(Cuboid { size }));
        scene.surfaces[0].material = Some("concrete".to_owned());
        scene.surfaces[glass].material = Some("glass".to_owned());
        let text = |scene: &Scene, materials: &Materials| {
            let structure = AlgorithmText::Hybrid.structure(scene);
            let start = (
                AlgorithmText::Hybrid,
                Directions::Random,
                StartOrderText::ByNumber,
            );
            arrivals_text(
                scene,
                &structure,
                &ArrivalsText::new(start, materials, 4, 8),
            )
        };
        let silent = text(&scene, &Materials::of(&scene, 0..BAND_COUNT));
        let transmitting = Materials::with_transmission(&scene, 0..BAND_COUNT);
        assert!(text(&scene, &transmitting).contains("isPassage"));
        assert!(!silent.contains("assage") && !silent.contains("passing"));
        assert!(!silent.contains('@'));
        scene.surfaces[glass].material = Some("brick".to_owned());
        let brick = Materials::with_transmission(&scene, 0..BAND_COUNT);
        assert!(!brick.transmit() && text(&scene, &brick) == silent);
    }
}
