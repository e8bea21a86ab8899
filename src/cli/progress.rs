//! The progress bar, and the interrupt.

use std::{
    fmt, process,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
};

use indicatif::{HumanCount, ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};

use crate::{Error, progress::Progress};

const BAR: &str = "{msg} [{wide_bar}] {human_pos}/{human_len} {prefix}, {rate}/s, {eta} to go";

/// How often the bar is drawn, per second.
const REFRESH_HZ: u8 = 10;

/// Draws progress on a terminal and learns of ctrl-c. Clones are the same bar.
#[derive(Clone)]
pub(super) struct Watch {
    bar: ProgressBar,
    is_cancelled: Arc<AtomicBool>,
}

impl Watch {
    /// Watches with a bar on standard error if `is_visible`. From now on the first interrupt asks
    /// the run to stop and a second one ends the process at once.
    pub(super) fn new(is_visible: bool) -> Self {
        let target = match is_visible {
            true => ProgressDrawTarget::stderr_with_hz(REFRESH_HZ),
            false => ProgressDrawTarget::hidden(),
        };
        let bar = ProgressBar::with_draw_target(None, target);
        let style = ProgressStyle::with_template(BAR);
        let style = style.unwrap_or_else(|_| ProgressStyle::default_bar());
        bar.set_style(style.with_key("rate", rate));
        let is_cancelled = Arc::new(AtomicBool::new(false));
        let flag = Arc::clone(&is_cancelled);
        let interrupted = move || {
            if flag.swap(true, Ordering::Relaxed) {
                process::exit(i32::from(Error::Interrupted.exit_code()));
            }
        };
        // Without a handler an interrupt ends the process as it always did, which is good enough.
        let _ = ctrlc::set_handler(interrupted);
        Self { bar, is_cancelled }
    }

    /// Takes the bar off the terminal, so that something can be printed.
    pub(super) fn clear(&self) {
        self.bar.finish_and_clear();
    }
}

/// Units per second, without the decimals of indicatif's own rate.
fn rate(state: &ProgressState, out: &mut dyn fmt::Write) {
    // A bar that cannot be drawn is no failure.
    let _ = write!(out, "{}", HumanCount(state.per_sec() as u64));
}

impl Progress for Watch {
    fn begin(&self, stage: &str, total: u64, unit: &str) {
        self.bar.set_message(stage.to_owned());
        self.bar.set_prefix(unit.to_owned());
        self.bar.set_length(total);
        self.bar.reset();
    }

    fn advance(&self, units: u64) {
        self.bar.inc(units);
    }

    fn end(&self) {
        self.clear();
    }

    fn is_cancelled(&self) -> bool {
        self.is_cancelled.load(Ordering::Relaxed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn template_is_valid() {
        assert!(ProgressStyle::with_template(BAR).is_ok());
    }
}
