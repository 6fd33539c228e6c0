//! Vectors of `f64` lanes: AVX-512, AVX2 with FMA, and plain arrays.
//!
//! A kernel written over [`Lanes`] is compiled once per kind inside a function that enables the
//! kind's instructions; [`Units::available`] says which of them this processor has.

#[cfg(target_arch = "x86_64")]
use std::arch::x86_64 as arch;

use serde::{Deserialize, Serialize};

/// The vector units that a kernel is compiled for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Units {
    /// Eight lanes, x86-64 with AVX-512F.
    Avx512,
    /// Four lanes, x86-64 with AVX2 and FMA.
    Avx2,
    /// Four lanes of plain Rust, any processor.
    Portable,
}

impl Units {
    /// All kinds, fastest first.
    pub const ALL: [Self; 3] = [Self::Avx512, Self::Avx2, Self::Portable];

    /// Its name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Avx512 => "avx512",
            Self::Avx2 => "avx2",
            Self::Portable => "portable",
        }
    }

    /// Whether this processor has them.
    pub fn available(self) -> bool {
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => {
                std::is_x86_feature_detected!("avx512f")
                    && std::is_x86_feature_detected!("avx512dq")
            }
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => {
                std::is_x86_feature_detected!("avx2") && std::is_x86_feature_detected!("fma")
            }
            #[cfg(not(target_arch = "x86_64"))]
            Self::Avx512 | Self::Avx2 => false,
            Self::Portable => true,
        }
    }

    /// The fastest that this processor has.
    pub fn best() -> Self {
        Self::ALL.into_iter().find(|units| units.available()).unwrap_or(Self::Portable)
    }
}

