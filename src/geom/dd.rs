//! Double-double arithmetic: an unevaluated sum of two `f64`, about 104 bits (Dekker 1971, Knuth 1969).
//!
//! Used to place implicit points: their rounded coordinates are then almost always right to the last bit, which makes the
//! floating-point filter of the exact signs succeed almost always.

use std::ops::{Add, Mul, Neg, Sub};

/// `hi + lo` with |lo| at most half a unit in the last place of hi.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dd {
    /// Leading part.
    pub hi: f64,
    /// Remainder.
    pub lo: f64,
}

/// Relative error that bounds any one operation below, with room: 2^-100.
pub const UNIT: f64 = 7.888609052210118e-31;

fn two_sum(a: f64, b: f64) -> Dd {
    let s = a + b;
    let t = s - a;
    Dd { hi: s, lo: (a - (s - t)) + (b - t) }
}

fn fast_two_sum(a: f64, b: f64) -> Dd {
    let s = a + b;
    Dd { hi: s, lo: b - (s - a) }
}

fn halves(a: f64) -> (f64, f64) {
    const SPLIT: f64 = 134_217_729.0; // 2^27 + 1
    let c = SPLIT * a;
    let hi = c - (c - a);
    (hi, a - hi)
}

fn two_product(a: f64, b: f64) -> Dd {
    let p = a * b;
    let ((ah, al), (bh, bl)) = (halves(a), halves(b));
    Dd { hi: p, lo: ((ah * bh - p) + ah * bl + al * bh) + al * bl }
}

impl Dd {
    /// The difference of two doubles, exactly.
    pub fn difference(a: f64, b: f64) -> Self {
        two_sum(a, -b)
    }
    /// Absolute value of the leading part.
    pub fn magnitude(self) -> f64 {
        self.hi.abs()
    }
}

impl From<f64> for Dd {
    fn from(x: f64) -> Self {
        Dd { hi: x, lo: 0.0 }
    }
}

impl Add for Dd {
    type Output = Dd;
    fn add(self, b: Dd) -> Dd {
        let s = two_sum(self.hi, b.hi);
        let t = two_sum(self.lo, b.lo);
        let v = fast_two_sum(s.hi, s.lo + t.hi);
        fast_two_sum(v.hi, t.lo + v.lo)
    }
}

impl Neg for Dd {
    type Output = Dd;
    fn neg(self) -> Dd {
        Dd { hi: -self.hi, lo: -self.lo }
    }
}

impl Sub for Dd {
    type Output = Dd;
    fn sub(self, b: Dd) -> Dd {
        self + (-b)
    }
}

impl Mul for Dd {
    type Output = Dd;
    fn mul(self, b: Dd) -> Dd {
        let p = two_product(self.hi, b.hi);
        fast_two_sum(p.hi, p.lo + (self.hi * b.lo + self.lo * b.hi))
    }
}

impl std::ops::Div for Dd {
    type Output = Dd;
    fn div(self, b: Dd) -> Dd {
        let q1 = self.hi / b.hi;
        let r = self - b * Dd::from(q1);
        let q2 = r.hi / b.hi;
        let r = r - b * Dd::from(q2);
        let q3 = r.hi / b.hi;
        let s = fast_two_sum(q1, q2);
        s + Dd::from(q3)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_third_times_three_is_one_to_a_hundred_bits() {
        let third = Dd::from(1.0) / Dd::from(3.0);
        let one = third * Dd::from(3.0) - Dd::from(1.0);
        assert!(one.magnitude() < UNIT);
        assert!(third.lo != 0.0);
    }

    #[test]
    fn products_and_differences_are_exact() {
        let a = 1.0 + f64::EPSILON;
        let p = Dd::from(a) * Dd::from(a);
        let rest = p - Dd::from(1.0) - Dd::from(2.0 * f64::EPSILON);
        assert_eq!(rest.hi, f64::EPSILON * f64::EPSILON);
        let d = Dd::difference(1e16, 1.0);
        assert_eq!((d.hi, d.lo), (1e16, -1.0));
    }
}
