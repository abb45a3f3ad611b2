# Headers of libraries, compiled once where LIGHTLOOM_PRECOMPILED is on: a third of the time that a clean build takes.
# Release builds go without, so that a file that leans on another's includes does not get far.
set(LIGHTLOOM_STD_HEADERS <algorithm> <array> <atomic> <cmath> <cstdint> <filesystem> <functional> <limits> <map>
    <memory> <optional> <span> <stop_token> <string> <string_view> <unordered_map> <vector> <fmt/format.h>
    <glm/glm.hpp>)

if(LIGHTLOOM_PRECOMPILED AND CCACHE AND CMAKE_CXX_COMPILER_LAUNCHER STREQUAL CCACHE)
  # what ccache asks for before it keeps results of such files
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros ${CCACHE})
endif()

# Gives `target` the standard headers and those named; with REUSE another target's, which has to have the same flags.
function(lightloom_precompile target)
  cmake_parse_arguments(arg "" "REUSE" "" ${ARGN})
  if(NOT LIGHTLOOM_PRECOMPILED)
    return()
  endif()
  if(arg_REUSE)
    target_precompile_headers(${target} REUSE_FROM ${arg_REUSE})
  else()
    target_precompile_headers(${target} PRIVATE ${LIGHTLOOM_STD_HEADERS} ${arg_UNPARSED_ARGUMENTS})
  endif()
endfunction()
