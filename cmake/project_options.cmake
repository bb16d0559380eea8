# What every target of the project is compiled with: the target `project_options`.
if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "" FORCE)
endif()

option(MASTIC_NATIVE "Use all instructions of the machine that compiles" ON)
option(MASTIC_SANITIZE "Address and undefined-behaviour sanitizers" OFF)

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE_PROGRAM})
endif()

add_library(project_options INTERFACE)
# No -ffast-math: sums keep their order and NaN stays visible. errno and traps are not used.
target_compile_options(project_options INTERFACE
  -Wall -Wextra -Wshadow -fno-math-errno -fno-trapping-math
  -Wno-maybe-uninitialized # GCC 12 warns inside its own AVX-512 header
  -Wno-restrict)           # and inside its own std::string
if(MASTIC_NATIVE)
  target_compile_options(project_options INTERFACE -march=native)
endif()
if(MASTIC_SANITIZE)
  target_compile_options(project_options INTERFACE
    -fsanitize=address,undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer)
  target_link_options(project_options INTERFACE -fsanitize=address,undefined)
endif()
