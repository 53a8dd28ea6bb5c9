#pragma once

// Functions built for several instruction sets, of which one is chosen at run time. Only this file
// has attributes of a compiler.

// A function that is always inlined takes the instruction set of its caller.
#define MINDAHL_INLINE_LAMBDA __attribute__((always_inline))
#define MINDAHL_INLINE inline MINDAHL_INLINE_LAMBDA

#if defined(__x86_64__)
#define MINDAHL_TARGET_AVX2 __attribute__((target("avx2,fma")))
#define MINDAHL_TARGET_AVX512 __attribute__((target("avx512f,avx512dq")))

namespace mindahl {

/// True if the processor runs MINDAHL_TARGET_AVX2.
inline bool HasAvx2() { return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"); }

/// True if the processor runs MINDAHL_TARGET_AVX512.
inline bool HasAvx512() {
  return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq");
}

}  // namespace mindahl
#endif
