//! SOFA files: small files of several kinds.

use super::Target;
use super::scratch::with_file;
use super::sofa_file::{SofaFile, Variable};
use echomarch::hrtf::HrirSet;
use echomarch::scene::Balloon;
use glam::DVec3;

/// Returns the target for SOFA files.
pub fn target() -> Target {
    let ears = || [vec![0.0, 1.0, 0.5, 0.25], vec![0.0, 0.0, 0.5, 0.25]];
    let three = SofaFile::new(
        44_100.0,
        &[
            ([0.0, 0.0], ears()),
            ([90.0, 0.0], ears()),
            ([0.0, 90.0], ears()),
        ],
    );
    let cartesian = Variable::new(&[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0], &[3, 3]);
    let amplitudes = |azimuth: f64| ([azimuth, 0.0], vec![1.0, 0.5]);
    let directivity =
        SofaFile::directivity(&[500.0, 2000.0], &[0.0, 90.0, 180.0, 270.0].map(amplitudes));
    Target {
        name: "sofa",
        corpus: vec![
            SofaFile::simple().bytes(),
            three.bytes(),
            three
                .with("SourcePosition", cartesian.with("Type", "cartesian"))
                .without("Data.Delay")
                .bytes(),
            directivity.bytes(),
            include_bytes!("../sofa/earliest-gzip.sofa").to_vec(),
            include_bytes!("../sofa/v112-endless.sofa").to_vec(),
            include_bytes!("../sofa/latest-chunked.sofa").to_vec(),
            include_bytes!("../sofa/latest-gzip.sofa").to_vec(),
        ],
        tokens: &[
            "OHDR",
            "TREE",
            "HEAP",
            "SNOD",
            "FRHP",
            "Data.IR",
            "Data.Real",
            "SOFA",
        ],
        one,
    }
}

/// Reads a set of responses, or else a directivity, and looks up a direction.
pub fn one(data: &[u8]) {
    with_file("head.sofa", data, |path| match HrirSet::read_sofa(path) {
        Err(error) => {
            drop(error.to_string());
            match Balloon::read_sofa(path) {
                Err(error) => drop(error.to_string()),
                Ok(balloon) => {
                    let factors = balloon.factor(DVec3::new(0.3, -0.8, 0.1));
                    assert!(factors.iter().all(|factor| *factor >= 0.0), "{factors:?}");
                }
            }
        }
        Ok(set) => {
            for ear in set.pair(DVec3::new(0.3, -0.8, 0.1)) {
                assert!(ear.delay_s.is_finite());
                assert!(ear.samples.iter().all(|sample| sample.is_finite()));
            }
        }
    });
}
