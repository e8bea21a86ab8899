//! Times of the steps from a volume to its isosurface, as JSON in milliseconds, and what came out:
//! `isosurfaces FILE.raw ISOVALUE RUNS`. The file's name ends in its size and type; of the models of
//! the thesis, `esfera:256` and the like stand for files.

#![expect(clippy::unwrap_used, clippy::print_stdout, reason = "an example")]

use std::{env, path::Path, time::Instant};

use zeroset::{
    expr::{self, Expr},
    hrb::{HrbOctree, Tolerance},
    math::Aabb,
    mesh::{Border, extract},
    progress::Unwatched,
    volume::{Quantize, RawFormat, Samples, Volume},
};

fn main() {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let [file, isovalue, runs] = arguments.as_slice() else { panic!("FILE ISOVALUE RUNS") };
    let (isovalue, runs): (f64, usize) = (isovalue.parse().unwrap(), runs.parse().unwrap());
    let volume = volume(file);
    let mut times: Vec<[f64; 3]> = Vec::new();
    let (mut vertices, mut triangles, mut crc) = (0, 0, 0_u64);
    for _ in 0..runs {
        let start = Instant::now();
        let (octree, grid, built) = {
            let Samples::U8(samples) = &volume.samples else { panic!("bytes") };
            let octree = HrbOctree::build(samples, volume.size, Tolerance::default());
            let built = start.elapsed();
            let grid = octree.grid(isovalue, Border::Open);
            (octree, grid, built)
        };
        let gridded = start.elapsed();
        let extraction = extract(&grid, |c| c.point().map(|x| x as f32));
        let extracted = start.elapsed();
        (vertices, triangles) = (extraction.vertices.len(), extraction.triangles.len());
        crc = extraction.triangles.as_flattened().iter().fold(0, |h, &v| {
            (h ^ u64::from(v)).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(17)
        });
        drop(octree);
        times.push([built, gridded - built, extracted - gridded].map(|t| 1e3 * t.as_secs_f64()));
    }
    let median = |step: usize| {
        let mut of_step: Vec<f64> = times.iter().map(|t| t[step]).collect();
        of_step.sort_by(f64::total_cmp);
        of_step[of_step.len() / 2]
    };
    println!(
        "{file}: build {:.1} bricks {:.1} extract {:.1}; {vertices} vertices {triangles} triangles {crc:x}",
        median(0),
        median(1),
        median(2)
    );
}

fn volume(file: &str) -> Volume {
    let Some((model, size)) = file.split_once(':') else {
        let format = RawFormat::from_name(file).unwrap();
        return Volume::read(Path::new(file), Some(&format)).unwrap();
    };
    let radius = match model {
        "esfera" => "sqrt(x^2 + y^2 + z^2)",
        "tronco" => "sqrt(x^2 + 2*y*z)",
        "silla" => "sin(x*z) + y + cos(x*z)",
        _ => "x*sin(x) + y*cos(y) + z*sin(z)",
    };
    let formula =
        Expr::resolve(&expr::parse(&format!("255*(1 - ({radius}))")).unwrap(), &[]).unwrap().expr;
    let bounds = Aabb { min: [-1.0; 3].into(), max: [1.0; 3].into() };
    Volume::sampled(&formula, bounds, [size.parse().unwrap(); 3], Quantize::Floor, &Unwatched)
        .unwrap()
}
