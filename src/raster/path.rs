//! The way of a camera through views that are given at times: smooth, and even in zooms.
//!
//! A view is a target, a direction and a size, that of what the picture shows around the target. A
//! zoom is even if the logarithm of the size changes evenly. The target has to keep pace: halfway
//! through a zoom by 10^6, a target that is halfway would be thousands of pictures away. So target
//! and size together move as a similarity does, scaling about one point of space that stays where
//! it is in the picture. Through several keys the way is a Bézier curve of such motions between
//! two keys; the speed at a key fits both sides, and never makes a coordinate overshoot.
//!
//! *Based on:* K. Shoemake, "Animating rotation with quaternion curves", 1985 (de Casteljau's
//! construction with another motion in place of the straight one); M. Steffen, "A simple method for
//! monotonic interpolation in one dimension", Astronomy and Astrophysics 239, 1990 (speeds at keys).

use std::f64::consts::LN_2;

use glam::DVec3;

use super::{Placement, Projection, View};

/// A smooth way through at least two views.
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    keys: Vec<Key>,
    is_parallel: bool,
    up: DVec3,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Key {
    /// When the camera is here.
    at: f64,
    pose: Pose,
    velocity: Velocity,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Pose {
    target: DVec3,
    /// From the target to the camera; about as long as 1.
    direction: DVec3,
    log_distance: f64,
    /// Of half the picture's height, where the target is.
    log_size: f64,
}

/// Change in a unit of time.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Velocity {
    /// In units of the size that the view has at that time.
    target: DVec3,
    direction: DVec3,
    log_distance: f64,
    log_size: f64,
}

impl Path {
    /// The way through `views`, each with the time when the camera is there.
    ///
    /// # Panics
    /// If there are fewer than two, their times do not increase, or one is not fixed: with `eye`
    /// and `target` that differ and, with parallel rays, a height. Also if not all are of one
    /// projection.
    #[must_use]
    pub fn new(views: &[(f64, View)]) -> Self {
        assert!(views.len() >= 2, "a way has two ends");
        let (_, first) = &views[0];
        let is_parallel = matches!(first.projection, Projection::Orthographic { .. });
        let poses: Vec<(f64, Pose)> =
            views.iter().map(|(at, view)| (*at, Pose::of(view, is_parallel))).collect();
        let steps: Vec<(f64, Velocity)> = poses
            .windows(2)
            .map(|pair| {
                let duration = pair[1].0 - pair[0].0;
                assert!(duration > 0.0, "time goes on");
                (duration, Velocity::between(&pair[0].1, &pair[1].1, duration))
            })
            .collect();
        let key = |(i, &(at, pose))| Key { at, pose, velocity: velocity_at(i, &steps) };
        Self { keys: poses.iter().enumerate().map(key).collect(), is_parallel, up: first.up }
    }

    /// The view at a time; before the first key it is the first, after the last the last.
    #[must_use]
    pub fn view(&self, time: f64) -> View {
        let after = self.keys.partition_point(|key| key.at <= time);
        let pose = match (after.checked_sub(1).map(|i| &self.keys[i]), self.keys.get(after)) {
            (Some(a), Some(b)) => a.on_the_way(b, time),
            (Some(key), None) | (None, Some(key)) => key.pose,
            (None, None) => unreachable!("a way has two ends"),
        };
        pose.view(self.is_parallel, self.up)
    }
}

impl Key {
    /// De Casteljau's construction.
    fn on_the_way(&self, next: &Self, time: f64) -> Pose {
        let duration = next.at - self.at;
        let u = (time - self.at) / duration;
        let b = self.pose.moved(&self.velocity, duration / 3.0);
        let c = next.pose.moved(&next.velocity, -duration / 3.0);
        let (ab, bc, cd) = (self.pose.toward(&b, u), b.toward(&c, u), c.toward(&next.pose, u));
        ab.toward(&bc, u).toward(&bc.toward(&cd, u), u)
    }
}

impl Pose {
    fn of(view: &View, is_parallel: bool) -> Self {
        let Placement::LookAt { eye, target } = view.placement else {
            panic!("a key has a place");
        };
        let distance = (eye - target).length();
        let log_distance = libm::log(distance);
        let log_size = match view.projection {
            Projection::Perspective { fov_degrees } if !is_parallel => {
                log_distance + libm::log(libm::tan(0.5 * fov_degrees.to_radians()))
            }
            Projection::Orthographic { height: Some(height) } if is_parallel => {
                libm::log(height) - LN_2
            }
            _ => panic!("keys have one projection, and a size"),
        };
        Self { target, direction: (eye - target) / distance, log_distance, log_size }
    }

