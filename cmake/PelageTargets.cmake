# Wide code lives in thousands of vectors on the stack, and GCC needs minutes and gigabytes to watch each of them. There the
# address sanitizer checks what is read and written outside the stack, which is where an index can go wrong.
function(pelage_ease_sanitizers target)
  if(NOT PELAGE_SANITIZE MATCHES address OR NOT CMAKE_CXX_COMPILER_ID STREQUAL GNU)
    return()
  endif()
  foreach(source ${ARGN})
    file(STRINGS ${source} wide LIMIT_COUNT 1 REGEX "hwy/foreach_target")
    if(wide)
      set_source_files_properties(${source} TARGET_DIRECTORY ${target} PROPERTIES
                                  COMPILE_OPTIONS "-fno-sanitize=undefined;--param;asan-stack=0")
    endif()
  endforeach()
endfunction()

# pelage_sources(a.cpp …): adds files of the current folder to the library.
function(pelage_sources)
  list(TRANSFORM ARGN PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/)
  target_sources(pelage PRIVATE ${ARGN})
  pelage_ease_sanitizers(pelage ${ARGN})
endfunction()

# pelage_test(name a_test.cpp …): one test program, one ctest entry. Tests may include internal headers.
function(pelage_test name)
  if(NOT PELAGE_TESTS)
    return()
  endif()
  add_executable(${name}_test ${ARGN})
  list(TRANSFORM ARGN PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/ OUTPUT_VARIABLE sources)
  pelage_ease_sanitizers(${name}_test ${sources})
  target_include_directories(${name}_test PRIVATE ${PROJECT_SOURCE_DIR}/src ${PROJECT_SOURCE_DIR}/tests)
  target_link_libraries(${name}_test PRIVATE pelage pelage_options GTest::gmock GTest::gtest_main TBB::tbb hwy::hwy
                                             fmt::fmt embree JPEG::JPEG nlohmann_json::nlohmann_json)
  target_compile_definitions(${name}_test PRIVATE PELAGE_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  add_test(NAME ${name} COMMAND ${name}_test)
  set_tests_properties(${name} PROPERTIES ENVIRONMENT "PELAGE_DATA=${PELAGE_DATA}" TIMEOUT 300)
endfunction()
