# touchtrace_embed_texts(library HEADER FUNCTION pattern...): compiles the text of files into a library, so that the
# program runs without its source tree. HEADER declares FUNCTION, which returns the text of each file by its name.
function(touchtrace_embed_texts library header function)
  file(GLOB files CONFIGURE_DEPENDS ${ARGN})
  set(generated ${PROJECT_BINARY_DIR}/generated/${function}.cpp)
  add_custom_command(
    OUTPUT ${generated}
    COMMAND ${CMAKE_COMMAND} -DOUTPUT=${generated} -DHEADER=${header} -DFUNCTION=${function} "-DFILES=${files}"
            -P ${PROJECT_SOURCE_DIR}/scripts/cmake/WriteTexts.cmake
    DEPENDS ${files} ${PROJECT_SOURCE_DIR}/scripts/cmake/WriteTexts.cmake
    VERBATIM)
  target_sources(touchtrace_${library} PRIVATE ${generated})
endfunction()
