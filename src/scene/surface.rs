//! Surfaces: formulas and blends of spheres with what they look like.

use toml::Spanned;

use super::{
    Surface,
    color::{default_color, linear_from_srgb},
    lower::Lower,
    spec::{BlendSpec, Inside, Section, SurfaceSpec},
};
use crate::{
    diagnostic::Diagnostic,
    expr::{Expr, parse},
    raster::Material,
};

/// More spheres than this are no scene written by hand, and take longer than anyone waits.
const MAX_SPHERES: usize = 10_000;

const DEFAULT_SPECULAR: f64 = 0.3;
const DEFAULT_SHININESS: i64 = 32;

impl Lower<'_> {
    /// All surfaces that could be made.
    pub(super) fn surfaces(&mut self, specs: &[Section<SurfaceSpec>]) -> Vec<Surface> {
        let surface = |(index, spec)| self.surface(index, spec);
        specs.iter().enumerate().filter_map(surface).collect()
    }

    fn surface(&mut self, index: usize, section: &Section<SurfaceSpec>) -> Option<Surface> {
        let spec = &section.spec;
        let color = spec.color.unwrap_or_else(|| default_color(index));
        let specular = self.number("specular", spec.specular.as_ref(), 0.0..=1.0, DEFAULT_SPECULAR);
        let shininess =
            self.whole("shininess", spec.shininess.as_ref(), 1..=1000, DEFAULT_SHININESS);
        let material =
            Material { color: linear_from_srgb(color), specular: specular as f32, shininess };
        let name = spec.name.clone().unwrap_or_else(|| format!("surface {}", index + 1));
        let (expr, usual) = self.expr(section)?;
        let expr = match spec.inside.unwrap_or(usual) {
            Inside::Negative => expr,
            Inside::Positive => expr.negated(),
        };
        Some(Surface { name, expr, material })
    }

    /// F, and the sign that it has inside unless the file says otherwise.
    fn expr(&mut self, section: &Section<SurfaceSpec>) -> Option<(Expr, Inside)> {
        match (&section.spec.f, &section.spec.blend) {
            (Some(f), None) => Some((self.formula(f)?, Inside::Negative)),
            (None, Some(blend)) => Some((self.blend(&blend.get_ref().0), Inside::Positive)),
            (Some(_), Some(blend)) => {
                self.errors.push(
                    Diagnostic::new(blend.span(), "a surface is given twice")
                        .label("it has a formula `f` as well")
                        .help("write a second [[surface]] for the blend"),
                );
                None
            }
            (None, None) if section.is_damaged => None,
            (None, None) => {
                self.errors.push(
                    Diagnostic::new(section.span.clone(), "the surface has no formula")
                        .label("neither `f` nor `blend`")
                        .help("add a formula, as in f = \"x^2 + y^2 + z^2 = 1\""),
                );
                None
            }
        }
    }

    fn formula(&mut self, text: &Spanned<String>) -> Option<Expr> {
        let resolved = parse(text.get_ref()).and_then(|ast| {
            Expr::resolve(&ast, &[])
                .map_err(|mistakes| mistakes.into_iter().map(|m| m.diagnostic).collect())
        });
        match resolved {
            Ok(resolved) => Some(resolved.expr),
            Err(errors) => {
                let errors = errors.into_iter().map(|error| in_file(error, text, self.source));
                self.errors.extend(errors);
                None
            }
        }
    }

    fn blend(&mut self, spec: &BlendSpec) -> Expr {
        let threshold = self.positive("threshold", &spec.threshold);
        let radius = self.positive("radius", &spec.radius);
        let spheres = spec.spheres.get_ref();
        if !(1..=MAX_SPHERES).contains(&spheres.len()) {
            self.errors.push(
                Diagnostic::new(spec.spheres.span(), format!("{} spheres", spheres.len()))
                    .label(format!("must be from 1 to {MAX_SPHERES}")),
            );
        }
        for sphere in spheres.iter().filter(|sphere| sphere.get_ref().0[3] <= 0.0) {
            self.errors.push(
                Diagnostic::new(sphere.span(), "the last number of a sphere is not above 0")
                    .label("[x, y, z, a]")
                    .help("the sphere's radius is `radius` divided by a"),
            );
        }
        let spheres: Vec<[f64; 4]> = spheres.iter().map(|sphere| sphere.get_ref().0).collect();
        Expr::blend(threshold, radius, &spheres)
    }
}

/// Moves a diagnostic of a formula to the file: exactly if the file holds the formula literally,
/// to the whole string if it is written with escapes.
fn in_file(error: Diagnostic, text: &Spanned<String>, source: &str) -> Diagnostic {
    let span = text.span();
    match start_of_literal(&source[span.clone()], text.get_ref()) {
        Some(offset) => error.shifted(span.start + offset),
        None => Diagnostic { span, label: "in this formula".to_owned(), ..error },
    }
}

/// Where in a TOML string, quotes included, its value begins, if it stands there literally.
fn start_of_literal(written: &str, value: &str) -> Option<usize> {
    let quotes = if written.starts_with("\"\"\"") || written.starts_with("'''") { 3 } else { 1 };
    let after = &written[quotes..];
    let newline = ["\r\n", "\n"].into_iter().find(|end| quotes == 3 && after.starts_with(end));
    let start = quotes + newline.map_or(0, str::len);
    let end = written.len().checked_sub(quotes)?;
    (written.get(start..end)? == value).then_some(start)
}

#[cfg(test)]
mod tests {
    use super::start_of_literal;

    #[test]
    fn literal_strings_are_found() {
        assert_eq!(start_of_literal("\"x+1\"", "x+1"), Some(1));
        assert_eq!(start_of_literal("''", ""), Some(1));
        assert_eq!(start_of_literal("\"\"\"\nx\n+1\"\"\"", "x\n+1"), Some(4));
        assert_eq!(start_of_literal("'''\r\nx'''", "x"), Some(5));
        assert_eq!(start_of_literal("\"\\u0078\"", "x"), None);
    }
}
