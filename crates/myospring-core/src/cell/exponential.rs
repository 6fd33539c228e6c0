//! The exponential function in a form that the compiler vectorises.
#![allow(clippy::inline_always, reason = "what the vectorised loops call is inlined into them")]

/// Arguments are held within these bounds; `exp` of both is a normal number.
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
    fn arguments_out_of_range_give_the_bound() {
        assert_eq!(exp(0.0), 1.0);
        assert_eq!(exp(-1e300), exp(SMALLEST));
        assert_eq!(exp(1e300), exp(LARGEST));
        assert!(exp(LARGEST).is_finite() && exp(SMALLEST) > 0.0);
    }
}
