#pragma once

// A function that is marked so is compiled for several generations of processors, and the right one is taken
// when the program starts; none of them fuses multiplications with additions, so that all give the same
// bytes. Sanitizers do not bear the functions that choose.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define LOCI_VECTORISED __attribute__((target_clones("avx2", "default")))
#else
#define LOCI_VECTORISED
#endif
