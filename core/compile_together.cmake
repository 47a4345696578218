# compile_together(TARGET [FILE...] [APART FILE...]...): the files of a target together, sixty at a time.
# FILEs whose local names clash with others' are compiled by themselves, or with those behind the same
# APART. Templates that several files use are compiled once. Not in the preset dev, where one file
# changes at a time.
# (Eigen comes before httplib, whose headers define a macro that breaks it.)
function(compile_together target)
  if(CMAKE_BUILD_TYPE STREQUAL Debug)
    return()
  endif()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP
    UNITY_BUILD_CODE_BEFORE_INCLUDE "#include <Eigen/Core>")
  set(apart 0)
  foreach(file ${ARGN})
    if(file STREQUAL APART)
      math(EXPR apart "${apart} + 1")
    elseif(apart)
      set_source_files_properties(${file} PROPERTIES UNITY_GROUP apart_${apart})
    endif()
  endforeach()
  get_target_property(sources ${target} SOURCES)
  set(group 1)
  set(place 0)
  foreach(source ${sources})
    get_filename_component(source ${source} ABSOLUTE)
    file(RELATIVE_PATH name ${CMAKE_CURRENT_SOURCE_DIR} ${source})
    if(place EQUAL 60)
      set(place 0)
      math(EXPR group "${group} + 1")
    endif()
    if(NOT name IN_LIST ARGN AND NOT source IN_LIST ARGN)
      set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${group})
      math(EXPR place "${place} + 1")
    endif()
  endforeach()
endfunction()

# compile_for_little_work(FLAGS): compiles this folder with FLAGS in a release build; nothing in it computes
# for long. Sanitizer builds do not optimise it: the compiler would need more time than its tests gain.
macro(compile_for_little_work flags)
  set(CMAKE_CXX_FLAGS_RELEASE "${flags}")
  if(UNWRAPD_SANITIZE AND CMAKE_CXX_COMPILER_ID STREQUAL GNU)
    set(CMAKE_CXX_FLAGS_RELWITHDEBINFO "-O0")
  endif()
endmacro()

# precompile(TARGET [HEADER...]): Eigen, what most files take from the standard library, and HEADERs,
# compiled once for all files of TARGET: for the many small programs of the tests. Libraries go without:
# sixty files at a time read each header once anyway, and GCC is slower where a precompiled one holds more
# than they use. Not in the preset dev: there a file that forgets an include does not compile.
function(precompile target)
  if(NOT CMAKE_BUILD_TYPE STREQUAL Debug)
    target_precompile_headers(${target} PRIVATE <Eigen/Core> <Eigen/Geometry> <algorithm> <array>
      <cmath> <functional> <map> <memory> <optional> <random> <span> <stop_token> <string> <vector>
      ${ARGN})
  endif()
endfunction()

# precompile_as(TARGET OTHER): what OTHER has precompiled, which is compiled with the same flags.
function(precompile_as target other)
  if(NOT CMAKE_BUILD_TYPE STREQUAL Debug)
    target_precompile_headers(${target} REUSE_FROM ${other})
  endif()
endfunction()
