#include "pipeline/cli/verb.h"

int main(int argc, char** argv) { return touchtrace::cli::run_command_line(argc, argv); }