/// Prefetches the cache line at an address, which need not be readable.
#[inline(always)]
#[allow(clippy::inline_always, reason = "one instruction")]
pub(super) fn prefetch(address: *const f64) {
    #[cfg(target_arch = "x86_64")]
    // SAFETY: every x86-64 has SSE, and a prefetch of any address does no harm.
    unsafe {
        arch::_mm_prefetch::<{ arch::_MM_HINT_T0 }>(address.cast());
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = address;
}

/// Arithmetic on `N` lanes.
///
/// # Safety
/// All functions need the processor features of their kind. `load` and `store` need `N` readable or
/// writable values behind the pointer, of any alignment.
pub(super) unsafe trait Lanes {
    type V: Copy;
    const N: usize;
    unsafe fn splat(value: f64) -> Self::V;
    unsafe fn load(from: *const f64) -> Self::V;
    unsafe fn store(to: *mut f64, value: Self::V);
    unsafe fn add(a: Self::V, b: Self::V) -> Self::V;
    unsafe fn sub(a: Self::V, b: Self::V) -> Self::V;
    unsafe fn mul(a: Self::V, b: Self::V) -> Self::V;
    /// a b + c
    unsafe fn mul_add(a: Self::V, b: Self::V, c: Self::V) -> Self::V;
    /// c - a b
    unsafe fn mul_sub_from(a: Self::V, b: Self::V, c: Self::V) -> Self::V;
    /// 1/sqrt(a) to about one unit in the last place, for a > 0.
    unsafe fn inverse_sqrt(a: Self::V) -> Self::V;
    /// Shifts values by one lane; the first lane takes the last value of `previous`.
    unsafe fn shift(current: Self::V, previous: Self::V) -> Self::V;
}

/// Four plain lanes.
pub(super) struct Portable;

// SAFETY: no processor features are needed; pointers are read and written unaligned, N values.
#[allow(clippy::inline_always, reason = "they must be inlined where the vector units are enabled")]
unsafe impl Lanes for Portable {
    type V = [f64; 4];
    const N: usize = 4;
    #[inline(always)]
    unsafe fn splat(value: f64) -> Self::V {
        [value; 4]
    }
    #[inline(always)]
    unsafe fn load(from: *const f64) -> Self::V {
        // SAFETY: the caller guarantees four readable values.
        unsafe { from.cast::<[f64; 4]>().read_unaligned() }
    }
    #[inline(always)]
    unsafe fn store(to: *mut f64, value: Self::V) {
        // SAFETY: the caller guarantees four writable values.
        unsafe { to.cast::<[f64; 4]>().write_unaligned(value) }
    }
    #[inline(always)]
    unsafe fn add(a: Self::V, b: Self::V) -> Self::V {
        std::array::from_fn(|i| a[i] + b[i])
    }
    #[inline(always)]
    unsafe fn sub(a: Self::V, b: Self::V) -> Self::V {
        std::array::from_fn(|i| a[i] - b[i])
    }
    #[inline(always)]
    unsafe fn mul(a: Self::V, b: Self::V) -> Self::V {
        std::array::from_fn(|i| a[i] * b[i])
    }
    #[inline(always)]
    unsafe fn mul_add(a: Self::V, b: Self::V, c: Self::V) -> Self::V {
        std::array::from_fn(|i| a[i] * b[i] + c[i])
    }
    #[inline(always)]
    unsafe fn mul_sub_from(a: Self::V, b: Self::V, c: Self::V) -> Self::V {
        std::array::from_fn(|i| c[i] - a[i] * b[i])
    }
    #[inline(always)]
    unsafe fn inverse_sqrt(a: Self::V) -> Self::V {
        std::array::from_fn(|i| 1.0 / a[i].sqrt())
    }
    #[inline(always)]
    unsafe fn shift(current: Self::V, previous: Self::V) -> Self::V {
        [previous[3], current[0], current[1], current[2]]
    }
}

/// Four lanes of AVX2 with FMA.
#[cfg(target_arch = "x86_64")]
pub(super) struct Avx2;

// SAFETY: the caller has AVX2 and FMA; loads and stores are the unaligned ones, N values.
#[cfg(target_arch = "x86_64")]
#[allow(clippy::inline_always, reason = "they must be inlined where the vector units are enabled")]
unsafe impl Lanes for Avx2 {
    type V = arch::__m256d;
    const N: usize = 4;
    #[inline(always)]
    unsafe fn splat(value: f64) -> Self::V {
        unsafe { arch::_mm256_set1_pd(value) }
    }
    #[inline(always)]
    unsafe fn load(from: *const f64) -> Self::V {
        unsafe { arch::_mm256_loadu_pd(from) }
    }
    #[inline(always)]
    unsafe fn store(to: *mut f64, value: Self::V) {
        unsafe { arch::_mm256_storeu_pd(to, value) }
    }
    #[inline(always)]
    unsafe fn add(a: Self::V, b: Self::V) -> Self::V {
        unsafe { arch::_mm256_add_pd(a, b) }
    }
    #[inline(always)]
    unsafe fn sub(a: Self::V, b: Self::V) -> Self::V {
        unsafe { arch::_mm256_sub_pd(a, b) }
    }
    #[inline(always)]
    unsafe fn mul(a: Self::V, b: Self::V) -> Self::V {
        unsafe { arch::_mm256_mul_pd(a, b) }
    }
    #[inline(always)]
    unsafe fn mul_add(a: Self::V, b: Self::V, c: Self::V) -> Self::V {
        unsafe { arch::_mm256_fmadd_pd(a, b, c) }
    }
    #[inline(always)]
    unsafe fn mul_sub_from(a: Self::V, b: Self::V, c: Self::V) -> Self::V {
        unsafe { arch::_mm256_fnmadd_pd(a, b, c) }
    }
    #[inline(always)]
    unsafe fn inverse_sqrt(a: Self::V) -> Self::V {
        unsafe { arch::_mm256_div_pd(arch::_mm256_set1_pd(1.0), arch::_mm256_sqrt_pd(a)) }
    }
    #[inline(always)]
    unsafe fn shift(current: Self::V, previous: Self::V) -> Self::V {
        unsafe {
            // (p2, p3, c0, c1), then (p3, c0, c1, c2)
            let middle = arch::_mm256_permute2f128_pd::<0x21>(previous, current);
            arch::_mm256_shuffle_pd::<0b0101>(middle, current)
        }
    }
}

/// Eight lanes of AVX-512.
#[cfg(target_arch = "x86_64")]
pub(super) struct Avx512;

// SAFETY: the caller has AVX-512F; loads and stores are the unaligned ones, N values.
#[cfg(target_arch = "x86_64")]
#[allow(clippy::inline_always, reason = "they must be inlined where the vector units are enabled")]
unsafe impl Lanes for Avx512 {
    type V = arch::__m512d;
    const N: usize = 8;
    #[inline(always)]
    unsafe fn splat(value: f64) -> Self::V {
        unsafe { arch::_mm512_set1_pd(value) }
    }
    #[inline(always)]
    unsafe fn load(from: *const f64) -> Self::V {
        unsafe { arch::_mm512_loadu_pd(from) }
    }
    #[inline(always)]
    unsafe fn store(to: *mut f64, value: Self::V) {
        unsafe { arch::_mm512_storeu_pd(to, value) }
    }
    #[inline(always)]
    unsafe fn add(a: Self::V, b: Self::V) -> Self::V {
        unsafe { arch::_mm512_add_pd(a, b) }
    }
    #[inline(always)]
    unsafe fn sub(a: Self::V, b: Self::V) -> Self::V {
        unsafe { arch::_mm512_sub_pd(a, b) }
    }
    #[inline(always)]
    unsafe fn mul(a: Self::V, b: Self::V) -> Self::V {
        unsafe { arch::_mm512_mul_pd(a, b) }
    }
    #[inline(always)]
    unsafe fn mul_add(a: Self::V, b: Self::V, c: Self::V) -> Self::V {
        unsafe { arch::_mm512_fmadd_pd(a, b, c) }
    }
    #[inline(always)]
    unsafe fn mul_sub_from(a: Self::V, b: Self::V, c: Self::V) -> Self::V {
        unsafe { arch::_mm512_fnmadd_pd(a, b, c) }
    }
    #[inline(always)]
    unsafe fn inverse_sqrt(a: Self::V) -> Self::V {
        unsafe {
            // Estimate y with relative error below 2^-14, then with e = 1 - a y^2 the series
            // 1/sqrt(a) = y (1 - e)^(-1/2) = y (1 + e/2 + 3 e^2/8 + 5 e^3/16 + ...)
            let y = arch::_mm512_rsqrt14_pd(a);
            let e = Self::mul_sub_from(a, Self::mul(y, y), Self::splat(1.0));
            let series = Self::mul_add(Self::splat(0.3125), e, Self::splat(0.375));
            let series = Self::mul_add(series, e, Self::splat(0.5));
            Self::mul_add(series, Self::mul(y, e), y)
        }
    }
    #[inline(always)]
    unsafe fn shift(current: Self::V, previous: Self::V) -> Self::V {
        unsafe {
            let shifted = arch::_mm512_alignr_epi64::<7>(
                arch::_mm512_castpd_si512(current),
                arch::_mm512_castpd_si512(previous),
            );
            arch::_mm512_castsi512_pd(shifted)
        }
    }
}
