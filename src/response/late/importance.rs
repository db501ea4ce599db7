//! Importance sampling of start directions: more waves start in directions that contribute to the end of the decay.
//!
//! Between two hard walls a flutter echo remains long after all other sound has been absorbed, and the end of the decay
//! comes from a few waves in ten thousand. The first waves of a response, the pilot waves, therefore estimate the
//! energy from each direction after each moment ([`Pilot`]). The first half of the pilot waves starts evenly. All other
//! waves also start evenly if this half shows that at least [`ENOUGH_WAVES`] effective waves carry each part of the
//! decay, or if two subsets of this half disagree about the directions.
//!
//! Otherwise the second half of the pilot waves is drawn by importance, to refine the estimate in the important
//! directions. Then most of the other waves are drawn by importance and some evenly. The weight of each wave
//! compensates for the uneven starts. The pilot waves are then dropped, because they have influenced the starts of the
//! other waves, and sums have no bias. (If the other waves start evenly, the pilot waves count although they led to
//! this decision: the resulting bias is small.)
//!
//! The energies of pilot waves contain the directivity of the source. If no pilot waves are traced, and the source
//! radiates in a narrow lobe, most waves are drawn by the energy that the source radiates ([`Importance::of_source`]).

use super::pilot::Pilot;
use crate::sampling::{hash, unit_interval};
use crate::scene::{Scene, Source};
use crate::shader::least_scattering;
use crate::sphere_cells::Cells;
use crate::tracer::{Directions, Settings, Start};
use glam::Vec3;
use std::f64::consts::PI;
use std::ops::{Range, RangeInclusive};

/// Number of all waves per pilot wave, both halves of the pilot waves together.
const ONE_OF: u32 = 4;

/// The minimum and the maximum number of pilot waves, both halves together. Fewer waves give no estimate, and more
/// waves are not needed.
const PILOT_WAVES: RangeInclusive<u32> = 2048..=65_536;

/// Sufficient number of waves of equal energy after each moment: the error is then 0.06 dB for a level, and 0.3 % for a
/// decay time evaluated over 30 dB.
const ENOUGH_WAVES: f64 = 5000.0;

/// The share of waves that start evenly: levels and early decays come from these waves. In six very uneven rooms with
/// 262,144 waves and two seeds each, the worst error of T30 was 0.98 % on average with this share and 1.04 % with 0.25.
const EVEN_SHARE: f64 = 0.35;

/// Minimum unevenness of the directions for importance sampling: the mean square of the importance over the square of
/// its mean, which is the factor by which the variance could fall. With 2, the waves drawn by importance, half of all
/// waves, compensate for the evenly started waves and for the dropped pilot waves.
const LEAST_UNEVENNESS: f64 = 2.0;

/// Mean number of pilot waves in a cell: an estimate is blurred over a cell and its neighbours.
const WAVES_IN_CELL: f64 = 2.0;

/// Divisions of a cell along each axis after pilot waves have been drawn by importance: half of an estimate then comes
/// from the smaller cell and its neighbours. The longest lasting waves between two hard walls start within some
/// hundredths of a radian.
const DIVIDED: usize = 4;

/// Greatest share of reflections that the face with the least scattering scatters if there are pilot waves. Waves that are
/// scattered more often soon forget their start direction. In eight rooms with two opposite walls of absorption 0.02 to
/// 0.06, and others of 0.2 to 0.6, with 65,536 waves and ten seeds each, T30 at 500 Hz had a noise below 2.5 % in 25 of
/// 52 responses with even starts and in 45 of 50 with pilot waves if all walls scatter 0.1, but in 38 of 48 and 44 of 49
/// if they scatter 0.14. Pilot waves multiplied the processor time by 1.7.
const MOST_SCATTERING: f64 = 0.12;

/// Greatest number of waves with pilot waves if all faces scatter. Chance decides which of these waves stay between two
/// walls, so that pilot waves predict only a part, and more waves need no prediction. In the eight rooms with a
/// scattering of 0.1, the squared deviation of T30 from the truth was on average 2.4, 1.5, 0.7 and 0.9 times the stated
/// square with even starts and 16,384, 65,536, 131,072 and 262,144 waves; with pilot waves 1.6, 1.3, 1.3 and 2.3 times.
const MOST_WAVES_SCATTERED: u32 = 65_536;

