//! OpenEXR: linear light and all layers, for compositing.
//!
//! One part with the channels R G B A (half, premultiplied), `Depth.Z`, `Normal.X Y Z`,
//! `Position.X Y Z`, `Surface.X`, `Curvature.X` and `Certificate.X` (float), which compositors group
//! by the name before the dot; or R G B A alone. ZIP compression:
//! lossless, and the same bytes in every run, since the blocks are stored in order.
//!
//! *Based on:* "OpenEXR File Layout" and "Technical Introduction to OpenEXR", openexr.com.

use std::io::{Read, Seek, Write};

use exr::meta::attribute::AttributeValue;
use exr::prelude::{
    AnyChannel, AnyChannels, Blocks, Compression, Encoding, Error, FlatSamples, Image, Layer,
    LayerAttributes, LineOrder, ReadChannels, ReadLayers, Text, Vec2, WritableImage, f16, read,
};

use super::{SOFTWARE, WriteError};
use crate::raster::Frame;

/// What the file says besides the picture.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ExrOptions {
    /// Whether only colour and alpha are written: a file with more is no texture to Blender.
    pub is_plain: bool,
    /// The scene's name, stored as the attribute `scene`.
    pub scene: String,
}

/// Writes all layers of `frame`.
///
/// # Errors
/// If `out` fails, or the picture is empty.
pub fn write(
    frame: &Frame,
    options: &ExrOptions,
    out: impl Write + Seek,
) -> Result<(), WriteError> {
    // UTF-8 as it is; `Text::from` would panic at a letter beyond Latin-1.
    let scene = Text::from_slice_unchecked(options.scene.as_bytes());
    let attributes = LayerAttributes {
        software_name: Some(SOFTWARE.into()),
        other: [("scene".into(), AttributeValue::Text(scene))].into(),
        ..LayerAttributes::default()
    };
    let encoding = Encoding {
        compression: Compression::ZIP16,
        blocks: Blocks::ScanLines,
        line_order: LineOrder::Increasing,
    };
    let size = (frame.width as usize, frame.height as usize);
    if size.0 == 0 || size.1 == 0 {
        return Err(WriteError::Encode("the picture has no pixels".into()));
    }
    let layer = Layer::new(size, attributes, encoding, channels(frame, options.is_plain));
    Ok(Image::from_layer(layer).write().to_buffered(out)?)
}

fn channels(frame: &Frame, is_plain: bool) -> AnyChannels<FlatSamples> {
    let mut list = planes(["R", "G", "B", "A"], &frame.rgba, |samples| {
        FlatSamples::F16(samples.map(f16::from_f32).collect())
    });
    if is_plain {
        return AnyChannels::sort(list.into());
    }
    for (name, plane) in [
        ("Depth.Z", &frame.depth),
        ("Surface.X", &frame.surface),
        ("Curvature.X", &frame.curvature),
        ("Certificate.X", &frame.certificate),
    ] {
        list.push(AnyChannel::new(name, FlatSamples::F32(plane.clone())));
    }
    for (names, pixels) in [
        (["Normal.X", "Normal.Y", "Normal.Z"], &frame.normal),
        (["Position.X", "Position.Y", "Position.Z"], &frame.position),
    ] {
        list.extend(planes(names, pixels, |samples| FlatSamples::F32(samples.collect())));
    }
    AnyChannels::sort(list.into())
}

/// Takes the pixels' components apart, one channel each.
fn planes<const N: usize>(
    names: [&str; N],
    pixels: &[[f32; N]],
    samples: impl Fn(&mut dyn Iterator<Item = f32>) -> FlatSamples,
) -> Vec<AnyChannel<FlatSamples>> {
    let plane = |k: usize| samples(&mut pixels.iter().map(move |pixel| pixel[k]));
    (0..N).map(|k| AnyChannel::new(names[k], plane(k))).collect()
}

