#include "pipeline/export/file_kind.h"

#include <fmt/core.h>

#include <cstdint>
#include <cstring>
#include <fstream>

#include "engine/base/error.h"
#include "pipeline/recording/h5_file.h"
#include "pipeline/recording/recording_schema.h"

namespace touchtrace {
namespace {

constexpr const char* kinds_hint =
    "give a recording, a labels file, JSON lines of `touchtrace predict`, or a model";

std::string first_bytes(const std::filesystem::path& file, std::size_t count) {
  std::string bytes(count, '\0');
  std::ifstream stream(file, std::ios::binary);
  if (!std::filesystem::is_regular_file(file) || !stream)
    throw data_error(fmt::format("cannot read {}", file.string()), "check the path");
  stream.read(bytes.data(), static_cast<std::streamsize>(count));
  bytes.resize(static_cast<std::size_t>(stream.gcount()));
  return bytes;
}

FileKind kind_of_hdf5(const std::filesystem::path& file) {
  const std::string schema = h5::schema_of(file);
  if (schema == labels_schema) return FileKind::labels;
  if (schema == recording_schema || schema == recording_schema_1) return FileKind::recording;
  throw data_error(fmt::format("{} has the unknown schema '{}'", file.string(), schema),
                   kinds_hint);
}

/// A safetensors file begins with the size of its JSON header, which fits the file.
bool is_safetensors(const std::filesystem::path& file, const std::string& start) {
  std::uint64_t header_bytes = 0;
  if (start.size() <= sizeof header_bytes) return false;
  std::memcpy(&header_bytes, start.data(), sizeof header_bytes);
  return start[sizeof header_bytes] == '{' && header_bytes < std::filesystem::file_size(file);
}

}  // namespace

std::string describe(FileKind kind) {
  switch (kind) {
    case FileKind::labels:
      return "a labels file";
    case FileKind::recording:
      return "a recording";
    case FileKind::predictions:
      return "a file of predictions";
    case FileKind::model:
      return "a model";
  }
  return "";
}

FileKind recognize_file(const std::filesystem::path& file) {
  const std::string start = first_bytes(file, 16);
  if (start.starts_with("\x89HDF\r\n\x1a\n")) return kind_of_hdf5(file);
  if (start.starts_with("{\"")) return FileKind::predictions;
  if (is_safetensors(file, start)) return FileKind::model;
  throw data_error(
      fmt::format("{} is not a file of touchtrace that can be exported", file.string()),
      kinds_hint);
}

}  // namespace touchtrace
