#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace touchtrace {

/// Frames of a tactile glove in a file of another program.
struct GloveFile {
  int rows = 0, cols = 0;
  std::vector<double> time_s;           ///< [frames], stamps of the file's clock
  double epoch_unix_s = 0.0;            ///< Unix time of the stamps' 0; 0: unknown
  bool has_time_unit = false;           ///< stamps are known to be seconds
  double counted_rate_hz = 0.0;         ///< of stamps that count frames; 0: stamps of a clock
  std::vector<std::uint64_t> sequence;  ///< [frames], the device's frame counter; empty: unknown
  std::vector<float> values;            ///< [frames, rows, cols]

  std::size_t taxels() const { return static_cast<std::size_t>(rows) * cols; }
};

/// What files cannot tell from their content.
struct GloveFileOptions {
  int rows = 0, cols = 0;  ///< of values without a shape; 0: unknown
  double rate_hz = 0.0;    ///< of frames without times; 0: unknown
  std::string taxels;      ///< columns FIRST:LAST of a table, by name or number; empty: all
  std::string stream;      ///< glove or recording in a file of several; empty: the only one
};

/// Kind of file. To add one, write its file and a row in glove_file.cpp.
struct GloveFileKind {
  const char* name;
  bool (*is_kind)(const std::filesystem::path& file);
  GloveFile (*read)(const std::filesystem::path& file, const GloveFileOptions& options);
};

/// Reads a file; its content tells the kind. The frames are complete, at least one. Throws
/// data_error.
GloveFile read_glove_file(const std::filesystem::path& file, const GloveFileOptions& options);

/// Throws data_error if the user chose one of several gloves, but the file has one.
void require_no_stream(const GloveFileOptions& options);

/// Sets rows and cols from `options`, else a square layout. Throws data_error unless they give
/// `values` per frame.
void set_layout(GloveFile& glove, std::size_t values, const GloveFileOptions& options);

// Each in its own file:
bool is_glove_hdf5(const std::filesystem::path& file);
GloveFile read_glove_hdf5(const std::filesystem::path& file, const GloveFileOptions& options);
bool is_glove_numpy(const std::filesystem::path& file);
GloveFile read_glove_numpy(const std::filesystem::path& file, const GloveFileOptions& options);
bool is_glove_matlab(const std::filesystem::path& file);
GloveFile read_glove_matlab(const std::filesystem::path& file, const GloveFileOptions& options);
bool is_glove_table(const std::filesystem::path& file);
GloveFile read_glove_table(const std::filesystem::path& file, const GloveFileOptions& options);

}  // namespace touchtrace
