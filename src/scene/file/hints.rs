//! Error messages about shapes, materials and other parts of a scene file, in terms of the notation.
//!
//! RON's own errors report their place and what the parser expected there. The author of
//! `Sphere(1)` or `Air(20)` needs to know the correct notation.

use super::air::AirFile;
use super::material::MaterialFile;
use super::sources_and_listeners::{ListenerFile, SourceFile};
use crate::ron_error::offset;
use crate::scene::notation::{FixedRadius, Form};
use crate::scene::shape::{form_of, shape_names};
use crate::text::nearest_or_all;
use ron::error::{Error, SpannedError};

/// The message for an error in this text that is about a shape, an operator, or another part that
/// has a name and fields.
pub(super) fn about_part(text: &str, error: &SpannedError) -> Option<String> {
    match &error.code {
        Error::NoSuchEnumVariant { found, outer, .. } if outer.as_deref() == Some("Shape") => {
            Some(no_such_shape(found))
        }
        Error::ExpectedArray
        | Error::ExpectedComma
        | Error::ExpectedStructLike
        | Error::ExpectedNamedStructLike(_)
        | Error::InvalidIdentifier(_)
        | Error::SuggestRawIdentifier(_) => {
            let (before, behind) = text.split_at(offset(text, error.span.start)?);
            how_written(before, behind)
        }
        _ => None,
    }
}

fn no_such_shape(found: &str) -> String {
    let told = format!("there is no shape or operator `{found}`");
    nearest_or_all(&told, found, shape_names())
}

/// The correct form of the part whose name is before the error.
fn how_written(before: &str, behind: &str) -> Option<String> {
    let before = before.trim_end();
    let named = before.strip_suffix(['(', '[', '{']).unwrap_or(before);
    let named = named.trim_end();
    let begin = named.rfind(|c: char| !c.is_alphanumeric());
    let name = &named[begin.map_or(0, |at| at + 1)..];
    let form = form_of(name).or_else(|| form_of_sound(name))?;
    let has_bracket = behind.trim_start().starts_with(['(', '[', '{']);
    if form == Form::NameAlone && !has_bracket {
        // The error is that something is missing after it.
        return None;
    }
    Some(format!("{name} is written {}", form.written(name)))
}

/// The notation of sources, listeners, materials and air.
fn form_of_sound(name: &str) -> Option<Form> {
    match name {
        "Material" => Form::of::<MaterialFile>(),
        "Air" => Form::of::<AirFile>(),
        "Source" => Form::of::<SourceFile>(),
        "Listener" => Form::of::<ListenerFile<FixedRadius>>(),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use crate::scene::Scene;

    fn told(shape: &str) -> String {
        let text = format!(
            "Scene(surfaces: [\n Surface(shape: {shape})], source: Source(position: (0, 0, 0)), \
             listener: Listener(position: (5, 0, 0), radius: 1))"
        );
        Scene::from_ron(&text, "scene").unwrap_err().to_string()
    }

    /// A shape in a wrong form is reported with its correct form.
    #[test]
    fn a_shape_is_told_by_its_name_and_how_it_is_written() {
        for (shape, sentence) in [
            ("Sphere(1)", "Sphere is written Sphere(radius: …)"),
            ("Sphere", "Sphere is written Sphere(radius: …)"),
            ("Box(1, 2, 3)", "Box is written Box(size: …)"),
            ("Torus[1]", "Torus is written Torus(ring: …, tube: …)"),
            (
                "Translate(of: Sphere(1), by: (0, 0, 0))",
                "Sphere is written Sphere(radius: …)",
            ),
            ("Union[Plane]", "Union is written Union(of: …)"),
            ("Union", "Union is written Union(of: …)"),
            ("Plane(1)", "Plane is written Plane, with nothing behind it"),
        ] {
            let said = told(shape);
            assert!(said.contains(sentence), "{shape}: {said}");
            assert!(said.starts_with("scene:2:"), "{shape}: {said}");
        }
    }

    /// A material, air or source in a wrong form is reported with its correct form.
    #[test]
    fn sound_is_told_how_it_is_written() {
        for (said, sentence) in [
            (
                "materials: {\"a\": Material(0.5)}",
                "Material is written Material(absorption: …, scattering: …, base: …)",
            ),
            (
                "air: Air(20)",
                "Air is written Air(temperature: …, humidity: …, pressure: …)",
            ),
            (
                "sources: [Source(1)]",
                "Source is written Source(name: …, level_db: …, position: …, path: …)",
            ),
        ] {
            let text = format!("Scene(surfaces: [],\n {said})");
            let said = Scene::from_ron(&text, "scene").unwrap_err().to_string();
            assert!(said.starts_with("scene:2:"), "{said}");
            assert!(said.ends_with(sentence), "{said}");
        }
    }

    /// For a mistyped shape the nearest one is suggested; without a near one, all are listed.
    #[test]
    fn the_nearest_shape_is_suggested() {
        for (shape, nearest) in [
            ("Tours(ring: 1, tube: 2)", "Torus"),
            ("sphere(radius: 1)", "Sphere"),
            ("Elipsoid(radii: (1, 1, 1))", "Ellipsoid"),
            ("SmoothUnoin(of: [], radius: 1)", "SmoothUnion"),
        ] {
            let said = told(shape);
            assert!(said.contains(&format!("did you mean {nearest}?")), "{said}");
            assert!(
                !said.contains("enum") && !said.contains("variant"),
                "{said}"
            );
        }
        let said = told("Teapot");
        assert!(
            said.contains("there are Plane, ") && said.contains("Scale"),
            "{said}"
        );
    }

    /// Protects other errors from misleading hints.
    #[test]
    fn what_is_no_error_of_a_shape_is_told_as_it_was() {
        for shape in ["Plane position: (0, 0, 0)", "Sphere(radius: one)"] {
            assert!(!told(shape).contains("is written"), "{}", told(shape));
        }
    }
}
