//! Finds the sheets of a tree at a point, down to the leaves that have the surface there.
//!
//! The surface is where value = level. Unions, cuts and walls choose a child or change the level;
//! moves, turns and copies change the axes. Operators that blend or distort end the way: there the
//! sheet is the level of the whole subtree, with derivatives by differences of its value.

use super::differences::Differenced;
use super::leaves;
use super::search::{Search, Way};
use super::sheet::Form;
use crate::scene::shape::{Elongate, Mirror, Repeat};
use crate::scene::{Node, Shape};
use glam::{DMat3, DVec3};

impl<'a> Search<'a> {
    /// Adds the sheets of `shape` that have the surface near the point.
    pub fn descend(&mut self, shape: &'a Shape, way: Way) {
        match &shape.node {
            Node::Union(_) => self.nearest(&shape.children, way, 1.0),
            Node::Intersection(_) => self.nearest(&shape.children, way, -1.0),
            Node::Difference(_) => self.difference(&shape.children, way),
            Node::SmoothUnion(_) => self.smooth_union(shape, way),
            Node::Repeat(repeat) => self.repeat(repeat, shape, way),
            Node::Twist(_) | Node::Bend(_) | Node::Morph(_) => self.differenced(shape, way),
            node => match shape.children.first() {
                Some(child) => self.single(node, child, way),
                None => self.leaf(shape, way),
            },
        }
    }

    /// Operators on one child.
    fn single(&mut self, node: &Node, child: &'a Shape, way: Way) {
        let p = way.frame.place(self.point);
        let below = match node {
            Node::Complement(_) => way.turned_out(),
            Node::Offset(offset) => way.at(way.level + f64::from(offset.by)),
            Node::Shell(shell) => {
                let half = way.level + 0.5 * f64::from(shell.thickness);
                match child.value(p) >= 0.0 {
                    true => way.at(half).branch(0),
                    false => way.at(half).turned_out().branch(1),
                }
            }
            Node::Scale(scale) => {
                let by = f64::from(scale.by);
                let smaller = DMat3::from_diagonal(DVec3::splat(by.recip()));
                way.at(way.level / by).turned(smaller, DVec3::ZERO)
            }
            Node::Translate(translate) => way.moved(-translate.by.as_dvec3()),
            Node::Rotate(rotate) => way.turned(rotate.matrix().transpose(), DVec3::ZERO),
            Node::Mirror(mirror) => folded(mirror, p, way),
            Node::Elongate(elongate) => pulled_apart(elongate, p, way),
            _ => return self.differenced(child, way),
        };
        self.descend(child, below);
    }

    /// Children of a union (`side` 1) or an intersection (−1) that have the surface at `p`.
    fn nearest(&mut self, children: &'a [Shape], way: Way, side: f64) {
        let p = way.frame.place(self.point);
        let values: Vec<f64> = children.iter().map(|child| side * child.value(p)).collect();
        let least = values.iter().copied().fold(f64::INFINITY, f64::min);
        for (index, child) in children.iter().enumerate() {
            if values[index] <= least + self.touch {
                self.descend(child, way.branch(index as u64));
            }
        }
    }

    /// The first child, cut by the complements of all others.
    fn difference(&mut self, children: &'a [Shape], way: Way) {
        let p = way.frame.place(self.point);
        let outward = |index: usize| if index == 0 { 1.0 } else { -1.0 };
        let value = |(index, child): (usize, &Shape)| outward(index) * child.value(p);
        let values: Vec<f64> = children.iter().enumerate().map(value).collect();
        let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        for (index, child) in children.iter().enumerate() {
            if values[index] < most - self.touch {
                continue;
            }
            let way = way.branch(index as u64);
            match index {
                0 => self.descend(child, way),
                _ => self.descend(child, way.turned_out()),
            }
        }
    }

    /// A value of only one child is not blended.
    fn smooth_union(&mut self, shape: &'a Shape, way: Way) {
        let p = way.frame.place(self.point);
        let value = shape.value(p);
        let alone = shape.children.iter().position(|c| c.value(p) == value);
        match alone {
            Some(index) => {
                self.descend(&shape.children[index], way.branch(index as u64));
            }
            None => self.differenced(shape, way),
        }
    }

    fn repeat(&mut self, repeat: &Repeat, shape: &'a Shape, way: Way) {
        let p = way.frame.place(self.point);
        let Some(child) = shape.children.first() else {
            return;
        };
        let places = repeat.places(child, p);
        let values: Vec<f64> = places.iter().map(|place| child.value(*place)).collect();
        let least = values.iter().copied().fold(f64::INFINITY, f64::min);
        for (place, value) in places.into_iter().zip(values) {
            if value > least + self.touch {
                continue;
            }
            let shift = place - p;
            let marks = shift.to_array().map(f64::to_bits);
            let way = marks
                .into_iter()
                .fold(way.moved(shift), Way::branch_of_bits);
            self.descend(child, way);
        }
    }

    /// Adds the level of the subtree itself.
    fn differenced(&mut self, shape: &'a Shape, way: Way) {
        if shape.nodes().iter().any(|tree| tree.node.user().is_some()) {
            self.is_sampled = true;
            return;
        }
        let differenced = Differenced::new(shape, way.level, self.largest);
        self.add(Form::Differenced(differenced), way);
    }

    fn leaf(&mut self, shape: &'a Shape, way: Way) {
        if shape.node.user().is_some() {
            self.is_sampled = true;
            return;
        }
        let before = self.found.len();
        leaves::add(self, &shape.node, way);
        if self.found.len() == before {
            self.differenced(shape, way);
        }
    }
}

fn folded(mirror: &Mirror, p: DVec3, way: Way) -> Way {
    let is_folded = |axis: usize| mirror.axes[axis] && p[axis] < 0.0;
    let sides = [0, 1, 2].map(|axis| if is_folded(axis) { -1.0 } else { 1.0 });
    let number = (0..3).map(|axis| u64::from(is_folded(axis)) << axis).sum();
    let turn = DMat3::from_diagonal(DVec3::from_array(sides));
    way.turned(turn, DVec3::ZERO).branch(number)
}

/// Between its halves a shape that was moved apart is constant along the axis.
fn pulled_apart(elongate: &Elongate, p: DVec3, way: Way) -> Way {
    let by = elongate.by.as_dvec3();
    let held = p.clamp(-by, by);
    let mut scale = DVec3::ONE;
    let mut shift = DVec3::ZERO;
    let mut number = 0;
    for axis in 0..3 {
        number *= 3;
        match held[axis] == p[axis] && by[axis] > 0.0 {
            true => scale[axis] = 0.0,
            false => {
                shift[axis] = -held[axis];
                number += if p[axis] > 0.0 { 1 } else { 2 };
            }
        }
    }
    way.turned(DMat3::from_diagonal(scale), shift)
        .branch(number)
}
