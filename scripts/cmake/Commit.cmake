# touchtrace_commit(target): every build updates generated/commit.h, which the target can include.
function(touchtrace_commit target)
  add_custom_target(write_commit BYPRODUCTS ${PROJECT_BINARY_DIR}/generated/commit.h
    COMMAND ${CMAKE_COMMAND} -DOUTPUT=${PROJECT_BINARY_DIR}/generated/commit.h -DSOURCE_DIR=${PROJECT_SOURCE_DIR}
            -P ${PROJECT_SOURCE_DIR}/scripts/cmake/WriteCommit.cmake
    VERBATIM)
  add_dependencies(${target} write_commit)
  target_include_directories(${target} PRIVATE ${PROJECT_BINARY_DIR})
endfunction()
