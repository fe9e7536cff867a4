// SPDX-License-Identifier: AGPL-3.0-or-later
// Computes with small matrices of several tets at once, one tet per SIMD lane. Code is compiled for two lanes and for
// four; four are used if the processor has AVX2. Every helper is inlined, so that it is compiled for the same
// instruction set as its caller. Both widths give the same result, bit for bit. Only .cpp files include this header.
#pragma once

#include "core/fem/signed_svd.h"

namespace limber {

#define LIMBER_INLINE [[gnu::always_inline]] inline
#pragma GCC diagnostic ignored "-Wpsabi"  // no vector is passed to a function that is not inlined

struct TwoLanes {
  static constexpr int kCount = 2;
  using Numbers = double __attribute__((vector_size(16)));
};
struct FourLanes {
  static constexpr int kCount = 4;
  using Numbers = double __attribute__((vector_size(32)));
};

// Returns true if the code should compute with four lanes: the processor has AVX2 and `width` permits it.
inline bool takes_four(MatrixLanes width) {
#if defined(__x86_64__)
  static const bool has_avx2 = __builtin_cpu_supports("avx2");
  return has_avx2 && width == MatrixLanes::Widest;
#else
  static_cast<void>(width);
  return false;
#endif
}

// Attribute of functions that compute with four lanes: the compiler may use AVX2 in them.
#if defined(__x86_64__)
#define LIMBER_FOR_FOUR [[gnu::target("avx2")]]
#else
#define LIMBER_FOR_FOUR
#endif

}  // namespace limber
