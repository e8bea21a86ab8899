//! Everything that is said to the user: mistakes, failures, summaries, statistics.
//!
//! Standard output carries statistics only, and only if they were asked for; all else goes to
//! standard error. Nobody can be told that standard error is closed, so that is ignored.

use std::{
    error::Error as _,
    fmt::Write as _,
    io::{self, IsTerminal, Write},
    ops::Range,
    path::{Path, PathBuf},
    time::Duration,
};

use annotate_snippets::{
    AnnotationKind, Group, Level, Renderer, Snippet, normalize_untrusted_str as clean,
};

use crate::{
    Error, Result,
    diagnostic::{Diagnostic, Sources},
    film,
    math::Aabb,
    scene::Scene,
};

/// So many mistakes of one file are shown; one who makes more wants to start with these.
const MAX_SHOWN: usize = 20;

/// Whether standard error is a terminal that can redraw a line.
pub(super) fn is_terminal() -> bool {
    io::stderr().is_terminal() && std::env::var_os("TERM").is_none_or(|term| term != "dumb")
}

/// Says why the scene at `path` was not rendered.
pub(super) fn failure(path: &Path, error: &Error) {
    let renderer = renderer();
    match error {
        Error::Scene(rejection) => {
            say(&excerpts(&Level::ERROR, &rejection.diagnostics, &rejection.sources, &renderer));
        }
        Error::Unknown(words) => say(&renderer.render(&[title(words)])),
        Error::Empty(_) | Error::Limit(_) => {
            say(&renderer.render(&[title(&format!("{}: {error}", path.display()))]));
        }
        _ => say(&renderer.render(&[title(&with_causes(error))])),
    }
}

/// Says what in a good scene is perhaps not meant.
pub(super) fn warnings(scene: &Scene) {
    if !scene.warnings.is_empty() {
        say(&excerpts(&Level::WARNING, &scene.warnings, &scene.sources, &renderer()));
    }
}

/// Says how the scene at `path` was understood, where it left that open.
pub(super) fn notes(path: &Path, notes: &[String]) {
    for note in notes {
        let text = format!("{}: {note}", path.display());
        say(&renderer().render(&[Group::with_title(Level::NOTE.primary_title(&text))]));
    }
}

/// The files of a picture, in words.
pub(super) fn files(written: &[PathBuf]) -> String {
    let files: Vec<_> = written.iter().map(|file| file.display().to_string()).collect();
    if files.is_empty() { "no files".to_owned() } else { files.join(", ") }
}

/// The files of a film or a sweep, in words.
pub(super) fn film(made: &film::Report) -> String {
    let film::Report { n_frames, written, together, .. } = made;
    let frames = if *n_frames == 1 { "1 frame" } else { &format!("{n_frames} frames") };
    let mut of_kinds: Vec<(&Path, &Path)> = Vec::new();
    for file in written {
        match of_kinds.iter_mut().find(|(first, _)| first.extension() == file.extension()) {
            Some((_, last)) => *last = file,
            None => of_kinds.push((file, file)),
        }
    }
    let span = |&(first, last): &(&Path, &Path)| match first == last {
        true => first.display().to_string(),
        false => format!("{} to {}", first.display(), last.display()),
    };
    let together = together.iter().map(|file| file.display().to_string());
    let files: Vec<String> = of_kinds.iter().map(span).chain(together).collect();
    match files.as_slice() {
        [] => format!("{frames} and no files"),
        files => format!("{frames}: {}", files.join(", ")),
    }
}

/// Says what was made of the scene at `path`: the files, in words.
pub(super) fn summary(path: &Path, written: &str, time: Duration) {
    say(&format!("{}: wrote {written} in {:.2} s", path.display(), time.as_secs_f64()));
}

/// Says where the report of an evaluation is, the first of its files.
pub(super) fn evaluated(written: &[PathBuf], time: Duration) {
    if let [first, others @ ..] = written {
        let (n, seconds) = (others.len(), time.as_secs_f64());
        say(&format!("wrote {} and {n} files beside it in {seconds:.2} s", first.display()));
    }
}

/// Says that nothing is wrong with the scene at `path`, and what it asks for.
pub(super) fn fine(path: &Path, scene: &Scene) {
    let surfaces = match scene.surfaces.len() + scene.solids.len() {
        1 => "1 surface".to_owned(),
        n => format!("{n} surfaces"),
    };
    let domain = scene.domain.map_or("a box to be found".to_owned(), |Aabb { min, max }| {
        format!("the box from {min} to {max}")
    });
    let image = &scene.image;
    let resolution = if scene.is_auto {
        "as fine as the picture".to_owned()
    } else {
        scene.resolution.to_string()
    };
    let frames = match scene.n_frames() {
        0 => String::new(),
        1 => ", 1 frame".to_owned(),
        n => format!(", {n} frames"),
    };
    say(&format!(
        "{}: fine: {surfaces} in {domain}, resolution {resolution}, {} x {} pixels{frames}",
        path.display(),
        image.width,
        image.height,
    ));
}

