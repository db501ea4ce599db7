//! A hierarchy of bounding boxes, which finds the surfaces that a line can hit, or that can be nearest to a point.
//!
//! This is a bounding volume hierarchy (Rubin and Whitted, *A 3-dimensional representation for fast rendering of
//! complex scenes*, 1980), split at the median. It only selects the surfaces to test. The boxes have a margin that
//! exceeds rounding errors, so the hits and distances are bit-identical to those found by testing every surface.

use crate::scene::Bounds3;
use glam::DVec3;

/// Maximum number of surfaces that are all tested, without boxes. For so few surfaces, boxes cost more than they save.
const ALL_ASKED: usize = 16;

/// Maximum number of surfaces in a leaf.
const IN_LEAF: usize = 4;

/// Maximum number of boxes on the stack during a traversal: one for each halving of 2^32 surfaces, and one more.
const WAITING: usize = 33;

/// A hierarchy of bounding boxes of surfaces.
#[derive(Clone, Debug, Default)]
pub(super) struct Hierarchy {
    /// Indices of surfaces that are always tested: unbounded surfaces, or all surfaces if there are few.
    always: Vec<u32>,
    /// Indices of the other surfaces. The surfaces of a leaf are adjacent.
    order: Vec<u32>,
    /// The first node encloses all others. Empty if all surfaces are always tested.
    nodes: Vec<Node>,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    bounds: Bounds3,
    /// For a leaf, the position of its first surface in `order`. Otherwise, the index of its second child; the first
    /// child follows the node directly.
    first: u32,
    /// Number of surfaces in a leaf; 0 for other nodes.
    count: u32,
}

/// A line from `origin` along a unit vector.
struct Line {
    origin: DVec3,
    /// The reciprocals of the direction's components.
    inverse: DVec3,
}

impl Hierarchy {
    /// Builds the hierarchy from indices of surfaces and their bounding boxes. Each box must include a margin for
    /// rounding errors.
    pub fn new(surfaces: Vec<(u32, Bounds3)>) -> Hierarchy {
        let index = |(index, _): &(u32, Bounds3)| *index;
        let (mut bounded, mut always): (Vec<_>, Vec<_>) = surfaces
            .into_iter()
            .partition(|(_, bounds)| has_ends(bounds));
        if bounded.len() <= ALL_ASKED {
            always.append(&mut bounded);
        }
        let mut always: Vec<u32> = always.iter().map(index).collect();
        always.sort_unstable();
        let mut made = Hierarchy {
            always,
            ..Hierarchy::default()
        };
        if !bounded.is_empty() {
            made.add(&mut bounded);
        }
        made
    }

    /// Adds the node for `surfaces`, and all nodes below it.
    fn add(&mut self, surfaces: &mut [(u32, Bounds3)]) {
        let boxes = surfaces.iter().map(|(_, bounds)| *bounds);
        let Some(bounds) = boxes.clone().reduce(Bounds3::hull) else {
            return;
        };
        let node = self.nodes.len();
        self.nodes.push(Node {
            bounds,
            first: self.order.len() as u32,
            count: surfaces.len() as u32,
        });
        if surfaces.len() <= IN_LEAF {
            self.order.extend(surfaces.iter().map(|(index, _)| *index));
            return;
        }
        let middles = Bounds3::of_points(boxes.map(Bounds3::middle));
        let axis = longest_axis(middles.max - middles.min);
        let half = surfaces.len() / 2;
        surfaces.select_nth_unstable_by(half, |(a, of_a), (b, of_b)| {
            let (at_a, at_b) = (of_a.middle()[axis], of_b.middle()[axis]);
            at_a.total_cmp(&at_b).then(a.cmp(b))
        });
        let (first, second) = surfaces.split_at_mut(half);
        self.add(first);
        self.nodes[node].first = self.nodes.len() as u32;
        self.nodes[node].count = 0;
        self.add(second);
    }

    /// Calls `ask` with the index of each surface that the line can hit nearer than `until` metres, and with the
    /// current value of `until`. The result of `ask` is the new value of `until`. Nearer boxes are visited first.
    ///
    /// Returns the number of surfaces and bounding boxes that were tested.
    pub fn along(
        &self,
        origin: DVec3,
        direction: DVec3,
        until: f64,
        ask: impl FnMut(usize, f64) -> f64,
    ) -> u64 {
        let line = Line {
            origin,
            inverse: direction.recip(),
        };
        self.nearest_first(|bounds| line.enters(bounds), until, ask)
    }

