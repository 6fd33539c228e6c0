//! The exponential function and the logarithm in a form that the compiler vectorises.
#![allow(clippy::inline_always, reason = "what the vectorised loops call is inlined into them")]

/// Arguments are limited to these bounds, whose exponentials are normal numbers.
const SMALLEST: f64 = -708.0;
const LARGEST: f64 = 709.0;
/// `1 / ln 2`.
const LOG2_E: f64 = std::f64::consts::LOG2_E;
/// `ln 2` in two parts: the first has so few digits that whole multiples of it are exact.
const LN_2_HIGH: f64 = 6.931_471_803_691_238e-1;
const LN_2_LOW: f64 = 1.908_214_929_270_587_7e-10;
/// Added to a number below 2^51, leaves the nearest whole number in the lowest bits.
const ROUNDER: f64 = 6_755_399_441_055_744.0;
/// Bias of the exponent of an `f64`.
const BIAS: u64 = 1023;

/// `e^x`, to 2 units in the last place; outside -708 to 709, `e` to the nearer of the two.
///
/// `e^x = 2^n e^r` with whole `n` and `|r| <= ln(2) / 2`, where `r = x - n ln(2)` is taken in two
/// steps (`cody_waite_1980`); `e^r` by its Taylor series to the 13th power, whose remainder is below
/// 1e-17. No branch, no table, no fused operation: it gives the same bits on every processor, alone
/// and in a vectorised loop. A NaN gives a number; callers see it in the other terms.
#[inline(always)]
pub(super) fn exp(x: f64) -> f64 {
    let x = if x > SMALLEST { x } else { SMALLEST };
    let x = if x < LARGEST { x } else { LARGEST };
    let shifted = x * LOG2_E + ROUNDER;
    let n = shifted - ROUNDER;
    let r = (x - n * LN_2_HIGH) - n * LN_2_LOW;
    // Taylor's series, neighbouring terms first: short chains of operations.
    let r2 = r * r;
    let r4 = r2 * r2;
    let c = |k: usize| INVERSE_FACTORIALS[k];
    let low = (c(2) + c(3) * r) + (c(4) + c(5) * r) * r2;
    let middle = (c(6) + c(7) * r) + (c(8) + c(9) * r) * r2;
    let high = (c(10) + c(11) * r) + (c(12) + c(13) * r) * r2;
    let series = 1.0 + (r + r2 * (low + r4 * (middle + r4 * high)));
    let power = f64::from_bits((shifted.to_bits().wrapping_add(BIAS)) << 52);
    series * power
}

/// Bits of the mantissa of an `f64`.
const MANTISSA: u32 = 52;
/// The bits of the root of a half, used to split a number into a power of two and a factor near 1.
const ROOT_OF_HALF: u64 = 0x3fe6_a09e_667f_3bcd;

/// `ln x` of a positive number, to 1 unit in the last place; for one below 2.2e-308, including 0,
/// the logarithm of that number; NaN for a negative number or NaN.
///
/// `ln x = n ln(2) + ln(1 + f)` with whole `n` and `1 + f` between the roots of a half and of 2; with
/// `s = f / (2 + f)` it is `ln(1 + f) = 2 s + 2 s^3 / 3 + 2 s^5 / 5 + ...`, here to the 23rd power, whose remainder is
/// below 1e-17. As [`exp`], it gives the same bits everywhere.
#[inline(always)]
pub(super) fn ln(x: f64) -> f64 {
    let held = if x > f64::MIN_POSITIVE { x } else { f64::MIN_POSITIVE };
    let bits = held.to_bits();
    // The biased exponent, with the mantissa between the root of a half and the root of 2.
    let exponent = bits.wrapping_sub(ROOT_OF_HALF).wrapping_add(BIAS << MANTISSA) >> MANTISSA;
    let n = f64::from_bits(ROUNDER.to_bits().wrapping_add(exponent)) - (ROUNDER + BIAS as f64);
    let f = f64::from_bits(bits.wrapping_sub(exponent << MANTISSA).wrapping_add(BIAS << MANTISSA))
        - 1.0;
    let s = f / (2.0 + f);
    let z = s * s;
    let z2 = z * z;
    let z4 = z2 * z2;
    // 2 / (2 k + 1)
    let c = |k: usize| 2.0 / (2.0 * k as f64 + 1.0);
    let low = (c(1) + c(2) * z) + (c(3) + c(4) * z) * z2;
    let middle = (c(5) + c(6) * z) + (c(7) + c(8) * z) * z2;
    let high = (c(9) + c(10) * z) + c(11) * z2;
    let series = z * (low + z4 * (middle + z4 * high));
    // ln(1 + f) = f - (f^2 / 2 - s (f^2 / 2 + series)): the largest term is exact.
    let half = 0.5 * f * f;
    let logarithm = n * LN_2_HIGH - ((half - (s * (half + series) + n * LN_2_LOW)) - f);
    if x >= 0.0 { logarithm } else { f64::NAN }
}

/// `1 / k!`.
const INVERSE_FACTORIALS: [f64; 14] = {
    let mut table = [1.0; 14];
    let mut factorial = 1.0;
    let mut k = 1;
    while k < table.len() {
        factorial *= k as f64;
        table[k] = 1.0 / factorial;
        k += 1;
    }
    table
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_exponential_is_right_to_two_units_in_the_last_place() {
        let mut worst: f64 = 0.0;
        for k in -708_000..709_000 {
            let x = f64::from(k) * 1e-3 + 1e-7 * f64::from(k % 97);
            let x = x.clamp(SMALLEST, LARGEST);
            let exact = x.exp();
            worst = worst.max((exp(x) - exact).abs() / exact);
        }
        println!("worst relative error: {:.2} epsilon", worst / f64::EPSILON);
        assert!(worst < 2.0 * f64::EPSILON, "{worst:e}");
    }

    #[test]
    fn the_logarithm_is_right_to_one_unit_in_the_last_place() {
        let mut worst: f64 = 0.0;
        for k in -700_000..700_000 {
            let x = (f64::from(k) * 1e-3).exp() * (1.0 + 1e-9 * f64::from(k % 97));
            let near = 1.0 + 1e-6 * f64::from(k);
            for x in [x, near].into_iter().filter(|x| *x > 0.0 && *x != 1.0) {
                worst = worst.max(((ln(x) - x.ln()) / x.ln()).abs());
            }
        }
        println!("worst relative error: {:.2} epsilon", worst / f64::EPSILON);
        assert!(worst < f64::EPSILON, "{worst:e}");
        assert_eq!(ln(1.0), 0.0);
        assert_eq!(ln(0.0), ln(f64::MIN_POSITIVE));
        assert!(ln(-1.0).is_nan() && ln(f64::NAN).is_nan());
    }

    #[test]
    fn arguments_out_of_range_give_the_bound() {
        assert_eq!(exp(0.0), 1.0);
        assert_eq!(exp(-1e300), exp(SMALLEST));
        assert_eq!(exp(1e300), exp(LARGEST));
        assert!(exp(LARGEST).is_finite() && exp(SMALLEST) > 0.0);
    }
}
