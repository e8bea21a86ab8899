//! Certified pictures of implicit surfaces: F(x, y, z) = 0 from a text file, without a window or a
//! GPU.
//!
//! The crate is a pipeline, and its modules are the stages. Data flows one way:
//!
//! | module | takes | gives |
//! |---|---|---|
//! | [`scene`] | a TOML file | a [`Scene`](scene::Scene), or every mistake in the file |
//! | [`expr`] | the text of a formula or a function graph | a [`Tape`](expr::Tape), a program over few slots |
//! | [`eval`] | tapes and boxes or points | enclosures, values, gradients, many at a time |
//! | [`voxelize()`] | a formula and a [`Lattice`](math::Lattice) | an octree of voxels with normals and certificates |
//! | [`raster`] | octrees and a [`Camera`](raster::Camera) | a [`Frame`](raster::Frame) |
//! | [`output`] | a frame, meshes | PNG and EXR; glTF, OBJ, PLY, STL and 3MF |
//!
//! [`pipeline`] puts them together, [`film`] repeats it for many frames of films and sweeps, and
//! [`gallery`] shows famous surfaces with it; [`import`] makes scene files of other programs' files;
//! [`cli`] is the command `render` around it.
//!
//! # From a formula to voxels
//!
//! A voxel is dropped only if interval arithmetic proves that F does not vanish in it, so what is
//! left out is certain:
//!
//! ```
//! use zeroset::{expr, math::{Aabb, Lattice}, octree::{Occupancy, Storage}};
//! use zeroset::{progress::Unwatched, voxelize, voxelize::Settings};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let ast = expr::parse("x^2 + y^2 + z^2 = 1").map_err(|mistakes| mistakes[0].message.clone())?;
//! let sphere = expr::Expr::resolve(&ast, &[]).map_err(|m| m[0].diagnostic.message.clone())?.expr;
//!
//! let domain = Aabb { min: [-2.0; 3].into(), max: [2.0; 3].into() };
//! let lattice = Lattice::new(domain, 64);
//! let found = voxelize(&sphere, &lattice, &Settings::default(), &Unwatched)?;
//!
//! assert_eq!(found.octree.occupancy([32, 32, 32]), Occupancy::Inside);
//! assert_eq!(found.octree.occupancy([47, 32, 32]), Occupancy::Surface);
//! assert_eq!(found.octree.occupancy([60, 32, 32]), Occupancy::Empty);
//! let rank = found.octree.find([47, 32, 32]).ok_or("the surface passes here")?;
//! assert!(found.octree.is_certified(rank));
//! assert!(found.octree.normal(rank).decode().x > 0.99);
//! # Ok(())
//! # }
//! ```
//!
//! # From a scene to a picture
//!
//! ```
//! use std::path::Path;
//! use zeroset::{pipeline, progress::Unwatched, scene};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let text = r#"
//!     version = 1
//!     [[surface]]
//!     f = "r = sin(3*theta) * sin(4*phi)"
//!     [voxels]
//!     resolution = 64
//!     [image]
//!     width = 64
//!     height = 64
//! "#;
//! let scene = scene::parse(Path::new("lobes.toml"), text)
//!     .map_err(|rejection| rejection.diagnostics[0].message.clone())?;
//! let options = pipeline::Options::default();
//! let picture = pipeline::render(&scene, &options, &Unwatched)?;
//! assert!(picture.statistics.voxels.stored > 10_000);
//! assert_eq!(picture.frame.rgba.len(), 64 * 64);
//! # Ok(())
//! # }
//! ```
//!
//! # What holds for every result
//!
//! - **No loss.** A voxel that the surface meets is stored, rounding included.
//! - **Determinism.** The same bits on any machine, with any number of threads, at any SIMD level.
//! - **Whole files.** A file is complete or not there.

pub mod advice;
pub mod cli;
pub mod diagnostic;
mod error;
pub mod eval;
pub mod evaluate;
pub mod expr;
pub mod files;
pub mod film;
pub mod gallery;
pub mod hrb;
pub mod import;
pub mod isosurface;
pub mod limits;
pub mod math;
pub mod memory;
pub mod mesh;
pub mod meshing;
pub mod octree;
pub mod output;
pub mod pipeline;
pub mod polygons;
pub mod progress;
pub mod raster;
pub mod scene;
pub mod sculpt;
mod solids;
pub mod statistics;
pub mod volume;
pub mod voxelize;
pub mod yields;

pub use error::{Error, Result};
pub use voxelize::voxelize;
