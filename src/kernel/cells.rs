//! Cells of space, each with the surfaces that matter in it.
//!
//! Two lists a cell. *Overlapping*: the surfaces whose solid reaches into it; a line through
//! the cell can meet no other. *Nearest candidates*: the surfaces that are the
//! nearest one to some point of it; a distance there needs no other. With the middle c of a
//! cell and its half diagonal r, the distance d of a surface and the least such distance u obey
//! d(x) ≥ d(c) − r and min d(x) ≤ u + r, so that only surfaces with d(c) ≤ u + 2 r are near.
//!
//! A distance from outside of the grid asks *groups* of surfaces instead (`groups.rs`).
//!
//! Uniform cells were chosen over a list of all surfaces (the same code with one cell) and
//! over unrolled text by measuring: see docs/benchmarks/surfaces-llvmpipe.md. Lists are kept from frame to
//! frame: what moved is taken out and put in, and only the cells that it was or can be
//! near to are made again. They are built on all cores; their order is that of the
//! surfaces, whatever the number of threads.

mod groups;

pub use groups::Group;

use super::layout::Layout;
use crate::scene::{Bounds3, Exactness, Node, Scene, Surface};
use glam::{BVec3, DVec3, UVec3};
use std::num::NonZeroUsize;

/// Cells for each surface, about: as many again, so that most hold one surface or none.
const CELLS_A_SURFACE: f64 = 2.0;

/// Cells along an axis at the most.
const MOST_CELLS: f64 = 128.0;

/// Half the length that stands for no end, in metres: squares of it are finite in `f32`.
pub(super) const ENDLESS: f64 = 1e9;

/// What is added to every cell when lists are made, as a share of its size: a place that
/// rounding put into the next cell must find the same surfaces there.
const PAD: f64 = 1e-3;

/// The free border of the grid, as a share of its size: what moves within it makes no new
/// grid.
const BORDER: f64 = 0.05;

/// The grid: where its cells are, in world metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// The corner with the least coordinates.
    pub origin: DVec3,
    /// Width, height and depth of a cell.
    pub cell: DVec3,
    /// Cells along each axis.
    pub count: UVec3,
    /// What holds every surface in it: smaller than the grid.
    pub inner: Bounds3,
}

/// The cells of a scene.
#[derive(Clone, Debug)]
pub struct Cells {
    layout: Layout,
    grid: Grid,
    /// The surfaces that lie in cells, as they were when the lists were made.
    known: Vec<Member>,
    overlapping: Vec<Vec<u32>>,
    near: Option<Vec<Candidates>>,
    /// Made with the lists of nearest candidates.
    groups: Vec<Group>,
}

/// A surface in the grid.
#[derive(Clone, Debug)]
struct Member {
    /// Its index in the scene.
    index: u32,
    surface: Surface,
    bounds: Bounds3,
    /// Whether positive values are the distance itself.
    exact: bool,
}

/// A cell's list of near surfaces (indices into the members), and what it was made by.
#[derive(Clone, Debug, Default)]
struct Candidates {
    members: Vec<u32>,
    least: f64,
}

/// Which lists are asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lists {
    /// What a line through the cell can meet.
    Overlapping,
    /// What a distance in the cell needs.
    NearestCandidates,
}

impl Cells {
    /// The cells of a scene, or `None` for one without.
    pub fn new(scene: &Scene, layout: &Layout) -> Option<Cells> {
        if !layout.has_cells() {
            return None;
        }
        let known = members(scene, layout);
        let grid = Grid::around(&known, layout.unbounded_axes);
        let mut cells = Cells {
            layout: layout.clone(),
            grid,
            known,
            overlapping: Vec::new(),
            near: None,
            groups: Vec::new(),
        };
        cells.overlapping = vec![Vec::new(); cells.grid.cells()];
        for member in 0..cells.known.len() {
            cells.put(member);
        }
        Some(cells)
    }

