#pragma once

#include <string>
#include <vector>

#include "engine/base/options.h"

namespace touchtrace::cli {

/// Assigns arguments to the targets of options and returns the names of the options given.
///
/// Accepts `--name VALUE`, `--name=VALUE`, `-o VALUE` for --output, `--name A B C` and repeated
/// --name for lists, positional arguments in any place, and `--` before further positional ones. A
/// positional list takes all arguments that are left.
/// `usage` is the hint for misplaced arguments. Throws usage_error.
std::vector<std::string> parse_arguments(const std::vector<std::string>& arguments,
                                         const std::vector<Option>& options,
                                         const std::string& usage);

}  // namespace touchtrace::cli
