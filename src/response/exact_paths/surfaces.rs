//! The surfaces of a scene, and their sheets at a point.

use super::sheet::{Differenced, Form, Frame, Search, Sheet, Way};
use crate::scene::{Pair, ROUNDING, Shape, Surface};
use glam::{DMat3, DQuat, DVec3};
use std::collections::HashSet;

/// A point at which a wave hit a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vertex {
    /// World position in metres, on the surface.
    pub point: DVec3,
    /// Unit vector in world axes, from the solid into the air.
    pub normal: DVec3,
    /// The number of the surface in the scene's order, counted from 1.
    pub surface: u32,
}

/// The surfaces of a scene in `f64`.
#[derive(Clone, Debug)]
pub(super) struct Surfaces {
    surfaces: Vec<(Shape, Frame)>,
    /// The faces of each surface that is a single shape with few faces, all of them plane; empty for other surfaces.
    faces: Vec<Vec<Sheet<'static>>>,
    /// For each surface, whether it has [planes alone](Shape::has_planes_alone).
    have_planes_alone: Vec<bool>,
    /// Maximum distance in metres at which a point counts as on a surface.
    pub touch: f64,
    /// The largest coordinate of the scene in metres.
    largest: f64,
}

/// Maximum distance at which a point counts as on a surface, in units of the scene's rounding. Solutions of Newton's
/// method and hits of marched fields deviate by some tens of units. A point closer to an edge than this distance cannot
/// be distinguished from the edge. In a scene of 100 m the distance is 0.1 µm.
const TOUCH_IN_ROUNDINGS: f64 = 1e4;

/// Maximum number of solids that a point is moved out of: a point in a corner lies in three solids by rounding, and
/// moving it out of one solid may move it into another.
const MOST_SOLIDS: usize = 8;

/// Value that counts as 0, as a share of `touch`.
const SETTLED: f64 = 1e-2;

impl Surfaces {
    /// The surfaces of the pair's scene, in which `rounding` metres count as rounding.
    pub fn new(pair: Pair, rounding: f64) -> Surfaces {
        let scene = pair.scene;
        let placed = |surface: &Surface| (surface.shape.clone(), frame(surface));
        let surfaces: Vec<_> = scene.surfaces.iter().map(placed).collect();
        let ends = [pair.source.position, pair.listener.position];
        let reach = |surface: &Surface| {
            surface.position.as_dvec3().abs().max_element() + surface.shape.extent()
        };
        let reaches = scene.surfaces.iter().map(reach);
        let far = ends.map(|end| end.as_dvec3().abs().max_element());
        // Corners of a mesh lie in the plane of their facet up to rounding in `f32`.
        let meshes = scene
            .surfaces
            .iter()
            .filter_map(|surface| surface.shape.mesh());
        let flatness = meshes.map(|mesh| mesh.flatness()).fold(0.0, f64::max);
        let have_planes_alone = |(shape, _): &(Shape, Frame)| shape.has_planes_alone();
        let largest = reaches.chain(far).fold(0.0, f64::max);
        let faces = |(number, (shape, frame)): (u32, &(Shape, Frame))| {
            let has_few = shape.is_flat() && shape.mesh().is_none();
            let planes = has_few.then(|| faces_of(shape, *frame, number, largest));
            planes.unwrap_or_default()
        };
        Surfaces {
            have_planes_alone: surfaces.iter().map(have_planes_alone).collect(),
            faces: (1..).zip(&surfaces).map(faces).collect(),
            surfaces,
            touch: (TOUCH_IN_ROUNDINGS * rounding).max(2.0 * flatness),
            largest,
        }
    }

