//! What the search knows of an octant, and of the eight children of one.

/// What a closer look found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Finding {
    /// Not decided.
    Candidate,
    /// The surface provably passes through.
    Certified,
    /// No surface, and F > 0 or undefined.
    Empty,
    /// No surface, and F < 0 where it is defined.
    Inside,
}

/// Along which axes F falls in an octant in which it is continuous and monotone along all three:
/// then its range is that between two opposite corners.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Trend(u8);

impl Trend {
    /// Not known to be monotone.
    pub(super) const UNKNOWN: Self = Self(u8::MAX);

    /// From the axes on which F is known not to fall, and not to rise.
    pub(super) fn new(rising: [bool; 3], falling: [bool; 3]) -> Self {
        let mut falls = 0;
        for axis in 0..3 {
            match (rising[axis], falling[axis]) {
                (true, _) => {}
                (false, true) => falls |= 1 << axis,
                (false, false) => return Self::UNKNOWN,
            }
        }
        Self(falls)
    }

    pub(super) fn is_known(self) -> bool {
        self != Self::UNKNOWN
    }

    /// Steps from the first corner of an octant of the given edge to the one where F is least.
    #[inline(always)]
    pub(super) fn to_least(self, edge: u32) -> [u32; 3] {
        [0, 1, 2].map(|axis| edge * u32::from(self.0 >> axis & 1))
    }

    /// Steps from the first corner of an octant of the given edge to the one where F is largest.
    #[inline(always)]
    pub(super) fn to_most(self, edge: u32) -> [u32; 3] {
        [0, 1, 2].map(|axis| edge * u32::from(!self.0 >> axis & 1))
    }
}

/// What became of the eight children of a node; bit c is child c.
#[derive(Clone, Copy)]
pub(super) struct Family {
    /// The surface may pass through.
    pub(super) mixed: u8,
    /// F < 0.
    pub(super) inside: u8,
    /// F is continuous, and the tape's region holds the child.
    pub(super) regular: u8,
}

impl Family {
    /// Nothing found yet.
    pub(super) const EMPTY: Self = Self { mixed: 0, inside: 0, regular: 0 };

    /// Child `c` was found to have no surface.
    pub(super) fn drop(&mut self, c: u32, is_inside: bool) {
        self.mixed &= !(1 << c);
        self.inside |= u8::from(is_inside) << c;
    }
}
