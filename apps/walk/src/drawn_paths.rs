//! The exact paths that the plan draws.

use echomarch::bands;
use echomarch::response::{HeardPath, PathKind, Response};
use echomarch::scene::Pair;
use glam::Vec3;

/// Maximum number of paths drawn per source. More paths would cover each other.
pub const DRAWN_PER_SOURCE: usize = 8;

/// An exact path of the last trace, for the plan.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnPath {
    /// The kind of the path.
    pub kind: PathKind,
    /// World positions in metres: the source, the path's points, the listener.
    pub points: Vec<Vec3>,
}

impl DrawnPath {
    fn of(pair: Pair, path: &HeardPath) -> DrawnPath {
        let between = path.path.points.iter().map(|point| point.as_vec3());
        let points = [pair.source().position].into_iter().chain(between);
        DrawnPath {
            kind: path.kind,
            points: points.chain([pair.listener().position]).collect(),
        }
    }
}

/// Returns the paths to draw: first the direct, diffracted and transmitted paths, then the mirrored paths, each group
/// with the loudest first. Energy added up to the least level has no path of its own.
pub(super) fn of_response(pair: Pair, response: &Response) -> Vec<DrawnPath> {
    let is_drawn = |path: &&HeardPath| path.kind != PathKind::Added;
    let mut paths: Vec<&HeardPath> = response.paths.iter().filter(is_drawn).collect();
    let is_mirrored = |path: &HeardPath| path.kind == PathKind::Mirrored;
    let energy = |path: &HeardPath| bands::mean(&path.energy);
    paths.sort_by(|a, b| {
        let kinds = is_mirrored(a).cmp(&is_mirrored(b));
        kinds.then(energy(b).total_cmp(&energy(a)))
    });
    paths.truncate(DRAWN_PER_SOURCE);
    paths
        .into_iter()
        .map(|path| DrawnPath::of(pair, path))
        .collect()
}
