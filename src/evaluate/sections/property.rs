//! Voxels, cells and HRB: what aggregation saves, and the property between samples.

use std::fmt::Write as _;

use crate::{
    Error, Result,
    evaluate::{
        CellOctree, Properties, Settings, Subject,
        report::{Report, side_by_side},
        surface::octree,
        table::{Cell, Table},
    },
    hrb::{Criterion, Tolerance},
    output::plot::{Marks, Plot, XAxis},
    progress::Progress,
    volume::with_samples,
};

/// Tolerances of the tables.
const EPSILONS: [f64; 3] = [0.0, 2.0, 8.0];
/// The tolerance of slices is this part of the range of samples, so that regions show.
const SLICE_PART: f64 = 1.0 / 4.0;
/// Width of a slice in pixels.
const SLICE_PX: u32 = 380;

pub(in crate::evaluate) fn write(
    report: &mut Report,
    subjects: &[Subject],
    settings: &Settings,
    progress: &dyn Progress,
) -> Result<String> {
    let mut aggregation = Table::new(&[
        "subject",
        "grid",
        "ε",
        "samples",
        "regions",
        "saved by voxels",
        "cells",
        "corners kept",
        "saved by cells",
    ]);
    let mut differences = Table::new(&[
        "subject",
        "grid",
        "ε",
        "property",
        "largest difference",
        "root mean square",
        "largest jump",
    ]);
    let mut slices = String::new();
    for subject in subjects {
        if progress.is_cancelled() {
            return Err(Error::Interrupted);
        }
        let grid = subject.test_grid(&settings.sizes);
        let volume = subject.volume(grid)?;
        let n_samples = volume.samples.len() as u64;
        for epsilon in EPSILONS.into_iter().filter(|&e| e == 0.0 || !subject.is_binary) {
            let tolerance = Tolerance { epsilon, criterion: Criterion::Range };
            let regions = with_samples!(&volume.samples, |samples| {
                octree(samples, volume.size, tolerance).storage().regions
            });
            let counts = CellOctree::build(&volume, epsilon).counts();
            aggregation.rows.push(vec![
                Cell::text(&subject.name),
                Cell::text(grid.to_string()),
                Cell::Number(epsilon, 0),
                Cell::Count(n_samples),
                Cell::Count(regions),
                Cell::Number(100.0 * (1.0 - regions as f64 / n_samples as f64), 2),
                Cell::Count(counts.cells),
                Cell::Count(counts.corners),
                Cell::Number(100.0 * (1.0 - counts.corners as f64 / n_samples as f64), 2),
            ]);
            if epsilon == 0.0 {
                continue;
            }
            for difference in Properties::new(&volume, epsilon).differences() {
                differences.rows.push(vec![
                    Cell::text(&subject.name),
                    Cell::text(grid.to_string()),
                    Cell::Number(epsilon, 0),
                    Cell::text(difference.name),
                    Cell::Number(difference.largest, 3),
                    Cell::Number(difference.rms, 4),
                    Cell::Number(difference.jump, 3),
                ]);
            }
        }
        if !subject.is_binary {
            slices += &slices_of(report, subject)?;
        }
        progress.advance(1);
    }
    report.csv("aggregation", &aggregation)?;
    let mut text = format!(
        "## Voxels, cells and HRB\n\n\
         ### What aggregation saves\n\n\
         Joining n³ voxels saves n³ − 1 samples. Joining n³ cells between samples saves (n + 1)³ − 2³ \
         at best, which is more, but only where no cell around needs a corner: {}\n\n\
         Regions and cells with samples that differ by ε at most, and what is saved in percent of all \
         samples:\n\n{}\n",
        best(),
        aggregation.markdown()
    );
    if !differences.rows.is_empty() {
        report.csv("property", &differences)?;
        let _ = write!(
            text,
            "### The property between samples\n\n\
             How far three ways to interpolate what is left are from the trilinear interpolation of \
             all samples, in units of these. The HRB error is bounded by ε (1 − 1/n) for regions of n \
             samples and the rounding of what a region keeps, and there is no jump; cells interpolate \
             between corners and jump where sizes change.\n\n{}\n{slices}",
            differences.markdown()
        );
    }
    Ok(text)
}

/// What can be saved, for a few sizes.
fn best() -> String {
    let of_size = |n: u64| {
        let (voxels, cells) = (n.pow(3) - 1, (n + 1).pow(3) - 8);
        format!("{cells} against {voxels} for n = {n}")
    };
    format!("{}.", [2, 4, 8].map(of_size).join(", "))
}

/// Slices and a profile through a coarse grid.
fn slices_of(report: &mut Report, subject: &Subject) -> Result<String> {
    let grid = subject.coarse_grid();
    let volume = subject.volume(grid)?;
    let [low, high] = volume.range();
    let epsilon = ((high - low) * SLICE_PART).floor();
    let properties = Properties::new(&volume, epsilon);
    let (name, slug) = (&subject.name, &subject.slug);
    let mut names = vec!["all samples, trilinear".to_owned()];
    let mut shown = vec![report.picture(
        &format!("{slug}-slice-samples"),
        &format!("{name}: all samples"),
        &properties.slice(&properties.exact, SLICE_PX),
    )?];
    let mut lines =
        vec![("all samples, trilinear".to_owned(), properties.profile(&properties.exact))];
    for (kind, (title, property)) in ["regions", "cells", "hrb"].into_iter().zip(&properties.all) {
        let frame = properties.slice(property, SLICE_PX);
        let title = (*title).to_owned();
        let file = format!("{slug}-slice-{kind}");
        shown.push(report.picture(&file, &format!("{name}: {title}"), &frame)?);
        lines.push((title.clone(), properties.profile(property)));
        names.push(title);
    }
    let most = lines.iter().flat_map(|(_, points)| points).map(|point| point.1).fold(1.0, f64::max);
    let plot = Plot {
        title: format!("{name}: the property along a line through the slice"),
        x_label: "samples".to_owned(),
        y_label: "value".to_owned(),
        x_axis: XAxis::Linear,
        y_max: 1.1 * most,
        marks: Marks::Lines,
        lines,
    };
    let plot = report.plot(&format!("{slug}-profile"), &plot)?;
    Ok(format!(
        "**{name}**, a slice across z of {grid} samples with ε = {epsilon}:\n\n{}\n{plot}\n\n",
        side_by_side(&names, &shown)
    ))
}