    /// Follows the scene: only what moved is taken out and put in again.
    ///
    /// Returns whether anything changed.
    pub fn update(&mut self, scene: &Scene, layout: &Layout) -> bool {
        if *layout != self.layout {
            return self.renew(scene, layout);
        }
        let moved: Vec<usize> = self
            .known
            .iter()
            .enumerate()
            .filter(|(_, member)| scene.surfaces[member.index as usize] != member.surface)
            .map(|(place, _)| place)
            .collect();
        if moved.is_empty() {
            return false;
        }
        // Of many, a new build is as fast, and has a grid that fits.
        if 4 * moved.len() > self.known.len() {
            return self.renew(scene, layout);
        }
        for &place in &moved {
            self.take_out(place);
            let surface = &scene.surfaces[self.known[place].index as usize];
            self.known[place] = Member::new(self.known[place].index, surface);
        }
        self.grid.inner = hull(&self.known, self.layout.unbounded_axes);
        if !self.grid.has_room() {
            return self.renew(scene, layout);
        }
        for &place in &moved {
            self.put(place);
        }
        self.renew_near(&moved);
        true
    }

    fn renew(&mut self, scene: &Scene, layout: &Layout) -> bool {
        let had_near = self.near.is_some();
        if let Some(new) = Cells::new(scene, layout) {
            *self = new;
            if had_near {
                self.make_near();
            }
        }
        true
    }

    /// The grid.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Groups of all surfaces in cells. Lists of nearest candidates must be prepared before.
    pub fn groups(&self) -> &[Group] {
        &self.groups
    }

    /// The length of the longest list. Lists of nearest candidates must be prepared before.
    pub fn longest(&self, which: Lists) -> usize {
        let mut longest = 0;
        self.for_each_list(which, |_, list| longest = longest.max(list.len()));
        longest
    }

    /// Makes the lists that are only made when they are asked for.
    pub fn prepare(&mut self, which: Lists) {
        if which == Lists::NearestCandidates && self.near.is_none() {
            self.make_near();
        }
    }

    /// Calls `visit` with each cell (x runs fastest, then y, then z) and the indices of its
    /// surfaces in the scene. Lists of nearest candidates must be prepared before.
    pub fn for_each_list(&self, which: Lists, mut visit: impl FnMut(usize, &[u32])) {
        let near = self.near.as_deref().unwrap_or_default();
        let mut list = Vec::new();
        for cell in 0..self.grid.cells() {
            let members = match which {
                Lists::NearestCandidates => near.get(cell).map_or(&[][..], |near| &near.members),
                Lists::Overlapping => &self.overlapping[cell],
            };
            list.clear();
            list.extend(
                members
                    .iter()
                    .map(|&member| self.known[member as usize].index),
            );
            visit(cell, &list);
        }
    }

    fn put(&mut self, place: usize) {
        for (cell, bounds) in self.touched(place) {
            if self.known[place].reaches_into(bounds, self.layout.unbounded_axes) {
                let list = &mut self.overlapping[cell];
                let at = list.partition_point(|&other| (other as usize) < place);
                list.insert(at, place as u32);
            }
        }
    }

    fn take_out(&mut self, place: usize) {
        for (cell, _) in self.touched(place) {
            self.overlapping[cell].retain(|&other| other as usize != place);
        }
    }

    /// The cells that a surface's bounds reach into.
    fn touched(&self, place: usize) -> Vec<(usize, Bounds3)> {
        let (low, high) = self.grid.range(self.known[place].bounds);
        let mut cells = Vec::new();
        for z in low.z..=high.z {
            for y in low.y..=high.y {
                for x in low.x..=high.x {
                    let at = UVec3::new(x, y, z);
                    cells.push((self.grid.index(at), self.grid.padded(at)));
                }
            }
        }
        cells
    }

