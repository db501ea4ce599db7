//! The sound of a free way, with the edges beside it and the ways around the far side of what is beside it.

use super::Ends;
use super::OFF_THE_EDGE;
use super::interference::{self, Sound, band_mean};
use super::narrow::wideness;
use super::rim::{MOST_DETOUR_M, Rim};
use super::space::Space;
use super::string::HalfPlanes;
use super::ways::Ways;
use crate::bands::Bands;
use num_complex::Complex64;

/// The edges and further ways beside a free way.
pub(super) struct Lit {
    /// Length of the way in metres.
    apart_m: f64,
    rims: Vec<Rim>,
    /// The ways around the far side of the obstacles of the edges.
    far: Option<Ways>,
}

impl Lit {
    /// The edges and ways beside the straight way between two points in sight; `None` if the points coincide.
    pub fn between(space: &impl Space, (source, listener): Ends) -> Option<Lit> {
        let planes = HalfPlanes::between(source, listener)?;
        let lit = Lit::beside(space, planes);
        let touched = lit.rims.iter().find(|rim| rim.touches_the_straight_way());
        let Some(touched) = touched else {
            return Some(lit);
        };
        // The half-planes of an edge on the line between source and listener are not defined.
        let moved = listener + touched.inwards() * (OFF_THE_EDGE[0] * lit.apart_m);
        let planes = HalfPlanes::between(source, moved)?;
        Some(Lit::beside(space, planes))
    }

    fn beside(space: &impl Space, planes: HalfPlanes) -> Lit {
        let rims = Rim::all(space, &planes, &[]);
        let apart_m = planes.apart_m();
        let far = (!rims.is_empty()).then(|| {
            let planes = planes.around_what_is_beside(MOST_DETOUR_M);
            Ways::around(space, &planes)
        });
        Lit { apart_m, rims, far }
    }

    /// The energy at the listener by band, relative to that in the open. Includes the energy of reflections that end at the
    /// edges. `coefficients` are the pressure reflection coefficients of a surface, by its number and by band.
    pub fn energy(
        &self,
        space: &impl Space,
        speed: f64,
        coefficients: impl Fn(u32) -> Bands,
    ) -> Bands {
        let faces = self
            .rims
            .iter()
            .map(|rim| coefficients(space.nearest(rim.point())));
        let faces: Vec<Bands> = faces.collect();
        let far = self
            .far
            .as_ref()
            .map(|far| (far, far.faces(space, coefficients)));
        std::array::from_fn(|band| {
            let far = far
                .as_ref()
                .map(|(far, faces)| (*far, Ways::in_band(faces, band)));
            band_mean(band, speed, |k| {
                let mut sounds = vec![Sound {
                    pressure: Complex64::ONE,
                    length_m: self.apart_m,
                }];
                let wide = self
                    .far
                    .as_ref()
                    .map_or(1.0, |far| wideness(k * far.wide_m));
                let mut reflected = 0.0;
                for (rim, face) in self.rims.iter().zip(&faces) {
                    let Some(added) = rim.added(space, k, (face[band], wide)) else {
                        continue;
                    };
                    reflected += added.reflected.norm_sqr();
                    sounds.push(Sound {
                        pressure: added.direct,
                        length_m: rim.length_m,
                    });
                }
                if let Some((far, faces)) = &far {
                    sounds.extend(self.heard_around(far.sounds(space, k, faces)));
                }
                interference::energy(&sounds, k) + reflected
            })
        })
    }

    /// The sounds around the far side of the obstacles, weighted by the nearness of the nearest edge.
    fn heard_around(&self, sounds: Vec<Sound>) -> impl Iterator<Item = Sound> {
        let nearness = self.rims.iter().map(Rim::nearness);
        let near = nearness.fold(0.0, f64::max);
        sounds.into_iter().map(move |sound| Sound {
            pressure: sound.pressure * near,
            ..sound
        })
    }
}
