// A function compiled several times, so that one binary runs on all machines and uses what each offers: the loader
// takes the variant that the processor can run. All variants give the same bits: none fuses multiplications and
// additions.
#pragma once

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define RETALHO_VARIANTS __attribute__((target_clones("avx512f", "avx2", "default")))
#define RETALHO_TWO_VARIANTS __attribute__((target_clones("avx2", "default")))  // for long functions
#else
#define RETALHO_VARIANTS
#define RETALHO_TWO_VARIANTS
#endif
