//! Edges beside a free way: they diffract although they hide nothing.
//!
//! In each half-plane the tent that is free is raised further, until an obstacle blocks it. The edge that it then touches
//! adds its diffracted pressure, which has the opposite sign to that behind an edge: together with the direct sound the
//! pressure is continuous at the boundary of the shadow. A plane has no diffracted pressure, and drops out.

use super::bend::Bend;
use super::beyond::FaceBeside;
use super::edge::{Edge, MOST_SEARCHES, ON_SURFACE, face_distance_m};
use super::errors::{TWO_EDGES_ERRORS_DB, errors_of_bend_db};
use super::narrow::factor_of;
use super::ring::{self, Basin, Detours, all_samples};
use super::samples::{LEAST_DETOUR_M, Samples};
use super::space::Space;
use super::string::{HALF_PLANES, HalfPlanes, STEP, TautString};
use super::touch::{edge_at, most_detour_m, touched};
use super::wedge::{Diffracted, Wedge, behind_screen};
use crate::bands::Bands;
use glam::DVec3;
use num_complex::Complex64;
use std::f64::consts::PI;

/// Difference in radians between the angle of the air and half a turn up to which an edge is a plane.
const PLANE: f64 = 0.01;

/// Share of the greatest detour up to which an edge counts fully.
const FULL: f64 = 0.5;

/// An edge beside the way.
pub(super) struct Rim {
    source: DVec3,
    listener: DVec3,
    edge: Edge,
    /// Unit vector from the edge to the straight way.
    inwards: DVec3,
    /// Length in metres of the shortest way over the line of the edge.
    pub length_m: f64,
    /// The way that would just touch the edge.
    grazing: Option<Bend>,
    /// Detour in metres at which the edge no longer counts.
    most_detour_m: f64,
    /// Half-planes whose tents touch obstacles, and those of them whose tents touch this edge.
    own: Vec<(Samples, [bool; HALF_PLANES])>,
    lines: Vec<Samples>,
    /// The faces beside the source and beside the listener.
    faces: [FaceBeside; 2],
    /// The half-planes on the edge's side of the straight way in which it is the first obstacle.
    pub half_planes: [bool; HALF_PLANES],
}

/// The pressures that an edge adds, relative to the direct sound.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Added {
    /// To the direct sound.
    pub direct: Complex64,
    /// To reflections at its faces in the direction of the direct sound, which end together with it.
    ending: Complex64,
    /// Energy of reflections at its faces beyond their ends.
    pub reflected: f64,
    /// The pressure behind the edge at the boundary of its shadow, relative to that behind a thin screen.
    pub behind: Complex64,
}

impl Rim {
    /// The edges beside the straight way if `strings` is empty, otherwise those beyond the strings.
    pub fn all(
        space: &impl Space,
        planes: &HalfPlanes,
        strings: &[Option<TautString>],
    ) -> Vec<Rim> {
        let above = |index: usize| strings.get(index).map(Option::as_ref);
        let touches: Touches = std::array::from_fn(|index| match above(index) {
            Some(None) => None,
            known => touched(space, planes, (index as f64 * STEP, known.flatten())),
        });
        let detours = touches.map(|touch| touch.map(|touch| planes.detour_m(touch)));
        let search = Search {
            space,
            planes,
            above: &above,
            touches: &touches,
            detours,
        };
        let mut rims: Vec<Rim> = Vec::new();
        for basin in Basin::all(&detours) {
            let azimuth = basin.shortest as f64 * STEP;
            let Some(rim) = Rim::of(space, planes, azimuth, above(basin.shortest).flatten()) else {
                continue;
            };
            let owners = search.owners(&basin, rim, &mut rims);
            for (number, rim) in rims.iter_mut().enumerate() {
                let own = owners.map(|owner| owner == Some(number));
                if own.contains(&true) {
                    let detours = rim.over_its_line(planes, &touches, detours);
                    rim.add(planes, basin.samples(&detours), own);
                }
            }
        }
        // A face between two of the edges reflects once.
        for index in 1..rims.len() {
            let (before, rest) = rims.split_at_mut(index);
            let near_m = rest[0].near_m();
            for (other, face) in before.iter().flat_map(|other| [(other, 0), (other, 1)]) {
                rest[0].faces[face].leave_to(&other.edge, near_m);
            }
        }
        rims
    }

