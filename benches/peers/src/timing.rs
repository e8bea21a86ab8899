//! Times of pieces of work that take turns, so that what else the machine does meets all alike.

use std::time::{Duration, Instant};

/// Rounds at least and at most; between them, as many as the budget allows.
const ROUNDS: (usize, usize) = (5, 15);
const BUDGET: Duration = Duration::from_secs(20);

/// Runs all pieces in turn, again and again, and returns the seconds of each piece, round by round.
/// Every other round goes backwards, so that none always follows the same other one.
pub fn take_turns<const N: usize>(work: [&mut dyn FnMut() -> Duration; N]) -> [Vec<f64>; N] {
    let mut times = [const { Vec::new() }; N];
    let start = Instant::now();
    for round in 0..ROUNDS.1 {
        if round >= ROUNDS.0 && start.elapsed() > BUDGET {
            break;
        }
        for turn in 0..N {
            let i = if round % 2 == 0 { turn } else { N - 1 - turn };
            times[i].push(work[i]().as_secs_f64());
        }
    }
    times
}

/// The time that `work` takes; what it returns is dropped later.
pub fn time<T>(work: impl FnOnce() -> T) -> Duration {
    let start = Instant::now();
    let result = work();
    let time = start.elapsed();
    drop(std::hint::black_box(result));
    time
}

/// The middle one.
pub fn median(times: &[f64]) -> f64 {
    let mut sorted = times.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted[sorted.len() / 2]
}
