//! Complex numbers of any magnitude: Bessel functions of high order leave the range of `f64`, their products do not.

use rustfft::num_complex::Complex64;

/// Magnitudes outside 1/`LIMIT` … `LIMIT` move into the exponent: the product of two mantissas is in the range of `f64`.
const LIMIT: f64 = 1e100;

/// `mantissa`·e^`log`.
#[derive(Clone, Copy, Debug)]
pub struct Scaled {
    mantissa: Complex64,
    log: f64,
}

impl From<f64> for Scaled {
    fn from(value: f64) -> Self {
        Self {
            mantissa: value.into(),
            log: 0.0,
        }
    }
}

impl Scaled {
    /// e^`log`.
    pub fn exp(log: f64) -> Self {
        Self {
            mantissa: Complex64::ONE,
            log,
        }
    }

    /// The number, 0 or infinite outside the range of `f64`.
    pub fn to_complex(self) -> Complex64 {
        if self.log == 0.0 {
            self.mantissa
        } else {
            self.mantissa * self.log.exp()
        }
    }

    pub fn times(self, factor: f64) -> Self {
        Self {
            mantissa: self.mantissa * factor,
            ..self
        }
        .normalised()
    }

    pub fn times_complex(self, factor: Complex64) -> Self {
        Self {
            mantissa: self.mantissa * factor,
            ..self
        }
        .normalised()
    }

    pub fn by(self, other: Self) -> Self {
        Self {
            mantissa: self.mantissa * other.mantissa,
            log: self.log + other.log,
        }
        .normalised()
    }

    pub fn over(self, other: Self) -> Self {
        Self {
            mantissa: self.mantissa / other.mantissa,
            log: self.log - other.log,
        }
        .normalised()
    }

    pub fn plus(self, other: Self) -> Self {
        if other.mantissa == Complex64::ZERO {
            return self;
        }
        if self.mantissa == Complex64::ZERO {
            return other;
        }
        if self.log == other.log {
            return Self {
                mantissa: self.mantissa + other.mantissa,
                ..self
            }
            .normalised();
        }
        let (large, small) = if self.log > other.log {
            (self, other)
        } else {
            (other, self)
        };
        let mantissa = large.mantissa + small.mantissa * (small.log - large.log).exp();
        Self { mantissa, ..large }.normalised()
    }

    fn normalised(self) -> Self {
        let magnitude = self.mantissa.re.abs().max(self.mantissa.im.abs());
        if magnitude == 0.0 || (1.0 / LIMIT..LIMIT).contains(&magnitude) {
            return self;
        }
        Self {
            mantissa: self.mantissa / magnitude,
            log: self.log + magnitude.ln(),
        }
    }
}
