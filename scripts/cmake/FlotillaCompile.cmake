# SPDX-License-Identifier: MIT
# Compile options as interface targets; nothing here touches global flags.

# Warnings, for our own code only.
add_library(flotilla_warnings INTERFACE)
target_compile_options(flotilla_warnings INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion
  $<$<BOOL:${FLOTILLA_WERROR}>:-Werror>)

# Numerics: the same bits from every compiler and optimisation level.
#  -ffp-contract=off       no fused multiply-add where the source has none
#  -fno-tree-slp-vectorize g++ 12 contracts in its SLP vectoriser in spite of the flag above
#  EIGEN_DONT_VECTORIZE    Eigen's packet sums change the order of additions
add_library(flotilla_numerics INTERFACE)
target_compile_features(flotilla_numerics INTERFACE cxx_std_20)
target_compile_options(flotilla_numerics INTERFACE -ffp-contract=off $<$<CXX_COMPILER_ID:GNU>:-fno-tree-slp-vectorize>)
target_compile_definitions(flotilla_numerics INTERFACE EIGEN_DONT_VECTORIZE)

# Flags of the kernels compiled for one instruction set and chosen at run time. A fused operation would give other bits
# than the scalar code. clang forms none with contraction off; g++ 12 may, so FMA is off there (in clang that would take
# AVX-512 away with it).
set(flotilla_no_fma $<$<CXX_COMPILER_ID:GNU>:-mno-fma>)
set(FLOTILLA_AVX2_FLAGS -mavx2 ${flotilla_no_fma})
set(FLOTILLA_AVX512_FLAGS -mavx512f -mavx512dq -mavx512vl ${flotilla_no_fma} -mprefer-vector-width=512
  $<$<CXX_COMPILER_ID:GNU>:-Wno-uninitialized>        # false alarms in g++ 12's own intrinsics header
  $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)

# What a build checks while it runs. Whatever links the library inside this tree gets the same flags, because an
# instrumented library needs its runtime in the program; nothing of it is exported.
add_library(flotilla_checks INTERFACE)
target_compile_definitions(flotilla_checks INTERFACE $<$<CONFIG:RelWithDebInfo>:FLOTILLA_ASSERTIONS>)
if(FLOTILLA_SANITIZE)
  set(sanitize "-fsanitize=${FLOTILLA_SANITIZE}" -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_compile_options(flotilla_checks INTERFACE ${sanitize})
  target_link_options(flotilla_checks INTERFACE ${sanitize})
endif()
if(FLOTILLA_COVERAGE)
  target_compile_options(flotilla_checks INTERFACE --coverage)
  target_link_options(flotilla_checks INTERFACE --coverage)
endif()
