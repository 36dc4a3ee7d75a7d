#include "tests/verify/areas.h"

int main(int argc, char** argv) {
  return touchtrace::cli::run_command_line(touchtrace::verify::verify_program(), argc, argv);
}
