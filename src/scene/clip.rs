//! Clipping: which part of a surface is kept, and whether cuts are closed.

use super::{
    lower::Lower,
    spanned::Spanned,
    spec::{DomainSpec, Section, SurfaceSpec},
};
use crate::{
    diagnostic::Diagnostic,
    expr::{Expr, Relation},
};

/// What `[domain]` says about all surfaces.
pub(super) struct Clip {
    /// Not positive in what is kept.
    region: Option<Expr>,
    /// Whether the section has `clip`, well-formed or not.
    is_given: bool,
    is_capped: bool,
}

impl Lower<'_> {
    /// The clip of all surfaces.
    pub(super) fn clip(&mut self, section: &Section<DomainSpec>) -> Clip {
        let spec = &section.spec;
        let region = spec.clip.as_ref().and_then(|clip| self.region(clip));
        let is_given = spec.clip.is_some() || section.is_damaged;
        self.cap_needs_clip(spec.cap.as_ref(), is_given);
        let is_capped = spec.cap.as_ref().is_some_and(|cap| *cap.get_ref());
        Clip { region, is_given, is_capped }
    }

    /// Cuts a surface by its own clip and that of all; F is negative inside.
    pub(super) fn clipped(
        &mut self,
        expr: Expr,
        section: &Section<SurfaceSpec>,
        common: &Clip,
    ) -> Expr {
        let spec = &section.spec;
        let own = spec.clip.as_ref().and_then(|clip| self.region(clip));
        let is_given = common.is_given || spec.clip.is_some() || section.is_damaged;
        self.cap_needs_clip(spec.cap.as_ref(), is_given);
        let is_capped = spec.cap.as_ref().map_or(common.is_capped, |cap| *cap.get_ref());
        let regions = own.iter().chain(&common.region);
        regions.fold(expr, |expr, region| match is_capped {
            true => expr.intersected(region),
            false => expr.clipped(region),
        })
    }

    fn region(&mut self, clip: &Spanned<String>) -> Option<Expr> {
        let formula = self.formula(clip);
        let resolved = self.resolve(&formula)?;
        let help = match resolved.relation {
            Relation::Solid => return Some(resolved.expr),
            Relation::Equation => "write `<=` or `>=` in place of `=`",
            Relation::Value => "compare it with something, as in x^2 + y^2 + z^2 <= 4",
        };
        let mistake = formula.mistake("`clip` must be an inequality");
        self.errors.push(mistake.label("does not say what is kept").help(help));
        None
    }

    fn cap_needs_clip(&mut self, cap: Option<&Spanned<bool>>, is_clipped: bool) {
        if let Some(cap) = cap
            && !is_clipped
        {
            self.errors.push(
                Diagnostic::new(cap.span(), "`cap` stands without `clip`")
                    .label("there is no cut to close")
                    .help("add what to keep, as in clip = \"x^2 + y^2 + z^2 <= 4\""),
            );
        }
    }
}