    fn of(
        space: &impl Space,
        planes: &HalfPlanes,
        mut azimuth: f64,
        above: Option<&TautString>,
    ) -> Option<Rim> {
        let mut last = None;
        for _ in 0..MOST_SEARCHES {
            let Some((edge, _)) = edge_at(space, planes, (azimuth, above), 0.0) else {
                break;
            };
            let (rim, is_nearest) = Rim::nearest(space, planes, edge, azimuth);
            if is_nearest {
                return rim.if_edge(space, planes, (azimuth, above));
            }
            last.get_or_insert(rim);
            let (source, listener) = planes.ends();
            azimuth = planes.azimuth_of(edge.shortest(source, listener));
        }
        last?.if_edge(space, planes, (azimuth, above))
    }

    /// The edge on this line, which a tent in the half-plane of an azimuth touches.
    fn on_edge(
        space: &impl Space,
        planes: &HalfPlanes,
        edge: Edge,
        (azimuth, above): (f64, Option<&TautString>),
    ) -> Option<Rim> {
        let (rim, _) = Rim::nearest(space, planes, edge, azimuth);
        rim.if_edge(space, planes, (azimuth, above))
    }

    /// The edge at the point with the shortest way and `true`, or at the point that a tent touches if it does not lie on a
    /// solid there.
    fn nearest(space: &impl Space, planes: &HalfPlanes, edge: Edge, azimuth: f64) -> (Rim, bool) {
        let (source, listener) = planes.ends();
        let point = edge.shortest(source, listener);
        let touching = Rim::at(planes, edge, azimuth);
        let shortest = Rim::at(planes, Edge { point, ..edge }, azimuth);
        match shortest.is_on_solid(space) {
            _ if touching.touches_the_straight_way() => (touching, true),
            true => (shortest, true),
            false => (touching, false),
        }
    }

    /// The edge with the surfaces about it; `None` if the surface is plane there. An edge on the straight way always counts.
    fn if_edge(
        self,
        space: &impl Space,
        planes: &HalfPlanes,
        (azimuth, above): (f64, Option<&TautString>),
    ) -> Option<Rim> {
        let is_edge = self.touches_the_straight_way() || self.is_edge(space);
        is_edge.then(|| {
            let rim = self.with_faces(space, most_detour_m(planes, above));
            if above.is_none() {
                return rim;
            }
            let other = rim.at_other_end(space, planes, azimuth);
            let nearer = other.filter(|other| other.length_m < rim.length_m);
            nearer.unwrap_or(rim)
        })
    }

    /// The edge at the other end of a narrow face beside this one. Which of both a tent touches first may depend on
    /// rounding.
    fn at_other_end(&self, space: &impl Space, planes: &HalfPlanes, azimuth: f64) -> Option<Rim> {
        let edge = self.faces.iter().find_map(FaceBeside::other_end)?;
        let (rim, _) = Rim::nearest(space, planes, edge, azimuth);
        let rim = rim.with_faces(space, self.most_detour_m);
        rim.has_on_strip(self.point()).then_some(rim)
    }

    fn at(planes: &HalfPlanes, edge: Edge, azimuth: f64) -> Rim {
        let (source, listener) = planes.ends();
        let shortest = edge.shortest(source, listener);
        let line = |azimuth: f64| planes.on_line(&edge, azimuth);
        let lines = ring::detours(|azimuth| line(azimuth).map(|point| planes.detour_m(point)));
        Rim {
            source,
            listener,
            inwards: -planes.upwards(azimuth),
            length_m: shortest.distance(source) + shortest.distance(listener),
            edge,
            own: Vec::new(),
            grazing: None,
            most_detour_m: 0.0,
            lines: all_samples(&lines),
            faces: [FaceBeside::default(); 2],
            half_planes: [false; HALF_PLANES],
        }
    }

    /// Adds half-planes, and those of them in which tents touch the edge.
    fn add(&mut self, planes: &HalfPlanes, samples: Samples, own: [bool; HALF_PLANES]) {
        let side = planes.azimuth_of(self.point());
        for index in (0..HALF_PLANES).filter(|index| own[*index]) {
            self.half_planes[index] |= (index as f64 * STEP - side).cos() > 0.0;
        }
        self.own.push((samples, own));
    }

