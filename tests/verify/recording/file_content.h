#pragma once

#include <filesystem>
#include <string>

namespace touchtrace {

// All that is read of a file, as bytes, to compare files. They throw data_error for an invalid one.

/// The members of a recording with truth.
std::string content_of_recording(const std::filesystem::path& path);
std::string content_of_labels(const std::filesystem::path& path);

}  // namespace touchtrace
