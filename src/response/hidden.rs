//! The sound of a source that is hidden from the listener: paths around what is in the way, and the path through it.

use super::diffraction::{self, Change, Mirror, Reflection};
use super::omnidirectional_path::Path;
use super::source_sound::{HeardPath, Medium, PathKind};
use super::transmission;
use crate::bands::{self, BAND_COUNT, Bands};
use crate::error::Error;
use crate::geometry::ExactScene;
use crate::platform::Instant;
use crate::response::exact_paths::{EarlyPaths, SpecularPath, Vertex};
use crate::response::{ResponseSettings, Tap};
use crate::scene::{IntoPair, Pair, Scene};
use glam::DVec3;
use rayon::prelude::*;
use std::time::Duration;

/// The sound that obstacles hide, along paths around them and through them.
#[derive(Default)]
pub(super) struct Hidden {
    /// The paths around what hides the source.
    around: Vec<HeardPath>,
    /// The paths around what hides reflections.
    reflected: Vec<Bent>,
    /// The straight path through what hides the source.
    through: Option<HeardPath>,
    /// The energy of the direct sound, or of the paths around what hides the source.
    first: Bands,
    /// Time that diffraction took.
    diffraction: Duration,
}

impl Hidden {
    /// Finds the hidden paths that the settings choose. Edges beside the other `paths` change their energies.
    /// `reflections` are the hidden reflections at plane faces.
    pub fn find(
        (pair, medium, early): (Pair, &Medium, &EarlyPaths),
        settings: &ResponseSettings,
        reflections: &[Vertex],
        paths: &mut [HeardPath],
    ) -> Hidden {
        let is_hidden = !paths.iter().any(HeardPath::is_direct);
        let transmits = settings.transmits() && is_hidden;
        if !settings.diffracts() && !transmits {
            return Hidden::default();
        }
        let obstacles = Obstacles::of(pair, medium, early);
        let mut hidden = Hidden::default();
        let began = Instant::now();
        if settings.diffracts() {
            hidden.reflected = obstacles.reflections_around(reflections);
            obstacles.change_beside(paths);
            if is_hidden {
                hidden.around = obstacles.paths_around();
            }
            hidden.diffraction = began.elapsed();
        }
        let direct = paths.iter().filter(|path| path.is_direct());
        hidden.first = bands::sum(direct.chain(&hidden.around).map(|path| &path.energy));
        if transmits {
            hidden.through = obstacles.path_through(&hidden.around);
        }
        hidden
    }

    /// Whether the sound bends around what hides the source.
    pub fn is_bent(&self) -> bool {
        !self.around.is_empty()
    }

    /// Whether the sound bends around what hides the reflection with this index.
    pub fn is_reflection_bent(&self, reflection: usize) -> bool {
        let mut all = self.reflected.iter();
        all.any(|bent| bent.reflection == reflection)
    }

    /// Whether paths replace the waves that pass solids in a straight line.
    pub fn replaces_straight_waves(&self) -> bool {
        self.is_bent() || self.through.is_some()
    }

    /// Time in milliseconds that diffraction took.
    pub fn diffraction_milliseconds(&self) -> f64 {
        self.diffraction.as_secs_f64() * 1e3
    }

    /// An estimate of the reflections of higher order that do not bend, if more than one face reflects: the taps of those
    /// of first order, weaker by the same ratio as those are weaker than the direct sound, or than the paths around what hides it.
    pub fn further_reflections(&self) -> Vec<Tap> {
        if self.reflected.len() < 2 {
            return Vec::new();
        }
        let all = || self.reflected.iter().flat_map(|bent| &bent.paths);
        let first = bands::sum(all().map(|path| &path.energy));
        let ratio: Bands = std::array::from_fn(|band| match first[band] < self.first[band] {
            true => first[band] / self.first[band],
            false => 1.0,
        });
        let tap = |path: &HeardPath| Tap {
            energy: std::array::from_fn(|band| path.energy[band] * ratio[band]),
            ..path.tap_of_energy()
        };
        all().map(tap).collect()
    }

