# Run with OUTPUT and SOURCE_DIR: writes a header that defines TOUCHTRACE_COMMIT, if it has changed.
execute_process(COMMAND git -C ${SOURCE_DIR} describe --always --dirty --exclude=* --abbrev=12
                OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
if(failed)
  set(commit unknown)
endif()
file(CONFIGURE OUTPUT ${OUTPUT} CONTENT "#define TOUCHTRACE_COMMIT \"${commit}\"\n")
