# touchtrace_embed_texts(target HEADER FUNCTION pattern...): puts files into the program, so that it runs without its
# source tree. HEADER declares FUNCTION, which gives the text of every file by its name.
function(touchtrace_embed_texts target header function)
  file(GLOB files CONFIGURE_DEPENDS ${ARGN})
  set(generated ${PROJECT_BINARY_DIR}/generated/${function}.cpp)
  add_custom_command(
    OUTPUT ${generated}
    COMMAND ${CMAKE_COMMAND} -DOUTPUT=${generated} -DHEADER=${header} -DFUNCTION=${function} "-DFILES=${files}"
            -P ${PROJECT_SOURCE_DIR}/scripts/cmake/WriteTexts.cmake
    DEPENDS ${files} ${PROJECT_SOURCE_DIR}/scripts/cmake/WriteTexts.cmake
    VERBATIM)
  add_library(${target} STATIC ${generated})
  target_include_directories(${target} PUBLIC ${PROJECT_SOURCE_DIR})
endfunction()