/// Says how many scenes of a call were rendered.
pub(super) fn total(n_rendered: usize, n_failed: usize, time: Duration) {
    say(&format!("{n_rendered} rendered, {n_failed} failed, {:.2} s in all", time.as_secs_f64()));
}

/// Writes to standard output. If nobody reads it any more, that is not a failure.
pub(super) fn to_stdout(text: &[u8]) -> Result<()> {
    let mut stdout = io::stdout().lock();
    match stdout.write_all(text).and_then(|()| stdout.flush()) {
        Err(source) if source.kind() != io::ErrorKind::BrokenPipe => {
            Err(Error::Io { action: "write", path: "standard output".into(), source })
        }
        _ => Ok(()),
    }
}

fn say(text: &str) {
    let _ = writeln!(io::stderr().lock(), "{text}");
}

/// In colour on a terminal, unless the user wants none (<https://no-color.org>).
fn renderer() -> Renderer {
    let is_plain = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
    if is_terminal() && !is_plain { Renderer::styled() } else { Renderer::plain() }
}

fn title(text: &str) -> Group<'_> {
    Group::with_title(Level::ERROR.primary_title(text))
}

/// The error's own words and those of what caused it.
fn with_causes(error: &Error) -> String {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        let _ = write!(text, ": {error}");
        cause = error.source();
    }
    text
}

/// Mistakes with excerpts from the texts, an empty line between them.
fn excerpts(
    level: &Level<'_>,
    diagnostics: &[Diagnostic],
    sources: &Sources,
    renderer: &Renderer,
) -> String {
    let shown = diagnostics.iter().take(MAX_SHOWN);
    let mut texts: Vec<String> =
        shown.map(|mistake| excerpt(level, mistake, sources, renderer)).collect();
    let hidden = diagnostics.get(MAX_SHOWN..).unwrap_or_default();
    if !hidden.is_empty() {
        let mut names: Vec<_> =
            hidden.iter().map(|mistake| sources.get(mistake.origin).0).collect();
        names.dedup();
        let text = format!("{} more in {}", hidden.len(), names.join(", "));
        texts.push(renderer.render(&[Group::with_title(level.clone().primary_title(&text))]));
    }
    texts.join("\n\n")
}

fn excerpt(
    level: &Level<'_>,
    mistake: &Diagnostic,
    sources: &Sources,
    renderer: &Renderer,
) -> String {
    let (name, source) = sources.get(mistake.origin);
    let mark = AnnotationKind::Primary.span(within(source, &mistake.span));
    let mark = match mistake.label.as_str() {
        "" => mark,
        label => mark.label(clean(label)),
    };
    let snippet = Snippet::source(source).path(name).annotation(mark);
    let group = Group::with_title(level.clone().primary_title(&mistake.message)).element(snippet);
    let help = mistake.help.as_deref().map(|help| Level::HELP.message(clean(help)));
    renderer.render(&[group.elements(help)])
}

/// `span` cut to what can be shown: inside the text, at the borders of characters.
fn within(source: &str, span: &Range<usize>) -> Range<usize> {
    let start = source.floor_char_boundary(span.start.min(source.len()));
    let end = source.ceil_char_boundary(span.end.clamp(start, source.len()));
    start..end
}

#[cfg(test)]
mod tests {
    use super::*;

    fn complaints(source: &str, spans: Vec<Range<usize>>) -> String {
        let diagnostics: Vec<_> =
            spans.into_iter().map(|s| Diagnostic::new(s, "wrong").label("here")).collect();
        let sources =
            Sources { path: "a.toml".into(), text: source.to_owned(), ..Sources::default() };
        excerpts(&Level::ERROR, &diagnostics, &sources, &Renderer::plain())
    }

    #[test]
    fn spans_that_cannot_be_shown_do_no_harm() {
        let awkward = vec![0..0, Range { start: 5, end: 3 }, 900..901, 1..2, 0..1000];
        for source in ["", "é", "a\r\nb\n", "\u{1b}[31m"] {
            let text = complaints(source, awkward.clone());
            assert_eq!(text.matches("error: wrong").count(), 5, "{text}");
            assert!(!text.contains('\u{1b}'));
        }
    }

    #[test]
    fn many_mistakes_are_counted() {
        let text = complaints("x", vec![0..1; 23]);
        assert!(text.ends_with("error: 3 more in a.toml"), "{text}");
    }

    #[test]
    fn causes_are_told() {
        let source = io::Error::other("disk on fire");
        let error = Error::Io { action: "write", path: "a.png".into(), source };
        assert_eq!(with_causes(&error), "cannot write a.png: disk on fire");
    }
}
