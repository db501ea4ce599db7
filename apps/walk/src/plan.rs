//! The scene from above: walls, sampled from the distance function, and paths of waves.

use echomarch::picture::Bounds;
use echomarch::scene::{Scene, Surface};
use echomarch::tracer::{Fate, Wave};
use glam::{Vec2, Vec3};

/// Number of pixels along the longer side of the plan.
const PIXELS: usize = 220;
/// Change of the listener's height, in metres, after which a new cut through the scene is computed.
const LEVEL: f32 = 0.25;

/// Length of the line drawn for the last segment of a dead wave, as a share of the plan's width.
pub const STUB: f32 = 0.12;

/// Air, in red, green and blue.
const AIR: [f32; 3] = [30.0, 36.0, 42.0];
/// Phase of the red, green and blue component relative to the hue, in radians.
const TURNS: [f32; 3] = [0.0, -2.09, 2.09];
/// Brightness and saturation of solids, and of their edges.
const SOLID: (f32, f32) = (92.0, 18.0);
const EDGE: (f32, f32) = (196.0, 30.0);
/// Hue of the first surface, and the difference between the hues of successive surfaces (the golden angle), in radians.
const FIRST_HUE: f32 = 1.25;
const NEXT_HUE: f32 = 2.399_963_2;

/// The plan, which is cached until the scene changes.
#[derive(Default)]
pub struct Cut {
    of: Option<CutOf>,
    image: PlanImage,
}

/// The plan's picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlanImage {
    /// Width in pixels.
    pub width: usize,
    pub height: usize,
    /// Red, green and blue of each pixel. The row with the smallest world z comes first.
    pub rgb: Vec<u8>,
}

/// The inputs of the plan's picture.
#[derive(Clone, PartialEq)]
struct CutOf {
    scene: String,
    surfaces: Vec<Surface>,
    level: i32,
    bounds: Bounds,
}

impl Cut {
    /// The plan's picture.
    pub fn image(&self) -> &PlanImage {
        &self.image
    }

    /// The part of the world that the plan shows.
    pub fn bounds(&self) -> Bounds {
        let nothing = Bounds {
            min: Vec2::ZERO,
            max: Vec2::ONE,
        };
        self.of.as_ref().map_or(nothing, |of| of.bounds)
    }

    /// Computes the cut through the scene called `name` at the first listener's height, if the scene has changed since
    /// the last call. Returns whether it has changed.
    pub fn refresh(&mut self, name: &str, scene: &Scene) -> bool {
        let Some(walker) = scene.listeners.first() else {
            return false;
        };
        let old = self.of.as_ref().filter(|cut| cut.scene == name);
        let height = walker.position.y;
        let level = (height / LEVEL).round() as i32;
        // The visible part only grows, so that the plan stays in place during a walk.
        let bounds = match old {
            Some(cut) if holds(cut.bounds, scene) => cut.bounds,
            Some(cut) => around(cut.bounds, Bounds::of(scene, height)),
            None => Bounds::of(scene, height),
        };
        let is_same = old.is_some_and(|cut| {
            (cut.level, cut.bounds) == (level, bounds) && cut.surfaces == scene.surfaces
        });
        if is_same {
            return false;
        }
        self.image = sample(scene, bounds, height);
        self.of = Some(CutOf {
            scene: name.to_owned(),
            surfaces: scene.surfaces.clone(),
            level,
            bounds,
        });
        true
    }
}

/// Whether all sources and listeners are within the bounds.
fn holds(bounds: Bounds, scene: &Scene) -> bool {
    let sources = scene.sources.iter().map(|source| source.position);
    let listeners = scene.listeners.iter().map(|listener| listener.position);
    sources.chain(listeners).all(|p| {
        (bounds.min.x..=bounds.max.x).contains(&p.x) && (bounds.min.y..=bounds.max.y).contains(&p.z)
    })
}

fn around(a: Bounds, b: Bounds) -> Bounds {
    Bounds {
        min: a.min.min(b.min),
        max: a.max.max(b.max),
    }
}

