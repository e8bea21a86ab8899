//! How much memory the machine has, and how much this process has held.

use std::fs;

/// The part of the machine's memory that a run may take if the user does not say.
const SHARE: f64 = 0.75;

/// Bytes that a run may take if the user does not say; nothing where the system does not tell (all but
/// Linux).
#[must_use]
pub fn usual() -> Option<u64> {
    Some((1024.0 * SHARE * kibibytes("/proc/meminfo", "MemTotal:")? as f64) as u64)
}

/// The most memory this process has held; nothing where the system does not tell (all but Linux).
#[must_use]
pub fn peak_bytes() -> Option<u64> {
    Some(1024 * kibibytes("/proc/self/status", "VmHWM:")?)
}

/// In words.
#[must_use]
pub fn mebibytes(bytes: u64) -> String {
    format!("{} MiB", bytes >> 20)
}

/// The number behind `key` in one of the kernel's tables.
fn kibibytes(table: &str, key: &str) -> Option<u64> {
    let text = fs::read_to_string(table).ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix(key))?;
    line.trim().strip_suffix("kB")?.trim().parse().ok()
}
