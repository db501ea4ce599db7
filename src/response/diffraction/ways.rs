//! All ways around an obstacle, and the sum of their pressures.

use super::bend::Bend;
use super::completed::{add_images, add_lines, up_to_its_ends};
use super::errors::{GAP_ERRORS_DB, errors_of_bend_db};
use super::interference::Sound;
use super::narrow::{factor_of, wideness};
use super::rim::Rim;
use super::ring::{self, Basin, Detours, all_samples};
use super::round::Arc;
use super::samples::{End, LEAST_DETOUR_M, Samples};
use super::space::Space;
use super::string::{HALF_PLANES, HalfPlanes, STEP, TautString};
use super::wedge::behind_screen;
use crate::bands::{BAND_COUNT, Bands, greater};
use glam::DVec3;
use num_complex::Complex64;

/// Phase in radians between the longest string around a closed obstacle and the straight line at which the factors of the
/// ways count half: a narrower obstacle disturbs the front as a thin screen does. The same for the longer way around an
/// endless obstacle.
const NARROW: f64 = 3.0;
const NARROW_ENDLESS: f64 = 0.2;

/// Turns of the half-plane in radians over which the growth of a string's length is measured: the first one counts if the
/// next gives the same growth.
const BESIDE: [f64; 4] = [0.1, 0.05, 0.025, 0.0125];

/// Greatest ratio of two growths that count as the same. The growth of a length that bends off beside the way doubles
/// with half the turn.
const SAME_GROWTH: f64 = 1.5;

/// Growth in metres that does not count: a phase of 0.15 rad at 8 kHz.
const NO_GROWTH_M: f64 = 1e-3;

/// Greatest pressure of a ray tube, relative to that of the strings beside its way. On a ball both are the same. Where
/// strings beside the way lead over another body too, their lengths do not bound the ray tube, which would become up to 20
/// times as loud.
const MOST_FOCUS: f64 = 2.0;

/// Angle in half-planes up to which a bend belongs to a basin: the search for the stationary way moves it.
const SAME_BASIN: f64 = 3.0;

/// The ways around what is between two points.
pub(super) struct Ways {
    pub bends: Vec<Way>,
    /// Unit vector into the half-plane of the shortest string, or into the first half-plane without strings.
    towards_shortest: DVec3,
    /// Detour of the shortest string in metres; infinite without strings.
    shortest_m: f64,
    /// Edges beside the ways.
    rims: Vec<Rim>,
    /// Strings around the far side of what is beside a free way, in half-planes next to free ones: behind the obstacle they
    /// belong to the way over the edge that is beside the free way here.
    border: Vec<Samples>,
    /// Distance between the points in metres.
    pub apart_m: f64,
    /// Wavelength over 2π in metres at which the factors of the ways count half.
    pub wide_m: f64,
}

/// One way, with the half-planes around it.
pub(super) struct Way {
    pub bend: Bend,
    /// The way around the other side, where the strings of all half-planes belong to this way.
    pub opposite: Option<Opposite>,
    /// Whether the way, and that around the other side, are heard.
    are_heard: [bool; 2],
    /// Detours of the half-planes that become longer from its own on.
    own: Vec<Samples>,
    /// Detours over the lines of its edges, if these are parallel.
    lines: Vec<Samples>,
    /// The least detour over these lines in metres: less than that of the way if they end before. `None` for edges that are
    /// not parallel, as a jamb and a lintel: half-planes over both lines have no stationary way in common.
    endless_m: Option<f64>,
    /// Ways along the surface in each half-plane, if the way has a single turn and that is curved.
    arcs: Vec<Option<Arc>>,
    /// Wavelength over 2π in metres at which the factor of the way counts half: infinite for an obstacle without an end.
    wide_m: f64,
    /// Curvature across the way, as a share of that along it: 1 on a ball, 0 on a cylinder.
    closed: f64,
    /// Growth of the detour with the square of the tangent of the azimuth, in metres.
    growth_m: f64,
    /// Growth in metres that an edge of the same turn would have.
    edge_growth_m: f64,
    /// Growth in metres that follows from the width of the ray tube.
    tube_growth_m: f64,
}

/// The way around the other side of an obstacle.
pub(super) struct Opposite {
    bend: Bend,
    /// The share of each half-plane that belongs to it.
    shares: [f64; HALF_PLANES],
}

