# Flags that every target of the project shares, as the interface target pelage_options.
if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "" FORCE)
endif()
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_CXX_FLAGS_RELEASE "-O3 -DNDEBUG")

find_program(PELAGE_CCACHE ccache)
if(PELAGE_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${PELAGE_CCACHE})
endif()

add_library(pelage_options INTERFACE)
target_compile_options(pelage_options INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wno-psabi
  -ffp-contract=off -fno-math-errno)
# SSSE3 (bit 12) adds nothing between EMU128 and SSE4 (11) that anyone owns. Instrumented wide code is slow to compile: the
# address sanitizer goes without SSE4 and AVX3 (7, 8); races do not depend on the instruction set, so the thread sanitizer
# goes without AVX3 and AVX2 (9).
set(disabled "(1LL<<12)")
if(PELAGE_SANITIZE MATCHES address)
  set(disabled "((1LL<<12)|(1LL<<11)|(1LL<<8)|(1LL<<7))")
elseif(PELAGE_SANITIZE MATCHES thread)
  set(disabled "((1LL<<12)|(1LL<<9)|(1LL<<8)|(1LL<<7))")
endif()
target_compile_definitions(pelage_options INTERFACE "HWY_DISABLED_TARGETS=${disabled}" PELAGE_VERSION="${PROJECT_VERSION}")
target_compile_definitions(pelage_options INTERFACE PELAGE_HAIRMESH=$<BOOL:${PELAGE_HAIRMESH}>)
if(PELAGE_SCALAR)
  target_compile_definitions(pelage_options INTERFACE HWY_COMPILE_ONLY_SCALAR)
endif()
if(PELAGE_SANITIZE)
  target_compile_options(pelage_options INTERFACE -fsanitize=${PELAGE_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_link_options(pelage_options INTERFACE -fsanitize=${PELAGE_SANITIZE})
endif()
if(PELAGE_COVERAGE)
  target_compile_options(pelage_options INTERFACE --coverage -fprofile-update=atomic)
  target_link_options(pelage_options INTERFACE --coverage)
endif()
