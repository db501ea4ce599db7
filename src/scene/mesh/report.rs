//! Measures and defects of a mesh, as numbers and as sentences.

use glam::{DVec3, Vec3};
use std::fmt;

/// A kind of defect: how often it occurs, and where first.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Defect {
    /// Number of occurrences.
    pub count: usize,
    /// The place of the first occurrence in metres.
    pub first: Vec3,
}

impl Defect {
    /// Adds an occurrence at a place.
    pub(super) fn add(&mut self, place: Vec3) {
        if self.count == 0 {
            self.first = place;
        }
        self.count += 1;
    }
}

/// Measures and defects of a mesh.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct MeshReport {
    /// Number of corners in the file.
    pub vertices_in_file: usize,
    /// Number of different corners.
    pub vertices: usize,
    /// Number of triangles that are traced.
    pub triangles: usize,
    /// Number of polygons with more than three corners that were divided into triangles.
    pub divided_polygons: usize,
    /// Number of parts that have no corner in common.
    pub parts: usize,
    /// Whether each edge has as many faces on one side as on the other.
    pub is_closed: bool,
    /// Whether a closed mesh encloses air.
    pub is_hollow: bool,
    /// Whether all faces were reversed, because the enclosed part was stated.
    pub is_reversed: bool,
    /// Enclosed volume in m³; meaningless for an open mesh.
    pub volume_m3: f64,
    /// Area of all faces in m².
    pub area_m2: f64,
    /// Width, height and depth of the bounding box in metres.
    pub size_m: DVec3,
    /// Greatest distance in metres between a corner of the file and the traced one, which is rounded to `f32`.
    pub rounding_m: f64,
    /// Triangles without an area, which were left out.
    pub degenerate: Defect,
    /// Triangles that occur more than once, of which one was kept.
    pub repeated: Defect,
    /// Triangles that were reversed, because their neighbours have the opposite orientation.
    pub turned: Defect,
    /// Parts that were reversed, because they enclosed air within air, or solids within the solid around all rooms.
    pub inverted: Defect,
    /// Edges with one face, or with more faces on one side than on the other.
    pub open_edges: Defect,
    /// Edges with more than two faces.
    pub crowded_edges: Defect,
    /// Pairs of triangles that intersect each other.
    pub intersections: Defect,
    /// Triangles that lie on a triangle of another material, with the same side towards the air.
    pub overlays: Defect,
    /// Triangles on whose back another face lies, with air behind: faces of sheets without thickness.
    pub sheets: Defect,
}

/// Size of a room or of a mesh in metres above which the unit is probably not the metre.
pub(crate) const LARGEST_USUAL_M: f64 = 1_000.0;

/// Size of a bounding box in metres below which the unit of the file is probably not the metre.
const SMALLEST_USUAL_M: f64 = 0.1;

/// Share of the size by which corners may be rounded without a warning: planes are then tilted by up to 1e-4 radians.
const MOST_ROUNDING: f64 = 1e-4;

impl MeshReport {
    /// The defects that change what is heard, as sentences without a full stop.
    pub fn warnings(&self) -> Vec<String> {
        let mut all = Vec::new();
        let mut tell = |defect: &Defect, one: &str, several: &str, effect: &str| {
            if defect.count > 0 {
                all.push(told(defect, one, several, effect));
            }
        };
        tell(
            &self.open_edges,
            "edge has",
            "edges have",
            "faces on one side only: the mesh is not closed, and sound escapes through its openings and through the backs of its faces",
        );
        tell(
            &self.turned,
            "triangle was",
            "triangles were",
            "reversed, because the neighbours have the opposite orientation",
        );
        tell(
            &self.inverted,
            "part was",
            "parts were",
            "reversed: faces enclosed air within air, or solids within the solid around all rooms",
        );
        tell(
            &self.intersections,
            "pair of triangles intersects",
            "pairs of triangles intersect",
            "each other: sound is reflected by the first face that it meets from the air side",
        );
        tell(
            &self.overlays,
            "triangle lies",
            "triangles lie",
            "on a triangle of another material in one place: either of the two materials is heard; lift the upper one by a millimetre, or cut it out of the lower one",
        );
        let size = self.size_m.max_element();
        if !(SMALLEST_USUAL_M..=LARGEST_USUAL_M).contains(&size) {
            all.push(format!(
                "it is {size:.4} m long: if its unit is not the metre, state the metres per unit as its scale"
            ));
        }
        if self.rounding_m > MOST_ROUNDING * size {
            all.push(format!(
                "its corners are rounded by up to {:.1} mm, because they are far from the origin: move the model to the origin, and sources and listeners with it",
                1e3 * self.rounding_m
            ));
        }
        all
    }
}

fn told(defect: &Defect, one: &str, several: &str, effect: &str) -> String {
    let Defect { count, first } = defect;
    let what = if *count == 1 { one } else { several };
    let (x, y, z) = (first.x, first.y, first.z);
    format!("{count} {what} {effect} (the first at ({x:.3}, {y:.3}, {z:.3}))")
}

impl fmt::Display for MeshReport {
    /// One line for each measure and for each defect.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let MeshReport {
            vertices_in_file,
            vertices,
            triangles,
            divided_polygons,
            parts,
            size_m,
            volume_m3,
            area_m2,
            ..
        } = self;
        writeln!(
            f,
            "triangles     {triangles} ({divided_polygons} polygons were divided)"
        )?;
        writeln!(
            f,
            "vertices      {vertices} ({vertices_in_file} in the file)"
        )?;
        writeln!(f, "parts         {parts}")?;
        writeln!(
            f,
            "size          {:.3} x {:.3} x {:.3} m",
            size_m.x, size_m.y, size_m.z
        )?;
        writeln!(f, "surface S     {area_m2:.3} m²")?;
        match self.is_closed {
            true => {
                let inside = if self.is_hollow { "air" } else { "solid" };
                writeln!(f, "volume V      {volume_m3:.3} m³, {inside} inside")?;
            }
            false => writeln!(f, "volume V      none: the mesh is not closed")?,
        }
        if self.is_reversed {
            writeln!(f, "orientation   all faces were reversed, as stated")?;
        }
        for (name, defect) in [
            ("without area", &self.degenerate),
            ("repeated", &self.repeated),
        ] {
            if defect.count > 0 {
                writeln!(f, "{name:<13} {} triangles, left out", defect.count)?;
            }
        }
        if self.crowded_edges.count > 0 {
            writeln!(
                f,
                "shared edges  {} with more than two faces",
                self.crowded_edges.count
            )?;
        }
        if self.sheets.count > 0 {
            writeln!(
                f,
                "sheets        {} triangles without thickness",
                self.sheets.count
            )?;
        }
        Ok(())
    }
}