impl Ways {
    pub fn around(space: &impl Space, planes: &HalfPlanes) -> Ways {
        let apart_m = planes.apart_m();
        let mut strings = planes.strings(space);
        let detour = |string: &TautString| string.length_m() - apart_m;
        let mut detours: Detours = std::array::from_fn(|index| strings[index].as_ref().map(detour));
        let bends = |basin: &Basin| Bend::of(space, planes, basin.shortest as f64 * STEP);
        let found: Vec<Bend> = Basin::all(&detours).iter().filter_map(bends).collect();
        for bend in &found {
            match bend.is_narrow() {
                true => add_lines(space, planes, bend, &mut detours),
                false => add_images(space, planes, bend, (&mut strings, &mut detours)),
            }
        }
        let mut bends: Vec<Way> = Vec::new();
        let mut border = Vec::new();
        let wide_m = wide_m(space, planes, (&strings, &detours));
        for basin in Basin::all(&detours) {
            if planes.are_beside() && !basin.is_inner(&detours) {
                border.push(basin.samples(&detours));
                continue;
            }
            let turned = |bend: &&Bend| basin.turns_from(bend.azimuth);
            let near = found.iter().min_by(|a, b| turned(a).total_cmp(&turned(b)));
            let Some(bend) = near.filter(|bend| turned(bend) <= SAME_BASIN) else {
                continue;
            };
            let samples = basin.samples(&detours);
            let own = up_to_its_ends(space, planes, bend, (samples, &detours));
            match bends.iter_mut().find(|way| way.bend.is_same(bend)) {
                Some(way) => way.own.push(own),
                None => {
                    let bend = bend.clone().with_brinks(space);
                    let way = Way {
                        growth_m: growth_m(space, planes, &bend),
                        ..Way::of(space, planes, &strings, bend, own, wide_m)
                    };
                    bends.push(way.with_other_side(space, planes, (&basin, &detours)));
                }
            }
        }
        if planes.are_beside() && bends.is_empty() {
            let far = Way::around_far_side(space, planes, (&strings, &detours), wide_m);
            if let Some(far) = far {
                bends.push(far);
                border.clear();
            }
        }
        let lengths = detours.iter().enumerate();
        let lengths = lengths.filter_map(|(index, detour)| Some((index, (*detour)?)));
        let shortest = lengths.min_by(|a, b| a.1.total_cmp(&b.1));
        Ways {
            towards_shortest: planes.upwards(shortest.map_or(0, |(index, _)| index) as f64 * STEP),
            shortest_m: shortest.map_or(f64::INFINITY, |(_, detour)| detour),
            rims: Rim::all(space, planes, &strings),
            border,
            bends,
            apart_m,
            wide_m,
        }
    }

    /// The ways around the far side of the obstacle of an edge beside a free way: their border reaches as far as the
    /// half-planes of the edge do. There both are continuous with the ways behind the edge.
    pub fn behind(mut self, rim: &Rim) -> Ways {
        let reaching = |samples: Samples| {
            let end = |side: usize| {
                let (index, detour_m) = samples.outer()[side];
                let angle = rim.angle_beyond(index, side);
                (angle > 0.0).then_some(End::Until { angle, detour_m })
            };
            let ends = [end(0), end(1)];
            samples.with_ends(ends)
        };
        self.border = self.border.into_iter().map(reaching).collect();
        self
    }

    /// The direction away from the solid if an edge lies on the straight way, or if the strings have no way over their
    /// edges, as at a thin plate seen edge-on. Where the straight way touches a solid, the shortest string may have no bend.
    pub fn touched(&self) -> Option<DVec3> {
        let is_touched = |way: &&Way| way.bend.length_m - self.apart_m < LEAST_DETOUR_M;
        let touched = self.bends.iter().find(is_touched);
        let has_no_bend = self.bends.is_empty() || self.shortest_m < LEAST_DETOUR_M;
        let lost = has_no_bend.then_some(self.towards_shortest);
        touched.map(|way| way.bend.outwards()).or(lost)
    }

    /// Keeps only the bends and edges with a point that satisfies the condition.
    pub fn retain(&mut self, is_kept: impl Fn(DVec3) -> bool) {
        let is_on = |bend: &Bend| bend.turns.iter().any(|turn| is_kept(turn.middle));
        for way in &mut self.bends {
            let on = way.sides().map(|bend| bend.is_some_and(is_on));
            way.are_heard = on;
        }
        self.bends.retain(|way| way.heard().next().is_some());
        self.rims.retain(|rim| is_kept(rim.point()));
    }

