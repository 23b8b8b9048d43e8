//! Length units, and literals in one unit as numbers of another: by exact arithmetic, rounded once.

use dashu_int::UBig;
use dashu_int::ops::BitTest;

/// A length unit: `numerator / denominator` metres.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Unit {
    /// As it is written.
    pub name: &'static str,
    numerator: u64,
    denominator: u64,
}

const fn unit(name: &'static str, numerator: u64, denominator: u64) -> Unit {
    Unit { name, numerator, denominator }
}

/// All length units.
pub(super) const UNITS: [Unit; 11] = [
    unit("m", 1, 1),
    unit("km", 1000, 1),
    unit("dm", 1, 10),
    unit("cm", 1, 100),
    unit("mm", 1, 1000),
    unit("um", 1, 1_000_000),
    unit("µm", 1, 1_000_000),
    unit("nm", 1, 1_000_000_000),
    unit("in", 254, 10_000),
    unit("ft", 3048, 10_000),
    unit("mil", 254, 10_000_000),
];

/// Digits and decimal exponent of a literal that are still read: far beyond every f64, so that no literal can take memory.
const MAX_DIGITS: usize = 800;

impl Unit {
    /// The unit of this name.
    pub fn named(name: &str) -> Option<Unit> {
        UNITS.into_iter().find(|u| u.name == name)
    }

    /// The f64 nearest to the decimal `literal` of (this unit)^power, in (unit `target`)^power. `None` if it is no decimal
    /// number of at most 800 digits.
    pub fn convert(self, literal: &str, power: u32, target: Unit) -> Option<f64> {
        let up = UBig::from(self.numerator) * UBig::from(target.denominator);
        let down = UBig::from(self.denominator) * UBig::from(target.numerator);
        let (digits, exponent) = decimal(literal)?;
        let ten = |e: i32| UBig::from(10u8).pow(e.max(0) as usize);
        let power = power as usize;
        Some(nearest(digits * up.pow(power) * ten(exponent), down.pow(power) * ten(-exponent)))
    }
}

/// A decimal literal as an integer and an exponent of ten.
fn decimal(literal: &str) -> Option<(UBig, i32)> {
    let (mantissa, exponent) = literal.split_once(['e', 'E']).unwrap_or((literal, "0"));
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let digits = format!("{whole}{fraction}");
    let exponent = exponent.parse::<i32>().ok()?.checked_sub(i32::try_from(fraction.len()).ok()?)?;
    if digits.is_empty() || digits.len() > MAX_DIGITS || exponent.unsigned_abs() as usize > MAX_DIGITS {
        return None;
    }
    Some((UBig::from_str_radix(&digits, 10).ok()?, exponent))
}

/// The f64 nearest to a quotient, ties to even.
fn nearest(mut numerator: UBig, mut denominator: UBig) -> f64 {
    if numerator == UBig::ZERO {
        return 0.0;
    }
    // Scaled to a quotient of 66 or 67 bits, whose last one also says whether anything is left: rounding it to 53 bits is
    // rounding the quotient.
    let shift = 66 + denominator.bit_len() as i64 - numerator.bit_len() as i64;
    if shift > 0 {
        numerator <<= shift as usize;
    } else {
        denominator <<= (-shift) as usize;
    }
    let quotient = &numerator / &denominator;
    let is_inexact = &quotient * &denominator != numerator;
    let bits = u128::try_from(quotient).unwrap_or(0) | u128::from(is_inexact);
    libm::ldexp(bits as f64, -(shift as i32))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn convert(literal: &str, from: &str, power: u32, to: &str) -> f64 {
        Unit::named(from).unwrap().convert(literal, power, Unit::named(to).unwrap()).unwrap()
    }

    #[test]
    fn literals_are_rounded_once() {
        for (literal, from, to, expected) in [
            ("0.1", "in", "mm", 2.54),
            ("0.8", "mm", "m", 0.0008),
            ("0.3", "mm", "um", 300.0),
            ("0.9", "mm", "m", 0.0009),
            ("123.456", "m", "mm", 123456.0),
            ("7", "um", "mm", 0.007),
            ("3", "mil", "in", 0.003),
            ("25.4", "mm", "in", 1.0),
            ("1e-3", "m", "mm", 1.0),
            ("12.7e1", "mm", "in", 5.0),
            ("0", "km", "nm", 0.0),
        ] {
            assert_eq!(convert(literal, from, 1, to), expected, "{literal} {from} in {to}");
        }
        // In binary arithmetic 0.9 * 0.001 is not 0.0009, and 1/3 ft has no decimal in inches but is 4.
        assert_ne!(0.9 * 0.001, 0.0009);
        assert_eq!(convert("1", "mm", 1, "in"), 10.0 / 254.0);
    }

    #[test]
    fn powers_and_refusals() {
        assert_eq!(convert("5", "mm", 3, "cm"), 0.005);
        assert_eq!(convert("2", "cm", 2, "mm"), 200.0);
        let mm = Unit::named("mm").unwrap();
        for bad in ["", ".", "1e999999999", "1e", "--1", "1.2.3", "x"] {
            assert_eq!(mm.convert(bad, 1, mm), None, "{bad}");
        }
    }
}
