//! Places of the texts in the plan: each beside its mark, and no two over each other.

use egui::{Pos2, Rect, Vec2};

/// Returns the first free place of a text of `size` at a mark with the radius `beside`: right, left, above, below. `None`
/// if each of them leaves `whole` or overlaps a `taken` place.
pub fn free_place(at: Pos2, size: Vec2, beside: f32, taken: &[Rect], whole: Rect) -> Option<Rect> {
    let half = 0.5 * size;
    let centres = [
        at + Vec2::new(beside + half.x, 0.0),
        at - Vec2::new(beside + half.x, 0.0),
        at - Vec2::new(0.0, beside + half.y),
        at + Vec2::new(0.0, beside + half.y),
    ];
    let places = centres.map(|centre| Rect::from_center_size(centre, size));
    let is_free = |place: &Rect| {
        whole.contains_rect(*place) && taken.iter().all(|other| !overlap(*place, *other))
    };
    places.into_iter().find(is_free)
}

/// Whether two places share an area. Places that only touch do not.
fn overlap(a: Rect, b: Rect) -> bool {
    let shared = a.intersect(b);
    shared.width() > 0.0 && shared.height() > 0.0
}

/// The largest of 1, 2 or 5 times a power of ten that is at most `most` metres, above 0.
pub fn round_length(most: f32) -> f32 {
    let ten = 10_f32.powf(most.max(f32::MIN_POSITIVE).log10().floor());
    let factor = [5.0, 2.0].into_iter().find(|times| times * ten <= most);
    factor.unwrap_or(1.0) * ten
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the texts of the plan: names of marks close together do not overlap, and a name without a place is left
    /// out.
    #[test]
    fn names_of_near_marks_do_not_overlap() {
        let whole = Rect::from_min_size(Pos2::ZERO, Vec2::new(200.0, 100.0));
        let size = Vec2::new(50.0, 10.0);
        let marks = [40.0, 45.0, 50.0, 55.0, 60.0].map(|y| Pos2::new(100.0, y));
        let mut taken = Vec::new();
        for at in marks {
            taken.extend(free_place(at, size, 6.0, &taken, whole));
        }
        assert!((3..=5).contains(&taken.len()), "{taken:?}");
        for (index, a) in taken.iter().enumerate() {
            assert!(taken[..index].iter().all(|b| !overlap(*a, *b)), "{taken:?}");
        }
        let beyond = free_place(Pos2::new(-500.0, 0.0), size, 6.0, &[], whole);
        assert_eq!(beyond, None);
    }

    /// Protects the bar of the plan from odd lengths.
    #[test]
    fn the_bar_has_a_round_length() {
        for (most, expected) in [(7.3, 5.0), (4.9, 2.0), (1.9, 1.0), (0.6, 0.5), (60.0, 50.0)] {
            assert!((round_length(most) / expected - 1.0).abs() < 1e-5, "{most}");
        }
    }
}
