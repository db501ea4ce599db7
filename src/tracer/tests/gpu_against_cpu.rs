//! Compares the algorithm of the thesis on the GPU with the same algorithm on the CPU, on every API.
//!
//! Both compute in `f32`, but in different orders: a GPU may fuse or regroup operations, and its sine, square root and
//! division may have errors of a few units in the last place. A wave is the same on both until a decision depends on
//! such a difference. Only waves with such a decision may deviate.

use crate::geometry::tests::march32::{self, MarchedWave};
use crate::gl::{Api, Context};
use crate::sampling::median;
use crate::scene::shape::Room;
use crate::test_common::{builtin, context, for_each_api, thesis};
use crate::tracer::{Fate, ThesisOptions, Wave};
use crate::{Frame, Node, Scene, Settings, Surface, Tracer};
use glam::Vec3;

const WAVES: u32 = 65_536;

/// Maximum distance in metres between two ends of a wave that count as equal. A distance near 15 m is rounded by up to
/// 1e-6 m. A normal from differences divides this error by twice its step of 0.01 m, which turns the next direction by
/// up to 5e-5, and most flights are shorter than 20 m. (Measured with llvmpipe for 1,048,576 waves in 8 iterations: at
/// most 2.6e-4, and 3e-8 for most waves.)
const SAME_PLACE: f32 = 1e-3;

/// A decision may differ if two distances differ by less than this margin, in metres. The margin is a hundred roundings
/// of 1e-6 m with the same sign, in the distance and along the march before it. One in a hundred waves has a smaller
/// margin. A wave that deviates for another reason is therefore not detected with a probability of one in a hundred.
const FLIP_MARGIN: f32 = 1e-4;

struct Pair {
    gpu: Wave,
    cpu: MarchedWave,
}

impl Pair {
    fn is_same(&self) -> bool {
        self.gpu.status == self.cpu.status
            && self.gpu.position.distance(self.cpu.position) < SAME_PLACE
    }
}

/// Traces the same start directions on the GPU and on the CPU.
fn trace_both(context: &Context, scene: &Scene, settings: &Settings) -> (Frame, Vec<Pair>) {
    let (frame, waves) = trace(context, scene, settings);
    let starts: Vec<Vec3> = waves.iter().map(|wave| wave.start_direction).collect();
    let marched = march32::march(scene, settings, &starts).unwrap();
    let pairs = waves.into_iter().zip(marched);
    let pairs = pairs.map(|(gpu, cpu)| Pair { gpu, cpu }).collect();
    (frame, pairs)
}

fn trace(context: &Context, scene: &Scene, settings: &Settings) -> (Frame, Vec<Wave>) {
    let mut tracer = Tracer::new(context).unwrap();
    tracer.frame_with_waves(scene, settings).unwrap()
}

/// Every float of a wave as bits. With bits 0 and −0 differ, and a NaN equals itself.
fn bits(wave: &Wave) -> [u32; 12] {
    let [s, p, d] = [wave.start_direction, wave.position, wave.direction]
        .map(|v| v.to_array().map(f32::to_bits));
    [
        s[0],
        s[1],
        s[2],
        p[0],
        p[1],
        p[2],
        d[0],
        d[1],
        d[2],
        wave.status.to_bits(),
        wave.zero_length_passes,
        wave.step_limit_reached,
    ]
}

fn all_bits(waves: &[Wave]) -> Vec<[u32; 12]> {
    waves.iter().map(bits).collect()
}

/// Protects the whole march on the GPU: passes, textures and shaders. At least 99.5 % of the waves end as on the CPU.
/// The other waves depend on a rounding, and the counts differ only by these waves.
#[test]
fn waves_end_on_the_gpu_as_on_the_cpu() {
    for_each_api(|context| {
        for name in ["corner", "obstacles"] {
            let scene = builtin(name);
            for iterations in [4, 8] {
                let (frame, pairs) = trace_both(context, &scene, &thesis(WAVES, iterations));
                check_waves(&format!("{name}, {iterations} iterations"), &pairs);
                check_counts(&frame, &pairs);
            }
        }
    });
}

fn check_waves(case: &str, pairs: &[Pair]) {
    assert_eq!(pairs.len(), WAVES as usize);
    let differ: Vec<&Pair> = pairs.iter().filter(|pair| !pair.is_same()).collect();
    let share = differ.len() as f64 / f64::from(WAVES);
    assert!(share <= 0.005, "{case}: {} waves differ", differ.len());
    for pair in differ {
        let Pair { gpu, cpu } = pair;
        assert!(
            cpu.margin < FLIP_MARGIN,
            "{case}: no close call parted\n{gpu:?} from\n{cpu:?}"
        );
    }
    // The margin is only meaningful if the decisions of most waves are far from it.
    let usual = median(pairs.iter().map(|pair| f64::from(pair.cpu.margin)));
    assert!(
        usual > 10.0 * f64::from(FLIP_MARGIN),
        "{case}: median margin {usual}"
    );
}

