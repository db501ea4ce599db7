//! Decides when a response is renewed: at which frames, and after which changes.

use crate::error::Error;
use crate::scene::{Listener, Pair, Scene, Source};
use std::rc::Rc;

/// Distance in metres that a source or a listener moves before its response is renewed. The direct sound at 1 m changes
/// by at most 0.2 dB over it.
const MOVED_M: f32 = 0.02;

/// Angle in radians that a source or a listener turns before its response is renewed: 1°, the smallest difference of
/// directions that is heard.
const TURNED: f32 = 1.0 * std::f32::consts::PI / 180.0;

/// The frames at which responses may be renewed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slots {
    /// Number of frames of a slot; at least 1.
    frames: u64,
    fps: f64,
    /// The last frame.
    last: u64,
}

impl Slots {
    /// Slots of whole frames, at most `per_second` each second.
    pub fn new(per_second: f64, fps: f64, frames: u64) -> Slots {
        /// Rounding errors of the quotient must not add a frame.
        const ROUNDING: f64 = 1e-9;
        Slots {
            frames: (fps / per_second - ROUNDING).ceil().max(1.0) as u64,
            fps,
            last: frames.saturating_sub(1),
        }
    }

    /// Whether a slot begins at a frame.
    pub fn begins(&self, frame: u64) -> bool {
        frame.is_multiple_of(self.frames)
    }

    /// The time in seconds of the end of the slot that begins at `frame`, at most the time of the last frame.
    pub fn end_s(&self, frame: u64) -> f64 {
        (frame + self.frames).min(self.last.max(frame)) as f64 / self.fps
    }

    /// Samples of a slot.
    pub fn samples(&self, rate_hz: u32) -> u32 {
        (self.frames as f64 / self.fps * f64::from(rate_hz)).round() as u32
    }

    /// Length of a slot in seconds.
    pub fn seconds(&self) -> f64 {
        self.frames as f64 / self.fps
    }
}

/// The scene of the last response of a source.
#[derive(Debug, Default)]
pub(super) struct Renewal {
    traced: Option<Rc<Scene>>,
}

impl Renewal {
    /// Whether the response of a pair must be renewed, because the pair differs from the last traced one. If so, the
    /// pair of `now` counts as traced.
    ///
    /// # Errors
    /// [`Error::Scene`] if the scene has no such source or listener.
    pub fn is_due(
        &mut self,
        now: &Rc<Scene>,
        (source, listener): (usize, usize),
    ) -> Result<bool, Error> {
        if let Some(before) = &self.traced {
            let (before, pair) = (before.pair(source, listener)?, now.pair(source, listener)?);
            if !has_changed(before, pair) {
                return Ok(false);
            }
        }
        self.traced = Some(Rc::clone(now));
        Ok(true)
    }
}

fn has_changed(before: Pair, now: Pair) -> bool {
    let (from, to) = (before.source, now.source);
    let source_moved = from.position.distance(to.position) >= MOVED_M
        || turn((from.yaw, from.pitch), (to.yaw, to.pitch)) >= TURNED;
    let (from, to) = (before.listener, now.listener);
    let listener_moved = from.position.distance(to.position) >= MOVED_M
        || turn((from.yaw, from.pitch), (to.yaw, to.pitch)) >= TURNED;
    source_moved || listener_moved || !is_else_equal(before, now)
}

/// The larger change of both angles.
fn turn(from: (f32, f32), to: (f32, f32)) -> f32 {
    (from.0 - to.0).abs().max((from.1 - to.1).abs())
}

/// Whether everything is equal except the places and the directions of source and listener.
fn is_else_equal(before: Pair, now: Pair) -> bool {
    let source = Source {
        position: now.source.position,
        yaw: now.source.yaw,
        pitch: now.source.pitch,
        ..before.source.clone()
    };
    let listener = Listener {
        position: now.listener.position,
        yaw: now.listener.yaw,
        pitch: now.listener.pitch,
        ..before.listener.clone()
    };
    let (a, b) = (before.scene, now.scene);
    source == *now.source
        && listener == *now.listener
        && a.air == b.air
        && a.materials == b.materials
        && a.scattering == b.scattering
        && a.surfaces == b.surfaces
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    /// Protects the cost and the accuracy of a rendering: a response is renewed after 2 cm, 1° or any change of a
    /// surface, also if these add up from small steps, and not before.
    #[test]
    fn a_response_is_renewed_after_a_change_that_is_heard() {
        let scene = Scene::builtin("corner").unwrap();
        let mut renewal = Renewal::default();
        let mut is_due = |change: &dyn Fn(&mut Scene)| {
            let mut scene = scene.clone();
            change(&mut scene);
            renewal.is_due(&Rc::new(scene), (0, 0)).unwrap()
        };
        assert!(is_due(&|_| ()));
        assert!(!is_due(&|_| ()));
        assert!(!is_due(&|scene| scene.sources[0].position.x += 0.015));
        assert!(is_due(&|scene| scene.sources[0].position.x += 0.025));
        assert!(!is_due(&|scene| scene.sources[0].position.x += 0.025));
        assert!(is_due(&|scene| scene.listeners[0].position.z -= 0.03));
        assert!(is_due(&|scene| scene.listeners[0].yaw += 0.02));
        assert!(is_due(&|scene| scene.surfaces[0].position += Vec3::X * 1e-4));
    }

    /// Protects the rate of responses: at 30 frames a second and 10 responses, each third frame begins a slot.
    #[test]
    fn slots_are_whole_frames() {
        let slots = Slots::new(10.0, 30.0, 31);
        let begins = (0..7).filter(|frame| slots.begins(*frame));
        assert_eq!(begins.collect::<Vec<_>>(), [0, 3, 6]);
        assert_eq!((slots.end_s(0), slots.end_s(30)), (0.1, 1.0));
        assert_eq!(slots.samples(48_000), 4800);
        assert!(Slots::new(10.0, 5.0, 31).begins(1));
        assert_eq!(Slots::new(10.0, 24.0, 31).samples(48_000), 6000);
    }
}
