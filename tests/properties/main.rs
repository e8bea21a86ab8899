//! What must hold whatever the numbers are: enclosures enclose, no voxel is lost, and the result
//! does not depend on the machine. A failure prints the case that failed, made small.

#![expect(clippy::unwrap_used, reason = "a test that cannot set up its case has failed")]

mod angles;
mod formulas;
mod intervals;
mod levels;
mod numbers;
mod precise;
mod slopes;
mod voxels;
