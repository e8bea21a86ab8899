//! Times of the steps from a volume to its isosurface, for `benches/volumes.py`, which asks for round
//! after round: `isosurfaces FILE.raw ISOVALUE`. The file's name ends in its size and type. For each line
//! that comes in, one goes out, in JSON: milliseconds, and how many triangles there are. One thread.

#![expect(clippy::unwrap_used, reason = "an example that cannot run has failed")]
#![expect(clippy::print_stdout, reason = "the answers")]

use std::{
    env,
    io::{self, BufRead as _},
    path::Path,
    time::Instant,
};

use serde_json::json;
use zeroset::{
    hrb::{HrbOctree, Tolerance},
    mesh::{Border, extract},
    volume::{RawFormat, Samples, Volume},
};

fn main() {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let [file, isovalue] = arguments.as_slice() else { panic!("isosurfaces FILE.raw ISOVALUE") };
    let format = RawFormat::from_name(file).unwrap();
    let volume = Volume::read(Path::new(file), Some(&format)).unwrap();
    let isovalue: f64 = isovalue.parse().unwrap();
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global().unwrap();
    let Samples::U8(samples) = &volume.samples else { panic!("samples of one byte") };
    for _ in io::stdin().lock().lines() {
        let start = Instant::now();
        let octree = HrbOctree::build(samples, volume.size, Tolerance::default());
        let built = start.elapsed();
        let grid = octree.grid(isovalue, Border::Open);
        let gridded = start.elapsed();
        let extraction = extract(&grid, |crossing| crossing.point().map(|x| x as f32));
        let extracted = start.elapsed();
        let [build, bricks, extraction_ms] =
            [built, gridded - built, extracted - gridded].map(|time| 1e3 * time.as_secs_f64());
        println!(
            "{}",
            json!({
                "build": build,
                "bricks": bricks,
                "extraction": extraction_ms,
                "triangles": extraction.triangles.len(),
            })
        );
    }
}
