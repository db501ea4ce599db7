//! A uniform grid of cells. Each cell lists the surfaces that can be hit in it or be the nearest to a point in it.
//!
//! Each cell has two lists. *Overlapping* lists the surfaces whose solid reaches into the cell: a line through the cell
//! can hit only these surfaces. *Nearest candidates* lists the surfaces that are the nearest to some point of the cell:
//! a distance in the cell depends only on these surfaces. Let c be the centre of a cell, r its half diagonal, d the
//! distance of a surface, and u the least distance of any surface from c. Then d(x) ≥ d(c) − r and min d(x) ≤ u + r
//! hold for each point x of the cell, so only surfaces with d(c) ≤ u + 2 r are candidates.
//!
//! A distance from a point outside the grid uses *groups* of surfaces instead (`members.rs`).
//!
//! Profile `hybrid` intersects lines with the surfaces of each kind separately (`kinds.rs`).
//!
//! Measurements show that uniform cells are faster than a list of all surfaces and than unrolled text: see
//! docs/benchmarks/surfaces-llvmpipe.md. Lists are kept from frame to frame: moved surfaces are removed and inserted
//! again, and only the cells near their old or new positions are rebuilt. Lists are built on all processor cores. The
//! order of a list is that of the surfaces, regardless of the number of threads.

mod grid;
mod kinds;
mod members;

pub use grid::Grid;
pub use kinds::SceneCells;
pub use members::Group;

use crate::scene::{Bounds3, Scene};
use glam::UVec3;
use grid::{CELLS_A_BOX, CELLS_A_SURFACE};
use members::{Member, groups, hull, radius};
use rayon::prelude::*;

/// Half the length that represents an infinite extent, in metres. Its square is finite in `f32`.
pub(super) const ENDLESS: f64 = 1e9;

/// The cells of some surfaces of a scene.
#[derive(Clone, Debug)]
pub struct Cells {
    /// Axes along which cells are infinite.
    unbounded_axes: [bool; 3],
    /// Whether a cell lists the surfaces whose boxes reach into it, instead of the surfaces whose solids do. A box has
    /// the axes of its surface.
    by_boxes: bool,
    grid: Grid,
    /// The surfaces in the cells, as they were when the lists were built.
    known: Vec<Member>,
    overlapping: Vec<Vec<u32>>,
    near: Option<Vec<Candidates>>,
    /// Built together with the lists of nearest candidates.
    groups: Vec<Group>,
}

/// A cell's list of nearest candidates (indices into the members), and an upper bound of the least distance of any
/// surface from the cell's centre.
#[derive(Clone, Debug, Default)]
struct Candidates {
    members: Vec<u32>,
    least: f64,
}

/// The requested kind of lists.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Lists {
    /// Surfaces that a line through the cell can hit, with separate cells for each kind.
    #[default]
    Lines,
    /// Surfaces that a line through the cell can hit.
    Overlapping,
    /// Surfaces on which a distance in the cell depends.
    NearestCandidates,
}

impl Cells {
    /// Builds the cells of these surfaces.
    pub fn new(scene: &Scene, surfaces: &[usize], unbounded_axes: [bool; 3]) -> Cells {
        Cells::build(scene, surfaces, unbounded_axes, false)
    }

    /// Builds the cells of the boxes around these surfaces.
    pub fn of_boxes(scene: &Scene, surfaces: &[usize], unbounded_axes: [bool; 3]) -> Cells {
        Cells::build(scene, surfaces, unbounded_axes, true)
    }

    fn build(
        scene: &Scene,
        surfaces: &[usize],
        unbounded_axes: [bool; 3],
        by_boxes: bool,
    ) -> Cells {
        let member = |&index: &usize| Member::new(index as u32, &scene.surfaces[index]);
        let known: Vec<Member> = surfaces.iter().map(member).collect();
        let inner = hull(&known, unbounded_axes);
        let share = match by_boxes {
            true => CELLS_A_BOX,
            false => CELLS_A_SURFACE,
        };
        let grid = Grid::around(inner, share * known.len() as f64, unbounded_axes);
        let mut cells = Cells {
            unbounded_axes,
            by_boxes,
            grid,
            known,
            overlapping: vec![Vec::new(); grid.cells()],
            near: None,
            groups: Vec::new(),
        };
        for member in 0..cells.known.len() {
            cells.put(member);
        }
        cells
    }

    /// Updates the cells to the scene: removes and inserts only the moved surfaces.
    pub fn update(&mut self, scene: &Scene) {
        let moved: Vec<usize> = self
            .known
            .iter()
            .enumerate()
            .filter(|(_, member)| scene.surfaces[member.index as usize] != member.surface)
            .map(|(place, _)| place)
            .collect();
        if moved.is_empty() {
            return;
        }
        // If many surfaces have moved, rebuilding takes no longer, and fits the grid to the surfaces.
        if 4 * moved.len() > self.known.len() {
            return self.renew(scene);
        }
        for &place in &moved {
            self.take_out(place);
            let surface = &scene.surfaces[self.known[place].index as usize];
            self.known[place] = Member::new(self.known[place].index, surface);
        }
        self.grid.inner = hull(&self.known, self.unbounded_axes);
        if !self.grid.has_room() {
            return self.renew(scene);
        }
        for &place in &moved {
            self.put(place);
        }
        self.renew_near(&moved);
    }

