//! Line sources at thick bars, a cylinder and a doorway: values computed by `scripts/references/boundary_elements.py`.

use rustfft::num_complex::Complex64;

/// Values with a header that names the bodies' places and the command.
const TABLE: &str = include_str!("boundary_elements.tsv");

/// Rigid bodies of the table, endless along the line source.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Body {
    /// Rectangle with the middle at the origin, `width` along x and 2 m along y.
    Bar,
    /// Cylinder of diameter `width` about the origin.
    Cylinder,
    /// Opening `width` about y = 0 in an endless wall 0.1 m thick about x = 0.
    Doorway,
}

/// One row: lengths in m, frequency in Hz, total field relative to the free field of the line source.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    pub body: Body,
    pub width: f64,
    pub frequency: f64,
    pub source: [f64; 2],
    pub receiver: [f64; 2],
    pub pressure: Complex64,
}

/// The rows of a body.
pub fn boundary_elements(body: Body) -> Vec<Row> {
    let lines = TABLE.lines().filter(|line| !line.starts_with('#'));
    let rows = lines.skip(1).map(row);
    rows.filter(|row| row.body == body).collect()
}

fn row(line: &str) -> Row {
    let (name, numbers) = line.split_once('\t').expect("a body and numbers");
    let body = match name {
        "bar" => Body::Bar,
        "cylinder" => Body::Cylinder,
        "doorway" => Body::Doorway,
        _ => panic!("{name} is not a body"),
    };
    let numbers: Vec<f64> = numbers
        .split('\t')
        .map(|number| number.parse().expect("a number"))
        .collect();
    let [
        width,
        frequency,
        source_x,
        source_y,
        receiver_x,
        receiver_y,
        re,
        im,
    ] = numbers[..]
    else {
        panic!("{} numbers for 8", numbers.len());
    };
    Row {
        body,
        width,
        frequency,
        source: [source_x, source_y],
        receiver: [receiver_x, receiver_y],
        pressure: Complex64::new(re, im),
    }
}
