//! Converts the index of a point to its scene, positions and settings.

use super::{BLOCK, SceneAxis, Study};
use crate::report::Cell;
use echomarch::scene::{Scene, SceneError};
use glam::Vec3;

/// A point of a study, as indices on the axes of the study.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Point {
    /// The point's index, from 0.
    pub index: u64,
    /// The index of the scene variant among all variants. A variant is a scene with numbers for its named values.
    pub variant: u64,
    pub time: u64,
    pub case: usize,
    pub source: u64,
    pub listener: u64,
    pub seed: u32,
}

impl Study {
    /// The points of a block, from 0. All of them are in one shard.
    pub(super) fn block(&self, number: u64) -> Vec<Point> {
        let first = number * BLOCK;
        let indices = first..self.points.min(first + BLOCK);
        indices.map(|index| self.point(index)).collect()
    }

    /// Returns the point at an index, which must be below [`Study::points`].
    pub(super) fn point(&self, index: u64) -> Point {
        let mut rest = index % self.each;
        let mut next = |length: u64| {
            let place = rest % length;
            rest /= length;
            place
        };
        // The last axis changes fastest.
        let seed = next(self.seeds.len());
        let listener = next(self.listeners.len().unwrap_or(1));
        let source = next(self.sources.len().unwrap_or(1));
        let case = next(self.settings.len() as u64) as usize;
        let time = next(self.times.as_ref().map_or(1, |times| times.len()));
        Point {
            index,
            variant: index / self.each,
            time,
            case,
            source,
            listener,
            seed: self.seeds.get(seed),
        }
    }

    /// The scene of a variant.
    pub(super) fn axis_of(&self, variant: u64) -> &SceneAxis {
        let at = self.variants.partition_point(|axis| axis.end <= variant);
        &self.variants[at]
    }

    /// The position of the source; `None` if the study keeps the position in the scene.
    pub(super) fn source_of(&self, point: &Point) -> Option<Vec3> {
        self.sources.get(point.source)
    }

    /// The position of the listener; `None` if the study keeps the position in the scene.
    pub(super) fn listener_of(&self, point: &Point) -> Option<Vec3> {
        self.listeners.get(point.listener)
    }

    /// The cells of [`Study::point_columns`]. `posed` is the scene in its state at the point.
    pub(super) fn point_cells(&self, point: &Point, posed: &Scene) -> Vec<Cell> {
        let axis = self.axis_of(point.variant);
        let case = &self.settings[point.case];
        let mut cells = vec![point.index.into(), Cell::text(&axis.scene.name)];
        let values = axis.values_at(point.variant);
        for name in self.value_names() {
            let value = values.iter().find(|(known, _)| *known == name);
            cells.push(value.map(|(_, value)| *value).into());
        }
        if let Some(times) = &self.times {
            cells.push(times.get(point.time).into());
        }
        if self.settings.iter().any(|case| case.label.is_some()) {
            cells.push(case.label.as_deref().into());
        }
        cells.push(Cell::text(case.settings.profile().to_string()));
        cells.push(Cell::text(case.settings.directions.to_string()));
        cells.push(case.settings.waves.into());
        cells.push(case.settings.iterations.into());
        let source = self.source_of(point).unwrap_or(posed.sources[0].position);
        let listener = self
            .listener_of(point)
            .unwrap_or(posed.listeners[0].position);
        for position in [source, listener] {
            cells.extend(position.to_array().map(Cell::from));
        }
        cells.push(point.seed.into());
        cells
    }

    /// The scene of a variant at a given time, before the positions of the study are set.
    pub(super) fn posed(&self, variant: u64, time: u64) -> Result<Scene, SceneError> {
        let axis = self.axis_of(variant);
        let mut scene = axis.scene.clone();
        let values = axis.values_at(variant);
        for (name, value) in &values {
            scene.set_value(name, *value)?;
        }
        if !values.is_empty() {
            scene.check()?;
        }
        if let Some(radius) = self.listener_radius {
            scene.listeners[0].radius = radius;
        }
        match &self.times {
            None => Ok(scene),
            Some(times) => {
                let seconds = times.get(time);
                let posed = scene.at(seconds);
                posed.validate().map_err(|refused| refused.at(seconds))?;
                Ok(posed)
            }
        }
    }

    /// Describes a point, for messages.
    pub(super) fn label(&self, point: &Point) -> String {
        let axis = self.axis_of(point.variant);
        let mut label = format!("scene {}", axis.scene.name);
        for (name, value) in axis.values_at(point.variant) {
            label += &format!(", {name} = {value}");
        }
        if let Some(times) = &self.times {
            label += &format!(", {} s", times.get(point.time));
        }
        for (what, place) in [
            ("source", self.source_of(point)),
            ("listener", self.listener_of(point)),
        ] {
            if let Some(place) = place {
                label += &format!(", {what} at {place}");
            }
        }
        label
    }
}

impl SceneAxis {
    /// The named values of a variant of this scene. The last value changes fastest.
    fn values_at(&self, variant: u64) -> Vec<(&str, f32)> {
        let mut rest = variant - self.first;
        let mut values: Vec<(&str, f32)> = Vec::new();
        for (name, numbers) in self.values.iter().rev() {
            values.push((name, numbers.get(rest % numbers.len()) as f32));
            rest /= numbers.len();
        }
        values.reverse();
        values
    }
}
