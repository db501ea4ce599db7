//! Checks trees of shapes; each error is one sentence.

use super::parameter::in_range;
use super::{Node, Shape, User};
use glam::DVec3;

/// Maximum number of nodes in a tree: larger trees take a shader too much memory and time to
/// compile. A field of 4,000 nodes took llvmpipe more than 7 GB.
pub(crate) const MOST_NODES: usize = 512;

/// Number of points at which a stated Lipschitz constant is checked.
const TRIES: usize = 4096;

/// Maximum number of times at which it is checked at all these points; more times share the points.
const TIMES_IN_FULL: usize = 64;

/// Minimum number of points at which it is checked at each time.
const LEAST_TRIES: usize = 32;

/// Relative excess of a difference quotient over a stated constant above which it is rejected: the
/// effect of rounding on a quotient over a thousandth of the size.
const ROUNDING: f64 = 1e-3;

impl Shape {
    /// Checks the tree's numbers, its operators' operands and that every repetition is safe: cheap
    /// enough for every frame. Checks that need evaluations are in [`Shape::check`].
    ///
    /// # Errors
    /// A message that names the node and states the requirement.
    pub fn validate(&self) -> Result<(), String> {
        let nodes = self.nodes();
        if nodes.len() > MOST_NODES {
            let count = nodes.len();
            return Err(format!(
                "a field of {count} nodes is too large: at most {MOST_NODES}"
            ));
        }
        for tree in &nodes {
            let named = |why| format!("{}: {why}", tree.node.name());
            tree.check_operands()
                .and_then(|()| tree.node.check())
                .map_err(named)?;
        }
        // Properties are defined for valid numbers only.
        for tree in nodes {
            let checked = tree.node.part().check_over(&tree.children);
            checked.map_err(|why| format!("{}: {why}", tree.node.name()))?;
        }
        Ok(())
    }

    /// Checks the tree as [`Shape::validate`] does, and checks every stated Lipschitz constant by a
    /// few thousand evaluations; the text of users' fields is read, but not yet compiled.
    ///
    /// # Errors
    /// A message that names the node and states the requirement.
    pub fn check(&self) -> Result<(), String> {
        self.validate()?;
        for field in self.nodes() {
            field
                .check_growth(TRIES)
                .and_then(|()| field.check_text())
                .map_err(|why| format!("{}: {why}", field.node.name()))?;
        }
        Ok(())
    }

    /// Checks every stated Lipschitz constant in the field's current state, at one of `times`
    /// times, which together take a few seconds at most.
    pub(in crate::scene) fn check_growth_at_one_of(&self, times: usize) -> Result<(), String> {
        let tries = TRIES * TIMES_IN_FULL / times.max(1);
        let tries = tries.clamp(LEAST_TRIES, TRIES);
        for field in self.nodes() {
            let checked = field.check_growth(tries);
            checked.map_err(|why| format!("{}: {why}", field.node.name()))?;
        }
        Ok(())
    }

    fn check_operands(&self) -> Result<(), String> {
        let (least, most) = self.node.part().operands();
        let count = self.children.len();
        if (least..=most).contains(&count) {
            return Ok(());
        }
        Err(match (least, most) {
            (0, _) => "is a shape and takes no fields".to_owned(),
            (least, most) if least == most => format!("takes {least} fields, not {count}"),
            (least, _) => format!("takes at least {least} fields, not {count}"),
        })
    }

    /// Checks the stated constant of a twist or a bend.
    fn check_growth(&self, tries: usize) -> Result<(), String> {
        let Some(stated) = self.node.part().stated_lipschitz() else {
            return Ok(());
        };
        let (steepest, place) = self.steepest_of(tries);
        if steepest <= f64::from(stated) * (1.0 + ROUNDING) {
            return Ok(());
        }
        Err(format!(
            "its value grows by {steepest:.3} a metre at ({:.3}, {:.3}, {:.3}), more than the stated lipschitz of {stated}: state at least {:.3}, or leave it out to have it computed",
            place.x,
            place.y,
            place.z,
            1.01 * steepest
        ))
    }

    /// Checks that a user's text defines the function and needs no other inputs.
    fn check_text(&self) -> Result<(), String> {
        match &self.node {
            Node::User(User { field }) => field.check_text().map_err(|(line, why)| {
                let file = field.file.display();
                match line {
                    Some(line) => format!("{file}:{line}: {why}"),
                    None => format!("{file}: {why}"),
                }
            }),
            _ => Ok(()),
        }
    }

    /// The greatest difference quotient found at points of the field's bounds, and the point where
    /// it was found.
    pub fn steepest(&self) -> (f64, DVec3) {
        self.steepest_of(TRIES)
    }

    fn steepest_of(&self, tries: usize) -> (f64, DVec3) {
        let bounds = self.properties().bounds;
        let reach = DVec3::splat(10.0);
        let box_ = super::Bounds3 {
            min: bounds.min.max(-reach),
            max: bounds.max.min(reach),
        };
        let step = 1e-4 * (box_.max - box_.min).max_element().max(1e-6);
        let mut found = (0.0, DVec3::ZERO);
        for index in 1..=tries {
            let p = box_.min + halton(index) * (box_.max - box_.min);
            let along = |axis: DVec3| {
                (self.value(p + axis * step) - self.value(p - axis * step)) / (2.0 * step)
            };
            let gradient = DVec3::new(along(DVec3::X), along(DVec3::Y), along(DVec3::Z));
            if gradient.length() > found.0 {
                found = (gradient.length(), p);
            }
        }
        found
    }
}

/// The n-th point of Halton's sequence in bases 2, 3, 5: evenly distributed in the unit cube.
pub(crate) fn halton(index: usize) -> DVec3 {
    let radical_inverse = |base: usize| {
        let (mut rest, mut share, mut sum) = (index, 1.0, 0.0);
        while rest > 0 {
            share /= base as f64;
            sum += share * (rest % base) as f64;
            rest /= base;
        }
        sum
    };
    DVec3::new(radical_inverse(2), radical_inverse(3), radical_inverse(5))
}

impl Node {
    /// Checks the node's own numbers against their ranges.
    fn check(&self) -> Result<(), String> {
        if !in_range(self.part()) {
            // Only an error message needs a copy and the names.
            let mut copy = self.clone();
            let parameters = copy.part_mut().parameters_mut();
            parameters.iter().try_for_each(|number| number.check())?;
        }
        self.part().check()
    }
}
