//! A picture in a few lines: what reference pictures keep of the layers that are too large to keep.
//!
//! The hashes are taken over the exact bits, so equal digests mean equal pictures.

use std::{fmt, hash::Hasher};

use siphasher::sip128::{Hasher128, SipHasher13};

use super::Frame;

/// Range and hash of one plane of numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneDigest {
    /// Smallest and largest number among the pixels that show a surface; both 0 if none does.
    pub range: [f32; 2],
    /// SipHash-1-3 with 128 bits and zero keys, over the numbers' bits, background included.
    pub hash: u128,
}

/// What is kept of a [`Frame`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameDigest {
    /// Width and height in pixels.
    pub size_px: [u32; 2],
    /// Number of pixels that show a surface.
    pub n_covered: usize,
    /// Of [`Frame::rgba`].
    pub rgba: PlaneDigest,
    /// Of [`Frame::depth`].
    pub depth: PlaneDigest,
    /// Of [`Frame::normal`].
    pub normal: PlaneDigest,
    /// Of [`Frame::position`].
    pub position: PlaneDigest,
    /// Of [`Frame::surface`].
    pub surface: PlaneDigest,
    /// Of [`Frame::curvature`].
    pub curvature: PlaneDigest,
    /// Of [`Frame::certificate`].
    pub certificate: PlaneDigest,
}

impl Frame {
    /// The picture in a few numbers, for comparison with another run's.
    #[must_use]
    pub fn digest(&self) -> FrameDigest {
        FrameDigest {
            size_px: [self.width, self.height],
            n_covered: self.depth.iter().filter(|&&d| d != Self::FAR).count(),
            rgba: self.plane(&self.rgba),
            depth: self.plane(single(&self.depth)),
            normal: self.plane(&self.normal),
            position: self.plane(&self.position),
            surface: self.plane(single(&self.surface)),
            curvature: self.plane(single(&self.curvature)),
            certificate: self.plane(single(&self.certificate)),
        }
    }

    fn plane<const N: usize>(&self, pixels: &[[f32; N]]) -> PlaneDigest {
        let mut hasher = SipHasher13::new();
        let mut range: Option<[f32; 2]> = None;
        for (pixel, &depth) in pixels.iter().zip(&self.depth) {
            for number in pixel {
                // The bytes in a fixed order: `write_u32` would take the machine's.
                hasher.write(&number.to_le_bytes());
                if depth != Self::FAR {
                    range = Some(range.map_or([*number; 2], |r| widened(r, *number)));
                }
            }
        }
        PlaneDigest { range: range.unwrap_or_default(), hash: hasher.finish128().as_u128() }
    }
}

/// A plane of one number a pixel.
fn single(plane: &[f32]) -> &[[f32; 1]] {
    plane.as_chunks().0
}

fn widened([lo, hi]: [f32; 2], x: f32) -> [f32; 2] {
    [if x < lo { x } else { lo }, if x > hi { x } else { hi }]
}

impl fmt::Display for FrameDigest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [width, height] = self.size_px;
        writeln!(f, "size {width} {height}")?;
        writeln!(f, "covered {}", self.n_covered)?;
        for (name, plane) in [
            ("rgba", &self.rgba),
            ("depth", &self.depth),
            ("normal", &self.normal),
            ("position", &self.position),
            ("surface", &self.surface),
            ("curvature", &self.curvature),
            ("certificate", &self.certificate),
        ] {
            let ([lo, hi], hash) = (plane.range, plane.hash);
            writeln!(f, "{name} {lo:?} {hi:?} {hash:032x}")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tells_every_plane_apart_and_never_changes() {
        let mut frame = Frame::filled(2, 1, [0.0; 4]);
        let empty = frame.digest();
        assert_eq!((empty.n_covered, empty.depth.range), (0, [0.0; 2]));
        frame.depth[1] = 2.5;
        frame.normal[1] = [0.0, -1.0, 0.0];
        let digest = frame.digest();
        assert_eq!((digest.n_covered, digest.rgba.hash), (1, empty.rgba.hash));
        assert_ne!(digest.depth.hash, empty.depth.hash);
        assert_eq!((digest.depth.range, digest.normal.range), ([2.5; 2], [-1.0, 0.0]));
        assert_eq!(
            digest.to_string().lines().nth(3).unwrap_or_default(),
            "depth 2.5 2.5 c486f6106fdb035c7a581ed5f1a1ba53"
        );
    }
}
