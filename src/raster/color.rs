//! The colour of what samples show: by place, normal, certificate, or a number and a palette.

use colorous::Gradient;
use glam::DVec3;

use super::{
    ColorMap, Coloring, Layer, Palette, Quantity, Shade,
    paint::{Painter, Seen, Tools},
    tile::Tile,
};
use crate::{
    expr::Tape,
    math::{Lattice, linear_from_srgb},
};

/// Green and red that differ in brightness too.
const CERTIFIED: [f32; 3] = [0.15, 0.55, 0.2];
const CANDIDATE: [f32; 3] = [0.75, 0.08, 0.04];

/// Gives samples the colours of their layers.
pub(super) struct Colorer<'a> {
    layers: &'a [Layer<'a>],
    rules: Vec<Rule<'a>>,
}

/// What gives one layer its colour.
struct Rule<'a> {
    coloring: &'a Coloring,
    /// Of a quantity that is a formula.
    tape: Option<Tape>,
    /// The palette, finely divided.
    ramp: Vec<[f32; 3]>,
}

/// A palette is divided into so many colours.
const RAMP: usize = 1024;

/// The largest curvature that has a colour of its own, times the domain's longest edge.
const CURVATURE: f64 = 10.0;

impl<'a> Colorer<'a> {
    pub(super) fn new(layers: &'a [Layer<'a>], shade: Shade) -> Self {
        let rule = |layer: &Layer<'a>| {
            let coloring = match shade {
                Shade::Status => &Coloring::Certificate,
                _ => layer.coloring,
            };
            let (tape, ramp) = match coloring {
                Coloring::Mapped(quantity, map) => (formula(quantity), ramp(map.palette)),
                _ => (None, Vec::new()),
            };
            Rule { coloring, tape, ramp }
        };
        Self { layers, rules: layers.iter().map(rule).collect() }
    }

    /// Whether a layer has colours of its own, instead of its material's.
    pub(super) fn colors(&self, layer: usize) -> bool {
        self.rules.get(layer).is_some_and(|rule| !matches!(rule.coloring, Coloring::Plain))
    }

    /// Gives all samples of a tile the colours of their layers.
    pub(super) fn color(
        &self,
        painter: &Painter<'_>,
        place: (usize, usize),
        tile: &Tile,
        seen: &mut [Option<Seen>],
        tools: &mut Tools,
    ) {
        for number in (0..self.layers.len()).filter(|&number| self.colors(number)) {
            let of_layer = seen.iter().enumerate().filter_map(|(i, seen)| {
                let seen = seen.filter(|seen| seen.layer == number)?;
                Some((i, Point { seen, at: painter.point(tile, i, &seen) }))
            });
            let (samples, points): (Vec<usize>, Vec<Point>) = of_layer.unzip();
            let colors = self.colors_of(number, &points, painter, place, tools);
            for (i, color) in samples.into_iter().zip(colors) {
                if let Some(seen) = &mut seen[i] {
                    seen.tint = color;
                }
            }
        }
    }

    /// The colours of points of a layer.
    fn colors_of(
        &self,
        number: usize,
        points: &[Point],
        painter: &Painter<'_>,
        place: (usize, usize),
        tools: &mut Tools,
    ) -> Vec<[f32; 3]> {
        let rule = &self.rules[number];
        let layer = &self.layers[number];
        let bounds = layer.lattice.bounds();
        let direct = |color: &dyn Fn(&Point) -> [f32; 3]| points.iter().map(color).collect();
        match rule.coloring {
            Coloring::Plain => direct(&|point| point.seen.tint),
            Coloring::Position => direct(&|point| linear((point.at - bounds.min) / bounds.size())),
            Coloring::Normal => direct(&|point| linear(0.5 + 0.5 * point.seen.normal)),
            Coloring::Certificate => {
                let open = |point: &&Point| point.seen.certified.is_none();
                let of_point = |point: &Point| Some((point.seen.block?, point.at));
                let asked: Vec<_> = points.iter().filter(open).filter_map(of_point).collect();
                let mut found = painter.certificates(place, &asked, tools).into_iter();
                let mut is = |point: &Point| point.seen.certified.or_else(|| found.next());
                let color = |is: Option<bool>| if is == Some(true) { CERTIFIED } else { CANDIDATE };
                points.iter().map(|point| color(is(point))).collect()
            }
            Coloring::Mapped(quantity, map) => {
                let values = match quantity {
                    Quantity::Curvature => {
                        let of_point = |point: &Point| {
                            Some((point.seen.block?, point.at, point.seen.voxel_size))
                        };
                        let points: Vec<_> = points.iter().filter_map(of_point).collect();
                        painter.curvatures(place, &points, tools)
                    }
                    Quantity::Value => {
                        let middle = |point: &Point| {
                            let size = point.seen.voxel_size;
                            bounds.min + (((point.at - bounds.min) / size).floor() + 0.5) * size
                        };
                        let middles: Vec<DVec3> = points.iter().map(middle).collect();
                        layer
                            .tape
                            .map(|tape| tools.tracer.values(tape, &middles))
                            .unwrap_or_default()
                    }
                    Quantity::Formula(_) => {
                        let places: Vec<DVec3> = points.iter().map(|point| point.at).collect();
                        rule.tape
                            .as_ref()
                            .map(|tape| tools.tracer.values(tape, &places))
                            .unwrap_or_default()
                    }
                };
                let range = range(quantity, map, layer.lattice);
                values.into_iter().map(|value| rule.ramp[index(range, value)]).collect()
            }
        }
    }
}