    /// The pressure reflection coefficients by band at the turns of each way, then at each edge beside the ways.
    pub fn faces(
        &self,
        space: &impl Space,
        coefficients: impl Fn(u32, DVec3) -> Bands,
    ) -> Vec<Vec<Bands>> {
        let face = |point: DVec3| coefficients(space.nearest(point), space.in_scene(point));
        let of_bends = self.bends.iter().map(|way| {
            let turns = way.bend.turns.iter();
            turns.map(|turn| face(turn.middle)).collect()
        });
        let of_rims = self.rims.iter().map(|rim| vec![face(rim.point())]);
        of_bends.chain(of_rims).collect()
    }

    /// The coefficients of one band.
    pub fn in_band(faces: &[Vec<Bands>], band: usize) -> Vec<Vec<f64>> {
        let of_one = |faces: &Vec<Bands>| faces.iter().map(|face| face[band]).collect();
        faces.iter().map(of_one).collect()
    }

    /// The sounds of the bends that are heard, followed by those of the edges beside the ways, relative to the open, for
    /// the wave number `k`, and the energy of reflections that end at these edges. `faces` has the pressure reflection
    /// coefficients at the turns of each way, and at each edge.
    pub fn sounds(&self, space: &impl Space, k: f64, faces: &[Vec<f64>]) -> (Vec<Sound>, f64) {
        let (of_bends, of_rims) = faces.split_at(self.bends.len());
        let ways = self.bends.iter().zip(of_bends).flat_map(|(way, faces)| {
            let pressures = way.pressures(space, k, faces, self.apart_m);
            let sides = way.sides().into_iter().zip(way.are_heard);
            let sounds = sides.zip(pressures.unwrap_or_default());
            sounds.filter_map(|((bend, is_heard), pressure)| {
                Some(Sound {
                    pressure,
                    length_m: bend.filter(|_| is_heard)?.length_m,
                })
            })
        });
        let mut sounds: Vec<Sound> = ways.collect();
        let mut reflected = 0.0;
        for (rim, face) in self.rims.iter().zip(of_rims.iter().flatten()) {
            let Some(added) = rim.added(space, k, (*face, 1.0)) else {
                continue;
            };
            reflected += added.reflected;
            sounds.push(Sound {
                pressure: added.direct,
                length_m: rim.length_m,
            });
        }
        (sounds, reflected)
    }

    /// The sound of the strings in half-planes next to free ones for the wave number `k`, relative to the open. `behind` is
    /// the pressure behind the edge beside the free way, relative to that behind a thin screen.
    pub fn at_border(&self, k: f64, behind: Complex64) -> Sound {
        let detours = self.border.iter().map(Samples::least);
        Sound {
            pressure: behind * ring::sum(&self.border, k),
            length_m: self.apart_m + detours.fold(f64::INFINITY, f64::min),
        }
    }

    /// Whether strings lead around what is beside a free way next to free half-planes.
    pub fn has_border(&self) -> bool {
        !self.border.is_empty()
    }

    /// The coefficients of rigid surfaces, for [`Ways::sounds`].
    #[cfg(test)]
    pub fn rigid(&self) -> Vec<Vec<f64>> {
        let of_bends = self.bends.iter().map(|way| vec![1.0; way.bend.turns.len()]);
        of_bends
            .chain(self.rims.iter().map(|_| vec![1.0]))
            .collect()
    }

    /// Half-widths in decibels of the intervals that contain 95 % of the errors of the energies, by band.
    pub fn errors_db(&self) -> Bands {
        let of_ways = self.bends.iter().map(|way| errors_of_bend_db(&way.bend));
        let of_rims = (!self.rims.is_empty()).then_some(GAP_ERRORS_DB);
        of_ways.chain(of_rims).fold([0.0; BAND_COUNT], greater)
    }
}

