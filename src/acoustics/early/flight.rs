//! The directions of flight along a path.

use glam::DVec3;

/// The unit vectors of flight along `points`, one for each segment, mirrored between them at surfaces with these
/// normals. Two points closer than `touch` metres lie in an edge, or an end lies on a surface: between them the
/// direction follows from mirroring; 0 if all are one point.
pub(super) fn directions(points: &[DVec3], normals: &[DVec3], touch: f64) -> Vec<DVec3> {
    let unit = |pair: &[DVec3]| {
        let offset = pair[1] - pair[0];
        (offset.length() > touch).then(|| offset.normalize())
    };
    let long: Vec<Option<DVec3>> = points.windows(2).map(unit).collect();
    let mut all = vec![DVec3::ZERO; long.len()];
    let Some(first) = long.iter().position(Option::is_some) else {
        return all;
    };
    for segment in first..all.len() {
        all[segment] = match long[segment] {
            Some(direction) => direction,
            None => all[segment - 1].reflect(normals[segment - 1]),
        };
    }
    for segment in (0..first).rev() {
        all[segment] = all[segment + 1].reflect(normals[segment]);
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the direction of sound from a source or to a listener on a wall, and in an edge: it leaves a surface
    /// there as it would next to it.
    #[test]
    fn short_segments_are_flown_as_mirrors_say() {
        let (wall, floor) = (DVec3::X, DVec3::Y);
        let (corner, away) = (DVec3::ZERO, DVec3::new(3.0, 4.0, 0.0));
        let out = DVec3::new(0.6, 0.8, 0.0);
        let expected = [-out, DVec3::new(0.6, -0.8, 0.0), out];
        for points in [
            [corner, corner, corner, away],
            [away, corner, corner, corner],
        ] {
            let found = directions(&points, &[wall, floor], 1e-9);
            assert_eq!(found.len(), expected.len());
            let off = found.iter().zip(expected).map(|(a, b)| a.distance(b));
            assert!(off.fold(0.0, f64::max) < 1e-15, "{found:?}");
        }
        assert_eq!(directions(&[away, away], &[], 1e-9), [DVec3::ZERO]);
    }
}