    fn renew(&mut self, scene: &Scene) {
        let had_near = self.near.is_some();
        let surfaces: Vec<usize> = self.known.iter().map(|m| m.index as usize).collect();
        *self = Cells::build(scene, &surfaces, self.unbounded_axes, self.by_boxes);
        if had_near {
            self.make_near();
        }
    }

    /// The grid.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Groups of all surfaces in cells. Lists of nearest candidates must have been prepared before.
    pub fn groups(&self) -> &[Group] {
        &self.groups
    }

    /// The length of the longest list. Lists of nearest candidates must have been prepared before.
    pub fn longest(&self, which: Lists) -> usize {
        let mut longest = 0;
        self.for_each_list(which, |_, list| longest = longest.max(list.len()));
        longest
    }

    /// Maximum number of records that a line visits: for each cell that the line crosses, one record and those of the
    /// cell's list.
    pub fn records_on_line(&self, which: Lists) -> u64 {
        let crossed = u64::from(self.grid.count.element_sum());
        crossed * (1 + self.longest(which) as u64)
    }

    /// Builds the requested lists, if they are built only on request.
    pub fn prepare(&mut self, which: Lists) {
        if which == Lists::NearestCandidates && self.near.is_none() {
            self.make_near();
        }
    }

    /// Calls `visit` with each cell (x runs fastest, then y, then z) and the indices of its
    /// surfaces in the scene. Lists of nearest candidates must have been prepared before.
    pub fn for_each_list(&self, which: Lists, mut visit: impl FnMut(usize, &[u32])) {
        let near = self.near.as_deref().unwrap_or_default();
        let mut list = Vec::new();
        for cell in 0..self.grid.cells() {
            let members = match which {
                Lists::NearestCandidates => near.get(cell).map_or(&[][..], |near| &near.members),
                Lists::Lines | Lists::Overlapping => &self.overlapping[cell],
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
            if self.known[place].reaches_into(bounds, self.unbounded_axes, self.by_boxes) {
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

    /// Builds all lists of nearest candidates.
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
        let made: Vec<_> = blocks.par_iter().flat_map_iter(of_block).collect();
        for (cell, list) in made {
            near[cell] = list;
        }
        self.near = Some(near);
        self.groups = groups(&self.known);
    }

    /// Rebuilds the lists of nearest candidates of cells that moved surfaces have left or entered.
    fn renew_near(&mut self, moved: &[usize]) {
        let Some(near) = &self.near else {
            return;
        };
        let stale = |cell: &usize| {
            let list = &near[*cell];
            let bounds = self.grid.padded(self.grid.at(*cell));
            let reach = list.least + 2.0 * radius(bounds, self.unbounded_axes);
            moved.iter().any(|&place| {
                let member = &self.known[place];
                list.members.contains(&(place as u32))
                    || member.least_value(bounds, self.unbounded_axes) <= reach
            })
        };
        let all: Vec<u32> = (0..self.known.len() as u32).collect();
        let cells: Vec<usize> = (0..self.grid.cells()).filter(stale).collect();
        let make = |&cell: &usize| {
            let bounds = self.grid.padded(self.grid.at(cell));
            self.near_to(bounds, &all)
        };
        let remade: Vec<Candidates> = cells.par_iter().map(make).collect();
        if let Some(near) = &mut self.near {
            for (cell, list) in cells.into_iter().zip(remade) {
                near[cell] = list;
            }
        }
        self.groups = groups(&self.known);
    }

    /// The candidates that can be the nearest to some point of a box.
    fn near_to(&self, bounds: Bounds3, candidates: &[u32]) -> Candidates {
        let unbounded_axes = self.unbounded_axes;
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::shape::Sphere;
    use crate::scene::{Listener, Source, Surface};
    use glam::Vec3;

    /// Balls of many sizes, so that lists of nearest candidates differ from cell to cell.
    fn balls() -> Scene {
        let ball = |index: usize| {
            let place = Vec3::new(
                (index % 7) as f32,
                (index / 7 % 7) as f32,
                (index / 49) as f32,
            );
            let radius = 0.1 + 0.05 * (index % 5) as f32;
            Surface::new(Sphere { radius }).at(2.0 * place)
        };
        Scene::new(
            "balls",
            (0..200).map(ball).collect(),
            Source::at(Vec3::splat(-1.0)),
            Listener::at(Vec3::splat(15.0), 0.5),
        )
    }

    /// All lists of the scene's cells, built by `threads` threads. Some lists are rebuilt after a surface has moved.
    fn lists(threads: usize) -> Vec<Vec<u32>> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build().unwrap().install(|| {
            let mut scene = balls();
            let surfaces: Vec<usize> = (0..scene.surfaces.len()).collect();
            let mut cells = Cells::new(&scene, &surfaces, [false; 3]);
            cells.prepare(Lists::NearestCandidates);
            let mut all = Vec::new();
            let mut keep = |_: usize, list: &[u32]| all.push(list.to_vec());
            cells.for_each_list(Lists::NearestCandidates, &mut keep);
            scene.surfaces[3].position.y += 0.7;
            cells.update(&scene);
            cells.for_each_list(Lists::NearestCandidates, &mut keep);
            all
        })
    }

    /// Protects lists, and therefore all results, from depending on the number of threads that built the lists.
    #[test]
    fn threads_do_not_change_a_list() {
        let alone = lists(1);
        assert!(alone.iter().any(|list| list.len() > 1));
        for threads in [2, 3, 7] {
            assert_eq!(alone, lists(threads), "{threads} threads");
        }
    }
}
