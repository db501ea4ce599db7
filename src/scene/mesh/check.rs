//! Checks the faces of a mesh, and makes a mesh with normals that point into the air.

use super::edges::{Edges, part_count};
use super::intersections::intersections;
use super::measures::{area, corners, cross, signed_volume};
use super::nesting::reverse_inverted;
use super::report::{Defect, MeshReport};
use super::sheets::{overlays, sheets};
use super::{Inside, MOST_GROUPS, MOST_TRIANGLES, MeshError, MeshFaces, MeshOptions, TriangleMesh};
use crate::scene::shape::{Bounds3, LARGEST};
use glam::{DVec3, Vec3};
use std::collections::{HashMap, HashSet};
use std::sync::OnceLock;

/// Least height of a triangle as a share of the largest coordinate: two units in the last place of that coordinate. The
/// plane of a triangle with a smaller height is rounding.
const LEAST_HEIGHT: f64 = 2.0 * f32::EPSILON as f64;

/// See [`TriangleMesh::new`].
pub(super) fn checked(
    name: &str,
    faces: MeshFaces,
    options: MeshOptions,
) -> Result<TriangleMesh, MeshError> {
    check_limits(&faces, options)?;
    let mut report = MeshReport {
        vertices_in_file: faces.vertices.len(),
        divided_polygons: faces.divided_polygons,
        ..MeshReport::default()
    };
    let scale = f64::from(options.scale);
    let scaled = || faces.vertices.iter().map(|v| *v * scale);
    let used = faces.triangles.iter().flatten();
    let used = used.map(|corner| faces.vertices[*corner as usize] * scale);
    report.rounding_m = used.map(rounding_m).fold(0.0, f64::max);
    let (vertices, place_of) = distinct(scaled().map(|v| v.as_vec3()));
    let corners = faces
        .triangles
        .iter()
        .map(|triangle| triangle.map(|corner| place_of[corner as usize]));
    let all = corners.zip(faces.group_of.iter().map(|group| *group as u8));
    let (mut triangles, mut group_of) = without_repeated(all, &vertices, &mut report);
    if triangles.is_empty() {
        return Err(MeshError::Empty);
    }
    orient(&vertices, &mut triangles, &mut report)?;
    let [open, crowded] = Edges::of(&triangles).defects(&vertices);
    (report.open_edges, report.crowded_edges) = (open, crowded);
    report.is_closed = open.count == 0;
    drop_slivers(&vertices, &mut triangles, &mut group_of, &mut report);
    if triangles.is_empty() {
        return Err(MeshError::Empty);
    }
    report.area_m2 = triangles.iter().map(|t| area(&vertices, t)).sum();
    let mut volume = signed_volume(&vertices, &triangles);
    // Sheets without thickness enclose no air.
    let rounding = f64::from(f32::EPSILON) * largest(&vertices) * report.area_m2;
    let natural = match volume < -rounding {
        true => Inside::Air,
        false => Inside::Solid,
    };
    let inside = options.inside.unwrap_or(natural);
    report.is_hollow = inside == Inside::Air;
    report.is_reversed = inside != natural;
    if report.is_reversed {
        triangles
            .iter_mut()
            .for_each(|triangle| triangle.swap(1, 2));
    }
    if report.is_closed {
        report.inverted = reverse_inverted(&vertices, &mut triangles, report.is_hollow);
    }
    if report.inverted.count > 0 {
        volume = signed_volume(&vertices, &triangles);
    }
    report.volume_m3 = volume.abs();
    report.vertices = vertices.len();
    report.triangles = triangles.len();
    report.parts = part_count(vertices.len(), &triangles);
    let corners = triangles.iter().flatten();
    let bounds = Bounds3::of_points(corners.map(|at| vertices[*at as usize].as_dvec3()));
    report.size_m = bounds.max - bounds.min;
    let normal = |triangle: &[u32; 3]| cross(&vertices, triangle).normalize().as_vec3();
    let mut mesh = TriangleMesh {
        name: name.to_owned(),
        options,
        normals: triangles.iter().map(normal).collect(),
        vertices,
        is_sheet: vec![false; triangles.len()],
        triangles,
        group_of,
        groups: faces.groups,
        report,
        bounds,
        tree: OnceLock::new(),
        facets: OnceLock::new(),
        cells: OnceLock::new(),
        has_far_side: OnceLock::new(),
    };
    mesh.report.intersections = intersections(&mesh);
    mesh.report.overlays = overlays(&mesh);
    mesh.is_sheet = sheets(&mesh);
    let mut found = Defect::default();
    for triangle in mesh.triangles().filter(|triangle| triangle.is_sheet) {
        let [a, b, c] = triangle.corners;
        found.add((a + b + c) / 3.0);
    }
    mesh.report.sheets = found;
    Ok(mesh)
}