    /// Makes all lists of nearest candidates.
    fn make_near(&mut self) {
        let all: Vec<u32> = (0..self.known.len() as u32).collect();
        let blocks = self.grid.blocks();
        let of_block = |block: &Vec<usize>| {
            let around = block
                .iter()
                .map(|&cell| self.grid.padded(self.grid.at(cell)))
                .reduce(Bounds3::hull);
            let Some(around) = around else {
                return Vec::new();
            };
            let candidates = self.near_to(around, &all).members;
            let near = |&cell: &usize| {
                let bounds = self.grid.padded(self.grid.at(cell));
                (cell, self.near_to(bounds, &candidates))
            };
            block.iter().map(near).collect::<Vec<_>>()
        };
        let mut near = vec![Candidates::default(); self.grid.cells()];
        for (cell, list) in on_all_cores(&blocks, of_block).into_iter().flatten() {
            near[cell] = list;
        }
        self.near = Some(near);
        self.groups = groups::groups(&self.known);
    }

    /// Makes the lists of nearest candidates again that something that moved was in, or gets into.
    fn renew_near(&mut self, moved: &[usize]) {
        let Some(near) = &self.near else {
            return;
        };
        let stale = |cell: &usize| {
            let list = &near[*cell];
            let bounds = self.grid.padded(self.grid.at(*cell));
            let reach = list.least + 2.0 * radius(bounds, self.layout.unbounded_axes);
            moved.iter().any(|&place| {
                let member = &self.known[place];
                list.members.contains(&(place as u32))
                    || member.least_value(bounds, self.layout.unbounded_axes) <= reach
            })
        };
        let all: Vec<u32> = (0..self.known.len() as u32).collect();
        let cells: Vec<usize> = (0..self.grid.cells()).filter(stale).collect();
        let remade = on_all_cores(&cells, |&cell| {
            let bounds = self.grid.padded(self.grid.at(cell));
            self.near_to(bounds, &all)
        });
        if let Some(near) = &mut self.near {
            for (cell, list) in cells.into_iter().zip(remade) {
                near[cell] = list;
            }
        }
        self.groups = groups::groups(&self.known);
    }

    /// Those of the candidates that are the nearest to some place of a box.
    fn near_to(&self, bounds: Bounds3, candidates: &[u32]) -> Candidates {
        let unbounded_axes = self.layout.unbounded_axes;
        let mut least = f64::INFINITY;
        let distances: Vec<f64> = candidates
            .iter()
            .map(|&place| {
                let member = &self.known[place as usize];
                least = least.min(member.most_distance(bounds, unbounded_axes));
                member.least_value(bounds, unbounded_axes)
            })
            .collect();
        let reach = least + 2.0 * radius(bounds, unbounded_axes);
        let with = candidates.iter().zip(distances);
        let members = with.filter(|(_, distance)| *distance <= reach);
        Candidates {
            members: members.map(|(place, _)| *place).collect(),
            least,
        }
    }
}

impl Member {
    fn new(index: u32, surface: &Surface) -> Member {
        let exact = surface.shape.properties().in_air == Exactness::Exact;
        Member {
            index,
            surface: surface.clone(),
            bounds: surface.bounds(),
            exact,
        }
    }

    /// Whether its value at the middle of a box says the distance there: not where there are
    /// unbounded axes and it has ends.
    fn is_told_by_value(&self, unbounded_axes: [bool; 3]) -> bool {
        let column = (0..3).find(|&axis| unbounded_axes[axis]);
        column.is_none_or(|axis| {
            unbounded_axes.iter().filter(|c| **c).count() == 1
                && matches!(self.surface.shape.node, Node::Cylinder(_))
                && self.bounds.min[axis].is_infinite()
        })
    }

    fn reaches_into(&self, bounds: Bounds3, unbounded_axes: [bool; 3]) -> bool {
        self.least_distance(bounds, unbounded_axes) <= radius(bounds, unbounded_axes)
    }

