use super::*;
use crate::geom::Affine;
use crate::primitive::place::Place;
use crate::scene::model::Frame;

fn request(start: f64, sweep: f64, segments: u32) -> CircleRequest {
    CircleRequest {
        place: Place::of_axes(&Affine::identity()),
        center: [0.0, 0.0],
        start,
        sweep,
        is_start_chosen: false,
        segments,
        radius: 45.0,
        heights: [0.0, 100.0],
    }
}

fn degrees(circle: &Circle) -> Vec<f64> {
    circle.breakpoints.iter().map(|b| b.degrees).collect()
}

/// Of the model, about.
const SIZE: f64 = 100.0;

#[test]
fn circle_ring_and_partial_sweep_share_breakpoints() {
    let circles = divide(&[request(0., 360., 24), request(0., 360., 36), request(-7., 14., 24)], 1e-9, SIZE);
    assert_eq!(degrees(&circles[0]), degrees(&circles[1]));
    // 14 degrees are 2 chords of 7, the other 346 are 35 chords.
    assert_eq!(degrees(&circles[2]), [353., 0., 7.]);
    assert_eq!(circles[0].breakpoints.len(), 2 + 35);
    let along: Vec<f64> = circles[2].breakpoints.iter().map(|b| b.along).collect();
    assert_eq!(along, [0., 7., 14.]);
    for (k, b) in circles[2].breakpoints.iter().enumerate() {
        let other = circles[0].breakpoints.iter().find(|o| o.degrees == b.degrees).unwrap();
        assert_eq!(circles[0].point(other.degrees, 45.0, 0.0), circles[2].point(b.degrees, 45.0, 0.0), "{k}");
    }
}

#[test]
fn the_reference_machine_has_36_breakpoints() {
    let coils = (0..12).map(|k| request(30. * f64::from(k) - 7., 14., 24));
    let magnets = (0..4).map(|k| request(45. + 90. * f64::from(k) - 30., 60., 24));
    let requests: Vec<_> = coils.chain(magnets).chain([request(0., 360., 24)]).collect();
    assert_eq!(divide(&requests, 1e-9, SIZE)[16].breakpoints.len(), 36);
}

#[test]
fn a_flipped_axis_is_the_same_axis() {
    let mut flipped = request(0., 90., 24);
    let frame = Frame { origin: Vec3::new(0., 0., 100.), x: Vec3::x(), y: -Vec3::y(), z: -Vec3::z() };
    flipped.place = Place::new(&frame, &Affine::identity());
    let circles = divide(&[request(270., 90., 24), flipped], 1e-9, SIZE);
    let mut backwards = degrees(&circles[1]);
    assert_eq!(backwards[0], 0.0);
    backwards.reverse();
    assert_eq!(backwards, degrees(&circles[0]));
    assert_eq!(circles[0].point(300., 45., 100.), circles[1].point(300., 45., 0.));
}

#[test]
fn other_axes_and_unaligned_starts() {
    let mut other = request(10., 33., 24);
    other.center = [1.0, 0.0];
    let circles = divide(&[request(0., 360., 24), other], 1e-9, SIZE);
    assert_eq!(degrees(&circles[0]), (0..24).map(|k| 15. * f64::from(k)).collect::<Vec<_>>());
    assert_eq!(degrees(&circles[1]), [10., 21., 32., 43.]);
}

#[test]
fn arc_of_nearly_a_whole_turn() {
    let circles = divide(&[request(0., 359., 4)], 1e-9, SIZE);
    assert_eq!(circles[0].breakpoints.len(), 5);
    assert_eq!(circles[0].breakpoints[4].along, 359.0);
}

#[test]
fn absurdly_many_sweeps_stay_bounded() {
    let arcs = (0..5000).map(|k| request(0.01 * f64::from(k), 30., 24));
    let requests: Vec<_> = arcs.chain([request(0., 360., 24)]).collect();
    let total: usize = divide(&requests, 1e-9, SIZE).iter().map(|c| c.breakpoints.len()).sum();
    assert_eq!(total, 5000 * 3 + 24);
}
