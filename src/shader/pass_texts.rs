//! The fragment shaders of a frame's passes.

use super::cells::Lists;
use super::structure::Structure;
use super::text::{
    ListenerText, Marched, Part, Source, Text, closed_form_parts, directed_parts, distance_parts,
    fill, is_marched, join, library, link, parts, source,
};
use crate::scene::Scene;
use serde::{Deserialize, Serialize};

/// The choice of the start directions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Directions {
    /// Independent and uniform over the sphere, as in the thesis.
    Random,
    /// A spherical Fibonacci lattice, randomly rotated as a whole.
    Fibonacci,
}

/// The wave that starts at a texel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum StartOrderText {
    /// The wave whose number is that of the texel.
    ByNumber,
    /// The wave that `uOrder` states for the texel, so that neighbouring texels hold waves of neighbouring directions.
    Sorted,
}

impl StartOrderText {
    /// The order for waves of this algorithm in a scene. Waves are sorted if they are marched to a surface, because
    /// waves that are traced in lockstep should take similar numbers of steps. In `hybrid` without a march all waves
    /// take the same time, so sorting has no benefit. `thesis` keeps the order of the thesis.
    pub fn of(algorithm: AlgorithmText, scene: &Scene) -> StartOrderText {
        let is_sorted = match algorithm {
            AlgorithmText::Thesis => false,
            AlgorithmText::March => true,
            AlgorithmText::Hybrid => scene.surfaces.iter().any(is_marched),
        };
        match is_sorted {
            true => StartOrderText::Sorted,
            false => StartOrderText::ByNumber,
        }
    }

    /// Fills one of two texts into the placeholder `name` of a pass over the waves. Returns the pass, and the parts
    /// that the text calls.
    pub(super) fn fill(
        self,
        pass: &Source,
        (name, by_number, sorted): (&str, &str, &str),
    ) -> (Source, Vec<Part>) {
        let (text, library) = match self {
            StartOrderText::ByNumber => (by_number, Vec::new()),
            StartOrderText::Sorted => (sorted, parts(source!("order.glsl"))),
        };
        let filled = fill(pass, &[(name, text)]);
        (Source::new(pass.name.clone(), filled), library)
    }

    /// Fills the placeholder for the number of the wave in a pass that starts waves.
    fn fill_start(self, pass: &Source) -> (Source, Vec<Part>) {
        let sorted = "waveAt(ivec2(gl_FragCoord.xy))";
        self.fill(pass, ("wave", "waveIndex()", sorted))
    }
}

/// Settings on which the text of a march depends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct MarchText {
    pub algorithm: AlgorithmText,
    /// Whether the wave's counters count evaluations of surfaces instead of their usual contents.
    pub count_evaluations: bool,
}

/// The algorithm that finds the next hit of a wave.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum AlgorithmText {
    Thesis,
    March,
    Hybrid,
}

impl AlgorithmText {
    /// The name of the profile.
    pub fn name(self) -> &'static str {
        match self {
            AlgorithmText::Thesis => "thesis",
            AlgorithmText::March => "march",
            AlgorithmText::Hybrid => "hybrid",
        }
    }

    /// The kind of lists of cells that the text reads. Lists of nearest candidates contain everything that lines need,
    /// except in cells that lie within a solid.
    pub fn lists(self) -> Lists {
        match self {
            AlgorithmText::Hybrid => Lists::Lines,
            AlgorithmText::March => Lists::Overlapping,
            AlgorithmText::Thesis => Lists::NearestCandidates,
        }
    }
}

/// The text of the pass that starts the waves.
pub(crate) fn initialise_text(directions: Directions, order: StartOrderText) -> String {
    let mut sources = vec![source!("wave.glsl")];
    sources.extend(start(directions));
    let (pass, mut parts) = order.fill_start(&source!("initialise.frag"));
    sources.push(pass);
    parts.extend(library());
    join(&link(sources, parts))
}

/// The sources that start a wave.
pub(super) fn start(directions: Directions) -> [Source; 2] {
    let direction = match directions {
        Directions::Random => source!("direction/random.glsl"),
        Directions::Fibonacci => source!("direction/fibonacci.glsl"),
    };
    [direction, source!("start.glsl")]
}

