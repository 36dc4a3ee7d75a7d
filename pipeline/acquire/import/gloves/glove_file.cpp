#include "pipeline/acquire/import/gloves/glove_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>

#include "engine/base/error.h"
#include "pipeline/acquire/import/gloves/glove_values.h"

namespace touchtrace {
namespace {

constexpr std::array<GloveFileKind, 4> glove_file_kinds{{
    {"HDF5 of the WiReSens toolkit or of ActionSense", is_glove_hdf5, read_glove_hdf5},
    {"NumPy archive (.npz with time_s and counts)", is_glove_numpy, read_glove_numpy},
    {"MAT-file (.mat of level 5 with pressure and ts, as STAG's metadata.mat)", is_glove_matlab,
     read_glove_matlab},
    {"table (.csv, .txt) with a time and all taxels in each row", is_glove_table, read_glove_table},
}};

/// Text that Git LFS leaves in place of a file.
bool is_lfs_pointer(const std::filesystem::path& file) {
  std::string line;
  std::getline(std::ifstream(file), line);
  return line.starts_with("version https://git-lfs");
}

/// Leaves out frames in which a taxel has no value.
void skip_incomplete(GloveFile& glove, const std::filesystem::path& file) {
  const std::size_t frames = glove.time_s.size(), taxels = glove.taxels();
  std::size_t kept = 0;
  for (std::size_t i = 0; i < frames; ++i) {
    const auto first = glove.values.begin() + static_cast<std::ptrdiff_t>(i * taxels),
               last = first + static_cast<std::ptrdiff_t>(taxels);
    if (std::any_of(first, last, [](float value) { return std::isnan(value); })) continue;
    std::copy(first, last, glove.values.begin() + static_cast<std::ptrdiff_t>(kept * taxels));
    glove.time_s[kept] = glove.time_s[i];
    if (!glove.sequence.empty()) glove.sequence[kept] = glove.sequence[i];
    ++kept;
  }
  if (kept == frames) return;
  report_incomplete(file, frames - kept, frames);
  glove.values.resize(kept * taxels), glove.time_s.resize(kept);
  if (!glove.sequence.empty()) glove.sequence.resize(kept);
}

}  // namespace

GloveFile read_glove_file(const std::filesystem::path& file, const GloveFileOptions& options) {
  if (!std::filesystem::is_regular_file(file))
    throw data_error(fmt::format("{} is not a file", file.string()), "check the path");
  if (is_lfs_pointer(file))
    throw data_error(fmt::format("{} is a pointer of Git LFS, not the data", file.string()),
                     "run `git lfs pull` in its repository");
  std::string names;
  for (const GloveFileKind& kind : glove_file_kinds) {
    if (kind.is_kind(file)) {
      GloveFile glove = kind.read(file, options);
      skip_incomplete(glove, file);
      if (glove.time_s.empty())
        throw data_error(fmt::format("{} has no frames", file.string()), "record again");
      if (glove.time_s.size() == 1)
        throw data_error(fmt::format("{} has one frame", file.string()),
                         "give a file with a row or an element of the first axis for each frame");
      return glove;
    }
    names += fmt::format("{}{}", names.empty() ? "" : "; ", kind.name);
  }
  throw data_error(fmt::format("{} is not a file of a tactile glove", file.string()),
                   "give one of: " + names);
}

}  // namespace touchtrace
