//! `echomarch import`: checks a mesh file, and writes a scene file that uses it.

use super::exit::BadInput;
use super::numbers::real;
use super::options::{Common, check_ending};
use super::print;
use clap::{Args, ValueEnum};
use echomarch::internals::file_output::{check_file, write_whole};
use echomarch::scene::mesh::{Inside, MeshOptions, MeshReport, TriangleMesh};
use echomarch::scene::shape::Mesh;
use echomarch::scene::{Bounds3, Material, path_from};
use echomarch::{Listener, Scene, Source, Surface};
use glam::{DVec3, Vec3};
use serde_json::json;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

const EXAMPLES: &str = "\
Examples:
  echomarch import room.obj                       measures and defects of a mesh
  echomarch import level.glb -o level.ron         a scene with this mesh
  echomarch import hall.obj -o hall.ron --inside air --scale 0.001";

/// Arguments of `import`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    /// The mesh file: .obj, .glb or .gltf
    mesh: PathBuf,
    /// The scene file to write; without it, the mesh is only checked
    #[arg(short, long, value_name = "FILE.ron")]
    output: Option<PathBuf>,
    /// Inside of a closed mesh: air or solid [default: solid if its faces point outwards, otherwise air]
    #[arg(long, value_name = "PART")]
    inside: Option<Enclosed>,
    /// Metres per unit of the file
    #[arg(long, default_value_t = 1.0, value_name = "METRES", value_parser = real::<f32>)]
    scale: f32,
}

/// The enclosed part of space.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum Enclosed {
    Air,
    Solid,
}

/// Absorption of a material whose name is not that of a built-in material.
const ABSORPTION: f32 = 0.1;

/// Radius of the listener of a written scene in metres.
const RADIUS_M: f32 = 0.25;

/// Runs the subcommand.
pub fn run(arguments: &Arguments, common: &Common) -> anyhow::Result<()> {
    if let Some(output) = &arguments.output {
        check_ending(output, "ron")?;
    }
    let options = MeshOptions {
        inside: arguments.inside.map(|part| match part {
            Enclosed::Air => Inside::Air,
            Enclosed::Solid => Inside::Solid,
        }),
        scale: arguments.scale,
    };
    let file = &arguments.mesh;
    let mesh = TriangleMesh::from_file(file, options)
        .map_err(|error| BadInput(format!("the mesh {}: {error}", file.display())))?;
    let mesh = Arc::new(mesh);
    if !common.quiet {
        for warning in mesh.report().warnings() {
            print::tell(&format!("warning: {}: {warning}", file.display()));
        }
    }
    if let Some(output) = &arguments.output {
        check_file(output)?;
        let text = scene_text(&mesh, file, output)?;
        write_whole(output, |to| to.write_all(text.as_bytes()))?;
    }
    if common.json {
        return print::json(&as_json(&mesh, arguments));
    }
    let mut told = mesh.report().to_string();
    let _ = write!(told, "materials     {}", mesh.groups().join(", "));
    if let Some(output) = &arguments.output {
        let _ = write!(told, "\n{}", output.display());
    }
    print::line(&told)
}

fn as_json(mesh: &TriangleMesh, arguments: &Arguments) -> serde_json::Value {
    let MeshReport {
        vertices,
        triangles,
        parts,
        is_closed,
        is_hollow,
        is_reversed,
        volume_m3,
        area_m2,
        size_m,
        ..
    } = mesh.report();
    let output = arguments.output.as_ref();
    json!({
        "mesh": mesh.name(), "output": output.map(|output| output.display().to_string()),
        "vertices": vertices, "triangles": triangles, "parts": parts, "closed": is_closed,
        "inside": if *is_hollow { "air" } else { "solid" }, "reversed": is_reversed,
        "volume_m3": is_closed.then_some(volume_m3), "surface_m2": area_m2,
        "size_m": size_m.to_array(), "materials": mesh.groups(),
        "warnings": mesh.report().warnings(),
    })
}

/// The text of a scene with the mesh, a source and a listener in its air.
fn scene_text(mesh: &Arc<TriangleMesh>, file: &Path, output: &Path) -> anyhow::Result<String> {
    let folder = output.parent().unwrap_or(Path::new(""));
    let name = path_from(folder, file)?;
    let MeshOptions { inside, scale } = mesh.options();
    let mut shape = format!("Mesh(file: {name:?}");
    if let Some(inside) = inside {
        let _ = write!(shape, ", inside: {inside:?}");
    }
    if scale != 1.0 {
        let _ = write!(shape, ", scale: {scale}");
    }
    shape.push(')');
    let mut materials = String::new();
    for group in mesh.groups() {
        let line = match Material::builtin(group).is_some() {
            true => format!("        // {group:?} is a built-in material.\n"),
            false => format!("        {group:?}: Material(absorption: {ABSORPTION}),\n"),
        };
        materials.push_str(&line);
    }
    let [source, listener] = places(mesh).map(|p| format!("({:.3}, {:.3}, {:.3})", p.x, p.y, p.z));
    let told = mesh.report().to_string();
    let told: String = told.lines().map(|line| format!("// {line}\n")).collect();
    Ok(format!(
        "// A scene of a mesh, written by `echomarch import`.\n{told}\
         Scene(\n    surfaces: [\n        Surface(shape: {shape}),\n    ],\n    \
         // The faces of each material of the mesh have the material of its name. Replace these absorptions.\n    \
         materials: {{\n{materials}    }},\n    \
         source: Source(position: {source}),\n    \
         listener: Listener(position: {listener}, radius: {RADIUS_M}),\n)\n"
    ))
}

/// Number of points at which the air is looked for.
const TRIES: u32 = 2_000;

/// Two places in the air. In a hollow mesh the first is the point, among [`TRIES`] points, that is farthest from all
/// faces, and the second is far from the first. Outside a solid object, one is in front of it and one beside it.
fn places(mesh: &Arc<TriangleMesh>) -> [Vec3; 2] {
    let Bounds3 { min, max } = mesh.bounds();
    let (middle, size) = (0.5 * (min + max), max - min);
    if !mesh.report().is_hollow {
        let away = size.max_element();
        let front = middle + DVec3::Z * away;
        return [front, middle + DVec3::X * away].map(|place| place.as_vec3());
    }
    let surface = Surface::new(Mesh { mesh: mesh.clone() });
    let (source, listener) = (Source::at(Vec3::ZERO), Listener::at(Vec3::ZERO, RADIUS_M));
    let scene = Scene::new("import", vec![surface], source, listener);
    // The plastic sequence (Roberts 2018) spreads the points evenly.
    let point = |index: u32| {
        let share = DVec3::new(0.819_172_5, 0.671_043_6, 0.549_700_5) * f64::from(index);
        (min + share.fract() * size).as_vec3()
    };
    let points: Vec<(Vec3, f32)> = (1..=TRIES)
        .map(|index| (point(index), scene.surface_distance(point(index)).distance))
        .collect();
    let first = points.iter().max_by(|a, b| a.1.total_cmp(&b.1));
    let Some(&(first, free)) = first else {
        return [middle.as_vec3(); 2];
    };
    let apart = |point: &&(Vec3, f32)| point.1 >= 0.5 * free;
    let second = points.iter().filter(apart).max_by(|a, b| {
        let [a, b] = [a, b].map(|(point, _)| point.distance(first));
        a.total_cmp(&b)
    });
    [first, second.map_or(first, |(second, _)| *second)]
}
