# touchtrace_unity(NAME source...)
# Compiles the sources of a target in groups. The libraries then take about 60 % of the time of one file by file.
# Two files that define one name in their anonymous namespaces are never in one group, so the setting asks nothing
# of the names; only overloads may meet, which is an error where such a function is passed instead of called.
# A file that is changed costs its group: switch it off to work on the code.
option(TOUCHTRACE_UNITY "Compile source files in groups" ON)
set(touchtrace_unity_files 16)  # at most, in a group

# Sets `defined` to the names that the file defines in its anonymous namespaces, for functions with the types of
# their parameters, and `used` to those that it takes from other namespaces.
function(touchtrace_private_names file defined used)
  file(READ ${file} text)
  string(REGEX REPLACE "[][;\\]" "_" text "${text}")
  string(REGEX MATCHALL "\nusing [^=\n]*::[^=\n]*" usings "${text}")
  string(REGEX MATCHALL "::[A-Za-z_0-9]+" usings "${usings}")
  list(TRANSFORM usings REPLACE "^::|_$" "")
  string(REPLACE "\nnamespace {\n" "[" text "${text}")
  string(REPLACE "\n}  // namespace\n" "]" text "${text}")
  string(REGEX MATCHALL "\\[[^]]*\\]" regions "${text}")
  string(REGEX MATCHALL "\n[A-Za-z][^\n(={]*[ *&][A-Za-z_0-9]+(\\([^\n]*| ?[={_])" names "${regions}")
  list(TRANSFORM names REPLACE "^[^(={]*[ *&]([A-Za-z_0-9]+ ?[(={_])" "\\1")
  list(TRANSFORM names REPLACE "\\).*| ?[={_]$" "")
  set(shortest ${names})
  list(TRANSFORM shortest REPLACE ",[^,=]*=.*" "")  # without parameters that have defaults
  list(APPEND names ${shortest})
  list(TRANSFORM names REPLACE "([ *&])[A-Za-z_0-9]+(,|$)" "\\1\\2")  # names of parameters
  string(REGEX MATCHALL "\nconst[^\n]*" constants "${regions}")
  string(REGEX MATCHALL ", [A-Za-z_0-9]+( = |{)" further "${constants}")  # of one declaration
  list(TRANSFORM further REPLACE "^, | = $|{$" "")
  set(${defined} ${names} ${further} PARENT_SCOPE)
  set(${used} ${usings} PARENT_SCOPE)
endfunction()

function(touchtrace_are_disjoint first second result)
  list(REMOVE_DUPLICATES first)
  list(REMOVE_DUPLICATES second)
  set(together ${first} ${second})
  list(LENGTH together all)
  list(REMOVE_DUPLICATES together)
  list(LENGTH together distinct)
  if(all EQUAL distinct)
    set(${result} TRUE PARENT_SCOPE)
  else()
    set(${result} FALSE PARENT_SCOPE)
  endif()
endfunction()

# The first group that has room for the file and none of its names.
function(touchtrace_unity target)
  if(NOT TOUCHTRACE_UNITY)
    return()
  endif()
  # Groups are made again when a source changes.
  set_property(DIRECTORY ${PROJECT_SOURCE_DIR} APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${ARGN})
  foreach(source ${ARGN})
    get_source_file_property(definitions ${source} COMPILE_DEFINITIONS)
    if(definitions)  # CMake compiles it alone
      continue()
    endif()
    touchtrace_private_names(${source} defined used)
    set(group 0)
    while(TRUE)
      touchtrace_are_disjoint("${defined}" "${defined_${group}};${used_${group}}" are_new)
      touchtrace_are_disjoint("${used}" "${defined_${group}}" are_foreign)
      list(LENGTH files_${group} size)
      if(are_new AND are_foreign AND size LESS touchtrace_unity_files)
        break()
      endif()
      math(EXPR group "${group} + 1")
    endwhile()
    list(APPEND defined_${group} ${defined})
    list(APPEND used_${group} ${used})
    list(APPEND files_${group} ${source})
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${group})
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  # A local name may repeat another file's private one.
  target_compile_options(${target} PRIVATE -Wno-shadow)
endfunction()
