# Flags for our own code only. Any x86-64-v2 machine runs the program; hot loops pick wider vectors at run time.
# -ffp-contract=off: a fused multiply-add would give other bits on other machines.
add_library(lightloom_flags INTERFACE)
target_compile_options(lightloom_flags INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wnon-virtual-dtor -Werror
  -march=x86-64-v2 -ffp-contract=off -fno-math-errno)
# at -O3 g++ 12 sees overlapping copies inside std::string that are not there (GCC bug 105651)
target_compile_options(lightloom_flags INTERFACE
  $<$<AND:$<CXX_COMPILER_ID:GNU>,$<CONFIG:Release>>:-Wno-restrict>)
target_compile_definitions(lightloom_flags INTERFACE GLM_FORCE_XYZW_ONLY GLM_ENABLE_EXPERIMENTAL QT_NO_KEYWORDS)
target_include_directories(lightloom_flags INTERFACE ${PROJECT_SOURCE_DIR})
if(LIGHTLOOM_ASSERTS)
  target_compile_options(lightloom_flags INTERFACE -UNDEBUG)
endif()
if(LIGHTLOOM_SANITIZE)
  # a finding ends the program, so that no test passes over one; line tables are all the debug info a report needs
  add_compile_options(-fsanitize=${LIGHTLOOM_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer -g1)
  add_compile_definitions(_GLIBCXX_ASSERTIONS)
  add_link_options(-fsanitize=${LIGHTLOOM_SANITIZE})
endif()
