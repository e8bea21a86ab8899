//! From the bytes of a file to samples: as many as the header says, or a refusal.
//!
//! No more memory is taken than the file can fill: plain bytes are counted before the first one is
//! read, and packed bytes cannot unpack to more than a thousand times as many. A volume that the machine
//! cannot hold is not begun.

use std::{
    fs::File,
    io::{self, BufReader, Read, Seek as _, SeekFrom},
};

use flate2::read::{MultiGzDecoder, ZlibDecoder};

use super::{Refusal, SampleType, Samples, room::check_room, times, with_room};

/// Which byte of a number comes first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ByteOrder {
    /// The least significant one, as on x86 and ARM.
    #[default]
    Little,
    /// The most significant one.
    Big,
}

/// How the bytes of samples are packed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Packing {
    Plain,
    Gzip,
    Zlib,
    /// Decimal numbers between white space.
    Text,
}

/// Where samples stand in a file.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stored {
    pub(super) size: [u32; 3],
    pub(super) sample_type: SampleType,
    pub(super) byte_order: ByteOrder,
    pub(super) packing: Packing,
    /// Bytes of the file before those that are packed.
    pub(super) start: u64,
    /// Unpacked bytes before the samples.
    pub(super) skip: u64,
}

/// Why samples cannot be had.
#[derive(Debug)]
pub(super) enum Failure {
    /// There are so many bytes of samples instead.
    Length(u64),
    /// There are more, and nobody counts them.
    TooLong,
    /// Anything else, in words.
    Other(Refusal),
}

/// What one packed byte becomes at most: deflate makes 258 of two bits.
const MAX_RATIO: u64 = 1032;

/// The bytes that are looked at together; a multiple of every sample's.
const CHUNK: usize = 1 << 16;

impl Stored {
    /// How many samples there are; sizes have been checked.
    pub(super) fn n_samples(&self) -> u64 {
        self.size.iter().map(|&n| u64::from(n)).product()
    }

    /// The bytes that all samples take, unpacked.
    pub(super) fn n_bytes(&self) -> u64 {
        self.n_samples() * self.sample_type.n_bytes()
    }

    /// The samples in `file`, which is `length` bytes long; they and their octree may take `max_memory`
    /// bytes.
    pub(super) fn read(
        &self,
        (mut file, length): (File, u64),
        max_memory: Option<u64>,
    ) -> Result<Samples, Failure> {
        check_room(self.size, self.sample_type, max_memory).map_err(Failure::Other)?;
        let packed = length.saturating_sub(self.start);
        file.seek(SeekFrom::Start(self.start)).map_err(failed)?;
        let file = BufReader::with_capacity(CHUNK, file);
        let (mut bytes, at_most): (Box<dyn Read>, u64) = match self.packing {
            Packing::Plain => (Box::new(file), packed),
            Packing::Gzip => (Box::new(MultiGzDecoder::new(file)), ratio(packed)),
            Packing::Zlib => (Box::new(ZlibDecoder::new(file)), ratio(packed)),
            Packing::Text => return super::text::samples(file, packed, self),
        };
        let held = at_most.saturating_sub(self.skip);
        if self.packing == Packing::Plain && held != self.n_bytes() {
            return Err(Failure::Length(held));
        }
        let skipped = io::copy(&mut bytes.by_ref().take(self.skip), &mut io::sink());
        if skipped.map_err(failed)? < self.skip {
            return Err(Failure::Length(0));
        }
        self.decode(&mut bytes, held)
    }

    /// As [`Stored::read`], with the words for what a header tells wrong.
    pub(super) fn samples(
        &self,
        file: (File, u64),
        max_memory: Option<u64>,
    ) -> Result<Samples, Refusal> {
        self.read(file, max_memory).map_err(|failure| failure.words(self))
    }

