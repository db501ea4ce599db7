//! The stored fields of bars and the doorway against exact solutions and symmetries.

use super::super::oracle::{
    Body, Row, SPEED_OF_SOUND, boundary_elements, cylinder_line_source, level_db, wave_number,
};

/// The surface's integral equation, solved at the cylinder, gives the series.
#[test]
fn the_stored_cylinder_is_the_series() {
    let rows = boundary_elements(Body::Cylinder);
    assert_eq!(rows.len(), 7 * 4);
    for row in rows {
        let k = wave_number(row.frequency, SPEED_OF_SOUND);
        let exact = cylinder_line_source(k, row.width / 2.0, row.source, row.receiver);
        assert!((row.pressure - exact).norm() < 1e-4, "{row:?} for {exact}");
    }
}

/// The doorway is symmetric about y = 0.
#[test]
fn the_stored_doorway_is_symmetric() {
    let rows = boundary_elements(Body::Doorway);
    assert_eq!(rows.len(), 5 * 2 * 7);
    let mirrored = |row: &Row| [row.receiver[0], -row.receiver[1]];
    let mut pairs = 0;
    for row in rows
        .iter()
        .filter(|row| row.source[1] == 0.0 && row.receiver[1] != 0.0)
    {
        let same = |other: &&Row| other.frequency == row.frequency && other.source == row.source;
        for other in rows.iter().filter(same) {
            if other.receiver == mirrored(row) {
                assert!(
                    (row.pressure - other.pressure).norm() < 2e-6,
                    "{row:?}, {other:?}"
                );
                pairs += 1;
            }
        }
    }
    assert_eq!(pairs, 5 * 2);
}

/// Right behind a bar's middle the level falls with its width.
#[test]
fn wider_bars_shade_more() {
    let rows = boundary_elements(Body::Bar);
    assert_eq!(rows.len(), 7 * 3 * 2 * 7);
    let behind = |row: &&Row| row.source[1] == 0.0 && row.receiver[1] == 0.0;
    for frequency in [63.0, 125.0, 250.0, 500.0, 1000.0, 2000.0, 4000.0] {
        let of_frequency = rows.iter().filter(|row| row.frequency == frequency);
        let middle: Vec<&Row> = of_frequency.filter(behind).collect();
        assert!(middle.is_sorted_by_key(|row| row.width));
        let levels: Vec<f64> = middle.iter().map(|row| level_db(row.pressure)).collect();
        assert!(
            levels.len() == 3 && levels[0] > levels[1] && levels[1] > levels[2],
            "{levels:?} dB"
        );
    }
}
