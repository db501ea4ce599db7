//! Bessel functions against values computed with 30 digits (mpmath 1.3) and against their Wronskians.

use super::super::oracle::bessel::{
    Sequence, cylindrical, hankel, modified_first, modified_second, spherical,
};
use super::super::oracle::scaled::Scaled;
use std::f64::consts::FRAC_2_PI;

/// Relative error of recurrences over some hundred orders.
const TOLERANCE: f64 = 1e-11;

/// Order, argument, and value and derivative of the function that falls with the order and of the one that grows.
type Row = (usize, f64, [f64; 2], [f64; 2]);

#[track_caller]
fn assert_near(found: f64, expected: f64, scale: f64) {
    assert!(
        (found - expected).abs() <= TOLERANCE * scale,
        "{found} for {expected}"
    );
}

/// Compares a row; `part` selects the growing function of its sequence. Value and derivative of one function have zeros
/// at different places, so the larger is the scale.
#[track_caller]
fn check(row: Row, functions: (Sequence, Sequence), part: fn(Scaled) -> f64) {
    let (n, _, falling, growing) = row;
    let found =
        [functions.0.value(n), functions.0.derivative(n)].map(|value| value.to_complex().re);
    let other = [functions.1.value(n), functions.1.derivative(n)].map(part);
    for (found, expected) in [(found, falling), (other, growing)] {
        let scale = expected[0].abs().max(expected[1].abs());
        assert_near(found[0], expected[0], scale);
        assert_near(found[1], expected[1], scale);
    }
}

/// Jₙ and Yₙ from far below to far above the turning point.
#[test]
fn cylindrical_functions() {
    let rows: [Row; 6] = [
        (
            0,
            0.01,
            [0.999_975_000_156_249_6, -0.004_999_937_500_260_416],
            [-3.005_455_637_083_646, 63.678_596_282_060_65],
        ),
        (
            1,
            0.01,
            [0.004_999_937_500_260_416, 0.499_981_250_130_207_94],
            [-63.678_596_282_060_65, 6_364.854_172_568_982],
        ),
        (
            7,
            5.5,
            [0.086_601_225_791_612_54, 0.076_562_991_097_248_1],
            [-0.874_921_069_456_375_9, 0.563_069_113_907_598_5],
        ),
        (
            60,
            41.0,
            [3.945_133_281_861_173e-7, 4.255_453_833_897_449e-7],
            [-18_427.271_639_798_35, 19_481.397_958_625_457],
        ),
        (
            3,
            300.0,
            [0.032_328_577_670_839_36, 0.032_762_686_223_747_28],
            [-0.032_818_167_765_077_164, 0.032_381_708_395_129_57],
        ),
        (
            310,
            300.0,
            [0.007_835_950_928_457_786, 0.002_200_494_865_329_392_7],
            [-0.534_100_319_800_511_6, 0.120_825_271_271_378_9],
        ),
    ];
    for row in rows {
        check(row, cylindrical(row.1, row.0 + 1), |value| {
            value.to_complex().im
        });
    }
}

/// Iₙ and Kₙ.
#[test]
fn modified_functions() {
    let rows: [Row; 4] = [
        (
            0,
            0.01,
            [1.000_025_000_156_250_5, 0.005_000_062_500_260_417],
            [4.721_244_730_161_095, -99.973_894_118_296_24],
        ),
        (
            5,
            0.3,
            [6.351_893_642_780_316e-7, 1.060_236_063_970_717_5e-5],
            [157_139.123_371_216_7, -2_624_867.119_176_856],
        ),
        (
            2,
            9.0,
            [864.496_193_952_051, 838.804_457_194_278_4],
            [6.280_064_992_967_079e-5, -6.759_271_636_382_323e-5],
        ),
        (
            40,
            25.0,
            [0.003_567_855_746_528_473_6, 0.006_712_047_973_338_523],
            [2.970_844_550_599_705, -5.622_298_175_749_233],
        ),
    ];
    for row in rows {
        let functions = (
            modified_first(row.1, row.0 + 1),
            modified_second(row.1, row.0 + 1),
        );
        check(row, functions, |value| value.to_complex().re);
    }
}

/// jₙ and yₙ.
#[test]
fn spherical_functions() {
    let rows: [Row; 5] = [
        (
            0,
            0.01,
            [0.999_983_333_416_666_5, -0.003_333_300_000_119_047_5],
            [-99.995_000_041_666_53, 10_000.499_987_500_07],
        ),
        (
            3,
            0.2,
            [7.602_131_786_241_085e-5, 0.001_138_629_722_279_169],
            [-9_412.625_829_172_215, 187_874.991_749_833_4],
        ),
        (
            12,
            4.0,
            [1.573_047_531_315_662_5e-6, 4.481_145_662_345_54e-6],
            [-6_713.085_928_870_587, 20_608.203_797_742_37],
        ),
        (
            50,
            41.0,
            [0.000_199_443_087_691_040_54, 0.000_145_241_823_403_770_4],
            [-2.082_809_103_582_617_3, 1.465_947_047_846_904_5],
        ),
        (
            9,
            300.0,
            [-0.000_425_322_107_091_423_1, -0.003_303_855_556_863_042],
            [0.003_306_927_856_656_565, -0.000_436_138_006_132_977_9],
        ),
    ];
    for row in rows {
        check(row, spherical(row.1, row.0 + 1), |value| {
            value.to_complex().im
        });
    }
}

/// Orders whose values are outside the range of `f64`: the Wronskians join the two functions and their derivatives.
#[test]
fn wronskians_hold_outside_the_range_of_f64() {
    const LAST: usize = 400;
    for x in [1e-8, 0.3, 20.0, 350.0] {
        let families = [
            (cylindrical(x, LAST), FRAC_2_PI / x, true),
            (spherical(x, LAST), 1.0 / (x * x), true),
            (
                (modified_first(x, LAST), modified_second(x, LAST)),
                -1.0 / x,
                false,
            ),
        ];
        for ((falling, growing), expected, imaginary) in families {
            for n in (0..LAST).step_by(19) {
                let first = falling.value(n).by(growing.derivative(n));
                let second = falling.derivative(n).by(growing.value(n));
                let found = first.plus(second.times(-1.0)).to_complex();
                assert_near(
                    if imaginary { found.im } else { found.re },
                    expected,
                    expected.abs(),
                );
            }
        }
    }
}

/// Hankel's expansion far below the turning point, against the orders from far above it.
#[test]
fn hankel_functions_agree_from_both_directions() {
    for x in [30.0, 31.7, 70.0, 500.0] {
        let last = x as usize - 1;
        let (far, all) = (hankel(x, last), cylindrical(x, last).1);
        for n in 0..last {
            let (found, expected) = (far.value(n).to_complex(), all.value(n).to_complex());
            assert!(
                (found - expected).norm() <= TOLERANCE * expected.norm(),
                "{found} for {expected}, H{n}({x})"
            );
        }
    }
}
