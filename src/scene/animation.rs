//! Films: how many frames, how the camera moves, which parameters change.

use super::{
    definitions::{no_parameter, settable},
    frames::MAX_FRAMES,
    lower::Lower,
    spanned::Spanned,
    spec::{AnimationSpec, CameraSpec, KeySpec, SceneSpec, Section},
    track::Track,
};
use crate::{
    diagnostic::Diagnostic,
    raster::{Motion, Path, Placement, Projection, View, time},
};

const DEFAULT_FPS: f64 = 24.0;

/// How a scene changes from frame to frame.
#[derive(Clone, Debug)]
pub struct Animation {
    /// How many frames, from 1 to 10000.
    pub n_frames: u32,
    /// Frames a second, from 0.1 to 1000.
    pub fps: f64,
    /// How the camera moves.
    pub motion: Motion,
}

/// The value at a time from 0 to 1 among values at even intervals.
fn between(values: &[f64], time: f64) -> f64 {
    let place = time * (values.len() - 1) as f64;
    let before = place as usize;
    match values.get(before + 1) {
        Some(after) => values[before] + (place - before as f64) * (after - values[before]),
        None => values[values.len() - 1],
    }
}

impl Lower<'_> {
    /// The parameters that change during a film.
    pub(super) fn tracks_of_film(&mut self, spec: &SceneSpec) -> Vec<Track> {
        let Some(section) = &spec.animation else { return Vec::new() };
        let n_frames = self.n_frames(&section.spec);
        let mut tracks = Vec::new();
        for (name, values) in &section.spec.params.spec {
            let span = values.span();
            match settable(name.get_ref(), &spec.params, &spec.lets) {
                Ok(name) if values.get_ref().len() >= 2 => {
                    let values: Vec<f64> = values.get_ref().iter().map(|value| value.0).collect();
                    let value = |frame| between(&values, time(frame, n_frames));
                    let values = (0..n_frames).map(value).collect();
                    tracks.push(Track { name, section: "[animation.params]", values, span });
                }
                Ok(_) => self.errors.push(
                    Diagnostic::new(span, format!("`{}` does not change", name.get_ref()))
                        .label("expected two numbers or more")
                        .help("write its values in the first frame, in the last and between them"),
                ),
                Err(help) => {
                    self.errors.push(no_parameter(name.span(), name.get_ref(), &help));
                }
            }
        }
        tracks
    }

    /// How many frames a film has, of which what is wrong is noted elsewhere.
    fn n_frames(&self, animation: &AnimationSpec) -> u32 {
        let written = animation.frames.as_ref().map_or(1, |frames| frames.get_ref().0);
        written.clamp(1, i64::from(MAX_FRAMES)) as u32
    }

    /// The view with which the scene begins, and how it goes on if it is a film.
    pub(super) fn animation(&mut self, spec: &SceneSpec) -> (View, Option<Animation>) {
        let Some(section) = &spec.animation else { return (self.view(&spec.camera), None) };
        let animation = &section.spec;
        if animation.frames.is_none() && !section.is_damaged {
            self.errors.push(
                Diagnostic::new(section.span.clone(), "the film has no length")
                    .label("no `frames`")
                    .help("say how many frames it has, as in frames = 48"),
            );
        }
        let n_frames =
            self.whole("frames", animation.frames.as_ref(), 1..=i64::from(MAX_FRAMES), 1);
        let fps = self.number("fps", animation.fps.as_ref(), 0.1..=1000.0, DEFAULT_FPS);
        let turn = self.number("turntable", animation.turntable.as_ref(), -1e6..=1e6, 0.0);
        let (view, motion) = match &animation.key[..] {
            [] if turn == 0.0 => (self.view(&spec.camera), Motion::Still),
            [] => (self.view(&spec.camera), Motion::Turn { degrees: turn }),
            keys => self.along(keys, animation, &spec.camera, n_frames),
        };
        let is_filmed = spec.sculptures.iter().any(|section| section.spec.film == Some(true));
        if motion == Motion::Still && animation.params.spec.is_empty() && !is_filmed {
            self.warnings.push(
                Diagnostic::new(section.span.clone(), "nothing moves in the film")
                    .help("add `turntable`, [animation.params] or [[animation.key]]"),
            );
        }
        (view, Some(Animation { n_frames, fps, motion }))
    }

    /// The way of the camera through its keys, and the view of the first of them.
    fn along(
        &mut self,
        keys: &[Section<KeySpec>],
        animation: &AnimationSpec,
        camera: &Section<CameraSpec>,
        n_frames: u32,
    ) -> (View, Motion) {
        if let Some(turntable) = &animation.turntable {
            self.errors.push(
                Diagnostic::new(turntable.span(), "`turntable` is for films without keys")
                    .label("keys say how the camera moves")
                    .help("remove it, or remove [[animation.key]]"),
            );
        }
        if let [alone] = keys {
            self.errors.push(
                Diagnostic::new(alone.span.clone(), "the camera has only one key")
                    .label("expected two or more")
                    .help("add another [[animation.key]], or write `eye` and `target` in [camera]"),
            );
        }
        self.no_place(&camera.spec);
        let mut before = f64::NEG_INFINITY;
        let mut views: Vec<(f64, View)> = Vec::new();
        for key in keys {
            let at = self.number("at", key.spec.at.as_ref(), 0.0..=1.0, 0.0);
            if let Some(written) = &key.spec.at
                && at <= before
            {
                self.errors.push(
                    Diagnostic::new(written.span(), "`at` does not increase")
                        .label(format!("must be above {before}, that of the key before")),
                );
            }
            before = before.max(at);
            let mut view = self.view_of_key(key, camera);
            view.up = views.first().map_or(view.up, |(_, first)| first.up);
            views.push((at, view));
        }
        let first = views[0].1.clone();
        if !self.errors.is_empty() {
            return (first, Motion::Still);
        }
        let motion = Motion::Along(Path::new(&views));
        self.never_along_up(&keys[0], &motion.views(&first, n_frames));
        (first, motion)
    }

    /// Complains about keys of the camera that say where it is.
    fn no_place(&mut self, camera: &CameraSpec) {
        let span = |vector: &Option<Spanned<_>>| vector.as_ref().map(Spanned::span);
        for (key, span) in [
            ("eye", span(&camera.eye)),
            ("target", span(&camera.target)),
            ("direction", span(&camera.direction)),
            ("margin", camera.margin.as_ref().map(Spanned::span)),
        ] {
            if let Some(span) = span {
                self.errors.push(
                    Diagnostic::new(span, format!("`{key}` is for cameras without keys"))
                        .label("keys say where the camera is")
                        .help("remove it, or remove [[animation.key]]"),
                );
            }
        }
    }

    /// The view of one key: what it says takes the place of what `[camera]` says.
    fn view_of_key(&mut self, key: &Section<KeySpec>, camera: &Section<CameraSpec>) -> View {
        let KeySpec { at, eye, target, fov, height } = &key.spec;
        let given = [at.is_some(), eye.is_some(), target.is_some()];
        for (name, _) in ["at", "eye", "target"].into_iter().zip(given).filter(|(_, is)| !is) {
            if !key.is_damaged {
                self.errors.push(
                    Diagnostic::new(key.span.clone(), format!("the key has no `{name}`"))
                        .help("every key says when (`at`) and where (`eye`, `target`)"),
                );
            }
        }
        let is_damaged = key.is_damaged || given.contains(&false);
        let spec = CameraSpec {
            eye: eye.clone(),
            target: target.clone(),
            fov: fov.clone().or(camera.spec.fov.clone()),
            height: height.clone().or(camera.spec.height.clone()),
            direction: None,
            margin: None,
            ..camera.spec.clone()
        };
        // What is wrong in [camera] would be found again in every key.
        let n_known = self.errors.len();
        let view = self.view(&Section { spec, span: key.span.clone(), is_damaged });
        let (known, new) = self.errors.split_at(n_known);
        let new = new.iter().filter(|mistake| !known.contains(mistake)).cloned().collect();
        self.errors.truncate(n_known);
        self.errors.extend::<Vec<Diagnostic>>(new);
        if view.projection == (Projection::Orthographic { height: None }) && !is_damaged {
            self.errors.push(
                Diagnostic::new(key.span.clone(), "the key has no `height`")
                    .label("how much does the picture show?")
                    .help("add `height`, the picture's height in scene units, here or in [camera]"),
            );
        }
        view
    }

    /// Between keys the camera may come to look along `up`, where the picture would whirl around.
    fn never_along_up(&mut self, first: &Section<KeySpec>, views: &[View]) {
        let is_along = |view: &View| match view.placement {
            Placement::LookAt { eye, target } => super::camera::parallel(eye - target, view.up),
            Placement::Fit { .. } => false,
        };
        if let Some(frame) = views.iter().position(is_along) {
            let message = format!("in frame {} the camera looks along `up`", frame + 1);
            self.errors.push(
                Diagnostic::new(first.span.clone(), message)
                    .help("choose another `up` in [camera], or add a key that leads around"),
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use super::between;

    #[test]
    fn parameters_meet_their_values() {
        let found = [0.0, 0.125, 0.5, 0.75, 1.0].map(|time| between(&[1.0, 5.0, 0.1], time));
        assert_eq!(found, [1.0, 2.0, 5.0, 2.55, 0.1]);
    }
}
