//! Likeness by gradient: whether it saves regions at equal error.

use crate::{
    Result,
    evaluate::{
        Settings, Subject,
        gradient::{Likeness, joined, regions_at},
        report::Report,
        table::{Cell, Table},
    },
};

/// Tolerances of values alone, in rising order.
const LADDER: [f64; 12] = [0.0, 1.0, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0, 24.0, 32.0, 48.0];
/// Tolerances of values and gradients together.
const PAIRS: [[f64; 2]; 6] =
    [[8.0, 1.0], [8.0, 2.0], [8.0, 4.0], [32.0, 2.0], [32.0, 4.0], [32.0, 8.0]];

pub(in crate::evaluate) fn write(
    report: &mut Report,
    subjects: &[Subject],
    settings: &Settings,
) -> Result<String> {
    let mut table = Table::new(&[
        "subject",
        "grid",
        "ε of values",
        "of gradients",
        "regions",
        "root mean square",
        "regions by values alone",
        "saved, %",
    ]);
    let (mut n_better, mut n_all) = (0, 0);
    for subject in subjects.iter().filter(|subject| !subject.is_binary) {
        let grid = subject.test_grid(&settings.sizes);
        let volume = subject.volume(grid)?;
        let of_ladder = LADDER.map(|value| Likeness { value, gradient: f64::INFINITY });
        let of_pairs = PAIRS.map(|[value, gradient]| Likeness { value, gradient });
        let all: Vec<Likeness> = of_ladder.into_iter().chain(of_pairs).collect();
        let found = joined(&volume, &all);
        let (ladder, pairs) = found.split_at(LADDER.len());
        for (likeness, own) in of_pairs.iter().zip(pairs) {
            let Some(alone) = regions_at(ladder, own.rms) else { continue };
            let saved = 100.0 * (1.0 - own.regions as f64 / alone);
            n_all += 1;
            n_better += u64::from(saved > 0.0);
            table.rows.push(vec![
                Cell::text(&subject.name),
                Cell::text(grid.to_string()),
                Cell::Number(likeness.value, 0),
                Cell::Number(likeness.gradient, 0),
                Cell::Count(own.regions),
                Cell::Number(own.rms, 4),
                Cell::Count(alone.round() as u64),
                Cell::Number(saved, 2),
            ]);
        }
    }
    if table.rows.is_empty() {
        return Ok(String::new());
    }
    report.csv("gradient", &table)?;
    Ok(format!(
        "## Likeness by gradient\n\n\
         Beyond the thesis: regions whose samples are alike by value and by gradient, the latter by \
         central differences along each axis. A region still keeps one value, so likeness by gradient \
         alone would join ramps. Both together are held against values alone with the tolerance that \
         gives the same root mean square of what samples differ from their regions (between whole \
         tolerances, interpolated): they leave fewer regions in {n_better} of {n_all} rows. Octrees \
         are built by values alone.\n\n{}\n",
        table.markdown()
    ))
}
