//! Solids that are given by samples: volumes at an isovalue, and sculptures.

use std::sync::Arc;

use super::sculpture::{Carved, Carving};
use crate::{
    hrb::Storage,
    isosurface::Isosurface,
    math::Aabb,
    mesh::Mesh,
    progress::Progress,
    raster::{Field, Material},
    sculpt::Felt,
};

/// A solid of a scene and how it looks.
#[derive(Debug)]
pub struct Solid {
    /// For messages and statistics.
    pub name: String,
    /// How it looks.
    pub material: Material,
    /// What it is made of.
    pub origin: Origin,
}

/// Where samples come from.
#[derive(Debug)]
pub enum Origin {
    /// From a file.
    Volume(Box<Isosurface>),
    /// From tools.
    Sculpture(Carving),
}

/// What a solid is like at some time.
#[derive(Debug)]
pub enum Shape<'a> {
    /// A volume, always the same.
    Volume(&'a Isosurface),
    /// A sculpture, as far as the work on it is done.
    Sculpture(Arc<Carved>),
}

impl Solid {
    /// What it is like when this part of the work on it is done, from 0 to 1; `None` if `progress` asks to
    /// stop.
    #[must_use]
    pub fn at(&self, time: f64, progress: &dyn Progress) -> Option<Shape<'_>> {
        Some(match &self.origin {
            Origin::Volume(isosurface) => Shape::Volume(isosurface),
            Origin::Sculpture(carving) => Shape::Sculpture(carving.at(time, progress)?),
        })
    }

    /// The box of all its samples.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        match &self.origin {
            Origin::Volume(isosurface) => isosurface.volume().bounds(),
            Origin::Sculpture(carving) => carving.bounds(),
        }
    }

    /// The bytes that its samples and their octree take, at most.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        match &self.origin {
            Origin::Volume(isosurface) => isosurface.volume().bytes_with_octree(),
            Origin::Sculpture(carving) => carving.bytes(),
        }
    }
}

impl Shape<'_> {
    /// What is drawn.
    #[must_use]
    pub fn field(&self) -> &dyn Field {
        match self {
            Self::Volume(isosurface) => *isosurface,
            Self::Sculpture(carved) => &**carved,
        }
    }

    /// The surface as triangles, in scene coordinates.
    #[must_use]
    pub fn mesh(&self) -> Mesh {
        match self {
            Self::Volume(isosurface) => isosurface.mesh(),
            Self::Sculpture(carved) => carved.mesh(),
        }
    }

    /// What its octree takes.
    #[must_use]
    pub fn storage(&self) -> Storage {
        match self {
            Self::Volume(isosurface) => isosurface.storage(),
            Self::Sculpture(carved) => carved.storage(),
        }
    }

    /// What hands have felt that pushed tools into it.
    #[must_use]
    pub fn felt(&self) -> &[Felt] {
        match self {
            Self::Volume(_) => &[],
            Self::Sculpture(carved) => carved.felt(),
        }
    }
}
