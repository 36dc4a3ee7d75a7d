#include "pipeline/sweep/cell_identity.h"

#include <fmt/core.h>

#include <filesystem>
#include <set>

#include "engine/base/files.h"
#include "pipeline/recording/labels.h"

namespace touchtrace::sweep {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

/// Hash of the labels that commands read for a recording by default; empty: none.
std::string labels_hash(const fs::path& recording) {
  std::error_code error;
  const auto labels = labels_path_of(recording);
  return recording.extension() == ".h5" && fs::is_regular_file(labels, error)
             ? "+" + sha256_of_file(labels)
             : "";
}

}  // namespace

json outside_identity(const json& value) {
  std::error_code error;  // text that cannot be a path is not one
  if (!value.is_string()) return value;
  const fs::path path = value.get<std::string>();
  if (fs::is_regular_file(path, error)) return "sha256:" + sha256_of_file(path) + labels_hash(path);
  if (!fs::is_directory(path, error)) return value;
  std::set<std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(path))
    if (entry.is_regular_file()) files.insert(entry.path().string());
  std::string text;
  for (const auto& file : files)
    text += fs::relative(file, path).string() + '\0' + sha256_of_file(file) + '\n';
  return "sha256:" + sha256_of(text);
}

std::string cell_id(const std::string& command, const json& identity,
                    const std::vector<Option>& options, const CommandTable& commands) {
  json values = commands.values(command, arguments_of(options, identity));
  for (const auto& [key, value] : identity.items())
    if (!values.contains(key)) values[key] = value;
  const json origin{{"command", command}, {"options", values}, {"version", commands.version}};
  return fmt::format("{}-{}", command, sha256_of(origin.dump()).substr(0, 16));
}

}  // namespace touchtrace::sweep