    /// The sheet hit at `vertex`: among the sheets at this point, the sheet whose normal is nearest to the vertex's
    /// normal. `None` for a surface known only from samples, and for a number without a surface.
    pub fn sheet(&self, vertex: &Vertex) -> Option<Sheet<'_>> {
        let alike = |sheet: &Sheet| {
            let normal = sheet.at(vertex.point).map(|at| at.normal);
            normal.map_or(f64::NEG_INFINITY, |normal| normal.dot(vertex.normal))
        };
        let index = (vertex.surface as usize).checked_sub(1)?;
        let faces = self.faces.get(index)?;
        if !faces.is_empty() {
            let distance = |face: &Sheet| face.at(vertex.point).map(|at| at.distance.abs());
            let is_near = |face: &&Sheet| distance(face).is_some_and(|far| far <= self.touch);
            let near = faces.iter().filter(is_near);
            let nearest = near.max_by(|a, b| alike(a).total_cmp(&alike(b)));
            if nearest.is_some() {
                return nearest.cloned();
            }
        }
        let search = self.search(vertex.surface, vertex.point, self.touch)?;
        if search.is_sampled {
            return None;
        }
        let found = search.found.into_iter();
        found.max_by(|a, b| alike(a).total_cmp(&alike(b)))
    }

    /// The sheets of the surface with this number that lie within `touch` metres of a world point.
    fn search(&self, surface: u32, point: DVec3, touch: f64) -> Option<Search<'_>> {
        let (shape, frame) = self.surfaces.get((surface as usize).checked_sub(1)?)?;
        let mut search = Search::near(point, touch, self.largest);
        search.descend(shape, Way::to_surface(surface, *frame));
        Some(search)
    }

    /// The planes of all surfaces that consist of planes of their leaves, each with its surface's number. A plane that
    /// contains several leaves of a surface is returned once.
    pub fn planes(&self) -> Vec<(u32, Sheet<'_>)> {
        let flat = (1..)
            .zip(&self.surfaces)
            .filter(|(_, (shape, _))| shape.has_planes_of_leaves());
        let of = |(surface, _): (u32, _)| {
            let all = self.search(surface, DVec3::ZERO, f64::INFINITY);
            let sheets = all.into_iter().flat_map(|search| search.found);
            let mut known = HashSet::new();
            let first = sheets.filter(move |sheet| known.insert(sheet.rounded_plane(self.touch)));
            first.map(move |sheet| (surface, sheet))
        };
        flat.flat_map(of).collect()
    }

    /// Number of nodes of the largest tree among the surfaces of [`Surfaces::planes`].
    pub fn most_nodes_of_planes(&self) -> usize {
        let flat = self.surfaces.iter().map(|(shape, _)| shape);
        let flat = flat.filter(|shape| shape.has_planes_of_leaves());
        flat.map(|shape| shape.nodes().len()).max().unwrap_or(0)
    }

    /// Whether the sheet hit at `vertex` is a plane.
    pub fn is_flat(&self, vertex: &Vertex) -> bool {
        let index = (vertex.surface as usize).wrapping_sub(1);
        // A surface that has only planes needs no search for the sheet.
        self.have_planes_alone.get(index) == Some(&true)
            || self.sheet(vertex).is_some_and(|sheet| sheet.is_flat())
    }

    /// The point near a world point on the surface with this number, by steps along the gradient of the surface's
    /// value. `None` if the steps do not converge.
    pub fn onto(&self, surface: u32, point: DVec3) -> Option<Vertex> {
        /// Maximum number of Newton steps: near a surface three are enough.
        const STEPS: usize = 16;
        let (shape, frame) = self.surfaces.get((surface as usize).checked_sub(1)?)?;
        let value = Differenced::new(shape, 0.0, self.largest);
        let mut p = frame.place(point);
        for _ in 0..STEPS {
            let at = value.derivatives(p);
            let squared = at.gradient.length_squared();
            if squared == 0.0 || !squared.is_finite() {
                return None;
            }
            if at.value.abs() <= SETTLED * self.touch {
                let back = frame.turn.transpose();
                return Some(Vertex {
                    point: back * (p - frame.shift),
                    normal: back * at.gradient.normalize(),
                    surface,
                });
            }
            p -= at.gradient * (at.value / squared);
        }
        None
    }

    /// Moves a world point out of solids in which it lies only because coordinates are rounded to `f32`, such as a
    /// point on a turned wall. Returns the point itself if it lies in no solid, or deeper in a solid.
    pub fn out_of_rounding(&self, point: DVec3) -> DVec3 {
        let most_m = f64::from(ROUNDING) * self.largest;
        let value = |(shape, frame): &(Shape, Frame), p: DVec3| shape.value(frame.place(p));
        let deepest = |p: DVec3| {
            let values = (1..).zip(&self.surfaces).map(|(n, s)| (n, value(s, p)));
            values.min_by(|a: &(u32, f64), b| a.1.total_cmp(&b.1))
        };
        let mut place = point;
        for _ in 0..MOST_SOLIDS {
            match deepest(place) {
                Some((surface, value)) if value < 0.0 && value >= -most_m => {
                    match self.onto(surface, place) {
                        // The point is then in the air, even if the value is slightly wrong.
                        Some(on) => place = on.point + on.normal * (2.0 * SETTLED * self.touch),
                        None => return point,
                    }
                }
                Some((_, value)) if value < -most_m => return point,
                _ => return place,
            }
        }
        point
    }

    /// Whether a world point lies on the surface with this number itself. A point on the continuation of one of its
    /// sheets does not count.
    pub fn has(&self, surface: u32, point: DVec3) -> bool {
        self.value(surface, point)
            .is_some_and(|value| value.abs() <= self.touch)
    }

    /// The value of the surface with this number at a world point: positive in the air.
    pub fn value(&self, surface: u32, point: DVec3) -> Option<f64> {
        let index = (surface as usize).wrapping_sub(1);
        let (shape, frame) = self.surfaces.get(index)?;
        Some(shape.value(frame.place(point)))
    }

    /// The numbers of the surfaces that are fields.
    pub fn fields(&self) -> impl Iterator<Item = u32> {
        let all = (1..).zip(&self.surfaces);
        all.filter(|(_, (shape, _))| shape.field().is_some())
            .map(|(number, _)| number)
    }

    /// The sheets of the surface with this number that contain a world point, each as a reflection there; empty for a
    /// surface known only from samples.
    pub fn sheets_at(&self, surface: u32, point: DVec3) -> Vec<Vertex> {
        let search = self.search(surface, point, self.touch);
        let found = search.filter(|_| self.has(surface, point));
        let sheets = found.into_iter().flat_map(|search| search.found);
        let vertex = |sheet: Sheet| {
            let normal = sheet.at(point)?.normal;
            Some(Vertex {
                point,
                normal,
                surface,
            })
        };
        sheets.filter_map(vertex).collect()
    }
}

/// The faces of a single shape whose faces are all plane.
fn faces_of(shape: &Shape, frame: Frame, number: u32, largest: f64) -> Vec<Sheet<'static>> {
    let mut search = Search::near(DVec3::ZERO, f64::INFINITY, largest);
    search.descend(shape, Way::to_surface(number, frame));
    let face = |sheet: Sheet| {
        let (normal, offset) = sheet.plane()?;
        let form = Form::Flat { normal, offset };
        Some(Sheet { form, ..sheet })
    };
    search.found.into_iter().filter_map(face).collect()
}

/// The axes of a surface's own shape, with its rotation normalised.
fn frame(surface: &Surface) -> Frame {
    let [x, y, z, w] = surface.rotation.to_array().map(f64::from);
    let rotation = DQuat::from_xyzw(x, y, z, w).normalize();
    let turn = match rotation == DQuat::IDENTITY {
        true => DMat3::IDENTITY,
        false => DMat3::from_quat(rotation).transpose(),
    };
    Frame::SAME.then(turn, -(turn * surface.position.as_dvec3()))
}
