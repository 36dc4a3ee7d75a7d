#pragma once

#include <filesystem>
#include <string>

namespace touchtrace {

/// Kinds of files that touchtrace writes and exports.
enum class FileKind { labels, recording, predictions, model };

/// "a labels file", ...
std::string describe(FileKind kind);

/// Recognises a file by its content, not by its name. Throws data_error for any other file.
FileKind recognize_file(const std::filesystem::path& file);

}  // namespace touchtrace
