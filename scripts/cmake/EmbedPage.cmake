# Puts the page of the report (HTML, CSS, scripts) into the program, so that a report needs no other file.
function(touchtrace_embed_page target folder)
  file(GLOB files CONFIGURE_DEPENDS ${folder}/*.html ${folder}/*.css ${folder}/*.js)
  set(generated ${PROJECT_BINARY_DIR}/generated/report_page.cpp)
  add_custom_command(
    OUTPUT ${generated}
    COMMAND ${CMAKE_COMMAND} -DOUTPUT=${generated} -DHEADER=pipeline/report/page.h -DFUNCTION=report_page
            "-DFILES=${files}" -P ${PROJECT_SOURCE_DIR}/scripts/cmake/WriteTexts.cmake
    DEPENDS ${files} ${PROJECT_SOURCE_DIR}/scripts/cmake/WriteTexts.cmake
    VERBATIM)
  add_library(${target} STATIC ${generated})
  target_include_directories(${target} PUBLIC ${PROJECT_SOURCE_DIR})
endfunction()
