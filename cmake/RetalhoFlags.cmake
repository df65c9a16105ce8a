# Flags of the whole house, as one interface target: nothing global leaks into a parent project.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM AND PROJECT_IS_TOP_LEVEL)
  # Paths count from the checkout: another build folder beside this one, or another checkout, finds the same objects.
  set(CMAKE_CXX_COMPILER_LAUNCHER "${CMAKE_COMMAND}" -E env "CCACHE_BASEDIR=${PROJECT_SOURCE_DIR}" CCACHE_NOHASHDIR=1 "${CCACHE_PROGRAM}")
endif()

add_library(retalho_flags INTERFACE)
# No contraction into fused multiply-adds: the same bytes on every build, and exact decisions stay exact.
target_compile_options(retalho_flags INTERFACE -Wall -Wextra -Wshadow -Wconversion -Wno-sign-conversion -ffp-contract=off)
if(RETALHO_WERROR)
  target_compile_options(retalho_flags INTERFACE -Werror)
endif()

set(RETALHO_SANITIZE "" CACHE STRING "Sanitizers, as -fsanitize takes them")
if(RETALHO_SANITIZE)
  target_compile_options(retalho_flags INTERFACE -fsanitize=${RETALHO_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  target_link_options(retalho_flags INTERFACE -fsanitize=${RETALHO_SANITIZE})
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # With sanitizers GCC 12 takes members of the standard library (std::regex, std::function) for uninitialized.
    target_compile_options(retalho_flags INTERFACE -Wno-maybe-uninitialized)
  endif()
endif()
option(RETALHO_COVERAGE "Instrument for line coverage" OFF)
if(RETALHO_COVERAGE)
  target_compile_options(retalho_flags INTERFACE --coverage)
  target_link_options(retalho_flags INTERFACE --coverage)
endif()
