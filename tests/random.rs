//! Random scenes: boxes on a grid against counted voxels, trees of all primitives against set identities, assemblies against
//! the box that encloses them, nests of shells against the cubes of their sizes. GSM_RANDOM is the number of each kind,
//! GSM_RANDOM_SEED the first; a failure prints its scene.

mod evaluated;
#[path = "random/generator.rs"]
mod generator;
#[path = "random/rich.rs"]
mod rich;

use evaluated::{build, build_in};
use generator::{Generator, Voxels};
use rayon::prelude::*;

/// Scenes of each kind unless GSM_RANDOM says otherwise.
const COUNT: u64 = 60;
/// Seeds of scenes that rounding once broke, run always: a vertex on or through an edge of its own facet (5122, 5503), a facet
/// rounded to a line (6276), facets that cross (49, 235, 547), an edge of a facet through a vertex of it (7043), a
/// triangle of two facets (30601), a region whose neck closes (31194, 100640), an edge of another facet in a facet (101146,
/// 40460), a region that is rounded to nothing (101731), a chord through one point and past another (120415), an edge past a
/// vertex in some facets and through it in the others, by turns (7001366).
const ONCE_BROKEN: [u64; 15] =
    [49, 235, 547, 5122, 5503, 6276, 7043, 30601, 31194, 40460, 100_640, 101_146, 101_731, 120_415, 7_001_366];
/// One seed in so many makes a pile, which takes as much time.
const PILES: u64 = 8;
/// One seed in so many makes scenes of all that the language has, for the same reason.
const RICH: u64 = 3;
/// What welding may change a volume by, relative to the volumes at hand: area times tolerance, with room for flat solids.
const VOLUME_ERROR: f64 = 1e-7;

fn volume(solid: &str) -> Result<f64, String> {
    Ok(build(&[("it", solid)])?.volumes[0])
}

/// The volumes of two piles. Spheres about one centre are divided alike, however each is turned: where both have such, each is
/// measured in company of the other.
fn volumes(a: &str, b: &str) -> Result<[f64; 2], String> {
    let centres = sphere_centres(b);
    if sphere_centres(a).iter().any(|c| centres.contains(c)) {
        // The first of them tells how.
        let both = format!("Intersection([{a}, {b}])");
        return Ok([volume(&format!("Union([{a}, {both}])"))?, volume(&format!("Union([{both}, {b}])"))?]);
    }
    Ok([volume(a)?, volume(b)?])
}

/// Where the spheres in a solid stand, unless they are turned about another place.
fn sphere_centres(solid: &str) -> Vec<&str> {
    let before = |(at, _)| solid[..at].rsplit("Translate(by: (").next()?.split(')').next();
    solid.match_indices("Sphere(").filter_map(before).collect()
}

/// Runs one kind of scene for all seeds.
fn run(what: &str, one: impl Fn(&mut Generator) -> Result<u32, String> + Sync) {
    let number = |name: &str, default| std::env::var(name).ok().and_then(|n| n.parse().ok()).unwrap_or(default);
    let (first, count) = (number("GSM_RANDOM_SEED", 0), number("GSM_RANDOM", COUNT));
    let mut seeds: Vec<u64> = (first..first + count).collect();
    seeds.extend(ONCE_BROKEN.iter().filter(|seed| !(first..first + count).contains(seed)));
    let count = seeds.len();
    let results: Vec<(u64, Result<u32, String>)> =
        seeds.into_par_iter().map(|seed| (seed, one(&mut Generator::new(seed)))).collect();
    let repairs = results.iter().filter(|r| matches!(r.1, Ok(n) if n > 0)).count();
    eprintln!("{what}: {count} scenes, rounding repaired in {repairs}");
    let failures: Vec<String> =
        results.into_iter().filter_map(|(seed, r)| r.err().map(|e| format!("{what}, seed {seed}: {e}"))).collect();
    assert!(failures.is_empty(), "{} of {count} failed\n{}", failures.len(), failures.join("\n"));
}

fn expect(what: &str, left: f64, right: f64, scale: f64) -> Result<(), String> {
    if (left - right).abs() <= VOLUME_ERROR * scale { Ok(()) } else { Err(format!("{what}: {left:?} is not {right:?}")) }
}

#[test]
fn boxes_on_a_grid_have_the_volume_of_their_voxels() {
    run("grid", |random| {
        let (solid, voxels): (String, Voxels) = random.grid_tree(3);
        let count = f64::from(voxels.count());
        expect(&solid, volume(&solid)?, count, count)?;
        let turned = random.turned(&solid);
        expect(&turned, volume(&turned)?, count, count)?;
        Ok(0)
    });
}

#[test]
fn trees_keep_the_identities_of_sets() {
    run("trees", |random| {
        let (a, b) = (random.tree(2), random.tree(2));
        let together = |operation: &str| {
            let built = build(&[("it", &format!("{operation}([{a}, {b}])")[..])])?;
            Ok::<_, String>((built.volumes[0], built.repairs()))
        };
        let (both, any) = (together("Intersection")?, together("Union")?);
        let (rest, either) = (together("Difference")?, together("Xor")?);
        let [first, second] = [volume(&a)?, volume(&b)?];
        let scale = first + second;
        let told = format!("A: {a}\nB: {b}\n");
        expect(&format!("{told}union and intersection"), any.0 + both.0, scale, scale)?;
        expect(&format!("{told}difference and intersection"), rest.0 + both.0, first, scale)?;
        expect(&format!("{told}symmetric difference"), either.0 + both.0, any.0, scale)?;
        Ok(both.1 + any.1 + rest.1 + either.1)
    });
}

