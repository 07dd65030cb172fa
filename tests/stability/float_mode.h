// SPDX-License-Identifier: Apache-2.0
// Whether a thread computes as IEEE 754 says: denormals, NaN, infinities, rounding to even, no reordering.
#pragma once

#include <cmath>
#include <limits>
#if defined(__SSE__)
#  include <xmmintrin.h>
#endif

namespace farfield::stability {

/// Volatile: what the processor does, not what the compiler knows.
template <class T>
inline bool is_ieee() {
  volatile T smallest = std::numeric_limits<T>::denorm_min(), least_normal = std::numeric_limits<T>::min();
  volatile T half = least_normal / 2, nan = std::numeric_limits<T>::quiet_NaN(), one = 1, zero = 0;
  const bool has_denormals = smallest > 0 && half > 0 && half + half == least_normal && smallest * one == smallest;
  const bool compares_nan = nan != nan && !(nan < one) && !(nan >= one) && std::isnan(nan);
  volatile T infinite = one / zero;
  const bool has_infinity = infinite > std::numeric_limits<T>::max() && std::isinf(infinite) && one / infinite == 0;
  volatile T large = std::ldexp(one, std::numeric_limits<T>::digits), small_part = large + one;
  const bool rounds_to_even = small_part == large;  // and does not reorder (large + 1) − large
  return has_denormals && compares_nan && has_infinity && rounds_to_even && (small_part - large) == 0;
}

/// Asks the calling thread.
inline bool is_thread_ieee() {
  bool result = is_ieee<float>() && is_ieee<double>();
#if defined(__SSE__)
  constexpr unsigned kFlushToZero = 0x8000, kDenormalsAreZero = 0x0040, kRounding = 0x6000;
  result = result && (_mm_getcsr() & (kFlushToZero | kDenormalsAreZero | kRounding)) == 0;
#endif
  return result;
}

}  // namespace farfield::stability
