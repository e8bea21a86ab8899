//! The values of one brick after the other, set out so that those of neighbours are found without search.

use super::{
    grid::{VOXELS, Voxels},
    halo::Halo,
};

/// See the file's text.
pub(super) struct Values<B: Voxels> {
    /// The number of the brick.
    brick: usize,
    all: Box<[B::Value; VOXELS]>,
}

impl<B: Voxels> Default for Values<B> {
    fn default() -> Self {
        Self { brick: usize::MAX, all: Box::new([B::Value::default(); VOXELS]) }
    }
}

impl<B: Voxels> Values<B> {
    /// How far those at a voxel of a brick and at the next one along an axis are above the isovalue; there
    /// must be one, and neither a phantom.
    #[inline]
    pub(super) fn along<const AXIS: usize>(
        &mut self,
        halo: &Halo<'_, B>,
        index: usize,
    ) -> [f32; 2] {
        let voxels = halo.voxels();
        if self.brick != halo.number() {
            self.brick = halo.number();
            voxels.values(&mut self.all);
        }
        let step = 1 << (3 * AXIS);
        let upper = match index >> (3 * AXIS) & 7 {
            7 => halo.voxels_after::<AXIS>().offset(index - 7 * step),
            _ => voxels.offset_of(self.all[index + step]),
        };
        [voxels.offset_of(self.all[index]), upper]
    }
}
