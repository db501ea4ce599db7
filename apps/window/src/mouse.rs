//! Mouse look: converts pointer positions to rotations of the gaze.
//!
//! The hidden pointer is kept inside the window: before it reaches the edge, it is moved back to the centre. Raw device
//! movements are not used, for two reasons: X11 reports them twice to a window that grabs the pointer (winit issue
//! 2846), and some devices report positions instead.

/// The pointer is moved back if its distance from the centre exceeds this share of the distance from the centre to the
/// edge.
const FAR: f64 = 0.5;

/// Tracks the pointer.
#[derive(Clone, Copy, Debug, Default)]
pub struct Mouse {
    /// The pointer's last position, in pixels.
    at: Option<[f64; 2]>,
    /// The position to which the pointer was moved back; `None` once an event has reported the pointer there.
    put: Option<[f64; 2]>,
}

/// The effect of a pointer movement.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moved {
    /// Movement to the right and down, in pixels.
    pub by: [f64; 2],
    /// The position to which the pointer must be moved back now.
    pub put: Option<[f64; 2]>,
}

impl Mouse {
    /// Handles an event that reports the pointer at `to`, in a window of the given size in pixels. `looks` is true
    /// while the mouse is captured.
    pub fn moved(&mut self, to: [f64; 2], [width, height]: [u32; 2], looks: bool) -> Moved {
        let before = self.at.replace(to);
        let middle = [f64::from(width / 2), f64::from(height / 2)];
        let is_far = [0, 1]
            .iter()
            .any(|&axis| (to[axis] - middle[axis]).abs() > FAR * middle[axis]);
        // A reported position far from the centre means that the pointer has not been moved back yet.
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

    /// Simulates a hand that moves the pointer in steps, where the pointer can be moved back. Returns the sum of the
    /// rotations.
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

    /// Protects long rotations: every pixel of the hand's movement counts once, and the pointer never reaches the edge.
    #[test]
    fn the_hand_may_go_on_in_one_direction() {
        assert_eq!(turned(&[[30.0, -8.0]; 100]), [3000.0, -800.0]);
        assert_eq!(turned(&[[-3.0, 2.0]; 1000]), [-3000.0, 2000.0]);
        assert_eq!(turned(&[[5.0, 0.0], [0.0, 0.0], [-5.0, 1.0]]), [0.0, 1.0]);
    }

    /// Protects the gaze: it does not jump when the pointer enters the window, and ignores a pointer that is not
    /// captured.
    #[test]
    fn a_free_pointer_turns_nothing() {
        let mut mouse = Mouse::default();
        assert_eq!(mouse.moved([9.0, 9.0], SIZE, true).by, [0.0; 2]);
        assert_eq!(mouse.moved([500.0, 300.0], SIZE, false).by, [0.0; 2]);
        assert_eq!(mouse.moved([501.0, 298.0], SIZE, true).by, [1.0, -2.0]);
    }

    /// Protects mouse look on systems where the pointer cannot be moved back: the request is not repeated, and pointer
    /// movements still rotate the gaze.
    #[test]
    fn a_pointer_that_stays_away_still_turns() {
        let mut mouse = Mouse::default();
        mouse.moved([900.0, 270.0], SIZE, false);
        for (x, put) in [(905.0, Some([480.0, 270.0])), (910.0, None), (915.0, None)] {
            let moved = mouse.moved([x, 270.0], SIZE, true);
            assert_eq!((moved.by, moved.put), ([5.0, 0.0], put));
        }
        // The pointer reaches the centre late, after a movement by the hand.
        assert_eq!(mouse.moved([483.0, 269.0], SIZE, true).by, [3.0, -1.0]);
    }
}
