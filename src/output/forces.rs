//! What hands have felt that pushed tools, as comma-separated values: a row for each moment.
//!
//! *Based on:* RFC 4180, 2005.

use std::io::Write;

use super::Written;
use crate::sculpt::Moment;

/// A tool's way into a sculpture.
#[derive(Clone, Copy, Debug)]
pub struct Push<'a> {
    /// The sculpture's name.
    pub sculpture: &'a str,
    /// Which of its strokes it is, from 1.
    pub stroke: usize,
    /// What happened.
    pub moments: &'a [Moment],
}

/// Writes all moments: of which sculpture, stroke, push of that stroke and number they are, how far the
/// hand and the tool are on their way, and the force.
///
/// # Errors
/// If `out` fails.
pub fn write(pushes: &[Push<'_>], mut out: impl Write) -> Written {
    writeln!(out, "sculpture,stroke,push,moment,hand,tool,force")?;
    for (i, push) in pushes.iter().enumerate() {
        let is_same =
            |other: &&Push<'_>| (other.sculpture, other.stroke) == (push.sculpture, push.stroke);
        let number = 1 + pushes[..i].iter().rev().take_while(is_same).count();
        let name = quoted(push.sculpture);
        for (moment, Moment { hand, tool, force }) in (1..).zip(push.moments) {
            writeln!(out, "{name},{},{number},{moment},{hand},{tool},{force}", push.stroke)?;
        }
    }
    Ok(())
}

/// A name as it is, or in quotation marks where it has to be.
fn quoted(name: &str) -> String {
    match name.contains([',', '"', '\n', '\r']) {
        true => format!("\"{}\"", name.replace('"', "\"\"")),
        false => name.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_moment_has_a_row() {
        let moments = [Moment { hand: 0.5, tool: 0.25, force: 2.0 }];
        let push = Push { sculpture: "a \"block\", cut", stroke: 2, moments: &moments };
        let mut text = Vec::new();
        write(&[push, push], &mut text).unwrap();
        let text = String::from_utf8(text).unwrap();
        let rows: Vec<&str> = text.lines().collect();
        assert_eq!(rows[0], "sculpture,stroke,push,moment,hand,tool,force");
        assert_eq!(rows[1], "\"a \"\"block\"\", cut\",2,1,1,0.5,0.25,2");
        assert_eq!(rows[2], "\"a \"\"block\"\", cut\",2,2,1,0.5,0.25,2");
    }
}
