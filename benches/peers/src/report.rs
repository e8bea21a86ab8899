//! The tables, in Markdown.

use crate::{
    agreement::{Kept, Likeness},
    meshes::{Meshed, Quality},
    pictures,
    throughput::Throughput,
    timing::median,
    tuning::Setting,
};

/// What was measured on one surface.
pub struct Outcome {
    pub name: &'static str,
    pub setting: Setting,
    /// Seconds of Zeroset with certificates, of Zeroset by values alone, which is Fidget's method,
    /// and of Fidget, round by round, for each number of threads.
    pub times: [[Vec<f64>; 3]; 2],
    /// Boxes tested by Zeroset by values alone, and by Fidget.
    pub n_boxes: [u64; 2],
    /// Voxels that Zeroset keeps with certificates, and those that it certifies.
    pub n_voxels: [u32; 2],
    pub kept: Kept,
    pub throughput: Throughput,
}

/// What was measured of one surface's picture.
pub struct Pictured {
    pub name: &'static str,
    /// Fidget's, with the tiles that it recommends and with the best ones, for each number of
    /// threads.
    pub settings: [[pictures::Setting; 2]; 2],
    /// Seconds of Zeroset, and of Fidget with both, round by round, for each number of threads.
    pub times: [[Vec<f64>; 3]; 2],
    pub likeness: Likeness,
}

/// Prints the tables of pictures.
pub fn print_pictures(pictures: &[Pictured]) {
    println!(
        "| scene | Fidget, one thread, ms | Zeroset, ms | ratio | Fidget, two threads, ms | \
         Zeroset, ms | ratio | Fidget's settings | ratios with the tiles that it recommends |\n\
         |---|---|---|---|---|---|---|---|---|"
    );
    for Pictured { name, settings, times, .. } in pictures {
        let cells = times.each_ref().map(|[zeroset, _, fidget]| {
            let [z, f] = [zeroset, fidget].map(|times| short(median(times) * 1e3));
            format!("{f} | {z} | {}", ratio(fidget, zeroset))
        });
        let recommended = [0, 1].map(|i| {
            let [zeroset, fidget, _] = &times[i];
            format!("{}: {}", settings[i][0], short(median(fidget) / median(zeroset)))
        });
        let mut best = settings.map(|[_, best]| best.to_string()).to_vec();
        best.dedup();
        let cells = [&cells[..], &[best.join("; "), recommended.join("; ")]].concat();
        println!("| {name} | {} |", cells.join(" | "));
    }
    println!(
        "\n| scene | pixels covered by both | by Zeroset only | by Fidget only | \
         mean difference of depths, voxels | within a voxel | mean angle between normals |\n\
         |---|---|---|---|---|---|---|"
    );
    for Pictured { name, likeness, .. } in pictures {
        let Likeness { covered, depth, within_voxel, degrees } = likeness;
        println!(
            "| {name} | {} | {} | {} | {} | {:.2} % | {}° |",
            grouped(covered.by_both),
            grouped(covered.by_zeroset),
            grouped(covered.by_fidget),
            short(*depth),
            100.0 * within_voxel,
            short(*degrees),
        );
    }
}

/// The ratios of a picture, for the impatient.
pub fn picture_summary(Pictured { name, times, .. }: &Pictured) -> String {
    let [one, two] = times.each_ref().map(|[zeroset, _, fidget]| ratio(fidget, zeroset));
    format!("{name}: Fidget takes {one} times Zeroset's time with one thread; with two {two}")
}

/// Prints the tables of meshes.
pub fn print_meshes(meshes: &[Meshed], threads: [usize; 2]) {
    println!(
        "| surface | threads | Zeroset, ms | from certified voxels, ms | Fidget, ms | \
         Fidget / Zeroset | Fidget / from certified | Fidget's setting |\n\
         |---|---|---|---|---|---|---|---|"
    );
    for Meshed { name, engines, times, .. } in meshes {
        for ((times, engine), n_threads) in times.iter().zip(engines).zip(threads) {
            let [zeroset, certified, fidget] = times;
            let [a, b, c] = [zeroset, certified, fidget].map(|t| short(median(t) * 1e3));
            let ratios = [ratio(fidget, zeroset), ratio(fidget, certified)].join(" | ");
            println!("| {name} | {n_threads} | {a} | {b} | {c} | {ratios} | {engine} |");
        }
    }
    println!(
        "\n| surface | mesh of | triangles | flipped | open edges | faults | crossing pairs | \
         mean distance of middles, cells |\n|---|---|---|---|---|---|---|---|"
    );
    for Meshed { name, quality, .. } in meshes {
        for (quality, program) in quality.iter().zip(["Zeroset", "Fidget"]) {
            let Quality { n_triangles, n_flipped, n_open, n_faults, n_crossings, distance } =
                *quality;
            let counts = [n_triangles, n_flipped, n_open, n_faults, n_crossings].map(grouped);
            println!("| {name} | {program} | {} | {distance:.4} |", counts.join(" | "));
        }
    }
}