    /// Never more than its distance from the middle of a box.
    fn least_distance(&self, bounds: Bounds3, unbounded_axes: [bool; 3]) -> f64 {
        let middle = middle(bounds, unbounded_axes);
        if self.is_told_by_value(unbounded_axes) {
            return f64::from(self.surface.distance(middle.as_vec3()));
        }
        let mask = BVec3::from_array(unbounded_axes);
        let flat = Bounds3 {
            min: DVec3::select(mask, DVec3::NEG_INFINITY, self.bounds.min),
            max: DVec3::select(mask, DVec3::INFINITY, self.bounds.max),
        };
        flat.distance(middle)
    }

    /// Never more than its value there, which for a bound may be less than the distance.
    fn least_value(&self, bounds: Bounds3, unbounded_axes: [bool; 3]) -> f64 {
        match self.exact || self.is_told_by_value(unbounded_axes) {
            true => self.least_distance(bounds, unbounded_axes),
            false => f64::NEG_INFINITY,
        }
    }

    /// Never less than that distance.
    fn most_distance(&self, bounds: Bounds3, unbounded_axes: [bool; 3]) -> f64 {
        if !self.is_told_by_value(unbounded_axes) {
            return f64::INFINITY;
        }
        let middle = middle(bounds, unbounded_axes);
        if self.exact {
            return f64::from(self.surface.distance(middle.as_vec3()));
        }
        let far = (middle - self.bounds.min)
            .abs()
            .max((self.bounds.max - middle).abs());
        far.length()
    }
}

/// The middle of a box, 0 along unbounded axes.
fn middle(bounds: Bounds3, unbounded_axes: [bool; 3]) -> DVec3 {
    let middle = 0.5 * (bounds.min + bounds.max);
    DVec3::select(BVec3::from_array(unbounded_axes), DVec3::ZERO, middle)
}

/// Half the diagonal of a box, what unbounded axes add left out, and what `f32` rounds a distance
/// by.
fn radius(bounds: Bounds3, unbounded_axes: [bool; 3]) -> f64 {
    let flat = |v: DVec3| DVec3::select(BVec3::from_array(unbounded_axes), DVec3::ZERO, v);
    let half = flat(0.5 * (bounds.max - bounds.min));
    let place = flat(bounds.min.abs().max(bounds.max.abs()));
    half.length() + 8.0 * f64::from(f32::EPSILON) * place.max_element()
}

fn members(scene: &Scene, layout: &Layout) -> Vec<Member> {
    let in_cells = (0..scene.surfaces.len()).filter(|&i| layout.kind_of[i].is_some());
    let members = in_cells.map(|index| Member::new(index as u32, &scene.surfaces[index]));
    members.collect()
}

/// What holds all members; without end along unbounded axes.
fn hull(members: &[Member], unbounded_axes: [bool; 3]) -> Bounds3 {
    let all = members.iter().map(|m| m.bounds).reduce(Bounds3::hull);
    let hull = all.unwrap_or(Bounds3::EVERYWHERE);
    let mask = BVec3::from_array(unbounded_axes);
    Bounds3 {
        min: DVec3::select(mask, DVec3::splat(-ENDLESS), hull.min),
        max: DVec3::select(mask, DVec3::splat(ENDLESS), hull.max),
    }
}

impl Grid {
    fn around(members: &[Member], unbounded_axes: [bool; 3]) -> Grid {
        let inner = hull(members, unbounded_axes);
        let size = inner.max - inner.min;
        let longest = (0..3)
            .filter(|&axis| !unbounded_axes[axis])
            .map(|axis| size[axis])
            .fold(0.0, f64::max);
        let border = DVec3::from_array([0, 1, 2].map(|axis| match unbounded_axes[axis] {
            true => 0.0,
            false => BORDER * longest.max(1e-3),
        }));
        let outer = inner.grown(border);
        let size = outer.max - outer.min;
        let along: Vec<f64> = (0..3)
            .filter(|&a| !unbounded_axes[a])
            .map(|a| size[a])
            .collect();
        let wanted = CELLS_A_SURFACE * members.len() as f64;
        let edge = (along.iter().product::<f64>() / wanted).powf(1.0 / along.len().max(1) as f64);
        let count = [0, 1, 2].map(|axis| match unbounded_axes[axis] {
            true => 1,
            false => (size[axis] / edge).round().clamp(1.0, MOST_CELLS) as u32,
        });
        let count = UVec3::from_array(count);
        Grid {
            origin: outer.min,
            cell: size / count.as_dvec3(),
            count,
            inner,
        }
    }