    fn view(&self, is_parallel: bool, up: DVec3) -> View {
        let projection = if is_parallel {
            Projection::Orthographic { height: Some(2.0 * libm::exp(self.log_size)) }
        } else {
            let slope = libm::exp(self.log_size - self.log_distance);
            Projection::Perspective { fov_degrees: 2.0 * libm::atan(slope).to_degrees() }
        };
        let distance = libm::exp(self.log_distance);
        let eye = self.target + distance * self.direction.normalize_or(DVec3::Z);
        View { projection, placement: Placement::LookAt { eye, target: self.target }, up }
    }

    /// What lies at `u` on the straight way from here (0) to `to` (1).
    fn toward(&self, to: &Self, u: f64) -> Self {
        let zoom = to.log_size - self.log_size;
        // As much of the way as the size has gone of its own: both are then affine in each other.
        let gone = if zoom == 0.0 { u } else { libm::expm1(u * zoom) / libm::expm1(zoom) };
        Self {
            target: self.target + gone * (to.target - self.target),
            direction: self.direction + u * (to.direction - self.direction),
            log_distance: self.log_distance + u * (to.log_distance - self.log_distance),
            log_size: self.log_size + u * zoom,
        }
    }

    /// Where a motion leads that keeps its velocity.
    fn moved(&self, velocity: &Velocity, time: f64) -> Self {
        let zoom = velocity.log_size * time;
        let size = libm::exp(self.log_size) / lag(zoom);
        Self {
            target: self.target + time * size * velocity.target,
            direction: self.direction + time * velocity.direction,
            log_distance: self.log_distance + time * velocity.log_distance,
            log_size: self.log_size + zoom,
        }
    }
}

/// zoom / (e^zoom − 1), and its limit 1 at 0.
fn lag(zoom: f64) -> f64 {
    if zoom == 0.0 { 1.0 } else { zoom / libm::expm1(zoom) }
}

impl Velocity {
    /// That of the straight way from `a` to `b`, which keeps it.
    fn between(a: &Pose, b: &Pose, duration: f64) -> Self {
        let zoom = b.log_size - a.log_size;
        let size = libm::exp(a.log_size) / lag(zoom);
        Self {
            target: (b.target - a.target) / size / duration,
            direction: (b.direction - a.direction) / duration,
            log_distance: (b.log_distance - a.log_distance) / duration,
            log_size: zoom / duration,
        }
    }

    fn map(&self, other: &Self, f: impl Fn(f64, f64) -> f64) -> Self {
        let each = |a: DVec3, b: DVec3| DVec3::new(f(a.x, b.x), f(a.y, b.y), f(a.z, b.z));
        Self {
            target: each(self.target, other.target),
            direction: each(self.direction, other.direction),
            log_distance: f(self.log_distance, other.log_distance),
            log_size: f(self.log_size, other.log_size),
        }
    }
}

/// The velocity at key `i`, from those of the straight ways between keys.
fn velocity_at(i: usize, steps: &[(f64, Velocity)]) -> Velocity {
    let before = i.checked_sub(1).map(|i| &steps[i]);
    match (before, steps.get(i)) {
        (Some((t, v)), Some((u, w))) => v.map(w, |v, w| inner_speed(v, w, *t, *u)),
        (None, Some((t, v))) => match steps.get(1) {
            Some((u, w)) => v.map(w, |v, w| end_speed(v, w, *t, *u)),
            None => *v,
        },
        (Some((t, v)), None) => match i.checked_sub(2).map(|i| &steps[i]) {
            Some((u, w)) => v.map(w, |v, w| end_speed(v, w, *t, *u)),
            None => *v,
        },
        (None, None) => unreachable!("a way has two ends"),
    }
}

/// The speed between two steps of speeds v and w that take the times t and u: that of the parabola
/// through the three ends, but not more than twice either, and 0 at a turning point.
fn inner_speed(v: f64, w: f64, t: f64, u: f64) -> f64 {
    if v * w <= 0.0 {
        return 0.0;
    }
    let parabola = (v * u + w * t) / (t + u);
    v.signum() * parabola.abs().min(2.0 * v.abs().min(w.abs()))
}