/// The ratios of a mesh, for the impatient.
pub fn mesh_summary(Meshed { name, times, .. }: &Meshed) -> String {
    let [one, two] = times.each_ref().map(|[zeroset, _, fidget]| ratio(fidget, zeroset));
    format!("{name}: Fidget takes {one} times Zeroset's time with one thread; with two {two}")
}

/// Prints the tables of enumerations.
pub fn print(outcomes: &[Outcome], threads: [usize; 2]) {
    println!(
        "| surface | threads | Zeroset, certified, ms | by values, ms | Fidget, ms | \
         Fidget / certified | Fidget / by values | Fidget's setting |\n\
         |---|---|---|---|---|---|---|---|"
    );
    for outcome in outcomes {
        for (times, n_threads) in outcome.times.iter().zip(threads) {
            let [certified, by_values, fidget] = times;
            println!(
                "| {} | {n_threads} | {} | {} | {} | {} | {} | {} |",
                outcome.name,
                short(median(certified) * 1e3),
                short(median(by_values) * 1e3),
                short(median(fidget) * 1e3),
                ratio(fidget, certified),
                ratio(fidget, by_values),
                outcome.setting
            );
        }
    }
    println!(
        "\n| surface | voxels, Zeroset, certified | of them proven | voxels by values, kept by both | \
         by Zeroset only | by Fidget only | boxes, Zeroset | boxes, Fidget | ns a box, Zeroset | \
         ns a box, Fidget |\n|---|---|---|---|---|---|---|---|---|---|"
    );
    for Outcome { name, times, n_boxes, n_voxels, kept, .. } in outcomes {
        let ns = |program: usize| median(&times[0][program + 1]) * 1e9 / n_boxes[program] as f64;
        println!(
            "| {name} | {} | {} | {} | {} | {} | {} | {} | {} | {} |",
            grouped(n_voxels[0].into()),
            grouped(n_voxels[1].into()),
            grouped(kept.by_both),
            grouped(kept.by_zeroset),
            grouped(kept.by_fidget),
            grouped(n_boxes[0]),
            grouped(n_boxes[1]),
            short(ns(0)),
            short(ns(1)),
        );
    }
    println!(
        "\n| surface | operations | ns a box, Zeroset | JIT | VM | ns a box and operation, Zeroset | \
         JIT | ns a gradient, Zeroset | JIT | VM |\n|---|---|---|---|---|---|---|---|---|---|"
    );
    for Outcome { name, throughput, .. } in outcomes {
        let Throughput { n_operations, zeroset, jit, vm } = throughput;
        println!(
            "| {name} | {n_operations} | {} | {} | {} | {} | {} | {} | {} | {} |",
            short(zeroset.box_ns),
            short(jit.box_ns),
            short(vm.box_ns),
            short(zeroset.box_ns / *n_operations as f64),
            short(jit.box_ns / *n_operations as f64),
            short(zeroset.gradient_ns),
            short(jit.gradient_ns),
            short(vm.gradient_ns),
        );
    }
}

/// The ratios, for the impatient.
pub fn summary(times: &[[Vec<f64>; 3]; 2]) -> String {
    let [one, two] = times.each_ref().map(|[certified, by_values, fidget]| {
        format!("{}, by values {}", ratio(fidget, certified), ratio(fidget, by_values))
    });
    format!("Fidget takes {one} times Zeroset's time with one thread; with two {two}")
}

/// The ratio of the medians, with the least and the largest ratio of a round.
fn ratio(a: &[f64], b: &[f64]) -> String {
    let rounds = || a.iter().zip(b).map(|(a, b)| a / b);
    let (least, most) = (rounds().fold(f64::MAX, f64::min), rounds().fold(0.0, f64::max));
    format!("{} ({} to {})", short(median(a) / median(b)), short(least), short(most))
}

/// Three digits, but no fewer than before the point.
fn short(v: f64) -> String {
    let digits = if v >= 100.0 {
        0
    } else if v >= 10.0 {
        1
    } else {
        2
    };
    format!("{v:.digits$}")
}

/// Such as 1,570,112.
fn grouped(n: u64) -> String {
    let digits = n.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}
