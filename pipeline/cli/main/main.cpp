#include "pipeline/cli/commands.h"

int main(int argc, char** argv) {
  return touchtrace::cli::run_command_line(touchtrace::cli::touchtrace_program(), argc, argv);
}