    /// Like [`Hierarchy::along`] for the surfaces whose bounding box is at most `until` metres from a point. A surface
    /// whose box contains the point is always visited, because its distance can be negative.
    pub fn around(&self, place: DVec3, until: f64, ask: impl FnMut(usize, f64) -> f64) -> u64 {
        self.nearest_first(|bounds| least_distance(bounds, place), until, ask)
    }

    /// Visits surfaces by the least distance at which a box can contain a result.
    fn nearest_first(
        &self,
        least: impl Fn(&Bounds3) -> f64,
        until: f64,
        mut ask: impl FnMut(usize, f64) -> f64,
    ) -> u64 {
        let mut until = until;
        for &index in &self.always {
            until = ask(index as usize, until);
        }
        let mut asked = self.always.len() as u64;
        let mut waiting = [(0.0, 0); WAITING];
        let mut count = 0;
        if let Some(root) = self.nodes.first() {
            waiting[0] = (least(&root.bounds), 0);
            count = 1;
        }
        while count > 0 {
            count -= 1;
            let (from, own) = waiting[count];
            if !is_before(from, until) {
                continue;
            }
            let node = &self.nodes[own as usize];
            if node.count > 0 {
                for &index in self.in_leaf(node) {
                    until = ask(index as usize, until);
                }
                asked += u64::from(node.count);
                continue;
            }
            let halves = [own + 1, node.first];
            let mut next = halves.map(|half| (least(&self.nodes[half as usize].bounds), half));
            asked += 2;
            if next[0].0 < next[1].0 {
                next.swap(0, 1);
            }
            for half in next {
                if is_before(half.0, until) {
                    waiting[count] = half;
                    count += 1;
                }
            }
        }
        asked
    }

    /// Calls `ask` with the index of each surface whose bounding box is within `by` metres of a point, until `ask`
    /// returns true. Returns whether `ask` returned true.
    pub fn any_near(&self, place: DVec3, by: f64, mut ask: impl FnMut(usize) -> bool) -> bool {
        if self.always.iter().any(|&index| ask(index as usize)) {
            return true;
        }
        let mut waiting = [0; WAITING];
        let mut count = usize::from(!self.nodes.is_empty());
        while count > 0 {
            count -= 1;
            let own = waiting[count];
            let node = &self.nodes[own as usize];
            if !holds(&node.bounds.grown(DVec3::splat(by)), place) {
                continue;
            }
            if node.count == 0 {
                waiting[count] = node.first;
                waiting[count + 1] = own + 1;
                count += 2;
            } else if self.in_leaf(node).iter().any(|&index| ask(index as usize)) {
                return true;
            }
        }
        false
    }

    fn in_leaf(&self, node: &Node) -> &[u32] {
        &self.order[node.first as usize..(node.first + node.count) as usize]
    }
}

impl Line {
    /// Distance along the line to a box, at least 0; ∞ if the line misses the box.
    fn enters(&self, bounds: &Bounds3) -> f64 {
        let low = (bounds.min - self.origin) * self.inverse;
        let high = (bounds.max - self.origin) * self.inverse;
        let enters = low.min(high).max_element().max(0.0);
        match enters <= low.max(high).min_element() {
            true => enters,
            false => f64::INFINITY,
        }
    }
}

/// Whether a box that begins at the distance `from` can contain a result no farther than `until`.
fn is_before(from: f64, until: f64) -> bool {
    from < f64::INFINITY && from <= until
}

/// Distance in metres from a point to a box; −∞ if the box contains the point.
fn least_distance(bounds: &Bounds3, place: DVec3) -> f64 {
    let outside = (bounds.min - place).max(place - bounds.max);
    match outside.max_element() > 0.0 {
        true => outside.max(DVec3::ZERO).length(),
        false => f64::NEG_INFINITY,
    }
}

/// Whether a box is finite along some axis. A box without finite faces excludes nothing.
fn has_ends(bounds: &Bounds3) -> bool {
    (bounds.min.is_finite_mask() & bounds.max.is_finite_mask()).any()
}

fn holds(bounds: &Bounds3, place: DVec3) -> bool {
    (bounds.min.cmple(place) & bounds.max.cmpge(place)).all()
}

