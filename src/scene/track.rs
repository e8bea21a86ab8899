//! Parameters that differ from frame to frame.

use std::{collections::HashSet, ops::Range};

use super::{formula::Formula, lower::Lower};
use crate::expr::{Ast, Node, Resolved};

/// A parameter with its value in each frame.
#[derive(Clone, Debug)]
pub(super) struct Track {
    pub(super) name: String,
    /// The section that says so.
    pub(super) section: &'static str,
    /// One for each frame, at least one.
    pub(super) values: Vec<f64>,
    /// Where they are written.
    pub(super) span: Range<usize>,
}

impl Track {
    /// The same as it would stand in `[params]`, in a frame that counts from 0.
    pub(super) fn formula(&self, frame: u32, source: &str) -> Formula {
        Formula::of_number(&self.values[frame as usize].to_string(), self.span.clone(), source)
    }
}

impl Lower<'_> {
    /// What a formula means that is the same in all frames, or a complaint.
    pub(super) fn resolve_once(&mut self, formula: &Formula) -> Option<Resolved> {
        let ast = self.parse(formula)?;
        if let Some(Track { name, section, .. }) = self.track_in(&ast) {
            let mistake = formula
                .mistake(format!("the sculpture does not change with `{name}`"))
                .label("is read once, for all frames")
                .help(format!("`{name}` changes in {section}: use another parameter here"));
            self.errors.push(mistake);
            return None;
        }
        self.resolve(formula)
    }

    /// A parameter that changes from frame to frame and on which a formula depends.
    fn track_in(&self, ast: &Ast) -> Option<&Track> {
        let mut open = vec![ast];
        let mut seen = HashSet::new();
        while let Some(ast) = open.pop() {
            for (node, _) in &ast.nodes {
                let Node::Name(name) = node else { continue };
                if let Some(track) = self.tracks.iter().find(|track| track.name == *name) {
                    return Some(track);
                }
                if seen.insert(name) {
                    let of_name = self.definitions.iter().filter(|known| known.name == *name);
                    open.extend(of_name.map(|known| &known.ast));
                }
            }
        }
        None
    }
}
