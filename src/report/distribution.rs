//! A quality measure over all elements: extremes, mean, and counts by range, as thesis 2.4 and 5 show them.

use serde::Serialize;
use std::fmt;

/// How one measure is distributed.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct Distribution {
    /// What is measured.
    pub measure: &'static str,
    /// Smallest value; 0 without elements, as are the others.
    pub min: f64,
    /// Largest value.
    pub max: f64,
    /// Mean of the finite values.
    pub mean: f64,
    /// Lower bounds of the ranges, ascending; the last range is open.
    pub bounds: &'static [f64],
    /// Elements per range; what lies below the first bound counts in the first range.
    pub counts: Vec<u64>,
}

impl Distribution {
    /// Sorts values into ranges.
    pub fn new(measure: &'static str, bounds: &'static [f64], values: impl IntoIterator<Item = f64>) -> Self {
        let mut d =
            Self { measure, min: f64::INFINITY, max: f64::NEG_INFINITY, mean: 0.0, bounds, counts: vec![0; bounds.len()] };
        let (mut sum, mut finite, mut count) = (0.0, 0u64, 0u64);
        for x in values {
            (d.min, d.max) = (d.min.min(x), d.max.max(x));
            count += 1;
            if x.is_finite() {
                sum += x;
                finite += 1;
            }
            let range = bounds.partition_point(|b| *b <= x).max(1) - 1;
            if let Some(c) = d.counts.get_mut(range) {
                *c += 1;
            }
        }
        if count == 0 {
            (d.min, d.max) = (0.0, 0.0);
        }
        d.mean = if finite == 0 { 0.0 } else { sum / finite as f64 };
        d
    }
}

/// A table with bars; the longest bar stands for the fullest range.
impl fmt::Display for Distribution {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        const BAR: usize = 40;
        let total = self.counts.iter().sum::<u64>().max(1) as f64;
        let most = self.counts.iter().copied().max().unwrap_or(0).max(1);
        writeln!(f, "{}: {:.4} to {:.4}, mean {:.4}", self.measure, self.min, self.max, self.mean)?;
        for (k, count) in self.counts.iter().enumerate().filter(|(_, c)| **c > 0) {
            let range = match self.bounds.get(k + 1) {
                Some(end) => format!("{} - {end}", self.bounds[k]),
                None => format!("{} -", self.bounds[k]),
            };
            let bar = "#".repeat((*count as usize * BAR).div_ceil(most as usize));
            writeln!(f, "  {range:>14} {count:>9} {:>5.1} % {bar}", 100.0 * *count as f64 / total)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_half_open_and_the_last_one_is_not_bounded() {
        let d = Distribution::new("angle", &[0.0, 10.0, 20.0], [5.0, 10.0, 19.0, 20.0, 300.0]);
        assert_eq!(d.counts, [1, 2, 2]);
        assert_eq!((d.min, d.max, d.mean), (5.0, 300.0, 70.8));
        let text = d.to_string();
        assert!(text.contains("10 - 20         2  40.0 %"), "{text}");
        assert_eq!(Distribution::new("angle", &[0.0], []).max, 0.0);
    }
}
