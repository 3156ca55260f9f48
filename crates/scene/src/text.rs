//! Numbers in messages: short, whatever their size.

use glam::DVec3;
use std::fmt;

/// A number without trailing zeros, and with an exponent where that is shorter: 0.5, 30, 1e308.
pub(crate) struct Number(pub(crate) f64);

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let is_plain = self.0.fract() == 0.0 && self.0.abs() < 1e16;
        if is_plain { write!(f, "{}", self.0) } else { write!(f, "{:?}", self.0) }
    }
}

/// The coordinates of a point as [`Number`]s.
pub(crate) struct Point(pub(crate) DVec3);

impl fmt::Display for Point {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = self.0.to_array().map(Number);
        write!(f, "({x}, {y}, {z})")
    }
}

/// An angle in degrees, as it was before it became radians: rounded to 10⁻⁹.
pub(crate) fn degrees(radians: f64) -> Number {
    let degrees = radians.to_degrees();
    let rounded = (degrees * 1e9).round() / 1e9;
    Number(if rounded.is_finite() { rounded } else { degrees })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let cases = [(0.5, "0.5"), (30.0, "30"), (-1e308, "-1e308"), (1e-300, "1e-300"), (f64::NAN, "NaN")];
        for (number, text) in cases {
            assert_eq!(Number(number).to_string(), text);
        }
        assert_eq!(Point(DVec3::new(1e308, 0.0, -0.25)).to_string(), "(1e308, 0, -0.25)");
    }

    #[test]
    fn angles_are_those_that_were_written() {
        for angle in [-30.0f64, 0.1, 179.9, 180.0, 1e-7, 1e300] {
            assert_eq!(degrees(angle.to_radians()).to_string(), Number(angle).to_string());
        }
    }
}