    /// All paths.
    pub fn paths(&self) -> impl Iterator<Item = &HeardPath> {
        let reflected = self.reflected.iter().flat_map(|bent| &bent.paths);
        self.around.iter().chain(reflected).chain(&self.through)
    }
}

/// The direct ways of the sources of a scene in its current state: straight, or around and through what is in between.
#[cfg(feature = "simulator")]
pub(crate) struct DirectWays {
    early: EarlyPaths,
}

#[cfg(feature = "simulator")]
impl DirectWays {
    /// # Errors
    /// The errors of [`Scene::validate`].
    pub fn new(pair: Pair) -> Result<DirectWays, Error> {
        Ok(DirectWays {
            early: EarlyPaths::new(pair)?,
        })
    }

    /// The straight path of a pair, as if nothing were in between; `None` if both ends coincide.
    pub fn in_the_open(pair: Pair) -> Option<HeardPath> {
        let ends = [pair.source.position, pair.listener.position].map(|end| end.as_dvec3());
        let straight = Path::straight(PathKind::Direct, (ends[0], ends[1]))?;
        Some(straight.heard(pair, &Medium::of(pair)))
    }

    /// Whether nothing lies between source and listener.
    pub fn is_in_sight(&self, pair: Pair) -> bool {
        let ends = self.early.ends(pair);
        let (a, b) = (ends.source, ends.listener);
        self.early.is_open(a) && self.early.is_open(b) && self.early.exact().is_in_sight(a, b)
    }

    /// The paths around and through what hides the source, as chosen.
    pub fn around_and_through(&self, pair: Pair, settings: &ResponseSettings) -> Vec<HeardPath> {
        let medium = Medium::of(pair);
        let obstacles = Obstacles::of(pair, &medium, &self.early);
        let mut paths = match settings.diffracts() {
            true => obstacles.paths_around(),
            false => Vec::new(),
        };
        if settings.transmits() {
            paths.extend(obstacles.path_through(&paths));
        }
        paths
    }
}

/// The effect of diffraction on the direct sound of a pair: the paths around the obstacle that hides the source, and the
/// energy of the direct sound by band, relative to that in the open. No paths if the pair is in sight, or an end lies in a solid.
///
/// # Errors
/// The errors of [`Scene::validate`].
#[doc(hidden)]
pub fn diffracted<'a>(pair: impl IntoPair<'a>) -> Result<(Vec<HeardPath>, Bands), Error> {
    let pair = pair.chosen()?;
    let medium = Medium::of(pair);
    let early = EarlyPaths::new(pair)?;
    let obstacles = Obstacles::of(pair, &medium, &early);
    let around = obstacles.paths_around();
    let beside = match obstacles.ends.filter(|_| around.is_empty()) {
        Some(ends) => {
            diffraction::beside(early.exact(), ends, medium.speed, obstacles.faces()).energy
        }
        None => [0.0; BAND_COUNT],
    };
    Ok((around, beside))
}

/// Maximum number of hidden reflections, and of paths in sight, whose diffraction is computed: those with the
/// shortest ways. Each takes milliseconds, at users' fields tens of them, and scenes can have thousands of faces.
const MOST_REFLECTIONS: usize = 32;

/// The surfaces between the source and the listener of a pair.
struct Obstacles<'a> {
    pair: Pair<'a>,
    medium: &'a Medium,
    early: &'a EarlyPaths,
    /// The source and the listener; `None` if either is in a solid.
    ends: Option<(DVec3, DVec3)>,
}

/// The paths around what hides the reflection at a plane face.
struct Bent {
    /// The index of the reflection.
    reflection: usize,
    /// The sound along the paths.
    paths: Vec<HeardPath>,
}

