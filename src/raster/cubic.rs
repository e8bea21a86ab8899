//! Where a cubic polynomial has its first root between 0 and 1.
//!
//! In Bernstein's form the signs of the coefficients bound the number of roots: none without a change
//! of sign, one with one change. With more the interval is halved.
//!
//! *Based on:* J. Lane, R. Riesenfeld, "Bounds on a Polynomial", BIT 21, 1981 (variation of signs of
//! Bernstein coefficients).

/// A cubic by its Bernstein coefficients over an interval; 0 counts as positive.
pub(super) type Cubic = [f64; 4];

/// Halvings after which roots that lie so near each other count as none, or as one.
const MAX_DEPTH: u32 = 24;

/// Steps of the search for a single root, at most.
const MAX_STEPS: u32 = 60;

/// A step as short as this leads to the root.
const PRECISION: f64 = 1e-10;

/// From 1, s, s² and s³ times these numbers.
pub(super) fn from_powers([c0, c1, c2, c3]: [f64; 4]) -> Cubic {
    [c0, c0 + c1 / 3.0, c0 + (2.0 * c1 + c2) / 3.0, c0 + c1 + c2 + c3]
}

/// The first root between 0 and 1, if there is one.
pub(super) fn first_root(cubic: &Cubic) -> Option<f64> {
    first_within(cubic, 0.0, 1.0, 0)
}

fn first_within(cubic: &Cubic, from: f64, to: f64, depth: u32) -> Option<f64> {
    let signs = cubic.map(|c| c >= 0.0);
    let changes = (0..3).filter(|&i| signs[i] != signs[i + 1]).count();
    let part = |s: f64| from + s * (to - from);
    match changes {
        0 => None,
        1 => Some(part(only_root(cubic))),
        _ if depth == MAX_DEPTH => (signs[0] != signs[3]).then(|| part(0.5)),
        _ => {
            let [left, right] = halves(cubic);
            let middle = part(0.5);
            first_within(&left, from, middle, depth + 1)
                .or_else(|| first_within(&right, middle, to, depth + 1))
        }
    }
}

/// Both halves, by de Casteljau's construction.
fn halves([a, b, c, d]: &Cubic) -> [Cubic; 2] {
    let mean = |a: f64, b: f64| 0.5 * (a + b);
    let [ab, bc, cd] = [mean(*a, *b), mean(*b, *c), mean(*c, *d)];
    let [abc, bcd] = [mean(ab, bc), mean(bc, cd)];
    let middle = mean(abc, bcd);
    [[*a, ab, abc, middle], [middle, bcd, cd, *d]]
}

/// The root of a cubic with different signs at both ends and one root: Newton's steps as long as they lead
/// into the bracket, else its middle.
fn only_root([a, b, c, d]: &Cubic) -> f64 {
    let [slope_a, slope_b, slope_c] = [b - a, c - b, d - c];
    let (mut from, mut to) = (0.0, 1.0);
    let is_first_positive = *a >= 0.0;
    let mut at = a / (a - d);
    for _ in 0..MAX_STEPS {
        let r = 1.0 - at;
        let value = r * r * (r * a + 3.0 * at * b) + at * at * (3.0 * r * c + at * d);
        if (value >= 0.0) == is_first_positive {
            from = at;
        } else {
            to = at;
        }
        let slope = 3.0 * (r * r * slope_a + 2.0 * r * at * slope_b + at * at * slope_c);
        let newton = at - value / slope;
        // What is no number is not between both.
        let next = if newton > from && newton < to { newton } else { 0.5 * (from + to) };
        if (next - at).abs() < PRECISION {
            return next;
        }
        at = next;
    }
    at
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn with_roots(scale: f64, roots: [f64; 3]) -> Cubic {
        let [a, b, c] = roots;
        from_powers([
            -scale * a * b * c,
            scale * (a * b + b * c + c * a),
            -scale * (a + b + c),
            scale,
        ])
    }

    proptest! {
        #[test]
        fn the_first_root_is_found(
            scale in prop_oneof![-9.0..-0.1_f64, 0.1..9.0_f64],
            mut roots in prop::array::uniform3(-0.5..1.5_f64),
        ) {
            roots.sort_by(f64::total_cmp);
            prop_assume!(roots.windows(2).all(|pair| pair[1] - pair[0] > 1e-3));
            prop_assume!(roots.iter().all(|r| r.abs() > 1e-6 && (r - 1.0).abs() > 1e-6));
            let first = roots.into_iter().find(|r| (0.0..=1.0).contains(r));
            let found = first_root(&with_roots(scale, roots));
            prop_assert_eq!(found.is_some(), first.is_some());
            if let (Some(found), Some(first)) = (found, first) {
                prop_assert!((found - first).abs() < 1e-8, "{} {}", found, first);
            }
        }
    }

    #[test]
    fn a_root_at_the_end_counts() {
        let root = first_root(&[-1.0, -0.6, -0.3, 0.0]).unwrap();
        assert!((root - 1.0).abs() < 1e-9, "{root}");
        assert_eq!(first_root(&[-1.0; 4]), None);
    }
}
