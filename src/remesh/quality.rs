//! Shape of triangles.

use crate::geom::Vec3;

/// Cosine of the smallest angle of a triangle: smaller is better, 0.5 is equilateral, 1 is degenerate.
///
/// Angles are compared by their cosines, so that no comparison needs trigonometry.
pub fn sharpest_cosine([a, b, c]: [&Vec3; 3]) -> f64 {
    let (u, v, w) = (b - a, c - b, a - c);
    let (uu, vv, ww) = (u.norm_squared(), v.norm_squared(), w.norm_squared());
    // The smallest angle is opposite to the shortest edge.
    let (short, x, y) = if uu <= vv && uu <= ww {
        (uu, vv, ww)
    } else if vv <= ww {
        (vv, uu, ww)
    } else {
        (ww, uu, vv)
    };
    if short == 0.0 {
        return 1.0;
    }
    let least = (x + y - short) * 0.5 / (x * y).sqrt();
    let obt = tune_obt();
    if obt > 0.0 {
        let long = x.max(y);
        let other = x.min(y);
        let greatest = (short + other - long) * 0.5 / (short * other).sqrt();
        return least.max(0.766 - obt * greatest);
    }
    least
}

/// Cosine of an angle given in degrees.
pub fn cosine_of_degrees(degrees: f64) -> f64 {
    libm::cos(degrees.to_radians())
}

fn tune_obt() -> f64 {
    static OBT: std::sync::OnceLock<f64> = std::sync::OnceLock::new();
    *OBT.get_or_init(|| tune("OBT", 0.0))
}
pub fn tune(name: &str, default: f64) -> f64 {
    std::env::var(name).ok().and_then(|v| v.parse().ok()).unwrap_or(default)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_triangles() {
        let (o, x, y) = (Vec3::zeros(), Vec3::x(), Vec3::y());
        assert!((sharpest_cosine([&o, &x, &y]) - 0.5f64.sqrt()).abs() < 1e-15);
        let top = Vec3::new(0.5, 0.75f64.sqrt(), 0.0);
        assert!((sharpest_cosine([&o, &x, &top]) - 0.5).abs() < 1e-15);
        assert_eq!(sharpest_cosine([&o, &o, &x]), 1.0);
        assert!((cosine_of_degrees(60.0) - 0.5).abs() < 1e-15);
    }
}