    /// The samples that `bytes` consists of, of which there are not more than `at_most`.
    fn decode(&self, bytes: &mut dyn Read, at_most: u64) -> Result<Samples, Failure> {
        let n = (self.n_samples(), at_most);
        macro_rules! decode {
            ($number:ty, $then:expr) => {
                match self.byte_order {
                    ByteOrder::Little => collect(bytes, n, |b| $then(<$number>::from_le_bytes(b)))?,
                    ByteOrder::Big => collect(bytes, n, |b| $then(<$number>::from_be_bytes(b)))?,
                }
            };
        }
        let same = std::convert::identity;
        Ok(match self.sample_type {
            SampleType::U8 => Samples::U8(decode!(u8, same)),
            SampleType::I8 => Samples::I8(decode!(i8, |v| v)),
            SampleType::U16 => Samples::U16(decode!(u16, |v| v)),
            SampleType::I16 => Samples::I16(decode!(i16, |v| v)),
            SampleType::U32 => Samples::U32(decode!(u32, |v| v)),
            SampleType::I32 => Samples::I32(decode!(i32, |v| v)),
            SampleType::F32 => Samples::F32(decode!(f32, |v| v)),
            SampleType::F64 => Samples::F32(decode!(f64, |v| v as f32)),
        })
    }
}

/// `n` samples of `N` bytes each, and nothing after them.
fn collect<T, const N: usize>(
    bytes: &mut dyn Read,
    (n, at_most): (u64, u64),
    decode: impl Fn([u8; N]) -> T,
) -> Result<Vec<T>, Failure> {
    // Sizes have been checked, so that the number fits.
    let room = n.min(at_most / N as u64) as usize;
    let mut samples = with_room(room, "samples").map_err(Failure::Other)?;
    let mut chunk = vec![0; CHUNK];
    let mut left = n * N as u64;
    while left > 0 {
        let wanted = left.min(CHUNK as u64) as usize;
        let found = fill(bytes, &mut chunk[..wanted]).map_err(failed)?;
        samples.extend(chunk[..found].as_chunks().0.iter().map(|&b| decode(b)));
        left -= found as u64;
        if found < wanted {
            return Err(Failure::Length(n * N as u64 - left));
        }
    }
    match fill(bytes, &mut chunk[..1]).map_err(failed)? {
        0 => Ok(samples),
        _ => Err(Failure::TooLong),
    }
}

/// Reads until `buffer` is full or the bytes end, and tells how many there were.
fn fill(bytes: &mut dyn Read, buffer: &mut [u8]) -> io::Result<usize> {
    let mut found = 0;
    while found < buffer.len() {
        match bytes.read(&mut buffer[found..]) {
            Ok(0) => break,
            Ok(n) => found += n,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    Ok(found)
}

/// The first bytes of a file, unpacked if they are packed with gzip: `n`, or as many as there are.
pub(super) fn head(file: File, packing: Packing, n: usize) -> Result<Vec<u8>, Refusal> {
    let mut bytes: Box<dyn Read> = match packing {
        Packing::Gzip => Box::new(MultiGzDecoder::new(file)),
        _ => Box::new(file),
    };
    let mut buffer = vec![0; n];
    let found = fill(&mut bytes, &mut buffer).map_err(|error| unreadable(&error))?;
    buffer.truncate(found);
    Ok(buffer)
}

/// The most bytes that `packed` bytes become.
pub(super) fn ratio(packed: u64) -> u64 {
    packed.saturating_mul(MAX_RATIO)
}

pub(super) fn failed(error: io::Error) -> Failure {
    Failure::Other(unreadable(&error))
}

fn unreadable(error: &io::Error) -> Refusal {
    format!("its samples cannot be read: {error}")
}

impl Failure {
    /// What to say where a header tells how the samples are `stored`.
    pub(super) fn words(self, stored: &Stored) -> Refusal {
        let size = times(stored.size.map(u64::from));
        let (kind, wanted) = (stored.sample_type, stored.n_bytes());
        match self {
            Self::Length(found) => {
                format!("it holds {found} bytes of samples, and {size} of {kind} are {wanted}")
            }
            Self::TooLong => {
                format!(
                    "it holds more bytes of samples than the {wanted} that {size} of {kind} are"
                )
            }
            Self::Other(words) => words,
        }
    }
}