/// A point of a layer.
struct Point {
    seen: Seen,
    at: DVec3,
}

fn formula(quantity: &Quantity) -> Option<Tape> {
    match quantity {
        Quantity::Formula(expr) => Some(expr.tape()),
        _ => None,
    }
}

/// Linear light of an sRGB colour.
fn linear(color: DVec3) -> [f32; 3] {
    color.to_array().map(|c| linear_from_srgb(c.clamp(0.0, 1.0)) as f32)
}

fn ramp(palette: Palette) -> Vec<[f32; 3]> {
    let color = |i: usize| {
        let t = i as f64 / (RAMP - 1) as f64;
        let of = |gradient: Gradient, t: f64| {
            let color = gradient.eval_continuous(t);
            DVec3::new(f64::from(color.r), f64::from(color.g), f64::from(color.b)) / 255.0
        };
        linear(match palette {
            Palette::Viridis => of(colorous::VIRIDIS, t),
            Palette::Magma => of(colorous::MAGMA, t),
            Palette::Plasma => of(colorous::PLASMA, t),
            Palette::Cividis => of(colorous::CIVIDIS, t),
            Palette::Turbo => of(colorous::TURBO, t),
            Palette::BlueRed => of(colorous::RED_BLUE, 1.0 - t),
            Palette::Gray => DVec3::splat(t),
        })
    };
    (0..RAMP).map(color).collect()
}

/// The numbers that have the first colour and the last.
fn range(quantity: &Quantity, map: &ColorMap, lattice: &Lattice) -> [f64; 2] {
    let largest = match quantity {
        Quantity::Curvature => CURVATURE / lattice.bounds().size().max_element(),
        Quantity::Value | Quantity::Formula(_) => 1.0,
    };
    map.range.unwrap_or([-largest, largest])
}

/// Where in the ramp the colour of a value is; what is no number counts as the lower end.
fn index([low, high]: [f64; 2], value: f64) -> usize {
    let t = (value - low) / (high - low);
    // A conversion of a float saturates, and NaN becomes 0.
    ((t * (RAMP - 1) as f64 + 0.5) as usize).min(RAMP - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_run_through_the_palette() {
        let at = |value: f64| ramp(Palette::Gray)[index([-2.0, 2.0], value)][1];
        assert_eq!([-9.0, -2.0, 2.0, 1e300].map(at), [0.0, 0.0, 1.0, 1.0]);
        assert_eq!(at(f64::NAN), 0.0);
        assert!((at(0.0) - 0.214).abs() < 1e-3, "the middle in sRGB");
    }

    #[test]
    fn blue_is_below_and_red_above() {
        let ramp = ramp(Palette::BlueRed);
        let [first, middle, last] = [ramp[0], ramp[RAMP / 2], ramp[RAMP - 1]];
        assert!(first[2] > first[0] && last[0] > last[2]);
        assert!(middle.iter().all(|&c| c > 0.8), "{middle:?}");
    }
}
