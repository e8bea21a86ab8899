//! Space: what octrees take.

use std::fmt::Write as _;

use crate::{
    Error, Result,
    evaluate::{
        Grid, Settings, Space, Subject,
        report::{Report, folded},
        space::{self, TOLERANCES},
        table::{Cell, Table},
    },
    output::plot::{Marks, Plot, XAxis},
    progress::Progress,
};

/// What was found, and how it is told.
pub(in crate::evaluate) struct Found {
    pub(in crate::evaluate) text: String,
    /// For each subject its grids, small ones first, each with the octrees of all tolerances.
    pub(in crate::evaluate) grids: Vec<Vec<(Grid, Vec<Space>)>>,
}

pub(in crate::evaluate) fn write(
    report: &mut Report,
    subjects: &[Subject],
    settings: &Settings,
    progress: &dyn Progress,
) -> Result<Found> {
    let mut grids = Vec::new();
    for subject in subjects {
        let mut of_subject = Vec::new();
        for grid in subject.grids(&settings.sizes) {
            if progress.is_cancelled() {
                return Err(Error::Interrupted);
            }
            of_subject.push((grid, space::measure(&*subject.volume(grid)?)));
            progress.advance(1);
        }
        grids.push(of_subject);
    }
    let mut text = "## Space\n\n\
        What an octree takes in percent of the grid, by the thesis's count: 4 bytes a node that is \
        divided and 3 a leaf, against 2 a sample. Leaves are regions in which samples differ by ε at \
        most, from each other (range) or from their mean (deviation).\n\n"
        .to_owned();
    text += &overview(subjects, &grids).markdown();
    let names = TOLERANCES.map(space::name);
    for (i, title) in [(0, "without a tolerance"), (2, "with ε = 2, range")] {
        let name = if i == 0 { "space-exact" } else { "space-tolerant" };
        let _ = write!(text, "\n{}", report.plot(name, &plot(subjects, &grids, i, title))?);
    }
    text += "\n\nThe count with all its parts; *held* is what the octree really takes in memory, with \
             the least and the largest sample of every node, in percent of the samples as they are \
             held.\n\n";
    let mut all = Table::new(&[
        "subject",
        "grid",
        "regions by",
        "nodes",
        "leaves",
        "bytes",
        "percent of grid",
        "bytes held",
        "percent of samples",
    ]);
    for (subject, grids) in subjects.iter().zip(&grids) {
        let mut own = Table { columns: all.columns[1..].to_vec(), rows: Vec::new() };
        for (grid, spaces) in grids {
            for (space, name) in spaces.iter().zip(&names) {
                own.rows.push(vec![
                    Cell::text(grid.to_string()),
                    Cell::text(name),
                    Cell::Count(space.storage.nodes),
                    Cell::Count(space.storage.regions),
                    Cell::Count(space.storage.thesis_bytes),
                    Cell::Number(space.percent(), 2),
                    Cell::Count(space.storage.resident_bytes),
                    Cell::Number(space.resident_percent(), 2),
                ]);
            }
        }
        let named = |row: &Vec<Cell>| {
            std::iter::once(Cell::text(&subject.name)).chain(row.iter().cloned()).collect()
        };
        all.rows.extend(own.rows.iter().map(named));
        text += &folded(&subject.name, &own.markdown());
    }
    report.csv("space", &all)?;
    Ok(Found { text, grids })
}

/// Percentages alone.
fn overview(subjects: &[Subject], grids: &[Vec<(Grid, Vec<Space>)>]) -> Table {
    let names = TOLERANCES.map(space::name);
    let columns = ["subject", "grid"].into_iter().chain(names.iter().map(String::as_str));
    let mut table = Table::new(&columns.collect::<Vec<&str>>());
    for (subject, grids) in subjects.iter().zip(grids) {
        for (grid, spaces) in grids {
            let mut row = vec![Cell::text(&subject.name), Cell::text(grid.to_string())];
            row.extend(spaces.iter().map(|space| Cell::Number(space.percent(), 2)));
            table.rows.push(row);
        }
    }
    table
}

/// Percentages with one tolerance over the longest edge of the grid.
fn plot(
    subjects: &[Subject],
    grids: &[Vec<(Grid, Vec<Space>)>],
    tolerance: usize,
    title: &str,
) -> Plot {
    let longest = |grid: &Grid| grid.size.into_iter().max().map_or(0.0, f64::from);
    let point = |(grid, spaces): &(Grid, Vec<Space>)| (longest(grid), spaces[tolerance].percent());
    let lines: Vec<(String, Vec<(f64, f64)>)> = subjects
        .iter()
        .zip(grids)
        .map(|(subject, grids)| (subject.name.clone(), grids.iter().map(point).collect()))
        .collect();
    let most = lines.iter().flat_map(|(_, points)| points).map(|point| point.1).fold(0.0, f64::max);
    Plot {
        title: format!("Space {title}"),
        x_label: "samples along the longest edge".to_owned(),
        y_label: "percent of the grid".to_owned(),
        x_axis: XAxis::Doubling,
        y_max: 1.05 * most,
        marks: Marks::Joined,
        lines,
    }
}
