//! Echogram and figures of random waves in empty rectangular rooms against image sources.

use super::waves::Room;
use crate::acoustics::{BandFigures, Echogram, Figures, Tap};
use crate::bands::{BAND_COUNT, Bands};
use crate::reference::ShoeboxEnergies;
use crate::rng::{hash, unit_interval};
use glam::DVec3;

const SPEED: f64 = 343.0;

/// Uniform numbers of a case.
pub(super) struct Draw(pub(super) u64);

impl Draw {
    pub(super) fn within(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_add(1);
        low + (high - low) * unit_interval(hash(self.0))
    }
}

pub(super) fn random_room(case: u64) -> Room {
    let mut draw = Draw(hash(case ^ 0x5eed));
    let radius = 0.3;
    let size = DVec3::new(
        draw.within(3.0, 14.0),
        draw.within(2.5, 6.0),
        draw.within(3.0, 10.0),
    );
    let mut place = || {
        let half = size / 2.0 - radius;
        DVec3::new(
            draw.within(-half.x, half.x),
            draw.within(-half.y, half.y),
            draw.within(-half.z, half.z),
        )
    };
    let source = place();
    let mut listener = place();
    while listener.distance(source) < 1.0 {
        listener = place();
    }
    Room {
        size,
        source,
        listener,
        radius,
        absorption: [[0.0; BAND_COUNT]; 6],
    }
}

fn tap(image: &crate::reference::ImageSource) -> Tap {
    Tap {
        seconds: image.length_m / SPEED,
        energy: image.energy,
        direction: image.direction,
    }
}

pub(super) struct Case {
    pub(super) truth: Figures,
    pub(super) found: Figures,
}

pub(super) fn run(room: &Room, waves: u32, seconds: f64, order: u32, seed: u64) -> Case {
    let exact =
        ShoeboxEnergies::new(room.size, room.source, room.listener, &room.absorption).unwrap();
    let direct_s = exact.direct_m() / SPEED;
    let taps: Vec<Tap> = exact.images(order).iter().map(tap).collect();
    // truth: 0.1 ms
    let cell_s = 1e-4;
    let fine_order = 12;
    let fine: Vec<Tap> = exact.images(fine_order).iter().map(tap).collect();
    let sums = exact.energies_by_length(cell_s * SPEED, seconds * SPEED, Some(fine_order));
    let mut truth = Echogram::with_edge_at(direct_s, cell_s, 1).unwrap();
    for (cell, energy) in sums.energies.iter().enumerate() {
        truth.add(0, sums.middle_m(cell) / SPEED, energy, DVec3::X);
    }
    let truth = Figures::new(&fine, &truth, Some(direct_s), seconds);
    let mut echogram = Echogram::with_edge_at(direct_s, 1e-3, 16).unwrap();
    room.trace(waves, seconds * SPEED, Some(order), seed, &mut |arrival| {
        echogram.add_arrival(&arrival, SPEED, &[0.0; BAND_COUNT]);
    });
    let found = Figures::new(&taps, &echogram, Some(direct_s), seconds);
    Case { truth, found }
}

fn get(f: &BandFigures) -> [Option<f64>; 8] {
    [
        f.edt_s, f.t20_s, f.t30_s, f.c50_db, f.c80_db, f.d50, f.ts_s, f.g_db,
    ]
}

#[test]
#[ignore]
fn survey() {
    let cases: u64 = std::env::var("CASES").map_or(4, |s| s.parse().unwrap());
    let order: u32 = std::env::var("ORDER").map_or(3, |s| s.parse().unwrap());
    let mode = std::env::var("MODE").unwrap_or("equal".into());
    let names = ["edt", "t20", "t30", "c50", "c80", "d50", "ts", "g"];
    let mut worst = [(0.0f64, 0u64, 0usize); 8];
    let mut all: Vec<Vec<f64>> = vec![vec![]; 8];
    let mut inside = [0; 8];
    let mut count = [0; 8];
    let mut missing = [0; 8];
    let mut false_ = [0; 8];
    for case in 0..cases {
        let mut room = random_room(case);
        let mut draw = Draw(hash(case ^ 77));
        let bands: Bands = [0.02, 0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 0.9];
        room.absorption = match mode.as_str() {
            "equal" => [bands; 6],
            "spread" => {
                std::array::from_fn(|_| bands.map(|a: f64| (a * draw.within(0.5, 1.5)).min(0.95)))
            }
            _ => std::array::from_fn(|_| {
                std::array::from_fn(|_| (draw.within((0.02f64).ln(), (0.9f64).ln())).exp())
            }),
        };
        let (v, s) = (
            room.size.x * room.size.y * room.size.z,
            2.0 * (room.size.x * room.size.y
                + room.size.y * room.size.z
                + room.size.x * room.size.z),
        );
        let min_a = (0..8)
            .map(|b| room.absorption.iter().map(|w| w[b]).sum::<f64>() / 6.0)
            .fold(1.0, f64::min);
        let seconds = (1.5 * 0.161 * v / (s * min_a)).min(6.0);
        let start = std::time::Instant::now();
        let Case { truth, found } = run(&room, 262_144, seconds, order, case + 1000);
        println!(
            "case {case} V {v:.0} seconds {seconds:.2} took {:.1}",
            start.elapsed().as_secs_f64()
        );
        for band in 0..8 {
            let (t, f, e) = (
                get(&truth.bands[band]),
                get(&found.bands[band]),
                get(&found.errors[band]),
            );
            for i in 0..8 {
                match (t[i], f[i], e[i]) {
                    (Some(t), Some(f), Some(e)) => {
                        let d = if [0, 1, 2, 6].contains(&i) {
                            f / t - 1.0
                        } else {
                            f - t
                        };
                        all[i].push(d.abs());
                        if d.abs() > worst[i].0 {
                            worst[i] = (d.abs(), case, band);
                        }
                        count[i] += 1;
                        if (f - t).abs() <= 2.0 * e {
                            inside[i] += 1;
                        }
                        if std::env::var("V").is_ok() && (i == 0 || i == 2 || i == 4 || i == 7) {
                            println!(
                                "  {} band {band} truth {t:.4} found {f:.4} err {e:.5} d {d:.4} z {:.2}",
                                names[i],
                                (f - t) / e
                            );
                        }
                    }
                    (Some(_), None, _) => missing[i] += 1,
                    (None, Some(_), _) => false_[i] += 1,
                    _ => {}
                }
            }
        }
    }
    for i in 0..8 {
        all[i].sort_by(f64::total_cmp);
        let q = |p: f64| {
            all[i]
                .get(((all[i].len() as f64 - 1.0) * p) as usize)
                .copied()
                .unwrap_or(0.0)
        };
        println!(
            "{}: n {} missing {} extra {} within2 {:.3} median {:.4} q90 {:.4} q95 {:.4} worst {:?}",
            names[i],
            count[i],
            missing[i],
            false_[i],
            inside[i] as f64 / count[i] as f64,
            q(0.5),
            q(0.9),
            q(0.95),
            worst[i]
        );
    }
}