    /// Looks at the surfaces about the edge, which counts up to a detour of `most_detour_m` metres.
    fn with_faces(self, space: &impl Space, most_detour_m: f64) -> Rim {
        let grazing = |from: DVec3, to: DVec3| {
            let after_m = self.edge.point.distance(to);
            Bend::grazing(space, from, self.edge, after_m, self.inwards)
        };
        // The source's way along a face leads into it: then a shadow of the listener begins at this edge.
        let way = grazing(self.source, self.listener);
        Rim {
            grazing: way.or_else(|| grazing(self.listener, self.source)),
            most_detour_m,
            faces: [[self.source, self.listener], [self.listener, self.source]]
                .map(|ends| FaceBeside::of(space, (&self.edge, self.inwards), ends)),
            ..self
        }
    }

    /// Whether a point lies on the line of the edge.
    fn has_on_line(&self, point: DVec3) -> bool {
        self.edge.is_near(point, self.near_m())
    }

    /// Whether a point lies on the other end of a narrow face beside the edge.
    fn has_on_strip(&self, point: DVec3) -> bool {
        let mut faces = self.faces.iter();
        faces.any(|face| face.ends_at(point, self.near_m()))
    }

    /// The detours of half-planes, over the line of the edge where tents touch the other end of a face beside it.
    fn over_its_line(
        &self,
        planes: &HalfPlanes,
        touches: &Touches,
        mut detours: Detours,
    ) -> Detours {
        for (index, detour) in detours.iter_mut().enumerate() {
            if touches[index].is_some_and(|touch| self.has_on_strip(touch)) {
                let point = planes.on_line(&self.edge, index as f64 * STEP);
                *detour = point.map(|point| planes.detour_m(point)).or(*detour);
            }
        }
        detours
    }

    /// Angle in radians by which the half-planes of the edge reach beyond this one, in the direction of falling (0) or of
    /// rising azimuths (1): half of the angle to the next one if that touches another edge.
    pub fn angle_beyond(&self, index: usize, side: usize) -> f64 {
        let next = (index + [HALF_PLANES - 1, 1][side]) % HALF_PLANES;
        let angle = |(samples, own): &(Samples, [bool; HALF_PLANES])| match own[index] && !own[next]
        {
            true if samples.outer()[side].0 == index => samples.ends()[side].angle(),
            true => 0.5 * STEP,
            false => 0.0,
        };
        self.own.iter().map(angle).fold(0.0, f64::max)
    }

    /// Distance in metres up to which points are the same.
    fn near_m(&self) -> f64 {
        ON_SURFACE.sqrt() * self.length_m
    }

    /// The integral of exp(ikδ) over the half-planes whose tents touch the edge, divided by 2π.
    fn own_sum(&self, k: f64) -> Complex64 {
        let share = |own: &[bool; HALF_PLANES], index: usize| f64::from(own[index]).into();
        let sums = self.own.iter();
        sums.map(|(samples, own)| samples.weighted_sum(k, |index| share(own, index)))
            .sum()
    }

    fn is_same(&self, other: &Rim) -> bool {
        self.edge.point.distance(other.edge.point) < self.near_m()
    }

    fn is_on_solid(&self, space: &impl Space) -> bool {
        let error = ON_SURFACE * self.length_m;
        let lifted = self.edge.point + self.inwards * error;
        space.distance(self.edge.point).abs() <= error
            && space.is_free(self.source, lifted)
            && space.is_free(self.listener, lifted)
    }

    /// Whether the surface is not plane there.
    fn is_edge(&self, space: &impl Space) -> bool {
        // The zone of the wave number 0 is endless: the legs limit the distance.
        let radius = self.face_m(0.0);
        let is_edge = |share: f64| {
            let wedge = self.wedge(space, share * radius);
            wedge.is_some_and(|wedge| wedge.air_angle > PI + PLANE)
        };
        is_edge(1.0) || is_edge(0.1)
    }

    /// Distance in metres from the edge at which sound of the wave number `k` perceives its faces.
    fn face_m(&self, k: f64) -> f64 {
        let legs = [self.source, self.listener].map(|end| end - self.edge.point);
        let [a, b] = legs.map(|leg| self.edge.across(leg).length());
        face_distance_m(k, legs.map(DVec3::length), a.min(b))
    }

