//! Warnings about numbers whose unit is probably another one.

use crate::scene::mesh::LARGEST_USUAL_M;
use crate::scene::{Key, Node, Path, Scene, Surface, Transmission, Warning};
use glam::DVec3;
use std::f32::consts::FRAC_PI_4;

/// Shortest edge in metres of the box around the air of a room above which the unit is probably not the metre. Hardly any
/// hall is as high; a room of 2.5 m in centimetres has 250.
const LONGEST_USUAL_SHORT_EDGE_M: f64 = 200.0;

/// Density in kg/m³ below which the unit is probably not kg/m³. Nearly all foams are heavier; concrete has 2.4 in g/cm³,
/// and steel 7.8.
const LEAST_USUAL_DENSITY: f64 = 8.0;

/// Greatest speed in m/s of a path whose times are probably in milliseconds, and its least duration in seconds.
const SLOWEST_USUAL_MPS: f64 = 0.01;
const SHORTEST_SLOW_PATH_S: f64 = 100.0;

impl Scene {
    /// Warns about rooms that are so large that their unit is probably not the metre. Meshes have their own warning.
    fn large_rooms(&self) -> Vec<Warning> {
        let mut warnings = Vec::new();
        for (index, surface) in self.surfaces.iter().enumerate() {
            let size = surface.room_size();
            let is_large = |size: &DVec3| {
                size.max_element() > LARGEST_USUAL_M
                    || size.min_element() > LONGEST_USUAL_SHORT_EDGE_M
            };
            warnings.extend(size.filter(is_large).map(|size| Warning::LargeRoom {
                surface: surface.label(index),
                length: size.max_element(),
            }));
        }
        warnings
    }

    /// Warns about numbers whose unit is probably another one.
    pub(super) fn odd_units(&self) -> Vec<Warning> {
        let mut warnings = self.large_rooms();
        warnings.extend(self.large_listeners());
        warnings.extend(self.odd_paths());
        let humidity = self.air.map(|air| air.humidity);
        let share = humidity.filter(|humidity| *humidity > 0.0 && *humidity <= 1.0);
        warnings.extend(share.map(|share| Warning::DryAir { humidity: share }));
        for (material, stated) in &self.materials {
            match stated.transmission {
                Some(Transmission::Mass { density, .. }) if density < LEAST_USUAL_DENSITY => {
                    warnings.push(Warning::LightSolid {
                        material: material.clone(),
                        density,
                    });
                }
                _ => (),
            }
        }
        warnings
    }

    /// Warns about listeners whose radius exceeds the shortest edge of a room.
    fn large_listeners(&self) -> Vec<Warning> {
        let edges = self.surfaces.iter().filter_map(Surface::room_size);
        let edge = edges.map(DVec3::min_element).fold(f64::INFINITY, f64::min);
        let listeners = self.listeners.iter().enumerate();
        let large = listeners.filter(|(_, listener)| f64::from(listener.radius) > edge);
        let warning =
            |(index, listener): (usize, &crate::scene::Listener)| Warning::LargeListener {
                listener: self.listener_label(index),
                radius: listener.radius,
                edge,
            };
        large.map(warning).collect()
    }

    /// Warns about yaws that are probably in radians, and about paths whose times are probably in milliseconds.
    fn odd_paths(&self) -> Vec<Warning> {
        let sources = self.sources.iter().enumerate();
        let sources = sources.map(|(at, of)| (self.source_label(at), of.yaw, &of.path));
        let listeners = self.listeners.iter().enumerate();
        let listeners = listeners.map(|(at, of)| (self.listener_label(at), of.yaw, &of.path));
        let mut warnings = Vec::new();
        for (of, yaw, path) in sources.chain(listeners) {
            let yaws = path.keys().iter().map(|key| key.yaw);
            let yaws: Vec<f32> = match path.is_empty() {
                true => vec![yaw],
                false => yaws.collect(),
            };
            let mut turned = yaws.into_iter().filter(|yaw| *yaw != 0.0);
            if let Some(first) = turned.next()
                && is_of_radians(first)
                && turned.all(is_of_radians)
            {
                warnings.push(Warning::YawInRadians {
                    of: of.clone(),
                    yaw: first.to_degrees(),
                });
            }
            if is_slow(path) {
                warnings.push(Warning::SlowPath {
                    of,
                    seconds: path.duration(),
                });
            }
        }
        warnings
    }
}

/// Whether an angle in radians was probably stated in radians where degrees are read: in degrees, it is a rounded
/// multiple of π/4 with two decimals or more.
fn is_of_radians(angle: f32) -> bool {
    const ROUNDING: f32 = 0.0035;
    const TENTH_ROUNDING: f32 = 1e-4;
    let stated = angle.to_degrees();
    let eighths = (stated / FRAC_PI_4).round();
    let tenths = 10.0 * stated;
    (1.0..=8.0).contains(&eighths.abs())
        && (stated - FRAC_PI_4 * eighths).abs() <= ROUNDING
        && (tenths - tenths.round()).abs() > TENTH_ROUNDING
}

/// Whether a path moves so slowly that its times are probably in milliseconds.
fn is_slow(path: &Path) -> bool {
    let speed = |pair: &[Key]| {
        let metres = f64::from(pair[0].position.distance(pair[1].position));
        metres / (pair[1].time - pair[0].time)
    };
    let fastest = path.keys().windows(2).map(speed).fold(0.0, f64::max);
    fastest > 0.0 && fastest < SLOWEST_USUAL_MPS && path.duration() >= SHORTEST_SLOW_PATH_S
}

impl Surface {
    /// The edges in metres of the box around the air of a room; `None` for another shape.
    fn room_size(&self) -> Option<DVec3> {
        let shape = &self.shape;
        match (&shape.node, &shape.children[..]) {
            (Node::Room(room), _) => Some(room.size.as_dvec3()),
            (Node::Rooms(rooms), _) => Some(rooms.mesh().report().size_m),
            (Node::Complement(_), [air]) => {
                let bounds = air.properties().bounds;
                bounds.is_finite().then(|| 2.0 * bounds.half_size())
            }
            _ => None,
        }
    }
}
