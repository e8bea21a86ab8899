//! A box of bricks with something about each. Bricks are counted from one before the volume, as in
//! meshes, so that there is room for the layer around it.

use super::{Samples, join_around};
use crate::mesh::SIDE;

/// See the file's text.
#[derive(Clone, Debug)]
pub(crate) struct Window<T> {
    /// The place of the first brick.
    pub(super) first: [u32; 3],
    /// Bricks along each axis, x fastest.
    pub(super) n: [usize; 3],
    pub(super) all: Vec<T>,
}

impl<T: Copy> Window<T> {
    /// The bricks from `first` to before `end`, with the same about all.
    pub(super) fn new(first: [u32; 3], end: [u32; 3], one: T) -> Self {
        let n = [0, 1, 2].map(|axis| end[axis].saturating_sub(first[axis]) as usize);
        Self { first, n, all: vec![one; n.iter().product()] }
    }

    /// Behind the last brick, along each axis.
    pub(super) fn end(&self) -> [u32; 3] {
        [0, 1, 2].map(|axis| self.first[axis] + self.n[axis] as u32)
    }

    /// The number of a brick, if it is in the window.
    #[inline]
    pub(super) fn slot(&self, place: [u32; 3]) -> Option<usize> {
        let at = [0, 1, 2].map(|axis| place[axis].wrapping_sub(self.first[axis]) as usize);
        (0..3)
            .all(|axis| at[axis] < self.n[axis])
            .then(|| at[0] + self.n[0] * (at[1] + self.n[1] * at[2]))
    }

    /// The brick with a number.
    #[inline]
    pub(super) fn place(&self, slot: usize) -> [u32; 3] {
        let [nx, ny, _] = self.n;
        let at = [slot % nx, slot / nx % ny, slot / nx / ny];
        [0, 1, 2].map(|axis| self.first[axis] + at[axis] as u32)
    }

    /// All bricks, in order.
    pub(super) fn places(&self) -> impl Iterator<Item = [u32; 3]> + use<T> {
        let (first, end) = (self.first, self.end());
        (Samples { first, end }).iter()
    }

    /// Says one thing about the bricks from `first` to before `end`, as far as they are in the window.
    pub(super) fn fill(&mut self, first: [u32; 3], end: [u32; 3], one: T) {
        let whole = Samples { first: self.first, end: self.end() };
        let part = Samples { first, end }.and(&whole);
        let n = part.size()[0];
        for row in part.rows() {
            let start = whole.index(row);
            self.all[start..start + n].fill(one);
        }
    }
}

impl Window<u8> {
    /// Of every brick the bits that it has, or one of the 26 around.
    pub(super) fn spread(&self) -> Self {
        let mut spread = self.clone();
        join_around(&mut spread.all, self.n, |bits, beside| *bits |= beside);
        spread
    }
}

impl Window<bool> {
    /// The bricks that hold samples of some boxes. The layer around a volume counts with what has grown
    /// over its border, or up to its first sample.
    pub(crate) fn of(boxes: &[Samples]) -> Self {
        let places = |samples: &Samples| Samples {
            first: samples.first.map(|i| if i == 0 { 0 } else { i / SIDE + 1 }),
            end: samples.end.map(|i| i.div_ceil(SIDE) + 1),
        };
        let whole = boxes.iter().map(places).reduce(|a, b| a.with(&b)).unwrap_or(Samples::NONE);
        let mut window = Self::new(whole.first, whole.end, false);
        boxes.iter().map(places).for_each(|Samples { first, end }| window.fill(first, end, true));
        window
    }

    /// Their places, in order.
    pub(crate) fn chosen(&self) -> impl Iterator<Item = [u32; 3]> {
        self.places().zip(&self.all).filter_map(|(place, &is_in)| is_in.then_some(place))
    }
}