    /// Whether the border about the surfaces is still at least half as wide as it was.
    fn has_room(&self) -> bool {
        let end = self.origin + self.cell * self.count.as_dvec3();
        let unbounded_axes = self.cell.cmpge(DVec3::splat(2.0 * ENDLESS));
        let border = 0.5 * BORDER / (1.0 + 2.0 * BORDER);
        let longest = DVec3::select(unbounded_axes, DVec3::ZERO, end - self.origin).max_element();
        let free = (self.inner.min - self.origin).min(end - self.inner.max);
        (0..3).all(|axis| unbounded_axes.test(axis) || free[axis] >= border * longest)
    }

    fn cells(&self) -> usize {
        self.count.element_product() as usize
    }

    fn index(&self, at: UVec3) -> usize {
        ((at.z * self.count.y + at.y) * self.count.x + at.x) as usize
    }

    fn at(&self, index: usize) -> UVec3 {
        let index = index as u32;
        let (x, rest) = (index % self.count.x, index / self.count.x);
        UVec3::new(x, rest % self.count.y, rest / self.count.y)
    }

    fn padded(&self, at: UVec3) -> Bounds3 {
        let min = self.origin + self.cell * at.as_dvec3();
        let max = min + self.cell;
        Bounds3 { min, max }.grown(PAD * self.cell)
    }

    /// The first and the last cell that a box reaches into.
    fn range(&self, bounds: Bounds3) -> (UVec3, UVec3) {
        let padded = bounds.grown(PAD * self.cell);
        let last = (self.count - 1).as_dvec3();
        let cell = |place: DVec3| ((place - self.origin) / self.cell).floor();
        let held = |place: DVec3| cell(place).clamp(DVec3::ZERO, last).as_uvec3();
        (held(padded.min), held(padded.max))
    }

    /// Neighbouring cells together, so that most surfaces are ruled out for all of them.
    fn blocks(&self) -> Vec<Vec<usize>> {
        const SIDE: u32 = 4;
        let blocks = (self.count + (SIDE - 1)) / SIDE;
        let mut all = vec![Vec::new(); blocks.element_product() as usize];
        for index in 0..self.cells() {
            let block = self.at(index) / SIDE;
            let place = (block.z * blocks.y + block.y) * blocks.x + block.x;
            all[place as usize].push(index);
        }
        all
    }
}

/// The results for all items, in their order, computed on all cores.
fn on_all_cores<T: Sync, R: Send>(items: &[T], work: impl Fn(&T) -> R + Sync) -> Vec<R> {
    /// Items below which threads cost more than they save.
    const FEW: usize = 4;
    let cores = std::thread::available_parallelism().map_or(1, NonZeroUsize::get);
    if items.len() <= FEW || cores == 1 {
        return items.iter().map(work).collect();
    }
    let share = items.len().div_ceil(cores);
    std::thread::scope(|scope| {
        let parts: Vec<_> = items
            .chunks(share)
            .map(|part| scope.spawn(|| part.iter().map(&work).collect::<Vec<R>>()))
            .collect();
        let joined = parts.into_iter().map(|part| match part.join() {
            Ok(results) => results,
            Err(panic) => std::panic::resume_unwind(panic),
        });
        joined.flatten().collect()
    })
}
