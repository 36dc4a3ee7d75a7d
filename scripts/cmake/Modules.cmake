# touchtrace_library(NAME [UNITY] FOLDERS folder... LINKS target... PRECOMPILE header...)
# Static library touchtrace_NAME of all sources in the folders, exported as touchtrace::NAME.
function(touchtrace_library name)
  cmake_parse_arguments(LIBRARY "UNITY" "" "FOLDERS;LINKS;PRECOMPILE" ${ARGN})
  set(patterns ${LIBRARY_FOLDERS})
  list(TRANSFORM patterns PREPEND ${PROJECT_SOURCE_DIR}/)
  list(TRANSFORM patterns APPEND /*.cpp)
  file(GLOB sources CONFIGURE_DEPENDS ${patterns})
  add_library(touchtrace_${name} STATIC ${sources})
  if(LIBRARY_UNITY)
    touchtrace_unity(touchtrace_${name} ${sources})
  endif()
  add_library(touchtrace::${name} ALIAS touchtrace_${name})
  set_target_properties(touchtrace_${name} PROPERTIES EXPORT_NAME ${name})
  target_link_libraries(touchtrace_${name} PUBLIC ${LIBRARY_LINKS})
  target_include_directories(touchtrace_${name} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/touchtrace>)
  target_compile_features(touchtrace_${name} PUBLIC cxx_std_20)
  if(LIBRARY_PRECOMPILE)
    target_precompile_headers(touchtrace_${name} PRIVATE ${LIBRARY_PRECOMPILE})
  endif()
endfunction()

# touchtrace_tests(folder LINKS target...): one GoogleTest executable test_<folder> of tests/<folder>/*_test.cpp
# In groups and optimised little, to compile faster.
function(touchtrace_tests folder)
  cmake_parse_arguments(TESTS "" "" "LINKS" ${ARGN})
  set(name test_${folder})
  file(GLOB sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/tests/${folder}/*_test.cpp)
  add_executable(${name} ${sources})
  touchtrace_unity(${name} ${sources})
  target_link_libraries(${name} PRIVATE ${TESTS_LINKS} GTest::gtest GTest::gtest_main)
  target_precompile_headers(${name} PRIVATE <gtest/gtest.h> <algorithm> <cmath> <filesystem> <fmt/core.h>)
  target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-O1>)
  target_compile_definitions(${name} PRIVATE TOUCHTRACE_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
                             TOUCHTRACE_PROGRAM="$<TARGET_FILE:touchtrace>")
  # Tests neither read nor write the user's tuning file.
  gtest_discover_tests(${name} DISCOVERY_MODE PRE_TEST
                       PROPERTIES TIMEOUT 600 ENVIRONMENT XDG_CACHE_HOME=${PROJECT_BINARY_DIR}/cache)
endfunction()