/// Samples the horizontal cut at height `level` with the distance function, on the CPU.
fn sample(scene: &Scene, bounds: Bounds, level: f32) -> PlanImage {
    let size = bounds.max - bounds.min;
    let metres = size.max_element() / PIXELS as f32;
    let pixels = |length: f32| ((length / metres).round() as usize).clamp(1, PIXELS);
    let (width, height) = (pixels(size.x), pixels(size.y));
    let mut rgb = Vec::with_capacity(3 * width * height);
    for row in 0..height {
        for column in 0..width {
            let at = Vec2::new(column as f32 + 0.5, row as f32 + 0.5) * metres + bounds.min;
            let nearest = scene.surface_distance(Vec3::new(at.x, level, at.y));
            rgb.extend(shade(nearest.distance / metres, nearest.object));
        }
    }
    PlanImage { width, height, rgb }
}

/// The colour of a pixel: dark for air, the hue of the surface for solids, with a bright edge. `pixels` is the distance
/// to the surface in pixels.
fn shade(pixels: f32, object: u32) -> [u8; 3] {
    let hue = FIRST_HUE + NEXT_HUE * (object as f32 - 1.0);
    let inside = (0.5 - pixels).clamp(0.0, 1.0);
    let on_edge = inside * (0.5 + pixels + 1.6).clamp(0.0, 1.0);
    std::array::from_fn(|channel| {
        let tinted = |(base, chroma): (f32, f32)| base + chroma * (hue + TURNS[channel]).cos();
        let mixed = AIR[channel] + (tinted(SOLID) - AIR[channel]) * inside;
        (mixed + (tinted(EDGE) - mixed) * on_edge) as u8
    })
}

/// Returns the final state of one wave, and the positions of its path. `states` has the form that
/// [`Tracer::paths`](crate::Tracer::paths) returns. The path of a dead wave, or of one that is not finite, ends with a
/// line of `stub` metres.
pub fn way(states: &[Vec<Wave>], wave: usize, source: Vec3, stub: f32) -> (Fate, Vec<Vec3>) {
    let mut points = vec![source];
    let mut heading = states[0][wave].start_direction;
    for waves in &states[1..] {
        let state = &waves[wave];
        match state.fate() {
            fate @ (Fate::Dead | Fate::NotFinite) => {
                let last = points[points.len() - 1];
                points.push(last + stub * heading);
                return (fate, points);
            }
            Fate::Listener => {
                points.push(state.position);
                return (Fate::Listener, points);
            }
            Fate::Travelling => points.push(state.position),
        }
        heading = state.direction;
    }
    (Fate::Travelling, points)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the plan: it shows walls at their true positions.
    #[test]
    fn the_cut_shows_air_and_solid_where_they_are() {
        let scene = Scene::builtin("corner").unwrap();
        let bounds = Bounds {
            min: Vec2::splat(-20.0),
            max: Vec2::splat(20.0),
        };
        let image = sample(&scene, bounds, 0.0);
        assert_eq!((image.width, image.height), (PIXELS, PIXELS));
        let at = |x: f32, z: f32| {
            let pixel = |metres: f32| ((metres + 20.0) / 40.0 * PIXELS as f32) as usize;
            let first = 3 * (pixel(z) * PIXELS + pixel(x));
            &image.rgb[first..first + 3]
        };
        let air = at(-8.0, -8.0);
        assert_eq!(at(10.0, 8.0), air);
        assert_ne!(at(7.5, -7.5), air);
        assert_ne!(at(-18.0, 0.0), air);
    }

    /// Protects the plan: it is redrawn when a surface moves, but not when only the listener walks.
    #[test]
    fn the_plan_is_cut_anew_when_a_surface_moves() {
        let mut scene = Scene::builtin("corner").unwrap();
        let mut cut = Cut::default();
        assert!(cut.refresh("corner", &scene));
        scene.listeners[0].position.x += 0.5;
        assert!(!cut.refresh("corner", &scene));
        scene.surfaces[1].position.x += 0.5;
        assert!(cut.refresh("corner", &scene));
    }
}