/// The same at the outer end of the step of speed v, if w is that of its neighbour.
fn end_speed(v: f64, w: f64, t: f64, u: f64) -> f64 {
    let parabola = v + (v - w) * t / (t + u);
    if parabola * v <= 0.0 { 0.0 } else { v.signum() * parabola.abs().min(2.0 * v.abs()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn view(eye: DVec3, target: DVec3) -> View {
        View {
            projection: Projection::Perspective { fov_degrees: 35.0 },
            placement: Placement::LookAt { eye, target },
            up: DVec3::Z,
        }
    }

    fn eye_and_target(view: &View) -> (DVec3, DVec3) {
        let Placement::LookAt { eye, target } = view.placement else { panic!("{view:?}") };
        (eye, target)
    }

    /// A zoom by 10^6 onto a point beside the middle: the same factor in every frame, and the goal
    /// stays in the picture.
    #[test]
    fn zooms_are_even_and_keep_their_goal_in_sight() {
        let (far, near) = (DVec3::new(0.0, -4.0, 0.0), DVec3::new(0.5, 0.0, 0.25));
        let end = near + 4e-6 * (far - DVec3::ZERO).normalize();
        let path = Path::new(&[(0.0, view(far, DVec3::ZERO)), (1.0, view(end, near))]);
        let frames: Vec<_> =
            (0..=60).map(|k| eye_and_target(&path.view(k as f64 / 60.0))).collect();
        let factor = libm::exp(-libm::log(1e6) / 60.0);
        for pair in frames.windows(2) {
            let [a, b] = [pair[0], pair[1]].map(|(eye, target)| (eye - target).length());
            assert!((b / a / factor - 1.0).abs() < 1e-9, "{a} {b}");
        }
        for (eye, target) in frames {
            let off = (near - target).length() / (eye - target).length();
            assert!(off < 0.14, "{off}");
        }
    }

    #[test]
    fn parallel_rays_zoom_by_height() {
        let with_height = |height| View {
            projection: Projection::Orthographic { height: Some(height) },
            ..view(DVec3::Y, DVec3::ZERO)
        };
        let path = Path::new(&[(0.0, with_height(4.0)), (1.0, with_height(1.0))]);
        let Projection::Orthographic { height: Some(height) } = path.view(0.5).projection else {
            panic!("another projection");
        };
        assert!((height - 2.0).abs() < 1e-12);
    }

    #[test]
    fn the_ends_hold() {
        let path =
            Path::new(&[(0.2, view(DVec3::X, DVec3::ZERO)), (0.7, view(DVec3::Y, DVec3::X))]);
        assert_eq!(path.view(0.0), path.view(0.2));
        assert_eq!(path.view(1.0), path.view(0.7));
    }

    /// Keys at increasing times, not too far from the origin and never at their targets.
    fn keys() -> impl Strategy<Value = Vec<(f64, View)>> {
        let point = [-2.0..2.0_f64, -2.0..2.0, -2.0..2.0].prop_map(DVec3::from_array);
        let key = (0.05..1.0_f64, point, [0.1..1.0_f64, 0.1..1.0, 0.1..1.0], -6.0..1.0_f64);
        prop::collection::vec(key, 2..6).prop_map(|keys| {
            let mut time = 0.0;
            let view = |(step, target, direction, log): (f64, DVec3, [f64; 3], f64)| {
                time += step;
                let away = libm::exp(log) * DVec3::from_array(direction).normalize();
                (time, view(target + away, target))
            };
            keys.into_iter().map(view).collect()
        })
    }

    proptest! {
        #[test]
        fn every_key_is_met_without_a_jolt(keys in keys()) {
            let path = Path::new(&keys);
            let at = |time: f64| eye_and_target(&path.view(time));
            for (i, (time, key)) in keys.iter().enumerate() {
                let ((eye, target), (e, t)) = (eye_and_target(key), at(*time));
                prop_assert!((eye - e).length() < 1e-9 && (target - t).length() < 1e-9);
                if i == 0 || i == keys.len() - 1 {
                    continue;
                }
                // The speed on one side, by the parabola through three places, in units of the view.
                let speed = |h: f64| {
                    let (a, b) = (at(time + h), at(time + 2.0 * h));
                    let along = |p: DVec3, q: DVec3, r: DVec3| 4.0 * q - 3.0 * p - r;
                    let unit = 2.0 * h * (eye - target).length();
                    [along(e, a.0, b.0) / unit, along(t, a.1, b.1) / unit]
                };
                for (before, after) in speed(-1e-6).into_iter().zip(speed(1e-6)) {
                    let tolerance = 1e-3 * (1.0 + before.length());
                    prop_assert!((before - after).length() < tolerance, "{before} {after}");
                }
            }
        }

        /// The camera never comes nearer than the nearer of two keys.
        #[test]
        fn zooms_do_not_overshoot(keys in keys()) {
            let path = Path::new(&keys);
            let distance = |view: &View| {
                let (eye, target) = eye_and_target(view);
                (eye - target).length()
            };
            for pair in keys.windows(2) {
                let ends = [distance(&pair[0].1), distance(&pair[1].1)];
                let (least, most) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
                for k in 0..=20 {
                    let time = pair[0].0 + (pair[1].0 - pair[0].0) * k as f64 / 20.0;
                    let distance = distance(&path.view(time));
                    prop_assert!(distance > 0.999 * least && distance < 1.001 * most);
                }
            }
        }
    }
}
