//! The names in the text of a scene, and the parts that every such text may call.

use super::field;
use super::link::{self, Part, Source, library};
use super::surface_names::{Marched, Named, value_name};
use crate::scene::Scene;
use crate::shader::structure::{Assets, Structure};
use std::borrow::Cow;
use std::fmt::Write;

/// Whether the listener stops waves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ListenerText {
    /// A wave that reaches the listener's sphere has arrived, and stops.
    Solid,
    /// Waves pass through the listener. The texts about the objects ahead do not contain it.
    Transparent,
}

/// The surfaces of a scene, with their names in the text.
pub(crate) struct Text<'a> {
    /// Unrolled surfaces.
    pub unrolled: Vec<Named<'a>>,
    /// Kinds of the surfaces in cells.
    pub instanced: Vec<Named<'a>>,
    /// Axes along which cells are infinite.
    pub unbounded_axes: [bool; 3],
    assets: &'a Assets,
}

impl<'a> Text<'a> {
    /// The names in a scene with this structure.
    pub fn new(scene: &'a Scene, structure: &'a Structure) -> Text<'a> {
        let layout = &structure.layout;
        let mut first = 0;
        let mut unrolled = Vec::new();
        for &index in &layout.unrolled {
            let named = Named::surface(scene, index, first);
            first += named.value_count();
            unrolled.push(named);
        }
        let kinds = layout.instanced.iter().enumerate();
        Text {
            unrolled,
            unbounded_axes: layout.unbounded_axes,
            instanced: kinds
                .map(|(kind, &index)| Named::kind(scene, index, kind))
                .collect(),
            assets: &structure.assets,
        }
    }

    /// Every surface and kind that has lines in the text.
    pub fn all(&self) -> impl Iterator<Item = &Named<'a>> {
        self.unrolled.iter().chain(&self.instanced)
    }

    /// Whether fields are marched together. With [`Marched::Others`], the surfaces of kinds are marched one at a time
    /// instead.
    pub fn marches(&self, marched: Marched) -> bool {
        let unrolled = self.unrolled.iter().any(|named| marched.takes(named));
        unrolled || self.marches_kinds(marched)
    }

    /// Whether a surface is a mesh. Meshes are never in cells.
    pub fn has_meshes(&self) -> bool {
        self.unrolled.iter().any(Named::is_mesh)
    }

    /// Whether fields in cells are marched together with all other fields.
    pub fn marches_kinds(&self, marched: Marched) -> bool {
        marched == Marched::All && self.instanced.iter().any(|named| marched.takes(named))
    }

    /// The parts that every text may call: the library, the users' fields, and the values of the surfaces.
    pub fn parts(&self) -> Vec<Part> {
        let mut parts = library();
        parts.extend(field::user_parts(self.assets));
        self.add(&mut parts, "the values of the surfaces", self.uniforms());
        parts
    }

    /// Adds functions that are generated for the scene.
    pub fn add(
        &self,
        parts: &mut Vec<Part>,
        name: &'static str,
        text: impl Into<Cow<'static, str>>,
    ) {
        parts.extend(link::parts(Source::new(name, text)));
    }

    /// The text `&& object != …` for every unrolled surface.
    pub fn not_unrolled(&self) -> String {
        let unrolled = self.unrolled.iter();
        unrolled
            .map(|named| format!(" && object != {}.0", named.tag))
            .collect()
    }

    /// Adds a function for each field that satisfies `wanted`.
    pub fn add_fields(
        &self,
        parts: &mut Vec<Part>,
        wanted: impl Fn(&Named) -> bool,
        write: field::Write,
    ) {
        let wanted = self.all().filter(|named| wanted(named));
        let text: String = wanted
            .map(|named| named.field_functions(write, self.assets))
            .collect();
        self.add(parts, "the surfaces", text);
    }

    /// The functions of the field that represents a group: gradient and normal.
    pub fn functions_of_group(&self, group: &Named) -> String {
        self.functions_of(group, field::gradient_text)
            + &self.functions_of(group, field::normal_text)
    }

    /// A function of the field of a surface or of a kind.
    pub fn functions_of(&self, named: &Named, write: field::Write) -> String {
        named.field_functions(write, self.assets)
    }

    /// The declaration of `uSurfaces`, a variable for each of its vectors, and the function `copyUniforms`, which every
    /// main function calls first. The copies are needed because some drivers load a uniform again at each use. These
    /// loads took up to half of the time in loops over iterations and steps (docs/cost.md).
    fn uniforms(&self) -> String {
        let count: usize = self.unrolled.iter().map(|named| named.value_count()).sum();
        let mut declarations = String::new();
        let mut copies = String::from(
            "    listener = uListener;\n    \
             squaredListenerRadius = listener.w * listener.w;\n",
        );
        if count > 0 {
            declarations = format!("uniform vec4 uSurfaces[{count}];\n");
        }
        for place in 0..count {
            let name = value_name(place);
            let _ = writeln!(declarations, "vec4 {name} = vec4(0.0);");
            let _ = writeln!(copies, "    {name} = uSurfaces[{place}];");
        }
        let squared_radii = self.unrolled.iter().filter_map(Named::squared_radius_of);
        for (name, value) in squared_radii {
            let _ = writeln!(declarations, "float {name} = 0.0;");
            let _ = writeln!(copies, "    {name} = {value}.w * {value}.w;");
        }
        format!(
            "{declarations}\n// Copies for the loops: a driver may load a uniform again at each use.\n\
             void copyUniforms() {{\n{copies}}}\n\n"
        )
    }
}

/// One line for each surface: a statement that is executed if the surface is the object.
pub(super) fn by_object<'a>(
    surfaces: impl Iterator<Item = &'a Named<'a>>,
    statement: impl Fn(&Named) -> String,
) -> String {
    let line = |named: &Named| {
        let (number, label, statement) = (&named.tag, &named.label, statement(named));
        format!("    if (object == {number}.0) {{ {statement} }} // {label}\n")
    };
    surfaces.map(line).collect()
}

/// A function with a statement for each kind that satisfies `wanted`. `head` is the text up to the opening brace, and
/// `otherwise` is the result for any other kind.
pub(super) fn of_kind(
    text: &Text,
    head: &str,
    wanted: impl Fn(&Named) -> bool,
    statement: impl Fn(&Named) -> String,
    otherwise: &str,
) -> String {
    let mut out = head.to_owned();
    for (kind, named) in text.instanced.iter().enumerate() {
        if wanted(named) {
            let (label, statement) = (&named.label, statement(named));
            let _ = writeln!(
                out,
                "    if (kind == {kind}.0) {{ {statement} }} // {label}"
            );
        }
    }
    out + otherwise + "}\n\n"
}
