//! Study files and the scene files that they name.

use super::Target;
use super::scratch::with_file;
use echomarch_lab::study::{Shard, Study};

const TOKENS: &[&str] = &[
    "Study",
    "name",
    "scenes",
    "Scene",
    "of",
    "corner",
    "shoebox",
    "room.ron",
    "study.ron",
    "values",
    "List",
    "Range",
    "Geometric",
    "from",
    "to",
    "count",
    "times",
    "settings",
    "All",
    "Accuracy",
    "quick",
    "full",
    "profiles",
    "hybrid",
    "march",
    "thesis",
    "waves",
    "iterations",
    "directions",
    "random",
    "lattice",
    "listeners",
    "sources",
    "Grid",
    "Path",
    "through",
    "counts",
    "AsInScene",
    "listener_radius",
    "seeds",
    "keep",
    "Keep",
    "pan",
    "exact",
    "response",
    "Response",
    "figures",
    "bands_hz",
    "seconds",
    "order",
    "errors",
    "echogram_ms",
    "t30",
    "g",
    "c80",
    "true",
    "false",
];

const CORPUS: [&str; 4] = [
    "Study(scenes: [Scene(of: \"corner\"), Scene(of: \"room.ron\", values: {\"v\": Range(from: 0.5, to: 1, count: 3)})], \
     listeners: Grid(from: (-3, 0, 2), to: (3, 0, 3), counts: (5, 1, 5)), settings: All(waves: [512, 1024], iterations: \
     [3]), seeds: Range(from: 1, count: 2))",
    "Study(name: \"n\", scenes: [Scene(of: \"room.ron\")], times: Geometric(from: 0.1, to: 2, count: 3), sources: \
     Path(through: [(0, 0, 0), (1, 0, 0)], count: 4), listeners: List([(1, 0, 1)]), listener_radius: 0.5, seeds: \
     List([1, 2, 9]), keep: Keep(pan: true, counts: false, exact: true))",
    "Study(scenes: [Scene(of: \"shoebox\")], settings: Accuracy(quick), keep: Keep(pan: false))",
    "Study(scenes: [Scene(of: \"room.ron\")], settings: All(profiles: [hybrid, march], waves: [64]), keep: \
     Keep(response: Response(figures: [t30, g, c80], bands_hz: [500, 1000], seconds: 1, order: 2, errors: true, \
     echogram_ms: 50)))",
];

const ROOM: &[u8] =
    b"Scene(surfaces: [Surface(shape: Room(size: (9, 5, 9))), Surface(shape: Sphere(radius: \
    Value(\"v\", 0.6)), position: (0, -2, 0))], source: Source(position: (-3, 1, 1)), listener: \
    Listener(position: (3, 1, 1), radius: 1))";

/// The fuzz target of corrupted study files.
pub fn target() -> Target {
    Target {
        name: "study",
        corpus: CORPUS.map(|text| text.as_bytes().to_vec()).to_vec(),
        tokens: TOKENS,
        one,
    }
}

/// Reads a study. An accepted study must have points, each in exactly one shard.
pub fn one(data: &[u8]) {
    with_file("room.ron", ROOM, |_| ());
    with_file("study.ron", data, |path| match Study::from_file(path) {
        Err(error) => assert!(!error.to_string().is_empty()),
        Ok(study) => {
            assert!(study.points() > 0 && study.hash().len() == 64);
            let of = 7;
            let all = Shard::all(of).map(|shard| shard.points(study.points()));
            assert_eq!(all.sum::<u64>(), study.points());
        }
    });
}