impl Way {
    /// A way whose length grows beside it as its ray tube does.
    fn of(
        space: &impl Space,
        planes: &HalfPlanes,
        strings: &[Option<TautString>],
        bend: Bend,
        own: Samples,
        wide_m: f64,
    ) -> Way {
        let arcs = strings
            .iter()
            .map(|string| string.as_ref().and_then(TautString::single_arc))
            .collect();
        let apart_m = planes.apart_m();
        let detour_m = bend.length_m - apart_m;
        let are_parallel = bend.has_parallel_edges();
        let lines = ring::detours(|azimuth| {
            let length = bend.length_over_lines(planes, azimuth);
            Some(length.filter(|_| are_parallel)? - apart_m)
        });
        let (edge_growth_m, width, closed) = match bend.turns[..] {
            [turn] => {
                let arc = bend.arc(0);
                let across = bend.across(space, 0);
                let closed = (across * turn.radius_m()).min(1.0);
                (arc.argument(1.0).powi(2), arc.width(across).abs(), closed)
            }
            _ => (detour_m, 1.0, 0.0),
        };
        let spread = (bend.length_m / apart_m).powf(2.0 * closed);
        let tube_growth_m = edge_growth_m * width * spread;
        Way {
            own: vec![own],
            arcs,
            lines: all_samples(&lines),
            endless_m: are_parallel.then(|| bend.length_over_endless_lines() - apart_m),
            wide_m,
            growth_m: tube_growth_m,
            edge_growth_m,
            tube_growth_m,
            closed,
            opposite: None,
            are_heard: [true; 2],
            bend,
        }
    }

    /// The ways around the far side of a closed round body beside a free way. They are longest in the middle, and meet
    /// those over its near side where the half-planes touch it: their sum over the half-planes counts.
    fn around_far_side(
        space: &impl Space,
        planes: &HalfPlanes,
        (strings, detours): (&[Option<TautString>], &Detours),
        wide_m: f64,
    ) -> Option<Way> {
        let (basin, longest) = Basin::around_longest(detours)?;
        let bend = Bend::of(space, planes, longest as f64 * STEP)?;
        let own = basin.samples(detours);
        let way = Way::of(space, planes, strings, bend, own, wide_m);
        (way.closed > 0.0).then_some(way)
    }

    /// Adds the way around the other side, if the strings of its basin become longer up to a single one there.
    fn with_other_side(
        self,
        space: &impl Space,
        planes: &HalfPlanes,
        (basin, detours): (&Basin, &Detours),
    ) -> Way {
        if planes.are_beside() || !basin.is_closed() {
            return self;
        }
        let azimuth = basin.longest_after() as f64 * STEP;
        let is_opposite = |bend: &Bend| (bend.azimuth - self.bend.azimuth).cos() < 0.0;
        let bend = Bend::of(space, planes, azimuth).filter(is_opposite);
        Way {
            opposite: bend.map(|bend| Opposite {
                bend,
                shares: ring::shares_of_longest(detours),
            }),
            ..self
        }
    }

    /// The way, and that around the other side.
    fn sides(&self) -> [Option<&Bend>; 2] {
        let opposite = self.opposite.as_ref().map(|opposite| &opposite.bend);
        [Some(&self.bend), opposite]
    }

    /// The bends of the way that are heard.
    pub fn heard(&self) -> impl Iterator<Item = &Bend> {
        let sides = self.sides().into_iter().zip(self.are_heard);
        sides.filter_map(|(bend, is_heard)| bend.filter(|_| is_heard))
    }

    /// Pressures at the listener for the wave number `k`, relative to the open at the straight way: along the way, and
    /// around the other side.
    ///
    /// The half-planes are divided between both sides by their detours. On the axis of a body of revolution both sides
    /// have the same sound. Far from it each has that of the stationary string in its middle.
    fn pressures(
        &self,
        space: &impl Space,
        k: f64,
        faces: &[f64],
        apart_m: f64,
    ) -> Option<[Complex64; 2]> {
        let bend = &self.bend;
        let detour_m = bend.length_m - apart_m;
        let product = bend.pressure(space, k, faces)?;
        let wide = wideness(k * self.wide_m);
        let screen = |growth_m: f64| behind_screen(k * growth_m);
        let relative = |factor: Complex64| factor_of(factor, wide);
        let softness = match faces {
            [face] => 0.5 * (1.0 + face),
            _ => 1.0,
        };
        let round = bend.most_round(space, k);
        let [mut all, mut opposite] = [Complex64::ZERO; 2];
        if round < 1.0 {
            let alone = product * (apart_m / bend.length_m) / screen(detour_m);
            let factor = (1.0 - round) * relative(alone);
            let [own, beyond] = self.sums(k, |_| Complex64::ONE);
            let endless = self.endless_m.map_or(Complex64::ZERO, |detour_m| {
                screen(detour_m) * Complex64::cis(k * detour_m) - ring::sum(&self.lines, k)
            });
            let front = endless + own;
            all += factor * front;
            opposite += factor * beyond;
        }
        if round > 0.0 {
            let spread = (apart_m / bend.length_m).powf(1.0 - self.closed);
            let factor = relative(product * spread / screen(self.edge_growth_m));
            let [own, beyond] = self.sums(k, |index| match &self.arcs[index] {
                Some(arc) => relative(
                    softness * spread * arc.pressure(k) / screen(arc.argument(1.0).powi(2)),
                ),
                None => factor,
            });
            let focus = round * self.focus(k);
            all += own * focus;
            opposite += beyond * focus;
        }
        Some([all - opposite, opposite])
    }

