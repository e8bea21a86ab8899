//! What gives a surface its colour: `color_by`, `palette` and `color_range`.

use super::{
    lower::Lower,
    spanned::Spanned,
    spec::{PaletteSpec, SurfaceSpec},
};
use crate::{
    diagnostic::{Diagnostic, did_you_mean},
    expr::Relation,
    raster::{ColorMap, Coloring, Palette, Quantity},
};

/// What a colour may tell, beside formulas.
const NAMES: [&str; 5] = ["position", "normal", "certificate", "curvature", "value"];

impl Lower<'_> {
    pub(super) fn coloring(&mut self, spec: &SurfaceSpec) -> Coloring {
        let Some(by) = &spec.color_by else {
            let palette = spec.palette.as_ref().map(|palette| ("palette", palette.span()));
            let range = spec.color_range.as_ref().map(|range| ("color_range", range.span()));
            for (key, span) in palette.into_iter().chain(range) {
                self.errors.push(
                    Diagnostic::new(span, format!("`{key}` stands without `color_by`"))
                        .help("add what the colour tells, as in color_by = \"curvature\""),
                );
            }
            return Coloring::Plain;
        };
        if let Some(color) = &spec.color {
            self.errors.push(
                Diagnostic::new(color.span(), "`color` contradicts `color_by`")
                    .help("remove one of them; `back_color` may stand beside `color_by`"),
            );
        }
        let usual = match by.get_ref().as_str() {
            "curvature" => Palette::BlueRed,
            _ => Palette::Viridis,
        };
        let palette = spec.palette.as_ref().map_or(usual, |palette| palette_of(*palette.get_ref()));
        let map = ColorMap { palette, range: self.color_range(spec) };
        match by.get_ref().as_str() {
            "position" => Coloring::Position,
            "normal" => Coloring::Normal,
            "certificate" => Coloring::Certificate,
            "curvature" => Coloring::Mapped(Quantity::Curvature, map),
            "value" => Coloring::Mapped(Quantity::Value, map),
            _ => self.formula_coloring(by, map),
        }
    }

    fn formula_coloring(&mut self, by: &Spanned<String>, map: ColorMap) -> Coloring {
        let text = by.get_ref();
        let is_defined = self.definitions.iter().any(|definition| definition.name == *text);
        if let Some(meant) = did_you_mean(text, NAMES).filter(|_| !is_defined) {
            self.errors.push(
                Diagnostic::new(by.span(), format!("`{text}` is nothing that a colour tells"))
                    .help(format!("did you mean \"{meant}\"? A formula may stand here too")),
            );
            return Coloring::Plain;
        }
        let formula = self.formula(by);
        let Some(resolved) = self.resolve(&formula) else { return Coloring::Plain };
        if resolved.relation != Relation::Value {
            self.errors.push(
                formula
                    .mistake("`color_by` must be a value")
                    .label("this is a comparison")
                    .help("write what the colour tells, as in color_by = \"x^2 + y^2\""),
            );
        }
        Coloring::Mapped(Quantity::Formula(resolved.expr), map)
    }

    fn color_range(&mut self, spec: &SurfaceSpec) -> Option<[f64; 2]> {
        let range = spec.color_range.as_ref()?;
        let [low, high] = range.get_ref().0;
        if low >= high {
            self.errors.push(
                Diagnostic::new(range.span(), "`color_range` is empty")
                    .label("the first number must be below the second"),
            );
        }
        Some([low, high])
    }
}

fn palette_of(spec: PaletteSpec) -> Palette {
    match spec {
        PaletteSpec::Viridis => Palette::Viridis,
        PaletteSpec::Magma => Palette::Magma,
        PaletteSpec::Plasma => Palette::Plasma,
        PaletteSpec::Cividis => Palette::Cividis,
        PaletteSpec::Turbo => Palette::Turbo,
        PaletteSpec::BlueRed => Palette::BlueRed,
        PaletteSpec::Gray => Palette::Gray,
    }
}
