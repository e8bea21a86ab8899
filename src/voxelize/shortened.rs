//! Shortened tapes, each made once in a subtree: neighbours on both sides of a seam come back to the
//! same few outcomes again and again.

use std::sync::Arc;

use rustc_hash::FxHashMap;

use crate::expr::{Choice, Tape};

/// The address of the tape that is shortened, and the outcome, as bytes, which are hashed eight at
/// a time.
type Key = (usize, Vec<u8>);

/// A tape, kept alive so that its address stays its own, and what it was shortened to.
type Shortened = (Arc<Tape>, Arc<Tape>);

/// The tapes made so far.
#[derive(Default)]
pub(super) struct ShortenedTapes {
    made: FxHashMap<Key, Shortened>,
}

impl ShortenedTapes {
    /// `tape` where its choices went as given.
    pub(super) fn shortened(&mut self, tape: &Arc<Tape>, choices: &[Choice]) -> Arc<Tape> {
        if choices.iter().all(|&choice| choice == Choice::Both) {
            return tape.clone();
        }
        let outcome = choices.iter().map(|&choice| choice as u8).collect();
        let key = (Arc::as_ptr(tape) as usize, outcome);
        let make = || (tape.clone(), Arc::new(tape.shortened(choices.iter().copied())));
        let (_, shortened) = self.made.entry(key).or_insert_with(make);
        shortened.clone()
    }

    /// Starts anew.
    pub(super) fn forget(&mut self) {
        self.made.clear();
    }
}
