# touchtrace_unity(NAME source...)
# Compiles the sources of a target in groups. The libraries then take about 60 % of the time of one file by file.
# Two files that define one name in their anonymous namespaces are never in one group, so the setting asks nothing
# of the names; only overloads may meet, which is an error where such a function is passed instead of called.
# A file that is changed costs its group: switch it off to work on the code.
option(TOUCHTRACE_UNITY "Compile source files in groups" ON)
set(touchtrace_unity_files 16)  # at most, in a group

# What the file defines in its anonymous namespaces, as a list of names, for functions with parameters.
function(touchtrace_private_names file result)
  file(READ ${file} text)
  string(REGEX REPLACE "[][;\\]" "_" text "${text}")
  string(REPLACE "\nnamespace {\n" "[" text "${text}")
  string(REPLACE "\n}  // namespace\n" "]" text "${text}")
  string(REGEX MATCHALL "\\[[^]]*\\]" regions "${text}")
  string(REGEX MATCHALL "\n[A-Za-z][^\n(={]*[ *&][A-Za-z_0-9]+(\\([^\n]*| ?[={_])" names "${regions}")
  list(TRANSFORM names REPLACE "^[^(={]*[ *&]([A-Za-z_0-9]+ ?[(={_])" "\\1")
  list(TRANSFORM names REPLACE "\\).*| ?[={_]$" "")
  set(${result} ${names} PARENT_SCOPE)
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
    touchtrace_private_names(${source} names)
    list(REMOVE_DUPLICATES names)
    set(group 0)
    while(TRUE)
      set(together ${names} ${names_${group}})
      list(LENGTH together all)
      list(REMOVE_DUPLICATES together)
      list(LENGTH together distinct)
      list(LENGTH files_${group} size)
      if(all EQUAL distinct AND size LESS touchtrace_unity_files)
        break()
      endif()
      math(EXPR group "${group} + 1")
    endwhile()
    list(APPEND names_${group} ${names})
    list(APPEND files_${group} ${source})
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${group})
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  # A local name may repeat another file's private one.
  target_compile_options(${target} PRIVATE -Wno-shadow)
endfunction()
