#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "pipeline/acquire/import/formats/byte_reader.h"

namespace touchtrace {

/// Parser of untrusted bytes under test. `parse` may throw Error for invalid input, with the exit
/// code of invalid data or usage, and nothing else.
struct FuzzTarget {
  std::string name;
  std::string extension;  ///< of the file that is parsed
  std::function<void(const std::filesystem::path& file, ByteSpan bytes)> parse;
};

const std::vector<FuzzTarget>& fuzz_targets();

/// Runs the parser on `bytes`, in a file in the temporary directory. Throws std::logic_error for an
/// invalid result or an Error of another exit code; every other exception passes through.
void run_fuzz_target(const FuzzTarget& target, ByteSpan bytes);

}  // namespace touchtrace
