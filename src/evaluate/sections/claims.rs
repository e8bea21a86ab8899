//! What the thesis says, beside what was found.

use std::fmt::Write as _;

use super::{error, space};
use crate::{
    evaluate::{Settings, Subject},
    hrb::Criterion,
};

/// What the report is.
pub(in crate::evaluate) fn intro(settings: &Settings) -> String {
    let criterion = match settings.criterion {
        Criterion::Range => {
            "differ from each other by ε at most (the thesis's definition 3; `--criterion deviation` \
             compares them with their mean)"
        }
        Criterion::Deviation => {
            "differ from their mean by ε at most. The thesis's definition 3 compares samples with each \
             other, but with that ε = 2 cannot reach the surface of a model at 128³, which it says it \
             does; `--criterion range` follows the definition"
        }
    };
    format!(
        "# Evaluation of HRB and IDDG octrees\n\n\
         The evaluation of A. León Salas (2008, chapters 2 and 3), remade: what octrees of homogeneous \
         regions take, how long isosurfaces need, and how far these are from the truth. Models are \
         densities from 0 to 255 over the cube from −1 to 1, sampled in the middles of voxels and \
         rounded down: α1 is 255 inside and 0 outside, α2 falls from 255 in the middle to 0 at the \
         border. For times and errors samples are joined that {criterion}. Every table is in a CSV \
         file beside this report; all figures but times repeat."
    )
}

/// A table of claims.
pub(in crate::evaluate) fn text(
    subjects: &[Subject],
    space: &space::Found,
    error: &error::Found,
) -> String {
    let mut text = "## What the thesis says, and what is found\n\n\
                    | claim | found | |\n|---|---|---|\n"
        .to_owned();
    let mut row = |claim: &str, found: String, verdict: &str| {
        let _ = writeln!(text, "| {claim} | {found} | **{verdict}** |");
    };
    for (subject, grids) in subjects.iter().zip(&space.grids).filter(|(s, _)| s.is_scan()) {
        let Some((grid, spaces)) = grids.last() else { continue };
        let percents = [0, 1, 2].map(|i| spaces[i].percent());
        let found = format!(
            "{:.1} %, {:.1} %, {:.1} % of the grid at {grid} with ε = 0, 1, 2",
            percents[0], percents[1], percents[2]
        );
        let verdict = match percents {
            [exact, ..] if exact < 50.0 => "confirmed",
            [.., two] if two < 50.0 => "with a tolerance",
            _ => "refuted",
        };
        row(&format!("{} takes far less space than the grid", subject.name), found, verdict);
    }
    let pairs = subjects.iter().enumerate().filter(|(_, subject)| subject.is_binary);
    for (i, binary) in pairs {
        let stem = binary.slug.trim_end_matches("-alpha1");
        let other = subjects.iter().position(|other| other.slug == format!("{stem}-alpha2"));
        let Some(other) = other else { continue };
        let last = |k: usize| space.grids[k].last().map(|(grid, of)| (*grid, of[0].percent()));
        let (Some((grid, own)), Some((_, smooth))) = (last(i), last(other)) else { continue };
        row(
            &format!("the binary model {} saves more than the smooth one", binary.name),
            format!("{own:.1} % against {smooth:.1} % of the grid at {grid}"),
            if own < smooth { "confirmed" } else { "refuted" },
        );
    }
    for of_subject in &error.subjects {
        for (i, epsilon) in [(2, 1), (3, 2)] {
            let (Some(of_grid), Some(own)) =
                (of_subject.summaries.first(), of_subject.summaries.get(i))
            else {
                continue;
            };
            let n = of_subject.n_differing[i];
            let part = 100.0 * n as f64 / of_subject.n_pixels.max(1) as f64;
            let beside_grid = format!(
                "mean error {:.4} against {:.4} voxels, {part:.1} % of pixels differ visibly",
                own.mean, of_grid.mean
            );
            let (found, is_same) = match of_subject.same_mesh[i] {
                0 => ("the same mesh, bit by bit".to_owned(), true),
                first => {
                    let also = if first == 1 { "; the same mesh as with ε = 0" } else { "" };
                    let is_same = own.mean <= 1.01 * of_grid.mean && part < 1.0;
                    (beside_grid + also, is_same)
                }
            };
            let (claim, verdict) = match epsilon {
                1 => ("looks like that of the grid", if is_same { "confirmed" } else { "refuted" }),
                _ => {
                    ("differs from that of the grid", if is_same { "refuted" } else { "confirmed" })
                }
            };
            row(
                &format!("the surface of {} with ε = {epsilon} {claim}", of_subject.name),
                found,
                verdict,
            );
        }
    }
    text += "\nWhether extraction beats the grid where simplification is high is told with the times, \
             [below](#time).\n";
    text
}

/// What of the thesis this is not.
pub(in crate::evaluate) const OPEN: &str = "## What is not reproduced\n\n\
- The thesis's histograms of errors. It reports most points of *esfera* at 0.765, and 0.654 and 0.639 for \
*jarrón*. The metric as it is defined gives a fraction of a voxel, in any unit. 0.765 is the radius of the \
isosurface 60, 195/255; a formula that gives just that for *esfera* does not give the figures of *jarrón*.\n\
- The fourth scan, *skull*, which is not at hand. A file of it can be named as any other.\n\
- Times in seconds, which were those of a machine of 2008. What can be compared are ratios to Marching \
Cubes on the same machine.";
