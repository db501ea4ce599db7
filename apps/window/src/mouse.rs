//! Mouse look: converts pointer positions to turns of the gaze.
//!
//! The hidden pointer is kept inside the window: before it reaches the edge, it is moved back to the middle. The
//! device's own movements are not used: X11 reports them twice to a window that grabs the pointer (winit's issue 2846),
//! and some devices report positions instead.

/// The pointer is moved back if its distance from the middle exceeds this share of the distance from the middle to the
/// edge.
const FAR: f64 = 0.5;

/// Tracks the pointer.
#[derive(Clone, Copy, Debug, Default)]
pub struct Mouse {
    /// The pointer's last position, in pixels.
    at: Option<[f64; 2]>,
    /// The position that the pointer was moved to, until an event reports the pointer near that position.
    put: Option<[f64; 2]>,
}

/// The effect of a pointer movement.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moved {
    /// Pixels to the right and down.
    pub by: [f64; 2],
    /// The position to move the pointer to now.
    pub put: Option<[f64; 2]>,
}

impl Mouse {
    /// Handles an event that reports the pointer at `to`, in a window of the given size in pixels; `looks` states
    /// whether the mouse is captured.
    pub fn moved(&mut self, to: [f64; 2], [width, height]: [u32; 2], looks: bool) -> Moved {
        let before = self.at.replace(to);
        let middle = [f64::from(width / 2), f64::from(height / 2)];
        let is_far = [0, 1]
            .iter()
            .any(|&axis| (to[axis] - middle[axis]).abs() > FAR * middle[axis]);
        // A pointer reported far from the middle has not been moved back yet.
        let from = self.put.take_if(|_| !is_far || !looks).or(before);
        let Some(from) = from.filter(|_| looks) else {
            return Moved::default();
        };
        let by = [to[0] - from[0], to[1] - from[1]];
        if !is_far || self.put.is_some() {
            return Moved { by, put: None };
        }
        self.put = Some(middle);
        Moved { by, put: self.put }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: [u32; 2] = [960, 540];

    /// Simulates a hand that moves the pointer by steps, with a pointer that can be moved back; returns the sum of
    /// turns.
    fn turned(steps: &[[f64; 2]]) -> [f64; 2] {
        let mut mouse = Mouse::default();
        let mut at = [480.0, 270.0];
        mouse.moved(at, SIZE, false);
        let mut sum = [0.0; 2];
        for step in steps {
            at = [at[0] + step[0], at[1] + step[1]];
            assert!((0.0..960.0).contains(&at[0]) && (0.0..540.0).contains(&at[1]));
            let moved = mouse.moved(at, SIZE, true);
            sum = [sum[0] + moved.by[0], sum[1] + moved.by[1]];
            if let Some(place) = moved.put {
                at = place;
                assert_eq!(mouse.moved(at, SIZE, true), Moved::default());
            }
        }
        sum
    }

    /// Protects long turns: every pixel of the hand's movement counts once, and the pointer never reaches the edge.
    #[test]
    fn the_hand_may_go_on_in_one_direction() {
        assert_eq!(turned(&[[30.0, -8.0]; 100]), [3000.0, -800.0]);
        assert_eq!(turned(&[[-3.0, 2.0]; 1000]), [-3000.0, 2000.0]);
        assert_eq!(turned(&[[5.0, 0.0], [0.0, 0.0], [-5.0, 1.0]]), [0.0, 1.0]);
    }

    /// Protects the gaze from a jump when the pointer enters the window, and from a pointer that is not captured.
    #[test]
    fn a_free_pointer_turns_nothing() {
        let mut mouse = Mouse::default();
        assert_eq!(mouse.moved([9.0, 9.0], SIZE, true).by, [0.0; 2]);
        assert_eq!(mouse.moved([500.0, 300.0], SIZE, false).by, [0.0; 2]);
        assert_eq!(mouse.moved([501.0, 298.0], SIZE, true).by, [1.0, -2.0]);
    }

    /// Protects mouse look where the pointer cannot be moved back: it is not moved twice, and its movements keep
    /// turning the gaze.
    #[test]
    fn a_pointer_that_stays_away_still_turns() {
        let mut mouse = Mouse::default();
        mouse.moved([900.0, 270.0], SIZE, false);
        for (x, put) in [(905.0, Some([480.0, 270.0])), (910.0, None), (915.0, None)] {
            let moved = mouse.moved([x, 270.0], SIZE, true);
            assert_eq!((moved.by, moved.put), ([5.0, 0.0], put));
        }
        // The pointer is moved back at last, after a movement of its own.
        assert_eq!(mouse.moved([483.0, 269.0], SIZE, true).by, [3.0, -1.0]);
    }
}
