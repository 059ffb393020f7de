# Language level, warnings, sanitizers and reproducible floating point for every target of the project.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_VERIFY_INTERFACE_HEADER_SETS ON)
if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
endif()

# CMake's own -O3 costs a third more build time than -O2; flags that a user chose are kept.
if(CMAKE_CXX_FLAGS_RELEASE STREQUAL "-O3 -DNDEBUG")
  set(CMAKE_CXX_FLAGS_RELEASE "-O2 -DNDEBUG")
endif()

find_program(TOUCHSTONE_CCACHE ccache)
if(TOUCHSTONE_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${TOUCHSTONE_CCACHE})
  set(CMAKE_C_COMPILER_LAUNCHER ${TOUCHSTONE_CCACHE})
endif()

add_library(touchstone_options INTERFACE)
# Fused multiply-add changes goldens by rounding; without it compilers and optimisation levels agree to the bit.
set(TOUCHSTONE_FP_CONTRACT off CACHE STRING "-ffp-contract: anything but off is for measuring the noise floor of goldens (ci/golden-floor)")
target_compile_options(touchstone_options INTERFACE -ffp-contract=${TOUCHSTONE_FP_CONTRACT})
# ccache can only cache units that use a precompiled header when the preprocessor keeps track of it.
target_compile_options(touchstone_options INTERFACE $<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess>)
target_compile_options(touchstone_options INTERFACE
  -Wall -Wextra -Wpedantic -Wnon-virtual-dtor -Wold-style-cast -Wcast-qual
  -Woverloaded-virtual -Wimplicit-fallthrough -Wunused)
# In a unit of several files a name of one file's unnamed namespace is not shadowed by a parameter in the next.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND TOUCHSTONE_UNITY GREATER 1)
  target_compile_options(touchstone_options INTERFACE -Wshadow=local -Wno-subobject-linkage)
else()
  target_compile_options(touchstone_options INTERFACE -Wshadow)
endif()
if(TOUCHSTONE_WERROR)
  target_compile_options(touchstone_options INTERFACE -Werror)
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # GCC 12 reports these from inside Eigen and libstdc++ at -O2; clang and the sanitizers cover the real ones.
  target_compile_options(touchstone_options INTERFACE -Wno-maybe-uninitialized -Wno-array-bounds -Wno-stringop-overflow -Wno-restrict)
endif()
if(TOUCHSTONE_SANITIZE)
  target_compile_options(touchstone_options INTERFACE -fsanitize=${TOUCHSTONE_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  target_link_options(touchstone_options INTERFACE -fsanitize=${TOUCHSTONE_SANITIZE})
endif()
if(TOUCHSTONE_BUILD_FUZZERS)
  # Coverage of the whole tree guides the fuzzers.
  target_compile_options(touchstone_options INTERFACE -fsanitize=fuzzer-no-link)
  target_link_options(touchstone_options INTERFACE -fsanitize=fuzzer-no-link)
endif()
