#pragma once
/// Loops that the compiler turns into vector instructions. The results are the same to the bit for every
/// instruction set: nothing is reordered and nothing contracted.

// A function so marked is compiled for several instruction sets; the program chooses when it starts.
// Sanitizers are not there yet where it chooses.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define VOLCAL_VECTOR_LOOPS __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define VOLCAL_VECTOR_LOOPS
#endif