/// The text of the march through a scene. The scene should have been [checked](Structure::check).
pub(crate) fn march_text(scene: &Scene, structure: &Structure, text: MarchText) -> String {
    let (mut roots, parts) = iterations(&Text::new(scene, structure), text);
    roots.push(source!("iterate.frag"));
    join(&link(roots, parts))
}

/// The text of a whole frame in one pass.
pub(crate) fn whole_frame_text(
    scene: &Scene,
    structure: &Structure,
    text: MarchText,
    (directions, order): (Directions, StartOrderText),
) -> String {
    let (mut roots, mut parts) = iterations(&Text::new(scene, structure), text);
    roots.extend(start(directions));
    let (pass, of_order) = order.fill_start(&source!("whole_frame.frag"));
    parts.extend(of_order);
    roots.extend([source!("contribution.glsl"), pass]);
    join(&link(roots, parts))
}

/// The sources that trace a wave through iterations, and the parts that they call.
fn iterations(scene: &Text, text: MarchText) -> (Vec<Source>, Vec<Part>) {
    let counters = match text.count_evaluations {
        true => source!("counters_evaluations.glsl"),
        false => source!("counters.glsl"),
    };
    let mut roots = vec![source!("wave.glsl"), counters];
    let parts = match text.algorithm {
        AlgorithmText::Thesis => {
            roots.push(source!("iterate_thesis.glsl"));
            distance_parts(scene)
        }
        AlgorithmText::March => {
            roots.push(options(scene.marches(Marched::All)));
            roots.push(mesh_option(scene));
            roots.push(source!("iterate_march.glsl"));
            directed_parts(scene, ListenerText::Solid)
        }
        AlgorithmText::Hybrid => {
            roots.push(options(scene.marches(Marched::Others)));
            roots.push(source!("iterate_hybrid.glsl"));
            closed_form_parts(scene, ListenerText::Solid)
        }
    };
    roots.push(source!("iterations.glsl"));
    (roots, parts)
}

/// The option that states whether fields are marched.
fn options(marches_fields: bool) -> Source {
    let defines = format!("#define MARCHES_FIELDS {}\n", u8::from(marches_fields));
    Source::new("options", defines)
}

/// The option of `march` that states whether lines are intersected with meshes.
pub(super) fn mesh_option(scene: &Text) -> Source {
    let defines = format!("#define MEETS_MESHES {}\n", u8::from(scene.has_meshes()));
    Source::new("option of meshes", defines)
}

/// The text of a picture of a scene, from the sources that draw the picture.
#[cfg(feature = "picture")]
pub(crate) fn picture_text(
    scene: &Scene,
    structure: &Structure,
    sources: impl IntoIterator<Item = Source>,
) -> String {
    let mut roots = vec![source!("view/colour.glsl")];
    roots.extend(sources);
    join(&link(roots, distance_parts(&Text::new(scene, structure))))
}

/// The sources of a picture from the listener's position, with this shading.
#[cfg(feature = "picture")]
pub(crate) fn first_person(shading: Source) -> [Source; 3] {
    [
        source!("view/eye.glsl"),
        shading,
        source!("view/first_person.frag"),
    ]
}

/// The text of the panning pass, which writes contributions in the order of the waves.
pub(crate) fn pan_text(order: StartOrderText) -> String {
    let texel = "ivec2(gl_FragCoord.xy)";
    let sorted = format!("texelOfWave({texel})");
    let (pass, parts) = order.fill(&source!("pan.frag"), ("texel", texel, &sorted));
    let roots = vec![source!("wave.glsl"), source!("contribution.glsl"), pass];
    join(&link(roots, parts))
}

/// The text of the pass that rearranges contributions into the order of the waves.
pub(crate) fn in_order_text() -> String {
    let order = parts(source!("order.glsl"));
    join(&link(vec![source!("in_order.frag")], order))
}

/// The text of the first pass of the summation on the GPU.
pub(crate) fn first_sum_text() -> String {
    join(&[
        source!("wave.glsl"),
        source!("sum/first.glsl"),
        source!("sum/block.frag"),
    ])
}

/// The text of the further passes of the summation.
pub(crate) fn further_sum_text() -> String {
    join(&[source!("sum/further.glsl"), source!("sum/block.frag")])
}

named_values!(Directions, "kind of directions": Random = "random", Fibonacci = "fibonacci");
