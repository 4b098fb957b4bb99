// SPDX-License-Identifier: MIT
#pragma once

// Included by every public header, directly or through others: what is inline in them must give the
// bits that the library gives (docs/determinism.md). Contraction to fused multiply-add shows in no
// macro; the package's targets and earshot.pc turn it off by -ffp-contract=off.

#if defined(__FAST_MATH__) || defined(__ASSOCIATIVE_MATH__) || defined(__RECIPROCAL_MATH__) || \
    (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__ > 0)
#error "earshot needs IEEE 754 arithmetic: compile without -ffast-math, -Ofast and their parts"
#endif
