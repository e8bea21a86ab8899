//! What a stroke costs: a ball of 8 samples' radius set down on the surface of a sphere, beside building
//! everything anew. Prints a Markdown table; times in milliseconds, medians, one thread with
//! `RAYON_NUM_THREADS=1`.

#![expect(clippy::print_stdout, reason = "an example")]

use std::{hint::black_box, time::Instant};

use glam::DVec3;
use zeroset::{
    hrb::{HrbOctree, Samples, Tolerance},
    mesh::Border,
    sculpt::{DEPTH, Deed, Falloff, Piece, Sculpture, Shape, Tool},
};

const STROKES: usize = 60;
const REBUILDS: usize = 3;

fn main() -> Result<(), rayon::ThreadPoolBuildError> {
    // In the pool, as programs are: nothing is handed from thread to thread.
    rayon::ThreadPoolBuilder::new().build()?.install(measure);
    Ok(())
}

fn measure() {
    println!("| samples | stroke | all anew | ratio |");
    println!("|---|---|---|---|");
    for n in [128_u32, 256, 512] {
        let middle = DVec3::splat(f64::from(n) / 2.0);
        let radius = 0.35 * f64::from(n);
        let all = Samples { first: [0; 3], end: [n; 3] };
        let depth = |p: [u32; 3]| {
            let r = (DVec3::from_array(p.map(f64::from)) + 0.5 - middle).length();
            (radius - r).clamp(-DEPTH, DEPTH) as f32
        };
        let samples: Vec<f32> = all.iter().map(depth).collect();
        let build = || HrbOctree::build(&samples, [n; 3], Tolerance::default());
        let anew = median(REBUILDS, |_| {
            black_box(Sculpture::new(build(), 0.0, Border::Capped).extraction());
        });
        let mut sculpture = Sculpture::new(build(), 0.0, Border::Capped);
        let stroke = median(STROKES, |i| {
            // Evenly around the sphere.
            let z = 1.0 - (2 * i + 1) as f64 / STROKES as f64;
            let turn = 2.399_963 * i as f64;
            let flat = (1.0 - z * z).sqrt();
            let way = DVec3::new(flat * libm::cos(turn), flat * libm::sin(turn), z);
            let at = middle + radius * way;
            let deed = [Deed::Fill, Deed::Cut, Deed::Smooth][i % 3];
            let tool = Tool {
                shape: Shape::Ball,
                deed,
                radius: 8.0,
                strength: 0.5,
                falloff: Falloff::Smooth,
                range: [-DEPTH, DEPTH],
            };
            sculpture.apply(&tool, &Piece { from: at, to: at });
        });
        println!("| {n}³ | {stroke:.2} | {anew:.1} | {:.0} |", anew / stroke);
    }
}

fn median(n: usize, mut work: impl FnMut(usize)) -> f64 {
    let mut times: Vec<f64> = (0..n)
        .map(|i| {
            let start = Instant::now();
            work(i);
            1e3 * start.elapsed().as_secs_f64()
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times[n / 2]
}