fn check_limits(faces: &MeshFaces, options: MeshOptions) -> Result<(), MeshError> {
    let (scale, largest) = (options.scale, f64::from(LARGEST));
    if !(scale > 0.0 && scale <= LARGEST) {
        return Err(MeshError::BadScale { scale });
    }
    let too_many = |what, most| Err(MeshError::TooMany { what, most });
    if faces.triangles.len() > MOST_TRIANGLES {
        return too_many("triangles", MOST_TRIANGLES);
    }
    if faces.vertices.len() > 3 * MOST_TRIANGLES {
        return too_many("vertices", 3 * MOST_TRIANGLES);
    }
    if faces.groups.len() > MOST_GROUPS {
        return too_many("materials", MOST_GROUPS);
    }
    let is_bad = |v: &DVec3| {
        !(*v * f64::from(scale))
            .abs()
            .cmple(DVec3::splat(largest))
            .all()
    };
    if let Some(index) = faces.vertices.iter().position(is_bad) {
        return Err(MeshError::NotFinite { vertex: index + 1 });
    }
    let vertices = faces.vertices.len();
    for (index, triangle) in faces.triangles.iter().enumerate() {
        if let Some(corner) = triangle.iter().find(|corner| **corner as usize >= vertices) {
            return Err(MeshError::NoSuchVertex {
                triangle: index + 1,
                vertex: *corner as usize + 1,
                vertices,
            });
        }
    }
    match faces.triangles.len() == faces.group_of.len()
        && faces
            .group_of
            .iter()
            .all(|group| (*group as usize) < faces.groups.len())
    {
        true => Ok(()),
        false => Err(MeshError::BadContent {
            why: "each triangle needs one of the groups".to_owned(),
        }),
    }
}

/// Distance in metres between a place and the nearest one in `f32`.
fn rounding_m(place: DVec3) -> f64 {
    place.distance(place.as_vec3().as_dvec3())
}

/// The different places, and for each place its index among them.
fn distinct(places: impl Iterator<Item = Vec3>) -> (Vec<Vec3>, Vec<u32>) {
    let mut known: HashMap<[u32; 3], u32> = HashMap::new();
    let mut vertices = Vec::new();
    let place_of = places.map(|place| {
        // The addition turns −0 into 0.
        let place = place + Vec3::ZERO;
        *known
            .entry(place.to_array().map(f32::to_bits))
            .or_insert_with(|| {
                vertices.push(place);
                vertices.len() as u32 - 1
            })
    });
    let place_of = place_of.collect();
    (vertices, place_of)
}

/// The triangles with three different corners, each once, and their groups.
fn without_repeated(
    all: impl Iterator<Item = ([u32; 3], u8)>,
    vertices: &[Vec3],
    report: &mut MeshReport,
) -> (Vec<[u32; 3]>, Vec<u8>) {
    let mut known = HashSet::new();
    let mut kept = (Vec::new(), Vec::new());
    for (triangle, group) in all {
        let [a, b, c] = triangle;
        let place = vertices[a as usize];
        if a == b || b == c || c == a {
            report.degenerate.add(place);
            continue;
        }
        let mut rotated = triangle;
        let first = (0..3).min_by_key(|at| triangle[*at]).unwrap_or(0);
        rotated.rotate_left(first);
        if !known.insert(rotated) {
            report.repeated.add(place);
            continue;
        }
        kept.0.push(triangle);
        kept.1.push(group);
    }
    kept
}

/// Reverses triangles whose neighbours have the opposite orientation.
fn orient(
    vertices: &[Vec3],
    triangles: &mut [[u32; 3]],
    report: &mut MeshReport,
) -> Result<(), MeshError> {
    let edges = Edges::of(triangles);
    if !edges.contradict() {
        return Ok(());
    }
    let areas: Vec<f64> = triangles.iter().map(|t| area(vertices, t)).collect();
    let reversed = edges.reversals(vertices, &areas)?;
    for (triangle, _) in triangles.iter_mut().zip(reversed).filter(|(_, is)| *is) {
        triangle.swap(1, 2);
        report.turned.add(vertices[triangle[0] as usize]);
    }
    Ok(())
}

/// Removes triangles whose height is below the rounding of their corners. Their neighbours then share an edge up to
/// rounding.
fn drop_slivers(
    vertices: &[Vec3],
    triangles: &mut Vec<[u32; 3]>,
    group_of: &mut Vec<u8>,
    report: &mut MeshReport,
) {
    let least = LEAST_HEIGHT * largest(vertices);
    let is_kept = |triangle: &[u32; 3]| {
        let [a, b, c] = corners(vertices, triangle);
        let longest = (b - a).length().max((c - b).length()).max((a - c).length());
        cross(vertices, triangle).length() > least * longest
    };
    let keep: Vec<bool> = triangles.iter().map(is_kept).collect();
    for (triangle, _) in triangles.iter().zip(&keep).filter(|(_, keep)| !**keep) {
        report.degenerate.add(vertices[triangle[0] as usize]);
    }
    let mut kept = keep.iter();
    triangles.retain(|_| kept.next() == Some(&true));
    let mut kept = keep.iter();
    group_of.retain(|_| kept.next() == Some(&true));
}

/// The largest coordinate in metres.
fn largest(vertices: &[Vec3]) -> f64 {
    let coordinates = vertices.iter().map(|v| v.abs().max_element());
    f64::from(coordinates.fold(0.0, f32::max))
}