/// Reads back what [`write()`] wrote. Colours come back rounded to half precision.
///
/// # Errors
/// If `input` fails, is no OpenEXR file, or lacks a channel.
pub fn read_frame(input: impl Read + Seek) -> Result<Frame, WriteError> {
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .from_buffered(input)?;
    let layer = image.layer_data;
    let channel = |name: &str| -> Result<Vec<f32>, WriteError> {
        let found = layer.channel_data.list.iter().find(|channel| channel.name.eq(name));
        let channel = found.ok_or_else(|| WriteError::Encode(format!("no channel {name}")))?;
        Ok(channel.sample_data.values_as_f32().collect())
    };
    let Vec2(width, height) = layer.size;
    let mut frame = Frame::filled(width as u32, height as u32, [0.0; 4]);
    frame.depth = channel("Depth.Z")?;
    frame.surface = channel("Surface.X")?;
    frame.curvature = channel("Curvature.X")?;
    frame.certificate = channel("Certificate.X")?;
    for (k, name) in ["R", "G", "B", "A"].into_iter().enumerate() {
        fill(&mut frame.rgba, k, &channel(name)?);
    }
    for (k, axis) in ["X", "Y", "Z"].into_iter().enumerate() {
        fill(&mut frame.normal, k, &channel(&format!("Normal.{axis}"))?);
        fill(&mut frame.position, k, &channel(&format!("Position.{axis}"))?);
    }
    Ok(frame)
}

fn fill<const N: usize>(pixels: &mut [[f32; N]], k: usize, samples: &[f32]) {
    for (pixel, &sample) in pixels.iter_mut().zip(samples) {
        pixel[k] = sample;
    }
}

impl From<Error> for WriteError {
    fn from(error: Error) -> Self {
        match error {
            Error::Io(error) => Self::Io(error),
            other => Self::Encode(other.to_string()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Cursor;

    fn picture() -> Frame {
        let mut frame = Frame::filled(37, 41, [0.0; 4]);
        for i in (0..frame.depth.len()).step_by(3) {
            let x = i as f32;
            frame.rgba[i] = [x, 0.5 * x, 0.25, 1.0];
            frame.depth[i] = 1.0 + x / 3.0;
            frame.normal[i] = [0.6, -0.8, 1e-9 * x];
            frame.position[i] = [x / 7.0, -x, f32::MIN_POSITIVE];
            frame.surface[i] = 1.0 + x;
            frame.curvature[i] = -x;
            frame.certificate[i] = 1.0;
        }
        frame
    }

    fn bytes(frame: &Frame) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        write(frame, &ExrOptions { scene: "球".into(), is_plain: false }, &mut bytes).unwrap();
        bytes.into_inner()
    }

    #[test]
    fn what_is_read_is_what_was_written() {
        let mut frame = picture();
        let read = read_frame(Cursor::new(bytes(&frame))).unwrap();
        for pixel in &mut frame.rgba {
            *pixel = pixel.map(|c| f16::from_f32(c).to_f32());
        }
        assert_eq!(read, frame);
    }

    #[test]
    fn a_plain_file_has_four_channels() {
        let options = ExrOptions { is_plain: true, ..ExrOptions::default() };
        let mut bytes = Cursor::new(Vec::new());
        write(&picture(), &options, &mut bytes).unwrap();
        let bytes = bytes.into_inner();
        let has = |name: &[u8]| bytes.windows(name.len()).any(|w| w == name);
        assert!(has(b"A\0") && !has(b"Depth.Z") && !has(b"Curvature.X"));
    }

    #[test]
    fn bytes_repeat() {
        let frame = picture();
        let first = bytes(&frame);
        assert!((0..8).all(|_| bytes(&frame) == first));
        let names: [&[u8]; 3] = [b"scene\0string\0", "球".as_bytes(), SOFTWARE.as_bytes()];
        assert!(names.iter().all(|name| first.windows(name.len()).any(|w| w == *name)));
    }

    #[test]
    fn damage_and_emptiness_are_errors() {
        let mut damaged = bytes(&picture());
        damaged.truncate(damaged.len() / 2);
        assert!(read_frame(Cursor::new(damaged)).is_err());
        let none = Frame::filled(0, 5, [0.0; 4]);
        assert!(write(&none, &ExrOptions::default(), Cursor::new(Vec::new())).is_err());
    }
}