    fn wedge(&self, space: &impl Space, radius: f64) -> Option<Wedge> {
        let ends = [self.source, self.listener];
        self.edge.wedge(space, ends, self.inwards, radius)
    }

    /// The pressures that the edge adds for the wave number `k`. `face` is the pressure reflection coefficient of its
    /// faces, and `wide` is how much its obstacle differs from a thin screen, from 0 to 1.
    pub fn added(&self, space: &impl Space, k: f64, (face, wide): (f64, f64)) -> Option<Added> {
        let detour_m = self.detour_m();
        let straight = behind_screen(k * detour_m) * Complex64::cis(k * detour_m);
        let ends = 1.0 + (self.own_sum(k) - ring::sum(&self.lines, k)) / straight;
        let strength = ends * self.nearness();
        let round = match &self.grazing {
            Some(grazing) => grazing.most_round(space, k),
            None => 0.0,
        };
        let radius = self.face_m(k);
        let wedge = self.wedge(space, radius);
        let sounds = wedge.map(|wedge| (wedge.diffracted(k), wedge.shares_of_direct()));
        let mut added = match &sounds {
            Some((diffracted, shares)) => Added {
                direct: diffracted.direct,
                ending: face
                    * (shares[0] * diffracted.reflected[0] + shares[1] * diffracted.reflected[1]),
                ..Added::default()
            },
            // A body that is smaller than the zone has no faces there: it disturbs the front as a thin screen does.
            None => Added {
                direct: -straight,
                ..Added::default()
            },
        };
        let way = (k, self.source.distance(self.listener));
        let single = self.of_faces(&sounds, |face, term| face.reflected(way, radius, term));
        let both = self.of_faces(&sounds, |face, term| face.over_both_ends(k, term));
        added.reflected = face * face * (single.norm_sqr() + both.norm_sqr());
        let [mut ratio, mut behind] = [Complex64::ONE; 2];
        if let Some(grazing) = &self.grazing {
            // Twice the pressures at the boundary of the shadow: an edge of a thin screen halves it.
            behind = factor_of(2.0 * grazing.pressure(space, k, &[face])?, wide);
            let edge = 2.0 * grazing.edge_pressure(space, k, face);
            ratio = behind / (edge * (1.0 - round) + round);
            added.direct = added.direct * (1.0 - round) - straight * round;
            added.ending *= 1.0 - round;
            added.reflected *= (1.0 - round) * (1.0 - round);
        }
        // At the boundary of the shadow the whole pressure is that behind the edge, times the ratio.
        Some(Added {
            direct: (added.direct * (2.0 - ratio) + added.ending * ratio) * strength,
            ending: Complex64::ZERO,
            reflected: added.reflected * ends.norm_sqr() * self.nearness(),
            behind,
        })
    }

    /// The sum over both faces of a function of their diffracted reflections and of the shares of these in the direct sound.
    fn of_faces(
        &self,
        sounds: &Option<(Diffracted, [f64; 2])>,
        of: impl Fn(&FaceBeside, (Complex64, f64)) -> Complex64,
    ) -> Complex64 {
        let none = [Complex64::ZERO; 2];
        let sounds = sounds.as_ref();
        let (terms, shares) =
            sounds.map_or((none, [0.0; 2]), |(all, shares)| (all.reflected, *shares));
        let terms = terms.into_iter().zip(shares);
        let faces = self.faces.iter().zip(terms);
        faces.map(|(beside, term)| of(beside, term)).sum()
    }

    /// Half-widths in decibels of the intervals that contain 95 % of the errors of the energy that the edge adds, by band:
    /// those behind it. An edge behind which no shadow begins is one of two.
    pub fn errors_db(&self) -> Bands {
        self.grazing
            .as_ref()
            .map_or(TWO_EDGES_ERRORS_DB, errors_of_bend_db)
    }

    /// Difference in metres between the way over the edge and the straight way.
    pub fn detour_m(&self) -> f64 {
        self.length_m - self.source.distance(self.listener)
    }

    /// How much the edge counts: 1 up to a share of the greatest detour, and 0 there.
    pub fn nearness(&self) -> f64 {
        let beyond = (self.detour_m() / self.most_detour_m - FULL) / (1.0 - FULL);
        (1.0 - beyond.clamp(0.0, 1.0).powi(2)).powi(2)
    }

