//! Line plots as SVG.

use std::io::Write;

use plotters::prelude::*;

use super::{WriteError, Written};

/// Several lines over one axis.
#[derive(Clone, Debug)]
pub struct Plot {
    /// Above the plot.
    pub title: String,
    /// Below the horizontal axis.
    pub x_label: String,
    /// Beside the vertical axis, which runs from 0.
    pub y_label: String,
    /// The top of the vertical axis.
    pub y_max: f64,
    /// Name and points of each line.
    pub lines: Vec<(String, Vec<(f64, f64)>)>,
}

const SIZE_PX: (u32, u32) = (720, 480);
/// Colours that all readers can tell apart (Okabe and Ito, 2008).
const COLORS: [RGBColor; 4] =
    [RGBColor(0, 114, 178), RGBColor(213, 94, 0), RGBColor(0, 158, 115), RGBColor(120, 120, 120)];

/// Writes `plot` to `out`.
///
/// # Errors
/// [`WriteError::Encode`] if it cannot be drawn, [`WriteError::Io`] if it cannot be written.
pub fn write(plot: &Plot, mut out: impl Write) -> Written {
    let mut svg = String::new();
    draw(plot, &mut svg).map_err(|error| WriteError::Encode(error.to_string()))?;
    Ok(out.write_all(svg.as_bytes())?)
}

fn draw(plot: &Plot, svg: &mut String) -> Result<(), Box<dyn std::error::Error>> {
    let area = SVGBackend::with_string(svg, SIZE_PX).into_drawing_area();
    area.fill(&WHITE)?;
    let all = || plot.lines.iter().flat_map(|(_, points)| points.iter().map(|point| point.0));
    let (x_min, x_max) = (all().fold(f64::INFINITY, f64::min), all().fold(0.0, f64::max));
    let mut chart = ChartBuilder::on(&area)
        .caption(&plot.title, ("sans-serif", 20))
        .margin(16)
        .x_label_area_size(44)
        .y_label_area_size(56)
        .build_cartesian_2d(x_min..x_max.max(x_min + 1.0), 0.0..plot.y_max)?;
    chart.configure_mesh().x_desc(&plot.x_label).y_desc(&plot.y_label).draw()?;
    for ((name, points), color) in plot.lines.iter().zip(COLORS.into_iter().cycle()) {
        chart
            .draw_series(
                LineSeries::new(points.iter().copied(), color.stroke_width(2)).point_size(3),
            )?
            .label(name)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], color.stroke_width(2)));
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::LowerLeft)
        .background_style(WHITE.mix(0.8))
        .border_style(BLACK.mix(0.3))
        .draw()?;
    area.present()?;
    Ok(())
}