/// Number of pilot waves. 0 if there are too few waves, if their directions are a lattice, which is even only as a
/// whole, or if all faces scatter in these bands and there are more waves than [`MOST_WAVES_SCATTERED`], or all scatter
/// more than [`MOST_SCATTERING`].
pub(super) fn pilot_waves(scene: &Scene, bands: &Range<usize>, trace: &Settings) -> u32 {
    let waves = (trace.waves / ONE_OF).min(*PILOT_WAVES.end());
    let is_random = trace.directions == Directions::Random;
    let may_matter = || match least_scattering(scene, bands) {
        0.0 => true,
        least => least <= MOST_SCATTERING && trace.waves <= MOST_WAVES_SCATTERED,
    };
    match PILOT_WAVES.contains(&waves) && is_random && may_matter() {
        true => waves,
        false => 0,
    }
}

/// Number of cells for the directivity of a source: a cell has a width of about 3°, as narrow as the lobe of a horn at
/// 8 kHz.
const CELLS_OF_SOURCE: f64 = 6144.0;

/// Distribution of the start directions after the pilot waves, or for the directivity of a source.
pub(super) struct Importance {
    cells: Cells,
    /// Cumulative probability of each cell.
    cumulative: Vec<f64>,
}

impl Importance {
    /// Estimates importance from the pilot waves out of `waves` waves, which started in `directions`; `None` if waves
    /// may start evenly.
    pub fn of(pilot: &Pilot, directions: &[Vec3], waves: u32) -> Option<Importance> {
        let sums = pilot.sums();
        let pilot_waves = directions.len() as f64;
        if sums.fewest_waves() >= ENOUGH_WAVES * pilot_waves / f64::from(waves) {
            return None;
        }
        let cells = Cells::about(pilot_waves / WAVES_IN_CELL);
        let importance = pilot.importance(&sums);
        let all = || directions.iter().zip(&importance);
        let halves = [0, 1].map(|half| blurred(all().skip(half).step_by(2), cells));
        if unevenness(&halves) < LEAST_UNEVENNESS {
            return None;
        }
        let [even, odd] = halves;
        let wanted: Vec<f64> = even.iter().zip(&odd).map(|(a, b)| a + b).collect();
        Some(Importance::by(cells, &wanted))
    }

    /// Refines the estimate with all pilot waves, including those drawn by importance, which started in `directions`.
    pub fn refined(pilot: &Pilot, directions: &[Vec3]) -> Importance {
        let importance = pilot.importance(&pilot.sums());
        let cells = Cells::about(directions.len() as f64 / WAVES_IN_CELL);
        let fine = cells.divided(DIVIDED);
        let all = || directions.iter().zip(&importance);
        let (known, mut wanted) = (blurred(all(), cells), blurred(all(), fine));
        for (cell, wanted) in wanted.iter_mut().enumerate() {
            let whole = known[fine.undivided(cell, DIVIDED)];
            *wanted += whole / (DIVIDED * DIVIDED) as f64;
        }
        Importance::by(fine, &wanted)
    }

    /// The distribution by the energy that the source radiates in these bands. `None` if waves start evenly: if there
    /// are few of them, if their directions are a lattice, if the source radiates almost evenly, or if its lobe is
    /// narrower than a cell and lies between the middles of the cells.
    pub fn of_source(
        source: &Source,
        bands: &Range<usize>,
        trace: &Settings,
    ) -> Option<Importance> {
        let is_random = trace.directions == Directions::Random;
        let are_few = trace.waves / ONE_OF < *PILOT_WAVES.start();
        if source.directivity.is_omnidirectional() || !is_random || are_few {
            return None;
        }
        let cells = Cells::about(CELLS_OF_SOURCE);
        let radiated = |cell: usize| {
            let (direction, steradians) = cells.direction(cell, [0.5; 2]);
            let factors = source.factor(direction);
            let squares = factors[bands.clone()].iter().map(|factor| factor * factor);
            let mean_square = squares.sum::<f64>() / bands.len() as f64;
            (mean_square.sqrt(), steradians / (4.0 * PI))
        };
        let radiated: Vec<(f64, f64)> = (0..cells.count()).map(radiated).collect();
        let mean: f64 = radiated
            .iter()
            .map(|(radiated, share)| radiated * share)
            .sum();
        let squares = radiated
            .iter()
            .map(|(radiated, share)| radiated * radiated * share);
        // Both sides are 0 if the lobe lies between the middles of the cells.
        if squares.sum::<f64>() <= LEAST_UNEVENNESS * mean * mean {
            return None;
        }
        let wanted: Vec<f64> = radiated
            .iter()
            .map(|(radiated, share)| radiated * share)
            .collect();
        Some(Importance::by(cells, &wanted))
    }

