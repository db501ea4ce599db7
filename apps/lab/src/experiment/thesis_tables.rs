//! The tables of the thesis, figures 11.1 to 11.4, as printed there.

/// The numbers of waves in the rows of every table.
pub const WAVE_COUNTS: [u32; 8] = [64, 256, 1024, 4096, 16_384, 65_536, 262_144, 1_048_576];

/// One of the four tables.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThesisTable {
    /// Number of the figure, such as `11.1`.
    pub figure: &'static str,
    /// Name of the built-in scene.
    pub scene: &'static str,
    /// Number of iterations of every wave.
    pub iterations: u32,
    /// The rows, one for each of [`WAVE_COUNTS`].
    pub rows: [ThesisRow; 8],
}

/// The thesis' measurements for one number of waves.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct ThesisRow {
    /// Milliseconds per frame on the mobile machine (GeForce GT 330M).
    pub mobile_ms: f64,
    /// Milliseconds per frame on the desktop machine (Radeon HD 3650).
    pub desktop_ms: f64,
    /// Number of waves that reached the listener.
    pub listener_hits: u64,
}

const fn row(mobile_ms: f64, desktop_ms: f64, listener_hits: u64) -> ThesisRow {
    ThesisRow {
        mobile_ms,
        desktop_ms,
        listener_hits,
    }
}

/// The four tables, in the order of the thesis. The thesis attributes the mobile times at 1,048,576 waves to a fault of
/// that machine, and says that they should be ignored.
pub const THESIS_TABLES: [ThesisTable; 4] = [
    ThesisTable {
        figure: "11.1",
        scene: "corner",
        iterations: 4,
        rows: [
            row(1.3, 1.9, 0),
            row(1.4, 1.7, 2),
            row(1.5, 2.0, 13),
            row(2.2, 2.8, 27),
            row(4.1, 6.6, 95),
            row(12.0, 19.5, 428),
            row(40.5, 73.2, 1642),
            row(22.0, 276.0, 6760),
        ],
    },
    ThesisTable {
        figure: "11.2",
        scene: "corner",
        iterations: 8,
        rows: [
            row(1.4, 2.4, 0),
            row(1.6, 1.9, 6),
            row(1.8, 2.3, 20),
            row(2.8, 5.5, 63),
            row(5.65, 10.1, 199),
            row(19.0, 33.9, 848),
            row(64.5, 128.4, 3270),
            row(20.5, 500.0, 13402),
        ],
    },
    ThesisTable {
        figure: "11.3",
        scene: "obstacles",
        iterations: 4,
        rows: [
            row(1.39, 1.7, 0),
            row(1.51, 1.8, 0),
            row(1.6, 2.2, 0),
            row(2.42, 3.5, 0),
            row(5.01, 8.7, 0),
            row(16.55, 30.0, 0),
            row(52.29, 110.0, 0),
            row(22.0, 428.01, 0),
        ],
    },
    ThesisTable {
        figure: "11.4",
        scene: "obstacles",
        iterations: 8,
        rows: [
            row(1.5, 1.8, 0),
            row(1.81, 2.0, 0),
            row(2.1, 2.6, 0),
            row(3.26, 5.0, 0),
            row(7.8, 13.8, 1),
            row(24.4, 51.3, 5),
            row(86.1, 194.6, 25),
            row(22.4, 764.3, 84),
        ],
    },
];
