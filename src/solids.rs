//! Solids of a scene that are given by samples, made ready to be drawn and to become meshes.

use crate::{
    Error, Result,
    limits::Memory,
    progress::Progress,
    raster,
    scene::{Scene, Shape, Solid},
    statistics,
};

/// What the solids of a scene are like in it, in their order.
///
/// # Errors
/// [`Error::Limit`] if their octrees do not fit beside the picture; [`Error::Interrupted`] if `progress`
/// asks to stop.
pub(crate) fn shapes<'a>(
    scene: &'a Scene,
    memory: &Memory,
    progress: &dyn Progress,
) -> Result<Vec<Shape<'a>>> {
    memory.check_solids(scene.solids.iter().map(Solid::bytes).sum(), &scene.image)?;
    let shape = |solid: &'a Solid| solid.at(scene.time, progress).ok_or(Error::Interrupted);
    scene.solids.iter().map(shape).collect()
}

/// The solids of a scene as they are drawn, and their shapes, in order.
///
/// # Errors
/// [`Error::Interrupted`] if `progress` asks to stop.
pub(crate) fn drawn<'a>(
    scene: &Scene,
    shapes: &'a [Shape<'a>],
    progress: &dyn Progress,
) -> Result<Vec<raster::Solid<'a>>> {
    if shapes.is_empty() {
        return Ok(Vec::new());
    }
    progress.begin("build octrees", shapes.len() as u64, "solids");
    let solid = |(shape, solid): (&'a Shape<'a>, &Solid)| {
        if progress.is_cancelled() {
            return Err(Error::Interrupted);
        }
        let drawn = raster::Solid::new(shape.field(), solid.material);
        progress.advance(1);
        Ok(drawn)
    };
    let drawn = shapes.iter().zip(&*scene.solids).map(solid).collect();
    progress.end();
    drawn
}

/// What the octrees of solids of these shapes take.
pub(crate) fn statistics(scene: &Scene, shapes: &[Shape<'_>]) -> Vec<statistics::Solid> {
    let numbers = |(solid, shape): (&Solid, &Shape<'_>)| {
        let storage = shape.storage();
        statistics::Solid {
            name: solid.name.clone(),
            samples: shape.field().size(),
            nodes: storage.nodes,
            regions: storage.regions,
            bytes: storage.resident_bytes,
        }
    };
    scene.solids.iter().zip(shapes).map(numbers).collect()
}

/// Says which solid there is nothing of.
pub(crate) fn nothing_of(scene: &Scene, drawn: &[raster::Solid<'_>]) -> Option<Error> {
    let (solid, _) = scene.solids.iter().zip(drawn).find(|(_, drawn)| drawn.is_empty())?;
    Some(Error::Empty(format!(
        "nothing is left of `{}`: none of its samples is inside, or all are",
        solid.name
    )))
}