fn longest_axis(size: DVec3) -> usize {
    (1..3).fold(0, |most, axis| match size[axis] > size[most] {
        true => axis,
        false => most,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::ExactScene;
    use crate::geometry::closed_form::Placed;
    use crate::scene::shape::{Cuboid, Cylinder, Ellipsoid, Plane, Prism, Room, Sphere, Torus};
    use crate::scene::{Listener, Node, Scene, Shape, Source, Surface};
    use crate::test_common::Random;
    use glam::{EulerRot, Quat, Vec2, Vec3};
    use proptest::prelude::*;

    /// Half the side of the cube that contains the surfaces, in metres.
    const HALF: f64 = 10.0;

    fn place(random: &mut Random) -> Vec3 {
        // Coordinates are multiples of a decimetre, so that axis-parallel lines lie in faces, and surfaces share faces.
        Vec3::from_array(std::array::from_fn(|_| {
            (10.0 * HALF * random.signed()).round() as f32 * 0.1
        }))
    }

    fn surface(random: &mut Random) -> Surface {
        let size = 0.2 * (2.0 + random.signed() as f32);
        let node = match (8.0 * (random.signed() + 1.0)) as u32 {
            0..=5 => Node::Cuboid(Cuboid {
                size: Vec3::new(size, 2.0 * size, 0.5),
            }),
            6..=9 => Node::Sphere(Sphere { radius: size }),
            10 => Node::Cylinder(Cylinder { radius: 0.3 * size }),
            11..=13 => Node::Prism(Prism {
                corners: [Vec2::ZERO, Vec2::X, Vec2::Y],
                depth: size,
            }),
            _ => Node::Torus(Torus {
                ring: size,
                tube: 0.3 * size,
            }),
        };
        let turn = match random.signed() > 0.0 {
            true => Quat::IDENTITY,
            false => {
                let [a, b, c] = std::array::from_fn(|_| 3.0 * random.signed() as f32);
                Quat::from_euler(EulerRot::YXZ, a, b, c)
            }
        };
        Surface::new(Shape::from(node))
            .at(place(random))
            .turned(turn)
    }

    /// A room with `count` surfaces, a tenth of which are duplicated, at an offset of `away` metres from the world's
    /// origin.
    fn scene(random: &mut Random, count: usize, away: Vec3) -> Scene {
        let size = Vec3::splat(2.5 * HALF as f32);
        let mut surfaces = vec![Surface::new(Node::Room(Room { size }))];
        for index in 0..count {
            let one = surface(random);
            surfaces.extend((index % 10 == 0).then(|| one.clone()));
            surfaces.push(one);
        }
        surfaces.push(Surface::new(Node::Plane(Plane)).at(Vec3::NEG_Y * 9.0));
        for surface in &mut surfaces {
            surface.position += away;
        }
        let (source, listener) = (Source::at(away), Listener::at(away + Vec3::X, 0.3));
        Scene::new("many", surfaces, source, listener)
    }

    /// The same scene without a hierarchy, so that every surface is tested.
    fn asking_all(exact: &ExactScene) -> ExactScene {
        let mut all = exact.clone();
        all.hierarchies = [false, true].map(|is_marched| {
            let surfaces = (0..).zip(&exact.surfaces);
            let of_kind = surfaces.filter(|(_, surface)| surface.is_marched() == is_marched);
            Hierarchy::new(
                of_kind
                    .map(|(index, _)| (index, Bounds3::EVERYWHERE))
                    .collect(),
            )
        });
        all
    }

    fn direction(random: &mut Random, number: usize) -> DVec3 {
        match number % 4 {
            0 => DVec3::AXES[number / 4 % 3] * random.signed().signum(),
            _ => random.direction(),
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(12))]

        /// Protects the hits of waves among many surfaces. Each flight, each obstacle and each test whether a point is
        /// in a solid is bit-identical to the result of testing every surface. The cases include surfaces that share a
        /// face, and lines along these faces.
        #[test]
        fn the_hierarchy_changes_no_hit(seed in any::<u32>(), count in 17..160usize, is_far in any::<bool>()) {
            let mut random = Random(seed.into());
            let away = if is_far { Vec3::new(3000.0, -200.0, 70.0) } else { Vec3::ZERO };
            let exact = ExactScene::new(&scene(&mut random, count, away)).expect("a valid scene");
            let all = asking_all(&exact);
            let mut met = 0;
            for number in 0..150 {
                let start = (place(&mut random) + away).as_dvec3();
                let direction = direction(&mut random, number);
                let flights = |exact: &ExactScene| {
                    let mut hits = Vec::new();
                    let last = exact.follow(start, direction, 6, |hit| hits.push(*hit));
                    (hits, last.map(|last| (last.origin, last.direction, last.is_free)))
                };
                let (found, expected) = (flights(&exact), flights(&all));
                prop_assert_eq!(&found, &expected, "from {} along {}", start, direction);
                met += found.0.len();
                let until = 5.0 * (1.0 + random.signed());
                prop_assert_eq!(
                    exact.first_surface(start, direction, None, until),
                    all.first_surface(start, direction, None, until)
                );
                let distance = exact.surface_distance(start);
                prop_assert_eq!(exact.is_in_solid(start, 1e-9), distance < -1e-9);
                let reach = 0.4;
                let within = exact.distance_within(start, reach);
                prop_assert_eq!(within < reach, distance < reach);
                prop_assert!(within == distance || within == reach);
            }
            prop_assert!(met > 100);
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(12))]

        /// Protects distances and nearest surfaces: they are bit-identical to the least values of all surfaces, and of
        /// equally distant surfaces the first is nearest. The cases include duplicated surfaces, points in solids, and
        /// fields whose value is only a lower bound of the distance.
        #[test]
        fn the_hierarchy_changes_no_distance(seed in any::<u32>(), count in 17..160usize, is_far in any::<bool>()) {
            let mut random = Random(seed.into());
            let away = if is_far { Vec3::new(3000.0, -200.0, 70.0) } else { Vec3::ZERO };
            let mut scene = scene(&mut random, count, away);
            let radii = Vec3::new(1.0, 0.1, 0.3);
            for _ in 0..20 {
                let ellipsoid = Surface::new(Node::Ellipsoid(Ellipsoid { radii }));
                scene.surfaces.push(ellipsoid.at(place(&mut random) + away));
            }
            let exact = ExactScene::new(&scene).expect("a valid scene");
            prop_assert!(!exact.surfaces.iter().all(Placed::has_exact_distance));
            let floor = away.as_dvec3() - DVec3::Y * (1.25 * HALF);
            let room = (1, (floor, DVec3::Y));
            for number in 0..300 {
                let far = if number % 3 == 0 { 4.0 } else { 1.0 };
                let point = (place(&mut random) * far + away).as_dvec3();
                let all: Vec<f64> = exact.surfaces.iter().map(|of| of.distance(point)).collect();
                let least = |of: &[f64]| of.iter().copied().fold(f64::INFINITY, f64::min);
                prop_assert_eq!(exact.surface_distance(point).to_bits(), least(&all).to_bits());
                let first = |of: &[f64]| 1 + of.iter().position(|d| *d == least(of)).unwrap();
                prop_assert_eq!(exact.nearest(point), first(&all) as u32);
                let in_front = exact.in_front(point, room);
                let opened: Vec<f64> = (1..).zip(&exact.surfaces).map(|(n, of)| in_front(n, of)).collect();
                prop_assert!(opened[0] >= all[0]);
                let found = exact.distance_in_front(point, room);
                prop_assert_eq!(found.to_bits(), least(&opened).to_bits());
                prop_assert_eq!(exact.nearest_in_front(point, room), first(&opened) as u32);
            }
        }
    }

    /// Protects the speed with many surfaces: a point tests a small share of them.
    #[test]
    fn a_point_asks_few_of_many() {
        let mut random = Random(5);
        let exact = ExactScene::new(&scene(&mut random, 5000, Vec3::ZERO)).expect("a valid scene");
        let mut asked = 0;
        for _ in 0..100 {
            let point = place(&mut random).as_dvec3();
            let mut least = f64::INFINITY;
            for hierarchy in &exact.hierarchies {
                asked += hierarchy.around(point, least, |index, _| {
                    least = least.min(exact.surfaces[index].distance(point));
                    least
                });
            }
        }
        assert!(asked < 100 * 500, "{asked}");
    }

    /// Protects the speed with many surfaces: a line tests a small share of them.
    #[test]
    fn a_line_asks_few_of_many() {
        let mut random = Random(5);
        let exact = ExactScene::new(&scene(&mut random, 5000, Vec3::ZERO)).expect("a valid scene");
        let directions = (0..100).map(|_| random.direction()).collect::<Vec<_>>();
        let flights = directions
            .iter()
            .map(|d| exact.next_surface(DVec3::ZERO, *d, None, 1e9).1);
        let asked: u64 = flights.sum();
        assert!(asked < 100 * 500, "{asked}");
    }
}
