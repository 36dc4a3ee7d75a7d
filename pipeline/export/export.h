#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "pipeline/export/file_kind.h"

namespace touchtrace {

/// One call of `touchtrace export`.
struct ExportRequest {
  FileKind kind;
  std::filesystem::path input, output;
  /// Recording of the labels or predictions: gives their Unix time and, in MCAP files, touch and
  /// images. Empty: none.
  std::filesystem::path recording = {};
  bool images = false;  ///< MCAP: include the camera's images
  bool overwrite = false;
};

/// Format of another program. To add one, write its file and a row in formats.cpp.
struct ExportFormat {
  const char *name, *description;  ///< description: begins in lower case, no full stop
  std::vector<FileKind> inputs;
  bool uses_recording = false;  ///< whether ExportRequest::recording has an effect
  bool uses_images = false;     ///< whether ExportRequest::images has an effect
  /// Writes the output and returns the paths of all files of it. Throws data_error.
  std::vector<std::filesystem::path> (*write)(const ExportRequest& request);
};

/// All formats.
std::span<const ExportFormat> export_formats();

/// Names of the formats that files of this kind can be written in.
std::vector<std::string> formats_of(FileKind kind);

/// Writes `request` in the format `name` and returns the paths of all files. Throws usage_error if
/// the format does not fit the kind of the input or an option has no effect.
std::vector<std::filesystem::path> export_file(const std::string& name,
                                               const ExportRequest& request);

// Each in its own file:
std::vector<std::filesystem::path> write_csv(const ExportRequest& request);
std::vector<std::filesystem::path> write_npz(const ExportRequest& request);
std::vector<std::filesystem::path> write_tum(const ExportRequest& request);
std::vector<std::filesystem::path> write_mcap(const ExportRequest& request);
std::vector<std::filesystem::path> write_rosbag2(const ExportRequest& request);
std::vector<std::filesystem::path> write_onnx(const ExportRequest& request);

}  // namespace touchtrace
