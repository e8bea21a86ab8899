//! Errors of isosurfaces: tables, curves, and pictures coloured by them.

use std::fmt::Write as _;

use crate::{
    Result,
    evaluate::{
        Errors, GRID, Grid, Histogram, Settings, Subject, Summary, Surface, Truth,
        histogram::{even_width, upper_end},
        pictures::{self, Colors},
        report::{Report, folded, side_by_side},
        space,
        subject::Source,
        table::{Cell, Table, thousands},
    },
    hrb::Tolerance,
    output::{
        plot::{Marks, Plot, XAxis},
        png,
    },
    progress::Progress,
    raster::Frame,
};

/// What was found, and how it is told.
pub(in crate::evaluate) struct Found {
    pub(in crate::evaluate) text: String,
    /// One for each subject that has a gradient.
    pub(in crate::evaluate) subjects: Vec<OfSubject>,
}

/// Of the grid and of every tolerance.
pub(in crate::evaluate) struct OfSubject {
    pub(in crate::evaluate) name: String,
    pub(in crate::evaluate) summaries: Vec<Summary>,
    /// How many pixels of all that show the surface differ visibly from the picture of the grid.
    pub(in crate::evaluate) n_pixels: u64,
    pub(in crate::evaluate) n_differing: Vec<u64>,
    /// Which way comes first that has the same mesh.
    pub(in crate::evaluate) same_mesh: Vec<usize>,
}

/// One way to get the surface.
struct Way {
    name: String,
    surface: Surface,
    errors: Errors,
    histogram: Histogram,
}

/// Rows of tables of frequencies, about.
const ROWS: usize = 16;
/// Points of curves, about.
const POINTS: usize = 100;

pub(in crate::evaluate) fn write(
    report: &mut Report,
    subjects: &[Subject],
    settings: &Settings,
    progress: &dyn Progress,
) -> Result<Found> {
    let mut text = "## Error of the isosurface\n\n\
        E = (ν − f(X)) / |∇f(X)| at the vertices X of the isosurface ν: to first order their distance \
        to the surface, positive on the side of smaller values. It is counted in voxels of the grid. \
        Of formulas f is the density itself, neither cut nor rounded down to whole numbers, which \
        moves every surface inwards by up to the length on which the density changes by 1. Of scans f \
        is the trilinear interpolation of all samples, and every second one is tested. Models of α1 \
        have no gradient to measure by. In the pictures blue is no error, red the error that 1 % of \
        the grid's vertices exceed or more, and grey where f jumps or is undefined.\n\n"
        .to_owned();
    let mut found = Vec::new();
    let mut summaries = Table::new(&[
        "subject",
        "grid",
        "surface",
        "vertices",
        "mean",
        "mean with sign",
        "median",
        "99 %",
        "largest",
        "beyond 3",
        "at jumps",
        "undefined",
    ]);
    for subject in subjects.iter().filter(|subject| !subject.is_binary) {
        let grid = subject.test_grid(&settings.sizes);
        let ways = ways(subject, grid, settings)?;
        for way in &ways {
            let summary = way.errors.summary();
            summaries.rows.push(vec![
                Cell::text(&subject.name),
                Cell::text(grid.to_string()),
                Cell::text(&way.name),
                Cell::Count(way.errors.signed.len() as u64),
                Cell::Number(summary.mean, 4),
                Cell::Number(summary.signed_mean, 4),
                Cell::Number(summary.median, 4),
                Cell::Number(summary.most_of_all, 4),
                Cell::Number(summary.largest, 4),
                Cell::Count(way.histogram.n_beyond),
                Cell::Count(way.errors.n_at_jumps),
                Cell::Count(way.errors.n_undefined),
            ]);
        }
        let (own, of_subject) = of_subject(report, subject, grid, &ways, progress)?;
        text += &own;
        found.push(of_subject);
        progress.advance(1);
    }
    if found.is_empty() {
        return Ok(Found { text: String::new(), subjects: found });
    }
    report.csv("error", &summaries)?;
    let _ = write!(text, "### All errors\n\nIn voxels.\n\n{}\n", summaries.markdown());
    Ok(Found { text, subjects: found })
}

