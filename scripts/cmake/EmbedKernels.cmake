# Puts the text of kernels/*.cl and *.clh into the program, so that it runs without its source tree.
function(touchtrace_embed_kernels folder)
  file(GLOB files CONFIGURE_DEPENDS ${folder}/*.cl ${folder}/*.clh)
  set(generated ${PROJECT_BINARY_DIR}/generated/kernel_sources.cpp)
  add_custom_command(
    OUTPUT ${generated}
    COMMAND ${CMAKE_COMMAND} -DOUTPUT=${generated} -DHEADER=engine/cl/kernel_sources.h
            -DFUNCTION=kernel_sources "-DFILES=${files}"
            -P ${PROJECT_SOURCE_DIR}/scripts/cmake/WriteTexts.cmake
    DEPENDS ${files} ${PROJECT_SOURCE_DIR}/scripts/cmake/WriteTexts.cmake
    VERBATIM)
  add_library(touchtrace_kernels STATIC ${generated})
  target_include_directories(touchtrace_kernels PUBLIC ${PROJECT_SOURCE_DIR})
endfunction()
