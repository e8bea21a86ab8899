//! Progress of many frames: which one is being made, how many there are in a second, and how long the
//! others will take.

use std::{fmt, time::Instant};

use crate::progress::Progress;

/// The frames of a run.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pace {
    /// When the first of them was begun.
    pub(super) start: Instant,
    /// How many are done.
    pub(super) n_done: u32,
    /// How many are left, with the one that is being made.
    pub(super) n_left: u32,
}

/// ` (2.5/s, 40 s to go)`, once a frame is done.
impl fmt::Display for Pace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let elapsed = self.start.elapsed().as_secs_f64();
        if self.n_done == 0 || elapsed == 0.0 {
            return Ok(());
        }
        let rate = f64::from(self.n_done) / elapsed;
        let seconds = (f64::from(self.n_left) / rate).ceil();
        write!(f, " ({rate:.1}/s, ")?;
        match seconds {
            ..120.0 => write!(f, "{seconds} s to go)"),
            ..7200.0 => write!(f, "{:.0} min to go)", seconds / 60.0),
            _ => write!(f, "{:.0} h to go)", seconds / 3600.0),
        }
    }
}

/// The progress of one frame, which says which one it is.
pub(super) struct Watched<'a> {
    pub(super) progress: &'a dyn Progress,
    /// Which one.
    pub(super) frame: String,
}

impl Progress for Watched<'_> {
    fn begin(&self, stage: &str, total: u64, unit: &str) {
        self.progress.begin(&format!("{}: {stage}", self.frame), total, unit);
    }

    fn advance(&self, units: u64) {
        self.progress.advance(units);
    }

    fn end(&self) {
        self.progress.end();
    }

    fn is_cancelled(&self) -> bool {
        self.progress.is_cancelled()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn what_is_left_is_estimated() {
        let pace = |seconds, n_done, n_left| {
            let start = Instant::now() - Duration::from_secs_f64(seconds);
            Pace { start, n_done, n_left }.to_string()
        };
        assert_eq!(pace(7.0, 0, 5), "");
        assert_eq!(pace(8.0, 4, 9), " (0.5/s, 19 s to go)");
        assert_eq!(pace(1.0, 10, 3000), " (10.0/s, 5 min to go)");
        assert_eq!(pace(50.0, 5, 3600), " (0.1/s, 10 h to go)");
    }
}