/// The grid, and every tolerance.
fn ways(subject: &Subject, grid: Grid, settings: &Settings) -> Result<Vec<Way>> {
    let volume = subject.volume(grid)?;
    let steps = volume.placing.matrix3;
    let voxel = [steps.x_axis, steps.y_axis, steps.z_axis].map(|step| step.length());
    let voxel = voxel.into_iter().fold(f64::INFINITY, f64::min);
    let tape = match &subject.source {
        Source::Formula(formula) => Some(formula.tape()),
        Source::Scan(_) => None,
    };
    let truth = match (&subject.source, &tape) {
        (Source::Scan(volume), _) => Truth::Grid(volume),
        (_, Some(tape)) => Truth::Formula(tape),
        (_, None) => return Ok(Vec::new()),
    };
    let of_grid = Tolerance { epsilon: GRID, criterion: settings.criterion };
    let way = |tolerance: Tolerance| {
        let surface = Surface::new(&volume, subject.isovalue, tolerance);
        let errors = Errors::new(&surface, truth, subject.isovalue, voxel);
        let histogram = Histogram::new(errors.measured());
        Way { name: space::name(tolerance), surface, errors, histogram }
    };
    Ok(std::iter::once(of_grid).chain(settings.tolerances()).map(way).collect())
}

fn of_subject(
    report: &mut Report,
    subject: &Subject,
    grid: Grid,
    ways: &[Way],
    progress: &dyn Progress,
) -> Result<(String, OfSubject)> {
    let (name, slug) = (&subject.name, &subject.slug);
    let most = ways[0].histogram.quantile(0.99).min(3.0);
    let plain: Vec<_> = ways.iter().map(|way| (&way.surface, None)).collect();
    let colored: Vec<_> = ways
        .iter()
        .map(|way| (&way.surface, Some(Colors { errors: &way.errors.signed, most })))
        .collect();
    let (plain, colored) = (pictures::draw(&plain, progress)?, pictures::draw(&colored, progress)?);
    let names: Vec<String> = ways.iter().map(|way| way.name.clone()).collect();
    let mut rows = [Vec::new(), Vec::new()];
    for (i, way) in ways.iter().enumerate() {
        let kinds = [("surface", &plain[i]), ("error", &colored[i])];
        for (row, (kind, frame)) in rows.iter_mut().zip(kinds) {
            let title = format!("{name}, {}: {kind}", way.name);
            let file = format!("{slug}-{kind}-{}", ["grid", "0", "1", "2"][i.min(3)]);
            row.push(report.picture(&file, &title, frame)?);
        }
    }
    let mut text = format!("### {name}, {grid}, isovalue {}\n\n", subject.isovalue);
    text += &side_by_side(&names, &rows[0]);
    text.pop();
    let _ = write!(text, "| {} |\n\n", rows[1].join(" | "));
    let _ = write!(text, "Red: {most} voxels. ");

    let curve = even_width(ways[0].histogram.quantile(0.995).max(most), POINTS);
    let end = end_of(ways, curve, 0.995);
    let point = |(i, count): (usize, u64), total: f64| {
        (upper_end((i + 1) * curve - 1) - 0.0005 * curve as f64, 100.0 * count as f64 / total)
    };
    let line = |way: &Way| {
        let total = way.histogram.total().max(1) as f64;
        let counts = way.histogram.joined(curve, end).into_iter().enumerate();
        (way.name.clone(), counts.map(|pair| point(pair, total)).collect())
    };
    let lines: Vec<(String, Vec<(f64, f64)>)> = ways.iter().map(line).collect();
    let top = lines.iter().flat_map(|(_, points)| points).map(|point| point.1).fold(0.0, f64::max);
    let plot = Plot {
        title: format!("{name}: how often errors are how large"),
        x_label: "|E| in voxels".to_owned(),
        y_label: format!("percent of vertices in each {} voxels", upper_end(curve - 1)),
        x_axis: XAxis::Linear,
        y_max: (1.08 * top).max(1e-9),
        marks: Marks::Lines,
        lines,
    };
    let shown = report.plot(&format!("{slug}-error"), &plot)?;
    report.csv(&format!("{slug}-histogram"), &bins(ways))?;

    let means: Vec<String> =
        ways.iter().map(|way| Cell::Number(way.errors.summary().mean, 4).words()).collect();
    let n_differing: Vec<u64> = plain.iter().map(|frame| differing(&plain[0], frame)).collect();
    let n_pixels = covered(&plain[0]);
    let _ = write!(
        text,
        "The mean error is {} voxels ({}). Of {} pixels that show the surface {} differ visibly from \
         the picture of the grid, by {VISIBLE} or more of 255.\n\n{shown}\n\n",
        means.join(", "),
        names.join("; "),
        thousands(n_pixels),
        n_differing[1..].iter().map(|&n| thousands(n)).collect::<Vec<String>>().join(", "),
    );
    text += &folded("Frequencies", &frequencies(ways));
    let same_mesh = ways
        .iter()
        .map(|way| ways.iter().position(|other| is_same(&other.surface, &way.surface)).unwrap_or(0))
        .collect();
    let summaries = ways.iter().map(|way| way.errors.summary()).collect();
    let of_subject = OfSubject { name: name.clone(), summaries, n_pixels, n_differing, same_mesh };
    Ok((text, of_subject))
}

