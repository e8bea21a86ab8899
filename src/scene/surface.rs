//! Surfaces: formulas, shapes, spheres and function graphs, with what they look like.

use std::ops::Range;

use super::{
    Surface,
    clip::Clip,
    color::{WHITE, default_color, linear},
    leaf::{Color, Number, Numbers, Whole},
    lower::Lower,
    spanned::Spanned,
    spec::{BlendSpec, Inside, Section, SurfaceSpec},
};
use crate::{
    diagnostic::Diagnostic,
    expr::{Expr, Relation},
    raster::Material,
};

/// More spheres than this do not fit into a scene file.
const MAX_SPHERES: usize = 100_000;

const DEFAULT_SPECULAR: f64 = 0.3;
const DEFAULT_SHININESS: i64 = 32;

impl Lower<'_> {
    /// All surfaces that could be made.
    pub(super) fn surfaces(&mut self, specs: &[Section<SurfaceSpec>], clip: &Clip) -> Vec<Surface> {
        let surface = |(index, spec)| self.surface(index, spec, clip);
        specs.iter().enumerate().filter_map(surface).collect()
    }

    fn surface(
        &mut self,
        index: usize,
        section: &Section<SurfaceSpec>,
        clip: &Clip,
    ) -> Option<Surface> {
        let spec = &section.spec;
        let material = self.material(index, spec);
        let coloring = self.coloring(spec);
        let name = spec.name.clone().unwrap_or_else(|| format!("surface {}", index + 1));
        let expr = self.expr(section)?;
        Some(Surface { name, expr: self.clipped(expr, section, clip), material, coloring })
    }

    fn material(&mut self, index: usize, spec: &SurfaceSpec) -> Material {
        let usual = if self.has_matcap { WHITE } else { default_color(index) };
        let color = spec.color.as_ref().map_or(usual, |color| *color.get_ref());
        self.material_of((color, spec.back_color), spec.specular.as_ref(), spec.shininess.as_ref())
    }

    /// From the colour of the front, and that of the back if it has one.
    pub(super) fn material_of(
        &mut self,
        (color, back_color): (Color, Option<Color>),
        specular: Option<&Spanned<Number>>,
        shininess: Option<&Spanned<Whole>>,
    ) -> Material {
        let (color, back_color) = (linear(color), back_color.map(linear));
        let specular = self.number("specular", specular, 0.0..=1.0, DEFAULT_SPECULAR) as f32;
        let shininess = self.whole("shininess", shininess, 1..=1000, DEFAULT_SHININESS);
        Material { color, back_color, specular, shininess }
    }

    /// F, negative inside.
    fn expr(&mut self, section: &Section<SurfaceSpec>) -> Option<Expr> {
        let spec = &section.spec;
        let keys = [
            spec.f.as_ref().map(|f| ("f", f.span())),
            spec.shape.as_ref().map(|shape| ("shape", shape.span())),
            spec.blend.as_ref().map(|blend| ("blend", blend.span())),
            spec.spheres.as_ref().map(|spheres| ("spheres", spheres.span())),
            spec.file.as_ref().map(|file| ("file", file.span())),
        ];
        let keys: Vec<(&str, Range<usize>)> = keys.into_iter().flatten().collect();
        if keys.len() > 1 {
            self.given_twice(keys);
            return None;
        }
        if let Some(f) = &spec.f {
            let formula = self.formula(f);
            let resolved = self.resolve(&formula)?;
            if resolved.relation == Relation::Solid {
                self.no_inside(spec.inside.as_ref(), "the comparison in `f`");
                return Some(resolved.expr);
            }
            return Some(turned(resolved.expr, spec, Inside::Negative));
        }
        if let Some(shape) = &spec.shape {
            let formula = self.formula(shape).into_shape();
            self.no_inside(spec.inside.as_ref(), "a shape");
            return Some(self.resolve(&formula)?.expr);
        }
        if let Some(blend) = &spec.blend {
            return Some(turned(self.blend(&blend.get_ref().0), spec, Inside::Positive));
        }
        if let Some(spheres) = &spec.spheres {
            self.no_inside(spec.inside.as_ref(), "a union of spheres");
            return Some(Expr::spheres(&self.spheres(spheres, RADIUS)));
        }
        if let Some(file) = &spec.file {
            return Some(turned(self.graph(file)?, spec, Inside::Negative));
        }
        if !section.is_damaged {
            self.errors.push(
                Diagnostic::new(section.span.clone(), "the surface has no formula")
                    .label("none of `f`, `shape`, `blend`, `spheres` and `file`")
                    .help("add a formula, as in f = \"x^2 + y^2 + z^2 = 1\""),
            );
        }
        None
    }

    /// Several of the keys that give a surface; the last of them is marked.
    fn given_twice(&mut self, mut keys: Vec<(&str, Range<usize>)>) {
        keys.sort_by_key(|(_, span)| span.start);
        let Some((last, span)) = keys.pop() else { return };
        let others: Vec<String> = keys.iter().map(|(key, _)| format!("`{key}`")).collect();
        self.errors.push(
            Diagnostic::new(span, "a surface is given twice")
                .label(format!("it has {} as well", others.join(" and ")))
                .help(format!("write a second [[surface]] for `{last}`")),
        );
    }

    /// A comparison needs no `inside`, and would contradict it half of the time.
    fn no_inside(&mut self, inside: Option<&Spanned<Inside>>, what: &str) {
        if let Some(inside) = inside {
            self.errors.push(
                Diagnostic::new(inside.span(), "`inside` is for equations")
                    .label(format!("{what} says what is inside"))
                    .help("remove it, or turn the comparison around"),
            );
        }
    }

    fn blend(&mut self, spec: &BlendSpec) -> Expr {
        let threshold = self.positive("threshold", &spec.threshold);
        let radius = self.positive("radius", &spec.radius);
        Expr::blend(threshold, radius, &self.spheres(&spec.spheres, SCALE))
    }

    /// Spheres, each three coordinates and a number above 0, of which `last` speaks.
    fn spheres(
        &mut self,
        list: &Spanned<Vec<Spanned<Numbers<4>>>>,
        [written, meaning]: [&str; 2],
    ) -> Vec<[f64; 4]> {
        let spheres = list.get_ref();
        if !(1..=MAX_SPHERES).contains(&spheres.len()) {
            self.errors.push(
                Diagnostic::new(list.span(), format!("{} spheres", spheres.len()))
                    .label(format!("must be from 1 to {MAX_SPHERES}")),
            );
        }
        for sphere in spheres.iter().filter(|sphere| sphere.get_ref().0[3] <= 0.0) {
            self.errors.push(
                Diagnostic::new(sphere.span(), "the last number of a sphere is not above 0")
                    .label(written)
                    .help(meaning),
            );
        }
        spheres.iter().map(|sphere| sphere.get_ref().0).collect()
    }
}

/// What a sphere of a blend is, and of a union.
const SCALE: [&str; 2] = ["[x, y, z, a]", "the sphere's radius is `radius` divided by a"];
const RADIUS: [&str; 2] = ["[x, y, z, radius]", "the last number is the sphere's radius"];

/// F with the sign that the file asks for, or the usual one, turned to negative inside.
fn turned(expr: Expr, spec: &SurfaceSpec, usual: Inside) -> Expr {
    match spec.inside.as_ref().map_or(usual, |inside| *inside.get_ref()) {
        Inside::Negative => expr,
        Inside::Positive => expr.negated(),
    }
}