fn check_counts(frame: &Frame, pairs: &[Pair]) {
    let counts = frame.counts;
    let sum = |count: fn(&MarchedWave) -> u32| {
        let counts = pairs.iter().map(|pair| u64::from(count(&pair.cpu)));
        counts.sum::<u64>()
    };
    let hits = sum(|wave| u32::from(Fate::of(wave.status) == Fate::Listener));
    let gap = counts.listener_hits.abs_diff(hits);
    // 0.5 % of few hits is less than one wave, but one deviating wave must be allowed.
    let allowed = (0.005 * hits as f64).max(1.0);
    assert!(gap as f64 <= allowed, "{counts:?}, {hits} on the CPU");

    // A wave that deviates may differ in each of its passes. All other waves are equal.
    let of_flips = |count: fn(&Pair) -> u32| {
        let differ = pairs.iter().filter(|pair| !pair.is_same());
        differ.map(|pair| u64::from(count(pair))).sum::<u64>()
    };
    let zero = sum(|wave| wave.zero_length_passes);
    let gap = counts.zero_length_passes.abs_diff(zero);
    let flipped = of_flips(|p| p.gpu.zero_length_passes.max(p.cpu.zero_length_passes));
    assert!(zero > 0 && gap <= flipped, "{counts:?}, {zero} on the CPU");
    assert_eq!(
        counts.step_limit_reached,
        sum(|wave| wave.step_limit_reached)
    );
}

/// Protects the margin with which the test above accepts deviating waves. If the minimum distance is changed by 1e-5 m,
/// only waves deviate whose margin is below that change (and a rounding of 1e-6 m). If every wave had a small margin,
/// the test above would accept every deviation.
#[test]
fn a_margin_tells_which_waves_a_nudge_parts() {
    const NUDGE: f32 = 1e-5;
    let scene = builtin("obstacles");
    let settings = thesis(WAVES, 4);
    let options = ThesisOptions::default();
    let nudged = options.with_min_distance(options.min_distance + NUDGE);
    let nudged = Settings::new(nudged).with_iterations(settings.iterations);
    let starts: Vec<Vec3> = (0..WAVES).map(|w| march32::start_direction(w, 1)).collect();
    let before = march32::march(&scene, &settings, &starts).unwrap();
    let after = march32::march(&scene, &nudged, &starts).unwrap();
    let mut parted = 0;
    for (before, after) in before.iter().zip(&after) {
        if before.position != after.position || before.status != after.status {
            parted += 1;
            assert!(before.margin < NUDGE + 1e-6, "{before:?}\n{after:?}");
        }
    }
    let close = before.iter().filter(|w| w.margin < NUDGE + 1e-6).count();
    assert!(parted > 0 && parted <= close, "{parted} of {close}");
    // A change in one direction affects only margins on one side of the threshold, which are about half of them.
    assert!(4 * parted > close, "{parted} of {close}");
}

/// Protects the start directions: they are unit vectors and equal those of the CPU. They are products of a sine or
/// cosine, a root and the normalisation. Each of these may have an error of a few units in the last place, 1.2e-7 at 1.
#[test]
fn start_directions_are_those_of_the_cpu() {
    let few_ulps = 4.0 * f32::EPSILON;
    for_each_api(|context| {
        for seed in [0, 1, 2011, u32::MAX] {
            let settings = thesis(WAVES, 1).with_seed(seed);
            let (_, waves) = trace(context, &builtin("corner"), &settings);
            for (number, wave) in (0..).zip(&waves) {
                let here = march32::start_direction(number, seed);
                let gap = (wave.start_direction - here).abs().max_element();
                assert!(gap <= few_ulps, "wave {number}, seed {seed}: {gap}");
                let length = wave.start_direction.length();
                assert!((length - 1.0).abs() <= few_ulps, "wave {number}: {length}");
            }
        }
    });
}

/// Protects `thesis` from the driver's result of `normalize(0)`. In the middle of a room that is smaller than the
/// minimum distance all differences are 0, and waves without a normal die there. Waves still reach a listener there.
#[test]
fn waves_without_a_normal_die() {
    let room = Surface::new(Node::Room(Room {
        size: Vec3::splat(0.0625),
    }));
    let mut scene = Scene {
        surfaces: vec![room],
        ..builtin("corner")
    };
    scene.sources[0].position = Vec3::ZERO;
    scene.listeners[0].position = Vec3::new(5.0, 0.0, 0.0);
    let options = ThesisOptions::default().with_start_offset(0.0);
    let settings = Settings::new(options).with_waves(64).with_iterations(1);
    for_each_api(|context| {
        let (frame, pairs) = trace_both(context, &scene, &settings);
        let counts = frame.counts;
        assert_eq!((counts.dead, counts.not_finite), (64, 0));
        assert!(pairs.iter().all(Pair::is_same));
        let mut heard = scene.clone();
        heard.listeners[0].position = Vec3::ZERO;
        let (frame, pairs) = trace_both(context, &heard, &settings);
        assert_eq!(frame.counts.listener_hits, 64);
        assert!(pairs.iter().all(Pair::is_same));
    });
}