/// Whether two meshes are the same, bit by bit; they may begin with different triangles.
fn is_same(a: &Surface, b: &Surface) -> bool {
    let corners = |of: &Surface| {
        let bits = |v: u32| of.positions[v as usize].to_array().map(f64::to_bits);
        let mut all: Vec<_> = of.triangles.iter().map(|corners| corners.map(bits)).collect();
        all.sort_unstable();
        all
    };
    a.triangles.len() == b.triangles.len() && corners(a) == corners(b)
}

/// The bin up to which every way has this part of its errors, in whole steps of `width`.
fn end_of(ways: &[Way], width: usize, part: f64) -> usize {
    let reach = |way: &Way| (way.histogram.quantile(part).min(3.0) * 1000.0).round() as usize;
    ways.iter().map(reach).max().unwrap_or(0).next_multiple_of(width)
}

/// Interval, absolute, relative and accumulated frequency; ways with the same errors share a table.
fn frequencies(ways: &[Way]) -> String {
    let mut groups: Vec<(Vec<&str>, &Histogram)> = Vec::new();
    for way in ways {
        match groups.iter_mut().find(|(_, histogram)| **histogram == way.histogram) {
            Some((names, _)) => names.push(&way.name),
            None => groups.push((vec![&way.name], &way.histogram)),
        }
    }
    let most = ways[0].histogram.quantile(0.999).min(3.0);
    let width = even_width(most, ROWS);
    let end = end_of(ways, width, 0.999);
    let mut text = String::new();
    for (names, histogram) in groups {
        let total = histogram.total();
        if total == 0 {
            continue;
        }
        let mut table = Table::new(&["interval", "absolute", "relative, %", "accumulated, %"]);
        let mut n = 0;
        let mut row = |interval: String, count: u64| {
            n += count;
            let percent = |n: u64| Cell::Number(100.0 * n as f64 / total as f64, 3);
            table.rows.push(vec![
                Cell::text(interval),
                Cell::Count(count),
                percent(count),
                percent(n),
            ]);
        };
        let counts = histogram.joined(width, end);
        let mut rest = total;
        for (i, &count) in counts.iter().enumerate() {
            let from = if i == 0 { 0.0 } else { upper_end(i * width - 1) };
            row(format!("{from:.3} – {:.3}", upper_end((i + 1) * width - 1)), count);
            rest -= count;
        }
        if rest > 0 {
            row(format!("above {:.3}", upper_end(counts.len() * width - 1)), rest);
        }
        let _ = write!(text, "**{}**\n\n{}\n", names.join("; "), table.markdown());
    }
    text
}

/// All bins of all ways.
fn bins(ways: &[Way]) -> Table {
    let mut columns = vec!["up to".to_owned()];
    columns.extend(ways.iter().map(|way| way.name.clone()));
    let row = |bin: usize| {
        let counts = ways.iter().map(|way| Cell::Count(way.histogram.counts[bin]));
        std::iter::once(Cell::Number(upper_end(bin), 3)).chain(counts).collect()
    };
    let mut rows: Vec<Vec<Cell>> = (0..ways[0].histogram.counts.len()).map(row).collect();
    let beyond = ways.iter().map(|way| Cell::Count(way.histogram.n_beyond));
    rows.push(std::iter::once(Cell::text("beyond")).chain(beyond).collect());
    Table { columns, rows }
}

/// Colours that differ by less than this are hard to tell apart, of 255.
const VISIBLE: u8 = 8;

/// Pixels of a picture whose colours are visibly not the same in the other one.
fn differing(a: &Frame, b: &Frame) -> u64 {
    let (a, b) = (png::to_srgb8(a), png::to_srgb8(b));
    let differ = |(a, b): &(&image::Rgba<u8>, &image::Rgba<u8>)| {
        a.0.iter().zip(b.0).any(|(a, b)| a.abs_diff(b) >= VISIBLE)
    };
    a.pixels().zip(b.pixels()).filter(differ).count() as u64
}

/// Pixels that show something.
fn covered(frame: &Frame) -> u64 {
    frame.surface.iter().filter(|&&surface| surface > 0.0).count() as u64
}
