//! Time: simplification and extraction beside plain Marching Cubes.

use std::fmt::Write as _;

use crate::{
    Result,
    evaluate::{
        Settings, Subject,
        report::Report,
        space,
        table::{Cell, Table},
        time,
    },
    output::plot::{Marks, Plot, XAxis},
    progress::Progress,
};

pub(in crate::evaluate) fn write(
    report: &mut Report,
    subjects: &[Subject],
    settings: &Settings,
    progress: &dyn Progress,
) -> Result<String> {
    let columns = [
        "subject",
        "grid",
        "regions by",
        "leaves per 100 samples",
        "triangles",
        "of plain",
        "simplification",
        "responsibilities",
        "extraction",
        "without index",
    ];
    let mut table = Table::new(&columns);
    let mut points: Vec<(String, Vec<(f64, f64)>)> = Vec::new();
    let (mut n_ahead, mut n_ahead_without, mut n_all) = (0, 0, 0);
    for subject in subjects {
        let mut of_subject = Vec::new();
        for grid in subject.grids(&settings.sizes) {
            let volume = subject.volume(grid)?;
            let tolerances = settings.tolerances();
            // Samples that are all or nothing are joined the same way whatever the tolerance is.
            let tolerances = if subject.is_binary { &tolerances[..1] } else { &tolerances };
            let (isovalue, runs) = (subject.isovalue, settings.runs);
            let found = time::measure(&volume, isovalue, tolerances, runs, progress)?;
            let n_samples = volume.samples.len() as f64;
            for times in &found.times {
                let density = 100.0 * times.n_regions as f64 / n_samples;
                n_all += 1;
                n_ahead += usize::from(times.extract < 1.0);
                n_ahead_without += usize::from(times.extract_all < 1.0);
                of_subject.push((density, times.extract));
                table.rows.push(vec![
                    Cell::text(&subject.name),
                    Cell::text(grid.to_string()),
                    Cell::text(space::name(times.tolerance)),
                    Cell::Number(density, 2),
                    Cell::Count(times.n_triangles),
                    Cell::Number(times.n_triangles as f64 / found.n_triangles as f64, 4),
                    Cell::Number(times.simplify, 2),
                    Cell::Number(times.answer, 2),
                    Cell::Number(times.extract, 2),
                    Cell::Number(times.extract_all, 2),
                ]);
            }
            progress.advance(1);
        }
        points.push((subject.name.clone(), of_subject));
    }
    report.csv("time", &table)?;
    let of_all = || points.iter().flat_map(|(_, points)| points.iter().copied());
    let most = of_all().map(|point| point.1).fold(1.0, f64::max);
    let below = below_which_it_pays(&of_all().collect::<Vec<(f64, f64)>>());
    let plot = Plot {
        title: "Extraction over simplification".to_owned(),
        x_label: "leaves per 100 samples".to_owned(),
        y_label: "times plain Marching Cubes".to_owned(),
        x_axis: XAxis::Linear,
        y_max: 1.05 * most,
        marks: Marks::Dots,
        lines: points,
    };
    let mut text = format!(
        "## Time\n\n\
         Times are multiples of that of plain Marching Cubes on the same samples, with the same table \
         of cases, medians of {} runs in turn with one thread. *Simplification* leads from samples to \
         the octree, *responsibilities* finds which region answers for which dual cell, which this \
         extraction does without, *extraction* from the octree to triangles; it passes over nodes whose samples lie \
         on one side of the isovalue. *Without index* it looks at all of them, as the thesis does. A table beside the report has the same figures.\n\n",
        settings.runs
    );
    text += &table.markdown();
    let _ = write!(text, "\n{}\n\n", report.plot("time", &plot)?);
    let _ = write!(
        text,
        "The thesis: extraction is faster than that of the grid where simplification is high. Found: \
         it takes less time than plain Marching Cubes in {n_ahead} of {n_all} rows, without the index in \
         {n_ahead_without}"
    );
    text += &match below {
        Some(density) => format!(
            ". Every row with less than {density:.1} leaves per 100 samples is among the first.\n\n"
        ),
        None => ".\n\n".to_owned(),
    };
    Ok(text)
}

/// The density of leaves below which all are faster than the grid, if any is.
fn below_which_it_pays(points: &[(f64, f64)]) -> Option<f64> {
    let slow = points.iter().filter(|point| point.1 >= 1.0).map(|point| point.0);
    let least_slow = slow.fold(f64::INFINITY, f64::min);
    let fast = points.iter().map(|point| point.0).filter(|&density| density < least_slow);
    let densest = fast.fold(f64::NEG_INFINITY, f64::max);
    densest.is_finite().then_some(if least_slow.is_finite() { least_slow } else { densest })
}