/// Protects the uniformity of the start directions, on which all counts of the thesis rely. A component of a uniform
/// direction has the variance 1/3. Its mean over n waves has the standard deviation √(1/3n), and five standard
/// deviations are exceeded once in 1.7 million draws. The chi square of the octants has 7 degrees of freedom, and
/// exceeds 40 once in 1.7 million draws too.
#[test]
fn start_directions_are_uniform() {
    let context = context(Api::Gl);
    for seed in [1, 2, 2011] {
        let settings = thesis(WAVES, 1).with_seed(seed);
        let (_, waves) = trace(&context, &builtin("corner"), &settings);
        let mut mean = glam::DVec3::ZERO;
        let mut octants = [0.0; 8];
        for Wave {
            start_direction, ..
        } in &waves
        {
            mean += start_direction.as_dvec3() / f64::from(WAVES);
            octants[start_direction.cmplt(Vec3::ZERO).bitmask() as usize] += 1.0;
        }
        let sigma = (1.0 / (3.0 * f64::from(WAVES))).sqrt();
        assert!(mean.abs().max_element() < 5.0 * sigma, "{mean}");
        let expected = f64::from(WAVES) / 8.0;
        let terms = octants.map(|n: f64| (n - expected).powi(2) / expected);
        let chi_square: f64 = terms.iter().sum();
        assert!(chi_square < 40.0, "seed {seed}: {octants:?}");
    }
}

/// Protects reproducibility: one seed gives the same bits in a second frame and on a second context. Another seed gives
/// other waves.
#[test]
fn a_seed_decides_every_bit() {
    for_each_api(|first| {
        let scene = builtin("obstacles");
        let settings = thesis(4096, 8);
        let mut tracer = Tracer::new(first).unwrap();
        let mut again = |settings: Settings| tracer.frame_with_waves(&scene, &settings).unwrap();
        let (frame, waves) = again(settings.clone());
        let (other_frame, other_waves) = again(settings.clone().with_seed(2));
        let (second_frame, second_waves) = again(settings.clone());
        assert_eq!(all_bits(&waves), all_bits(&second_waves));
        assert_eq!(frame.counts, second_frame.counts);
        assert_eq!(frame.panning, second_frame.panning);

        let second_context = context(first.api());
        let (_, second_waves) = trace(&second_context, &scene, &settings);
        assert_eq!(all_bits(&waves), all_bits(&second_waves));

        // Two random directions out of 2^48 are practically never equal.
        let kept = waves.iter().zip(&other_waves);
        let kept = kept.filter(|(a, b)| a.start_direction == b.start_direction);
        assert_eq!(kept.count(), 0);
        assert_ne!(frame.counts, other_frame.counts);
    });
}

/// Protects counts if the waves do not fill a square texture: each wave is counted once, and texels beyond the last
/// wave are ignored.
#[test]
fn every_wave_is_counted_once() {
    for_each_api(|context| {
        let scene = builtin("corner");
        for waves in [1, 2, 3, 64, 1000, 1023, 65_537] {
            let (frame, ends) = trace(context, &scene, &thesis(waves, 8));
            let counts = frame.counts;
            let sum = counts.listener_hits + counts.dead + counts.travelling + counts.not_finite;
            assert_eq!(sum, u64::from(waves), "{counts:?}");
            assert_eq!(ends.len(), waves as usize);
            let of = |fate| ends.iter().filter(|w| w.fate() == fate).count() as u64;
            assert_eq!(counts.listener_hits, of(Fate::Listener));
            assert_eq!(counts.dead, of(Fate::Dead));
            let zero = ends.iter().map(|w| u64::from(w.zero_length_passes));
            assert_eq!(counts.zero_length_passes, zero.sum::<u64>());
            // Every heard wave contributes 1, divided into two parts, whose sum is 1 within rounding in `f32`.
            let given = frame.panning.left + frame.panning.right;
            let hits = counts.listener_hits as f64;
            assert!((given - hits).abs() <= 1e-7 * hits, "{given} of {hits}");
        }
    });
}

/// Protects a wave from its neighbours: a wave depends only on its number and the seed, and not on the size of the
/// texture.
#[test]
fn a_wave_is_the_same_in_a_larger_frame() {
    for_each_api(|context| {
        let scene = builtin("obstacles");
        let (_, few) = trace(context, &scene, &thesis(1000, 8));
        let (_, many) = trace(context, &scene, &thesis(4096, 8));
        assert_eq!(all_bits(&few), all_bits(&many[..1000]));
    });
}