    /// Whether the edge lies on the straight way.
    pub fn touches_the_straight_way(&self) -> bool {
        let point = self.edge.point;
        let over_m = self.source.distance(point) + point.distance(self.listener);
        over_m - self.source.distance(self.listener) < LEAST_DETOUR_M
    }

    /// Unit vector from the edge to the straight way.
    pub fn inwards(&self) -> DVec3 {
        self.inwards
    }

    /// The point at which the way bends.
    pub fn point(&self) -> DVec3 {
        self.edge.point
    }
}

/// The points at which obstacles touch the lowest tents that they block, by half-plane.
type Touches = [Option<DVec3>; HALF_PLANES];

/// The index of an edge among the others: that of the same edge, or a new one.
fn place(rims: &mut Vec<Rim>, rim: Rim) -> usize {
    let same = rims.iter().position(|other| other.is_same(&rim));
    same.unwrap_or_else(|| {
        rims.push(rim);
        rims.len() - 1
    })
}

/// The index of the edge on whose line a point lies, or at a narrow face of which it lies on the other end.
fn on_line_of(rims: &[Rim], point: DVec3) -> Option<usize> {
    let on_line = rims.iter().position(|rim| rim.has_on_line(point));
    on_line.or_else(|| rims.iter().position(|rim| rim.has_on_strip(point)))
}

/// The search for the edges that the half-planes of a basin touch.
struct Search<'a, S, F> {
    space: &'a S,
    planes: &'a HalfPlanes,
    /// The strings above which edges are sought.
    above: &'a F,
    touches: &'a Touches,
    detours: Detours,
}

impl<'a, S: Space, F: Fn(usize) -> Option<Option<&'a TautString>>> Search<'_, S, F> {
    /// The indices of the edges that the half-planes of a basin touch. `first` is the edge of its shortest half-plane.
    ///
    /// Straight edges that are not parallel, as a jamb and a lintel, have pressures of their own, and planes have none.
    fn owners(
        &self,
        basin: &Basin,
        first: Rim,
        rims: &mut Vec<Rim>,
    ) -> [Option<usize>; HALF_PLANES] {
        let near_m = first.near_m();
        let first = place(rims, first);
        let mut owners = [None; HALF_PLANES];
        for index in basin.half_planes() {
            owners[index] = self.touches[index].and_then(|touch| on_line_of(rims, touch));
        }
        let known = owners;
        let all: Vec<usize> = basin.half_planes().collect();
        let runs = all.chunk_by(|a, b| known[*a].is_some() == known[*b].is_some());
        for run in runs.filter(|run| known[run[0]].is_none()) {
            let mut rest = run.to_vec();
            while let Some((shortest, edge)) = self.straight_edge(&rest) {
                let is_on = |index: usize| {
                    let touch = self.touches[index];
                    index == shortest || touch.is_some_and(|touch| edge.is_near(touch, near_m))
                };
                let (own, others): (Vec<usize>, _) = rest.iter().partition(|index| is_on(**index));
                rest = others;
                let mut known = owners.into_iter().flatten();
                let parallel = known.find(|owner| rims[*owner].edge.is_parallel_to(&edge));
                let owner = parallel.or_else(|| {
                    let above = (self.above)(shortest).flatten();
                    let tent = (shortest as f64 * STEP, above);
                    let rim = Rim::on_edge(self.space, self.planes, edge, tent)?;
                    Some(place(rims, rim))
                });
                for index in own {
                    owners[index] = owner;
                }
            }
            for index in rest {
                owners[index] = Some(first);
            }
        }
        owners
    }

    /// The straight edge that a tent touches in the shortest of these half-planes, and the index of that half-plane; `None` if
    /// the surface is curved there.
    fn straight_edge(&self, run: &[usize]) -> Option<(usize, Edge)> {
        let detour = |index: &usize| self.detours[*index].unwrap_or(f64::INFINITY);
        let shortest = *run.iter().min_by(|a, b| detour(a).total_cmp(&detour(b)))?;
        let tent = (shortest as f64 * STEP, (self.above)(shortest).flatten());
        let (edge, is_straight) = edge_at(self.space, self.planes, tent, 0.5 * STEP)?;
        is_straight.then_some((shortest, edge))
    }
}