    /// The distribution over `cells` for the importance `wanted` of each cell.
    fn by(cells: Cells, wanted: &[f64]) -> Importance {
        let all: f64 = wanted.iter().sum();
        let mut sum = 0.0;
        let cumulative = wanted.iter().enumerate().map(|(cell, wanted)| {
            let evenly = cells.direction(cell, [0.5; 2]).1 / (4.0 * PI);
            sum += EVEN_SHARE * evenly + (1.0 - EVEN_SHARE) * wanted / all;
            sum
        });
        Importance {
            cumulative: cumulative.collect(),
            cells,
        }
    }

    /// Draws the starts of waves `numbers` out of `waves`, by seed. Waves are assigned to batches in turn; each batch
    /// is spread over all cells.
    pub fn starts(&self, numbers: Range<u32>, waves: u32, batches: usize, seed: u32) -> Vec<Start> {
        let stream = hash(u64::from(seed));
        let start = |wave: u32| {
            let random =
                |which: u64| unit_interval(hash(stream.wrapping_add(3 * u64::from(wave) + which)));
            let wave = wave as usize;
            let in_batch = (waves as usize - wave % batches).div_ceil(batches);
            let share = ((wave / batches) as f64 + random(0)) / in_batch as f64;
            self.start(share * self.total(), [random(1), random(2)])
        };
        numbers.map(start).collect()
    }

    /// The sum of the probabilities. It is 1, apart from the approximation of each cell's size by the size at its
    /// middle.
    fn total(&self) -> f64 {
        self.cumulative[self.cumulative.len() - 1]
    }

    /// The start at a position in the cell that contains this cumulative probability.
    fn start(&self, until: f64, place: [f64; 2]) -> Start {
        let cell = self.cumulative.partition_point(|sum| *sum <= until);
        let cell = cell.min(self.cumulative.len() - 1);
        let before = if cell == 0 {
            0.0
        } else {
            self.cumulative[cell - 1]
        };
        let probability = (self.cumulative[cell] - before) / self.total();
        let (direction, steradians) = self.cells.direction(cell, place);
        Start {
            direction: direction.as_vec3(),
            weight: (steradians / (4.0 * PI * probability)) as f32,
        }
    }
}

/// The importance of waves by cell: half of a wave's importance counts in its own cell, half in that cell and its
/// neighbours.
fn blurred<'a>(waves: impl Iterator<Item = (&'a Vec3, &'a f64)>, cells: Cells) -> Vec<f64> {
    let mut sums = vec![0.0; cells.count()];
    for (direction, importance) in waves {
        let cell = cells.of(direction.as_dvec3());
        let near: Vec<usize> = cells.about_cell(cell).collect();
        sums[cell] += importance;
        for cell in &near {
            sums[*cell] += importance / near.len() as f64;
        }
    }
    sums
}

