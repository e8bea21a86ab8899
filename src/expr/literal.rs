//! Decimal literals as constants: exact where an f64 holds them, else with an enclosure.

use crate::math::Constant;

/// The constant that a decimal literal means: exact where an f64 holds it.
pub(super) fn decimal(text: &str) -> Constant {
    let value: f64 = text.parse().unwrap_or(f64::NAN);
    if is_dyadic(text) { Constant::exact(value) } else { Constant::rounded(value) }
}

/// Whether an f64 holds a literal m·10ᵉ: no 5 may be left in the denominator, and the odd part of
/// the numerator must fit the fraction.
fn is_dyadic(text: &str) -> bool {
    let (mantissa, exponent) = text.split_once(['e', 'E']).unwrap_or((text, "0"));
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let digits = format!("{whole}{fraction}");
    let (Ok(mut m), Ok(exponent)) = (digits.parse::<u128>(), exponent.parse::<i32>()) else {
        return false;
    };
    if m == 0 {
        return true;
    }
    let mut fives = i64::from(exponent) - fraction.len() as i64;
    while fives < 0 && m.is_multiple_of(5) {
        m /= 5;
        fives += 1;
    }
    let odd = m >> m.trailing_zeros();
    (0..=22).contains(&fives)
        && exponent.abs() < 250
        && odd.checked_mul(5_u128.pow(fives as u32)).is_some_and(|v| v < 1 << 53)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn literals_are_exact_where_they_can_be() {
        for text in ["0", "1", "0.5", ".25", "3.", "1e3", "12.125", "5e-1", "1e22", "0.0"] {
            assert!(decimal(text).as_exact().is_some(), "{text}");
        }
        for text in ["0.1", "2.3", "1e-1", "1e23", "9007199254740993", "0.42"] {
            let c = decimal(text);
            assert!(c.lo < c.value && c.value < c.hi, "{text}");
        }
    }
}