    /// The pressure of the ray tube relative to that of the strings in the half-planes beside the way, at most
    /// [`MOST_FOCUS`].
    fn focus(&self, k: f64) -> Complex64 {
        let [tube, strings] =
            [self.tube_growth_m, self.growth_m].map(|growth_m| behind_screen(k * growth_m));
        let focus = tube / strings;
        focus / (focus.norm() / MOST_FOCUS).max(1.0)
    }

    /// The integral of exp(ikδ) over the half-planes of the way, divided by 2π, and the part of it around the other
    /// side. `factor` takes the index of the half-plane.
    fn sums(&self, k: f64, factor: impl Fn(usize) -> Complex64) -> [Complex64; 2] {
        let factors: Vec<Complex64> = (0..HALF_PLANES).map(factor).collect();
        let sum = |share: &dyn Fn(usize) -> f64| -> Complex64 {
            let own = self.own.iter();
            own.map(|own| own.weighted_sum(k, |index| factors[index] * share(index)))
                .sum()
        };
        let opposite = self.opposite.as_ref();
        let around_opposite = opposite.map(|opposite| sum(&|index| opposite.shares[index]));
        [sum(&|_| 1.0), around_opposite.unwrap_or_default()]
    }
}

/// Growth of the length of a way with the square of the tangent of the azimuth in metres, from the strings beside it. If a
/// string beside the way touches another body, or leads over an edge, it is much longer: the growth then depends on the
/// turn, and the least one counts. 0 for edges, which have no focus.
fn growth_m(space: &impl Space, planes: &HalfPlanes, bend: &Bend) -> f64 {
    if bend.is_sharp() {
        return 0.0;
    }
    let beside = |turn: f64| {
        let string = planes.string(space, bend.azimuth + turn)?;
        Some((string.length_m() - bend.length_m) / turn.tan().powi(2))
    };
    let mut wider: Option<f64> = None;
    let mut least = f64::INFINITY;
    for turn in BESIDE {
        let sides: Vec<f64> = [turn, -turn].into_iter().filter_map(beside).collect();
        let mean = sides.iter().sum::<f64>().max(0.0) / sides.len().max(1) as f64;
        if let Some(wider) = wider
            && wider <= SAME_GROWTH * mean + NO_GROWTH_M
            && mean <= SAME_GROWTH * wider + NO_GROWTH_M
        {
            return wider;
        }
        wider = (!sides.is_empty()).then_some(mean);
        least = sides.into_iter().fold(least, f64::min);
    }
    match least.is_finite() {
        true => least.max(0.0),
        false => 0.0,
    }
}

/// The wavelength over 2π in metres at which the factors of the ways around an obstacle with these detours count half;
/// infinite if a single way leads around what hides the source.
fn wide_m(
    space: &impl Space,
    planes: &HalfPlanes,
    (strings, detours): (&[Option<TautString>], &Detours),
) -> f64 {
    // Beside a free way, a closed body has a string wherever it blocks a tent.
    let is_around = |index: usize| strings[index].is_some() || !planes.is_blocked(space, index);
    if (0..HALF_PLANES).all(is_around) {
        return detours.iter().flatten().copied().fold(0.0, f64::max) / NARROW;
    }
    // Beside a free way, the way over the edge that is beside it is not among them.
    let mut basins = Basin::all(detours);
    let least = match planes.are_beside() {
        true => 1,
        false => 2,
    };
    basins.retain(|basin| !planes.are_beside() || basin.is_inner(detours));
    if basins.len() < least {
        return f64::INFINITY;
    }
    let of_ways = basins.iter().filter_map(|basin| detours[basin.shortest]);
    of_ways.fold(0.0, f64::max) / NARROW_ENDLESS
}
