//! Keys of paths, by which a player recognises a path from one moment to the next.
//!
//! A path keeps its key while it leads over the same surfaces. The ways around both sides of a pillar lead over the same
//! one. Their levels do not distinguish them, because another way is the loudest beyond the axis. The side on which each
//! passes does: the difference between its directions at the listener and at the source points into the pillar.

use super::source_sound::{HeardPath, PathKind};
use crate::sampling::hash;
use glam::{DVec2, DVec3};
use std::collections::{BTreeMap, HashSet};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Angle in radians, from the right counterclockwise, at which the first of the four sides begins. Ways to the right and
/// left, and over and under an obstacle, pass in the middle of a side each.
const FIRST_SIDE: f64 = -0.75 * PI;

/// A key for each path, all different. `bits` is a number for each surface.
///
/// The key of the surfaces belongs to the first path over them that is not diffracted. A diffracted path has this key
/// only if it is the only one over its surfaces.
pub(crate) fn keys(paths: &[&HeardPath], bits: impl Fn(u32) -> u64) -> Vec<u64> {
    let mut keys: Vec<u64> = paths.iter().map(|path| key(path, &bits)).collect();
    let mut diffracted: BTreeMap<u64, Vec<usize>> = BTreeMap::new();
    for (index, path) in paths.iter().enumerate() {
        if path.kind == PathKind::Diffracted {
            diffracted.entry(keys[index]).or_default().push(index);
        }
    }
    for (key, mut indices) in diffracted.into_iter().filter(|(_, paths)| paths.len() > 1) {
        let group: Vec<&HeardPath> = indices.iter().map(|index| paths[*index]).collect();
        let angles: BTreeMap<usize, f64> = indices.iter().copied().zip(angles(&group)).collect();
        indices.sort_by(|a, b| angles[a].total_cmp(&angles[b]));
        let mut given = HashSet::new();
        for index in indices {
            let side = (angles[&index] / FRAC_PI_2) as u64;
            keys[index] = first_free(hash(key ^ hash(1 + side)), &mut given);
        }
    }
    let mut given = HashSet::new();
    for key in &mut keys {
        *key = first_free(*key, &mut given);
    }
    keys
}

/// A number that stays the same over time for a path over the same surfaces and walls: a hash of them. Several paths may
/// have it.
fn key(path: &HeardPath, bits: impl Fn(u32) -> u64) -> u64 {
    let mirrors = path.path.surfaces.iter().zip(&path.path.walls);
    mirrors.fold(0, |key, (surface, wall)| {
        let wall = wall.map_or(0, |wall| u64::from(wall) + 1);
        hash(key ^ hash(bits(*surface) << 8 | wall))
    })
}

/// The key, or the first of its hashes that is not given to another path.
fn first_free(mut key: u64, given: &mut HashSet<u64>) -> u64 {
    while !given.insert(key) {
        key = hash(key);
    }
    key
}

/// The angles about the way from source to listener, from `FIRST_SIDE` on, at which paths pass relative to their mean:
/// radians from 0 to 2π. Up is y, or z for a vertical way.
fn angles(paths: &[&HeardPath]) -> Vec<f64> {
    let ends = paths.iter().map(|path| &path.path);
    let ends = ends.map(|path| (path.departure, path.arrival_direction));
    let ahead: DVec3 = ends.clone().map(|(from, to)| from + to).sum();
    let right = ahead.cross(DVec3::Y).try_normalize().unwrap_or(DVec3::X);
    let up = right.cross(ahead).try_normalize().unwrap_or(DVec3::Z);
    let passing = ends.map(|(from, to)| from - to);
    let passing = passing.map(|aside| DVec2::new(aside.dot(right), aside.dot(up)));
    let passing: Vec<DVec2> = passing.collect();
    let mean = passing.iter().sum::<DVec2>() / passing.len() as f64;
    let angle = |aside: DVec2| (aside.to_angle() - FIRST_SIDE).rem_euclid(TAU);
    passing.iter().map(|aside| angle(*aside - mean)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bands;
    use crate::response::diffracted;
    use crate::scene::Scene;

    /// The key of each path around a body, its direction of arrival and its energy, for a listener at a distance in metres
    /// from the axis behind the body, which is seen along −z.
    fn behind(body: &str, aside: f64) -> BTreeMap<u64, (DVec3, f64)> {
        let text = format!(
            "Scene(surfaces: [Surface(shape: {body})], source: Source(position: (0, 0, 3)), \
             listener: Listener(position: ({aside}, 0, -2.5), radius: 0.05))"
        );
        let scene = Scene::from_ron(&text, "test").expect("a scene");
        let (mut paths, _) = diffracted(&scene).expect("paths");
        // The order in which players take paths.
        paths.sort_by(|a, b| bands::mean(&b.energy).total_cmp(&bands::mean(&a.energy)));
        let paths: Vec<&HeardPath> = paths.iter().collect();
        let keys = keys(&paths, u64::from);
        let heard = |path: &&HeardPath| (path.path.arrival_direction, bands::mean(&path.energy));
        let by_key: BTreeMap<u64, _> = keys.into_iter().zip(paths.iter().map(heard)).collect();
        assert_eq!(by_key.len(), paths.len(), "keys that differ");
        by_key
    }

    /// Protects walks across the axis behind a pillar, a ball and a box, also past its upper edge: the path of each key
    /// comes from nearly the same direction after a step of 1 cm, although another becomes the loudest.
    #[test]
    fn the_path_of_a_key_does_not_change_sides_on_the_axis() {
        for body in [
            "Cylinder(radius: 0.5, height: 500)",
            "Sphere(radius: 1)",
            "Box(size: (1, 500, 1))",
            "Box(size: (1, 1.2, 1))",
        ] {
            let loudest = |paths: &BTreeMap<u64, (DVec3, f64)>| {
                let by_energy = paths.values().max_by(|a, b| a.1.total_cmp(&b.1));
                by_energy.map(|(direction, _)| direction.x > 0.0)
            };
            let mut last = behind(body, -0.1005);
            let first_loudest = loudest(&last);
            for step in -9..=10 {
                let aside = 0.01 * f64::from(step) + 0.0005;
                let paths = behind(body, aside);
                assert!(paths.len() > 1, "{body} at {aside} m");
                for (key, (direction, _)) in &paths {
                    let before = last
                        .get(key)
                        .map(|(before, _)| before.angle_between(*direction));
                    let turn = before.unwrap_or_else(|| panic!("{body} at {aside} m: a new key"));
                    assert!(turn < 0.05, "{body} at {aside} m: {turn} rad");
                }
                last = paths;
            }
            let is_endless = body.contains("500");
            assert!(!is_endless || loudest(&last) != first_loudest, "{body}");
        }
    }
}