/// The mean over the cells of the squared importance, over the square of its mean. The square is the product of the
/// estimates from two halves of the waves, so that chance does not contribute. 1 if all directions are equally
/// important.
fn unevenness([even, odd]: &[Vec<f64>; 2]) -> f64 {
    let both: f64 = even.iter().zip(odd).map(|(even, odd)| even * odd).sum();
    let sum = |half: &[f64]| half.iter().sum::<f64>();
    both * even.len() as f64 / (sum(even) * sum(odd)).max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bands::BAND_COUNT;
    use crate::sampling::lattice;
    use crate::scene::{Balloon, Directivity, Material};
    use glam::DVec3;

    const WAVES: u32 = 1 << 15;

    /// An estimate from a few waves near the z axis that alone carry the end of a decay.
    fn importance_of_few() -> Importance {
        let directions: Vec<Vec3> = lattice(u64::from(WAVES / ONE_OF))
            .map(|d| d.as_vec3())
            .collect();
        let mut pilot = Pilot::new(directions.len() as u32, 1.0);
        pilot.begin(directions.len() as u32);
        for (wave, direction) in directions.iter().enumerate() {
            pilot.add(wave as u32, 0.1, &[1.0; BAND_COUNT]);
            if is_important(direction.as_dvec3()) {
                pilot.add(wave as u32, 0.9, &[1.0; BAND_COUNT]);
            }
        }
        Importance::of(&pilot, &directions, WAVES).expect("few waves bring the end")
    }

    /// Whether a direction is within 0.08 of the z axis, as 0.32 % of all directions are.
    fn is_important(direction: DVec3) -> bool {
        direction.truncate().length() < 0.08
    }

    /// Protects sums over waves from bias: the weights of the waves in any part of the sphere add up to its solid
    /// angle, and no weight is much above 1/[`EVEN_SHARE`].
    #[test]
    fn weights_make_up_for_uneven_directions() {
        const MANY: u32 = 1 << 18;
        let starts = importance_of_few().starts(0..MANY, MANY, 16, 7);
        let heaviest = starts.iter().map(|start| start.weight).fold(0.0, f32::max);
        assert!(heaviest < 1.1 / EVEN_SHARE as f32, "{heaviest}");
        let share = |part: &dyn Fn(DVec3) -> bool| {
            let inside = starts
                .iter()
                .filter(|start| part(start.direction.as_dvec3()));
            inside.map(|start| f64::from(start.weight)).sum::<f64>() / f64::from(MANY)
        };
        let part = 1.0 - (1.0_f64 - 0.08 * 0.08).sqrt();
        // Some 20,000 waves: a deviation of 0.7 %.
        let found = share(&is_important) / part;
        assert!((found - 1.0).abs() < 0.03, "{found}");
        assert!((share(&|_| true) - 1.0).abs() < 0.005);
        for normal in [DVec3::X, DVec3::Y, DVec3::new(1.0, 2.0, 2.0)] {
            let half = share(&|direction| direction.dot(normal) > 0.0);
            assert!((half - 0.5).abs() < 0.01, "{half}");
        }
    }

    /// Protects the purpose of importance sampling: many more waves start in the few directions that carry the end, the
    /// same number in each batch.
    #[test]
    fn more_waves_start_where_they_matter() {
        const BATCHES: usize = 16;
        let starts = importance_of_few().starts(0..WAVES, WAVES, BATCHES, 7);
        let mut found = [0; BATCHES];
        for (wave, start) in starts.iter().enumerate() {
            found[wave % BATCHES] += usize::from(is_important(start.direction.as_dvec3()));
        }
        // With even starts a batch would have 6 or 7.
        assert!(found.iter().all(|found| *found > 100), "{found:?}");
        // By chance, sixteen counts of 300 would have a range of a fifth of their mean.
        let most = found.iter().max().zip(found.iter().min());
        assert!(
            most.is_some_and(|(most, least)| most - least < most / 6),
            "{found:?}"
        );
    }

    /// Protects sources with a narrow lobe: most waves start within it, and the weights compensate for this. Waves of
    /// sources that radiate almost evenly, waves of lattices, and few waves start evenly.
    #[test]
    fn most_waves_start_in_the_lobe_of_a_source() {
        const MANY: u32 = 1 << 17;
        let trace = Settings::default()
            .with_waves(MANY)
            .with_directions(Directions::Random);
        let lobe = |d: DVec3| (d, [(0.5 + 0.5 * d.x).powi(16); BAND_COUNT]);
        let balloon = Balloon::new("lobe", lattice(2000).map(lobe)).expect("a good balloon");
        let directed = |directivity| Source::at([0.0; 3]).with_directivity(directivity);
        let narrow = directed(Directivity::Balloon(balloon.into()));
        let of = |source: &Source, trace: &Settings| Importance::of_source(source, &(0..8), trace);
        let starts = of(&narrow, &trace)
            .expect("a lobe")
            .starts(0..MANY, MANY, 16, 3);
        let in_lobe = starts
            .iter()
            .filter(|start| start.direction.z < -0.7)
            .count();
        assert!(in_lobe > MANY as usize / 2, "{in_lobe}");
        let power = |start: &Start| {
            let factor = narrow.factor(start.direction.as_dvec3())[0];
            f64::from(start.weight) * factor
        };
        let powers: Vec<f64> = starts.iter().map(power).collect();
        let mean = powers.iter().sum::<f64>() / f64::from(MANY);
        assert!((mean - 1.0).abs() < 0.005, "{mean}");
        let mean_square = powers.iter().map(|power| power * power).sum::<f64>() / f64::from(MANY);
        // With even starts the mean square is that of the factors, 17²/33.
        assert!(mean_square < 2.0, "{mean_square}");
        assert!(of(&directed(Directivity::CARDIOID), &trace).is_none());
        let lattice = trace.clone().with_directions(Directions::Fibonacci);
        assert!(of(&narrow, &lattice).is_none());
        assert!(of(&narrow, &trace.with_waves(8191)).is_none());
    }

    /// Protects weights from a division of 0 by 0: waves of a lobe that lies between the middles of the cells start
    /// evenly.
    #[test]
    fn waves_start_evenly_if_the_cells_miss_the_lobe() {
        // A lobe of 1° to the right of the source, where four cells meet.
        let (sin, cos) = 1_f64.to_radians().sin_cos();
        let ring = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]];
        let ring = ring.map(|[ahead, up]| DVec3::new(sin * ahead, -cos, sin * up));
        let others = lattice(100).filter(|direction| direction.y > -0.99);
        let silent = ring
            .into_iter()
            .chain(others)
            .map(|d| (d, [0.0; BAND_COUNT]));
        let loud = (DVec3::NEG_Y, [1.0; BAND_COUNT]);
        let balloon = Balloon::new("lobe", silent.chain([loud])).expect("a good balloon");
        let source = Source::at([0.0; 3]).with_directivity(Directivity::Balloon(balloon.into()));
        assert!(source.factor(DVec3::X)[0] > 1000.0);
        let trace = Settings::default()
            .with_waves(1 << 17)
            .with_directions(Directions::Random);
        assert!(Importance::of_source(&source, &(0..BAND_COUNT), &trace).is_none());
    }

    /// Protects even starts: without important directions waves are not drawn by importance.
    #[test]
    fn importance_that_does_not_repeat_is_none() {
        let directions: Vec<Vec3> = lattice(4096).map(|d| d.as_vec3()).collect();
        let mut pilot = Pilot::new(4096, 1.0);
        pilot.begin(4096);
        for wave in 0..4096 {
            pilot.add(wave, 0.1, &[1.0; BAND_COUNT]);
        }
        for number in 0..64 {
            let wave = (hash(number) % 4096) as u32;
            pilot.add(wave, 0.9, &[1.0; BAND_COUNT]);
        }
        assert!(Importance::of(&pilot, &directions, WAVES).is_none());
    }

    /// Protects starts without pilot waves: of lattices, which are even only as a whole, of runs with few waves, and of
    /// scenes in which all faces scatter. A face that hardly scatters suffices for pilot waves.
    #[test]
    fn some_runs_have_no_pilot_waves() {
        let mut scene = Scene::builtin("shoebox").expect("a built-in scene");
        let of = |scene: &Scene, waves: u32, directions| {
            let trace = Settings::default().with_waves(waves);
            pilot_waves(scene, &(3..6), &trace.with_directions(directions))
        };
        assert_eq!(of(&scene, 1 << 17, Directions::Random), 1 << 15);
        assert_eq!(of(&scene, 1 << 24, Directions::Random), 1 << 16);
        assert_eq!(of(&scene, 8191, Directions::Random), 0);
        assert_eq!(of(&scene, 1 << 18, Directions::Fibonacci), 0);
        let mut rough = Material::absorbing(0.1);
        rough.scattering[3..6].fill(0.2);
        scene.materials.insert("rough".to_owned(), rough);
        scene.surfaces[0].material = Some("rough".to_owned());
        assert_eq!(of(&scene, 1 << 18, Directions::Random), 0);
        rough.scattering[3..6].fill(0.1);
        scene.materials.insert("smooth".to_owned(), rough);
        scene.surfaces[0].walls[0] = Some("smooth".to_owned());
        assert_eq!(of(&scene, 1 << 16, Directions::Random), 1 << 14);
        assert_eq!(of(&scene, 1 << 18, Directions::Random), 0);
        scene.surfaces[0].walls[0] = Some("mirror".to_owned());
        scene
            .materials
            .insert("mirror".to_owned(), Material::MIRROR);
        assert_eq!(of(&scene, 1 << 18, Directions::Random), 1 << 16);
        let trace = Settings::default().with_waves(1 << 18);
        let mirrored = pilot_waves(&scene, &(0..3), &trace.with_directions(Directions::Random));
        assert_eq!(mirrored, 1 << 16);
    }
}