impl<'a> Obstacles<'a> {
    fn of(pair: Pair<'a>, medium: &'a Medium, early: &'a EarlyPaths) -> Obstacles<'a> {
        let ends = early.ends(pair);
        let ends = (ends.source, ends.listener);
        let are_open = early.is_open(ends.0) && early.is_open(ends.1);
        Obstacles {
            pair,
            medium,
            early,
            ends: are_open.then_some(ends),
        }
    }

    /// The pressure reflection coefficients of a surface, by its number, at a point, and by band.
    fn faces(&self) -> impl Fn(u32, DVec3) -> Bands {
        let (pair, exact) = (self.pair, self.early.exact());
        let ends = [pair.source.position, pair.listener.position].map(|end| end.as_dvec3());
        move |surface, point| {
            let way_m = ends.iter().map(|end| end.distance(point)).sum::<f64>();
            pressure_reflection(pair.scene, exact, surface, (point, AT_EDGE * way_m))
        }
    }

    /// The paths around what hides the source from the listener; none if they see each other, or if either is in a solid.
    fn paths_around(&self) -> Vec<HeardPath> {
        let Some(ends) = self.ends else {
            return Vec::new();
        };
        let (exact, speed) = (self.early.exact(), self.medium.speed);
        let paths = diffraction::around(exact, ends, speed, self.faces());
        self.heard_together(paths.into_iter().map(Path::from))
    }

    /// The sound along paths around the same obstacle. Their samples interfere with the amplitudes at the listener, after
    /// the source's directivity and the loss in the air.
    fn heard_together(&self, paths: impl Iterator<Item = Path>) -> Vec<HeardPath> {
        let paths = paths.map(|path| path.heard(self.pair, self.medium));
        let mut paths: Vec<HeardPath> = paths.collect();
        let ways = paths.iter().map(|path| (path.energy, path.path.length_m));
        let ways: Vec<(Bands, f64)> = ways.collect();
        let in_samples = diffraction::in_samples(self.medium.speed, &ways);
        for path in &mut paths {
            path.in_samples = in_samples;
        }
        paths
    }

    /// The paths around the obstacles that hide these reflections at plane faces, for those with the shortest ways.
    fn reflections_around(&self, hidden: &[Vertex]) -> Vec<Bent> {
        let Some(ends) = self.ends else {
            return Vec::new();
        };
        let way_m = |vertex: &Vertex| mirror(vertex).image(ends.0).distance(ends.1);
        let mut nearest: Vec<(usize, &Vertex)> = hidden.iter().enumerate().collect();
        nearest.sort_by(|a, b| way_m(a.1).total_cmp(&way_m(b.1)));
        nearest.truncate(MOST_REFLECTIONS);
        let bent = |(reflection, vertex): (usize, &Vertex)| {
            let (exact, speed) = (self.early.exact(), self.medium.speed);
            let paths =
                diffraction::around_mirrored(exact, mirror(vertex), ends, speed, self.faces());
            let wall = self.wall(vertex);
            // The ways with one reflection and those with two share different energies.
            let groups = paths.chunk_by(|a, b| a.reflections.len() == b.reflections.len());
            let heard = groups.flat_map(|group| {
                let paths = group.iter().map(|path| {
                    let path = path.clone().within_faces(exact, vertex.normal, ends, speed);
                    Path::reflected(path, self.pair.scene, wall)
                });
                self.heard_together(paths)
            });
            let paths: Vec<HeardPath> = heard.collect();
            (!paths.is_empty()).then_some(Bent { reflection, paths })
        };
        nearest.into_par_iter().filter_map(bent).collect()
    }

    /// The change of the direct sound and of reflections by the edges of obstacles beside their ways, and by the ends of plane
    /// faces, for those with the shortest ways.
    fn change_beside(&self, paths: &mut [HeardPath]) {
        let Some(ends) = self.ends else {
            return;
        };
        // Paths are in the order of their lengths.
        let most = paths.len().min(MOST_REFLECTIONS);
        paths[..most].par_iter_mut().for_each(|path| {
            let (exact, speed, faces) = (self.early.exact(), self.medium.speed, self.faces());
            if path.is_direct() {
                change(path, &diffraction::beside(exact, ends, speed, faces));
                return;
            }
            let reflections = self.at_planes(&path.path, ends);
            if let ([surface], [plane]) = (&path.path.surfaces[..], &reflections[..]) {
                let mirror = Mirror {
                    surface: *surface,
                    point: plane.point,
                    normal: plane.normal,
                };
                let beside = diffraction::beside_mirrored(exact, mirror, ends, speed, faces);
                change(path, &beside);
            }
            let within = diffraction::within_faces(exact, &reflections, speed);
            multiply(&mut path.energy, within);
        });
    }

    /// The reflections of a path at plane faces.
    fn at_planes(
        &self,
        path: &SpecularPath,
        (source, listener): (DVec3, DVec3),
    ) -> Vec<Reflection> {
        let points = [&[source], &path.points[..], &[listener]].concat();
        let reflection = |(index, &surface): (usize, &u32)| {
            let [from, point, to] = [points[index], points[index + 1], points[index + 2]];
            let (towards, away) = (point - from, to - point);
            let (towards, away) = (towards.try_normalize()?, away.try_normalize()?);
            let normal = (away - towards).try_normalize()?;
            let vertex = Vertex {
                point,
                normal,
                surface,
            };
            match self.early.are_flat(&[vertex]) {
                true => Reflection::on_way(&points, index + 1, normal),
                false => None,
            }
        };
        let surfaces = path.surfaces.iter().enumerate();
        surfaces.filter_map(reflection).collect()
    }

    fn wall(&self, vertex: &Vertex) -> Option<u8> {
        self.early.walls(std::slice::from_ref(vertex)).next()?
    }

    /// The path straight through what hides the source from the listener; `None` if nothing passes, or if either is in a
    /// solid. `around` are the paths around the obstacle: it intercepts only the rest of the front.
    fn path_through(&self, around: &[HeardPath]) -> Option<HeardPath> {
        let ends = self.ends?;
        let passed = transmission::through(self.pair.scene, self.early.exact(), ends)?;
        let straight = Path::straight(PathKind::Transmitted, ends)?;
        let detour = |path: &HeardPath| path.path.length_m - straight.length_m;
        let detours: Vec<f64> = around.iter().map(detour).collect();
        let intercepted = diffraction::intercepted(&detours, self.medium.speed);
        let passing = |band: usize| intercepted[band] * straight.energy[band] * passed.share[band];
        let path = Path {
            walls: vec![None; passed.surfaces.len()],
            points: passed.points,
            surfaces: passed.surfaces,
            energy: std::array::from_fn(passing),
            ..straight
        };
        Some(path.heard(self.pair, self.medium))
    }
}

/// Distance from an edge within which faces meet there, as a share of the length of the way round it. Edges are found within
/// 1e-5 of this length.
const AT_EDGE: f64 = 1e-4;

/// The share of the pressure that a surface reflects at a point, by band: 1 for a surface without a material. At the edge of
/// a mesh, or of rooms, the mean of the faces within `reach_m` metres.
fn pressure_reflection(
    scene: &Scene,
    exact: &ExactScene,
    surface: u32,
    (point, reach_m): (DVec3, f64),
) -> Bands {
    let Some(index) = (surface as usize).checked_sub(1) else {
        return [1.0; BAND_COUNT];
    };
    let groups = exact.groups_near(surface, point, reach_m);
    let groups = groups.into_iter().map(Some);
    let mut faces: Vec<Option<usize>> = groups.collect();
    if faces.is_empty() {
        faces.push(None);
    }
    let count = faces.len() as f64;
    let coefficients = faces.into_iter().map(|face| {
        let material = scene.material(index, face);
        material.map_or([1.0; BAND_COUNT], |material| {
            material.absorption.map(|share| (1.0 - share).sqrt())
        })
    });
    coefficients.fold([0.0; BAND_COUNT], |sum, of| {
        std::array::from_fn(|band| sum[band] + of[band] / count)
    })
}

fn change(path: &mut HeardPath, by: &Change) {
    multiply(&mut path.energy, by.energy);
    path.errors_db = by.errors_db;
}

fn multiply(energy: &mut Bands, shares: Bands) {
    for (energy, share) in energy.iter_mut().zip(shares) {
        *energy *= share;
    }
}

fn mirror(vertex: &Vertex) -> Mirror {
    Mirror {
        surface: vertex.surface,
        point: vertex.point,
        normal: vertex.normal,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn path(energy: f64) -> HeardPath {
        let scene = Scene::builtin("open-field").expect("a built-in scene");
        let pair = scene.pair(0, 0).expect("a pair");
        let medium = Medium {
            air: [0.0; BAND_COUNT],
            ..Medium::of(pair)
        };
        let straight = Path::straight(PathKind::Diffracted, (DVec3::ZERO, 10.0 * DVec3::X));
        let path = Path {
            energy: [energy; BAND_COUNT],
            ..straight.expect("two points")
        };
        path.heard(pair, &medium)
    }

    /// The paths around a pillar to a listener beside its axis, so that the detours differ by half a wavelength of 1 kHz.
    fn paths_around_pillar(directivity: &str) -> Vec<HeardPath> {
        let text = format!(
            "Scene(surfaces: [Surface(shape: Cylinder(radius: 0.5, height: 500))], \
             source: Source(position: (0, 0, 3), {directivity}), \
             listener: Listener(position: (0.4, 0, -2.5), radius: 0.05))"
        );
        let scene = Scene::from_ron(&text, "test").expect("a scene");
        let (paths, _) = diffracted(&scene).expect("paths");
        assert_eq!(paths.len(), 2);
        paths
    }

    /// Protects the samples of a cardioid that radiates nothing to one side of a pillar: the other side interferes with
    /// nothing, and its samples have the energy of its path.
    #[test]
    fn samples_of_the_only_way_that_a_source_radiates_to_have_its_energy() {
        let both = paths_around_pillar("");
        let most = both[0].in_samples.into_iter().fold(0.0, f64::max);
        assert!(most > 1.5, "{most}");
        for path in both {
            let silent = path.path.departure;
            let yaw = (-silent.x).atan2(silent.z).to_degrees();
            let paths = paths_around_pillar(&format!("directivity: Cardioid, yaw: {yaw}"));
            let is_silent = |path: &&HeardPath| path.path.departure.distance(silent) < 1e-6;
            let [of_silent, of_other] = [true, false].map(|silent| {
                let mut own = paths.iter().filter(|path| is_silent(path) == silent);
                own.next().expect("a path")
            });
            for band in 0..BAND_COUNT {
                assert!(of_silent.energy[band] < 1e-6 * of_other.energy[band]);
                let factor = of_other.in_samples[band];
                assert!((factor - 1.0).abs() < 0.01, "band {band}: {factor}");
            }
        }
    }

    /// Protects responses that were saved before paths stated the energy of their samples: it is that of the paths.
    #[test]
    fn a_saved_path_without_samples_has_those_of_its_energy() {
        let mut saved = serde_json::to_value(path(2.0)).expect("JSON");
        let fields = saved.as_object_mut().expect("an object");
        assert!(fields.remove("in_samples").is_some());
        let read: HeardPath = serde_json::from_value(saved).expect("a path");
        assert_eq!(read, path(2.0));
        assert_eq!(read.tap().energy, read.energy);
    }

    fn bent(reflection: usize, energy: f64) -> Bent {
        Bent {
            reflection,
            paths: vec![path(energy)],
        }
    }

    /// Protects the estimate of what does not bend: reflections continue their series, by at most their own energy, and a
    /// single face has no further ones.
    #[test]
    fn further_reflections_continue_the_series() {
        let energies = |around: f64, reflected: Vec<f64>| -> Vec<f64> {
            let reflected = reflected.into_iter().enumerate();
            let hidden = Hidden {
                first: [around; BAND_COUNT],
                reflected: reflected
                    .map(|(index, energy)| bent(index, energy))
                    .collect(),
                ..Hidden::default()
            };
            let taps = hidden.further_reflections();
            taps.iter().map(|tap| tap.energy[0]).collect()
        };
        assert_eq!(energies(8.0, vec![1.0, 3.0]), [0.5, 1.5]);
        assert_eq!(energies(1.0, vec![1.0, 3.0]), [1.0, 3.0]);
        assert_eq!(energies(0.0, vec![1.0, 3.0]), [1.0, 3.0]);
        assert!(energies(1.0, vec![1.0]).is_empty());
    }
}