/// Many solids over one place: what lies where the tree is constant is culled.
#[test]
fn piles_keep_the_identities_of_sets() {
    run("piles", |random| {
        if random.below(PILES) != 0 {
            return Ok(0);
        }
        let [a, b] = [0; 2].map(|_| random.pile(18));
        let together = |operation: &str| {
            let built = build(&[("it", &format!("{operation}([{a}, {b}])")[..])])?;
            Ok::<_, String>((built.volumes[0], built.repairs()))
        };
        let (both, any, rest) = (together("Intersection")?, together("Union")?, together("Difference")?);
        let [first, second] = volumes(&a, &b)?;
        let scale = first + second;
        expect(&format!("{a} and {b}: union and intersection"), any.0 + both.0, scale, scale)?;
        expect(&format!("{a} and {b}: difference and intersection"), rest.0 + both.0, first, scale)?;
        Ok(both.1 + any.1 + rest.1)
    });
}

#[test]
fn assemblies_tile_the_box_that_encloses_them() {
    run("assemblies", |random| {
        let side = 2.0 * generator::REACH;
        let room = format!("Block(size: ({side:?}, {side:?}, {side:?}), center: (0, 0, 0))");
        let mut parts = vec![("room".to_string(), room)];
        for k in 0..2 + random.below(4) {
            parts.push((format!("part{k}"), random.tree(1)));
        }
        // A part that a later one swallows is an error, and not what is asked here.
        while parts.len() > 1 {
            match build(&parts) {
                Err(e) if e.contains("empty-part") => drop(parts.remove(1)),
                Err(e) => return Err(e),
                Ok(built) => {
                    let all = side * side * side;
                    expect(&format!("{parts:?}"), built.volumes.iter().sum(), all, all)?;
                    let last = parts.last().map_or(Ok(0.0), |p| volume(&p.1))?;
                    expect(&format!("{parts:?}: the last part"), built.volumes[parts.len() - 1], last, last)?;
                    assert!(built.counts()[2] > parts.len());
                    return Ok(built.repairs());
                }
            }
        }
        Ok(0)
    });
}

/// Imports, sweeps, patterns, scales and mirrors. Each tree is measured in company of the other, since coaxial solids are
/// divided alike.
#[test]
fn all_kinds_of_solids_keep_the_identities_of_sets() {
    run("all kinds", |random| {
        if random.below(RICH) != 0 {
            return Ok(0);
        }
        let (a, b) = (random.rich_tree(1), random.rich_tree(1));
        let mut repairs = 0;
        let mut together = |solid: &str| {
            let built = build_in(rich::folder(), &[("it", solid)])?;
            repairs += built.repairs();
            Ok::<_, String>(built.volumes[0])
        };
        let common = format!("Intersection([{a}, {b}])");
        let (both, any) = (together(&common)?, together(&format!("Union([{a}, {b}])"))?);
        let (rest, either) = (together(&format!("Difference([{a}, {b}])"))?, together(&format!("Xor([{a}, {b}])"))?);
        let first = together(&format!("Union([{a}, {common}])"))?;
        let second = together(&format!("Union([{common}, {b}])"))?;
        let scale = first + second;
        let told = format!("A: {a}\nB: {b}\n");
        expect(&format!("{told}union and intersection"), any + both, scale, scale)?;
        expect(&format!("{told}difference and intersection"), rest + both, first, scale)?;
        expect(&format!("{told}symmetric difference"), either + both, any, scale)?;
        Ok(repairs)
    });
}

#[test]
fn assemblies_of_all_kinds_tile_the_box_that_encloses_them() {
    run("assemblies of all kinds", |random| {
        if random.below(RICH) != 0 {
            return Ok(0);
        }
        let side = 2.0 * generator::REACH;
        let mut parts = vec![("room".to_string(), format!("Block(size: ({side:?}, {side:?}, {side:?}), center: (0, 0, 0))"))];
        for k in 0..2 + random.below(3) {
            parts.push((format!("part{k}"), random.rich_tree(1)));
        }
        while parts.len() > 1 {
            match build_in(rich::folder(), &parts) {
                Err(e) if e.contains("empty-part") => drop(parts.remove(1)),
                Err(e) => return Err(e),
                Ok(built) => {
                    let all = side * side * side;
                    expect(&format!("{parts:?}"), built.volumes.iter().sum(), all, all)?;
                    assert!(built.counts()[2] > parts.len());
                    return Ok(built.repairs());
                }
            }
        }
        Ok(0)
    });
}

#[test]
fn shells_of_a_nest_have_the_volumes_between_their_sizes() {
    run("nests", |random| {
        if random.below(RICH) != 0 {
            return Ok(0);
        }
        let nest = random.nest();
        let parts: Vec<(String, String)> = nest.iter().enumerate().map(|(k, s)| (format!("shell{k}"), s.0.clone())).collect();
        let built = build_in(rich::folder(), &parts)?;
        let (all, whole) = (built.volumes.iter().sum::<f64>(), nest.iter().map(|s| s.1).sum::<f64>());
        for ((_, share), volume) in nest.iter().zip(&built.volumes) {
            expect(&format!("{parts:?}"), *volume, all * share / whole, all)?;
        }
        // The outside is a region too.
        if built.counts()[2] == parts.len() + 1 { Ok(built.repairs()) } else { Err(format!("{:?}: {parts:?}", built.counts())) }
    });
}
