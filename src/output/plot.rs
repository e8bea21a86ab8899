//! Plots of lines and points as SVG.

use std::io::Write;

use plotters::{
    coord::{Shift, types::RangedCoordf64},
    prelude::*,
};

use super::{WriteError, Written};

/// Several series over one axis.
#[derive(Clone, Debug, Default)]
pub struct Plot {
    /// Above the plot.
    pub title: String,
    /// Below the horizontal axis.
    pub x_label: String,
    /// Beside the vertical axis, which runs from 0.
    pub y_label: String,
    /// How numbers lie along the horizontal axis.
    pub x_axis: XAxis,
    /// The top of the vertical axis.
    pub y_max: f64,
    /// What stands for the points of a series.
    pub marks: Marks,
    /// Name and points of each series.
    pub lines: Vec<(String, Vec<(f64, f64)>)>,
}

/// How numbers lie along an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum XAxis {
    /// Evenly.
    #[default]
    Linear,
    /// Each power of two a step further; they are above 0.
    Doubling,
}

/// What stands for the points of a series.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Marks {
    /// Dots joined by a line.
    #[default]
    Joined,
    /// A line; those before are broader, so that lines on top of each other all show.
    Lines,
    /// Dots.
    Dots,
}

const SIZE_PX: (u32, u32) = (840, 480);
/// Room for names to the right of the plot.
const LEGEND_PX: u32 = 180;
/// From one name to the next.
const LINE_PX: i32 = 22;
/// Colours that all readers can tell apart (Okabe and Ito, 2008).
const COLORS: [RGBColor; 8] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(0, 0, 0),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(230, 159, 0),
    RGBColor(120, 120, 120),
];

/// Writes `plot` to `out`.
///
/// # Errors
/// [`WriteError::Encode`] if it cannot be drawn, [`WriteError::Io`] if it cannot be written.
pub fn write(plot: &Plot, mut out: impl Write) -> Written {
    let mut svg = String::new();
    draw(plot, &mut svg).map_err(|error| WriteError::Encode(error.to_string()))?;
    Ok(out.write_all(svg.as_bytes())?)
}

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;
type Failed = Box<dyn std::error::Error>;

fn draw(plot: &Plot, svg: &mut String) -> Result<(), Failed> {
    let area: Area<'_> = SVGBackend::with_string(svg, SIZE_PX).into_drawing_area();
    area.fill(&WHITE)?;
    let place = |x: f64| match plot.x_axis {
        XAxis::Linear => x,
        XAxis::Doubling => libm::log2(x),
    };
    let xs = plot.lines.iter().flat_map(|(_, points)| points.iter().map(|point| place(point.0)));
    let (least, most) =
        xs.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
    let x_min = if least.is_finite() { least } else { 0.0 };
    let x_max = if most > x_min { most } else { x_min + 1.0 };
    let (left, right) = area.split_horizontally(SIZE_PX.0 - LEGEND_PX);
    let mut chart = ChartBuilder::on(&left)
        .caption(&plot.title, ("sans-serif", 20))
        .margin(16)
        .x_label_area_size(44)
        .y_label_area_size(64)
        .build_cartesian_2d(x_min..x_max, 0.0..plot.y_max)?;
    let short = |x: &f64| ((x * 1e6).round() / 1e6).to_string();
    let power = |x: &f64| libm::exp2(*x).round().to_string();
    let mut mesh = chart.configure_mesh();
    mesh.x_desc(&plot.x_label).y_desc(&plot.y_label);
    mesh.light_line_style(TRANSPARENT).bold_line_style(BLACK.mix(0.15));
    mesh.x_label_formatter(&short).y_label_formatter(&short);
    if plot.x_axis == XAxis::Doubling {
        mesh.x_labels((x_max - x_min).round() as usize + 1).x_label_formatter(&power);
    }
    mesh.draw()?;
    for (i, (name, points)) in plot.lines.iter().enumerate() {
        let points: Vec<(f64, f64)> = points.iter().map(|&(x, y)| (place(x), y)).collect();
        draw_series(plot, &mut chart, i, points)?;
        let y = 60 + LINE_PX * i as i32;
        right.draw(&PathElement::new([(4, y), (24, y)], style(plot, i)))?;
        right.draw(&Text::new(name.as_str(), (32, y - 7), ("sans-serif", 14)))?;
    }
    area.present()?;
    Ok(())
}

/// How series `i` is drawn.
fn style(plot: &Plot, i: usize) -> ShapeStyle {
    let width = match plot.marks {
        Marks::Lines => (2 * (plot.lines.len() - i) as u32 - 1).max(2),
        Marks::Joined | Marks::Dots => 2,
    };
    COLORS[i % COLORS.len()].stroke_width(width)
}

fn draw_series(
    plot: &Plot,
    chart: &mut Chart<'_, '_>,
    i: usize,
    points: Vec<(f64, f64)>,
) -> Result<(), Failed> {
    let line = style(plot, i);
    match plot.marks {
        Marks::Dots => {
            let dots = points.into_iter().map(|point| Circle::new(point, 4, line.filled()));
            chart.draw_series(dots)?
        }
        Marks::Lines => chart.draw_series(LineSeries::new(points, line))?,
        Marks::Joined => chart.draw_series(LineSeries::new(points, line).point_size(3))?,
    };
    Ok(())
}
