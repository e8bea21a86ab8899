//! Samples written as decimal numbers.

use std::{
    io::{BufReader, Read as _},
    str::FromStr,
};

use super::{
    SampleType, Samples,
    bytes::{Failure, Stored, failed},
    with_room,
};

/// The longest text.
const MAX_BYTES: u64 = 1 << 30;

/// The samples in `text`, which is `length` bytes long.
pub(super) fn samples(
    mut text: BufReader<std::fs::File>,
    length: u64,
    stored: &Stored,
) -> Result<Samples, Failure> {
    if length > MAX_BYTES {
        return Err(Failure::Other(format!("its text is longer than {} MiB", MAX_BYTES >> 20)));
    }
    let mut bytes = Vec::new();
    text.by_ref().take(MAX_BYTES).read_to_end(&mut bytes).map_err(failed)?;
    let text = bytes.get(stored.skip as usize..).unwrap_or_default();
    let text = std::str::from_utf8(text)
        .map_err(|_| Failure::Other("its samples are not text".to_owned()))?;
    let n = stored.n_samples();
    Ok(match stored.sample_type {
        SampleType::U8 => Samples::U8(parse(text, n)?),
        SampleType::I8 => Samples::I8(parse(text, n)?),
        SampleType::U16 => Samples::U16(parse(text, n)?),
        SampleType::I16 => Samples::I16(parse(text, n)?),
        SampleType::U32 => Samples::U32(parse(text, n)?),
        SampleType::I32 => Samples::I32(parse(text, n)?),
        // Decimal numbers are rounded once.
        SampleType::F32 | SampleType::F64 => Samples::F32(parse(text, n)?),
    })
}

fn parse<T: FromStr>(text: &str, n: u64) -> Result<Vec<T>, Failure> {
    let found = text.split_ascii_whitespace().count() as u64;
    if found != n {
        return Err(Failure::Other(format!("it holds {found} numbers instead of {n}")));
    }
    let mut samples = with_room(n as usize, "samples").map_err(Failure::Other)?;
    for (i, word) in text.split_ascii_whitespace().enumerate() {
        let sample = word.parse().map_err(|_| {
            let kind = std::any::type_name::<T>();
            let word: String = word.chars().take(40).collect();
            Failure::Other(format!("sample {} is `{word}`, which is no {kind}", i + 1))
        })?;
        samples.push(sample);
    }
    Ok(samples)
}
