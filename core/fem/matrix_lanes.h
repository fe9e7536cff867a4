// SPDX-License-Identifier: AGPL-3.0-or-later
// Small matrices of several tets at once: what is written for lanes is compiled for two numbers and for four, and four
// are taken where the processor has AVX2. Every helper is inlined, so that it is compiled for the processor that its
// caller is compiled for; the same comes out for each, to the bit. Included by .cpp files only.
#pragma once

#include "core/fem/signed_svd.h"

namespace limber {

#define LIMBER_INLINE [[gnu::always_inline]] inline
#pragma GCC diagnostic ignored "-Wpsabi"  // no vector is handed to a function that is called

struct TwoLanes {
  static constexpr int kCount = 2;
  using Numbers = double __attribute__((vector_size(16)));
};
struct FourLanes {
  static constexpr int kCount = 4;
  using Numbers = double __attribute__((vector_size(32)));
};

// Whether four are to be taken.
inline bool takes_four(MatrixLanes width) {
#if defined(__x86_64__)
  static const bool has_avx2 = __builtin_cpu_supports("avx2");
  return has_avx2 && width == MatrixLanes::Widest;
#else
  static_cast<void>(width);
  return false;
#endif
}

// In front of what takes four.
#if defined(__x86_64__)
#define LIMBER_FOR_FOUR [[gnu::target("avx2")]]
#else
#define LIMBER_FOR_FOUR
#endif

}  // namespace limber
