#include "pipeline/recording/h5_file.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <fstream>

namespace touchtrace::h5 {
namespace {

namespace fs = std::filesystem;

Handle latest_format() {
  Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "file access");
  check(H5Pset_libver_bounds(access, H5F_LIBVER_LATEST, H5F_LIBVER_LATEST), "file format");
  // Closing the file fails while a dataset is open, instead of leaving the file open.
  check(H5Pset_fclose_degree(access, H5F_CLOSE_SEMI), "file access");
  return access;
}

std::string schema_attribute(const Loader& root) {
  std::string schema;
  root.attribute("schema", schema);
  return schema;
}

}  // namespace

Handle create_file(const fs::path& path) {
  const Handle creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose, "file creation");
  check(H5Pset_obj_track_times(creation, false), "file creation");
  return {H5Fcreate(path.c_str(), H5F_ACC_TRUNC, creation, latest_format()), H5Fclose,
          path.string()};
}

void close_file(Handle& file) {
  check(H5Fflush(file, H5F_SCOPE_GLOBAL), "cannot flush the file");
  file.close("cannot close the file");
}

Loader open_root(const fs::path& path, FileFaults& faults) {
  const Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose,
                    "cannot open the file");
  return {Handle(H5Gopen2(file, "/", H5P_DEFAULT), H5Gclose, "cannot open the root group"),
          fs::file_size(path), "", faults};
}

Loader open_root(const fs::path& path, const std::vector<std::string>& schemas,
                 FileFaults& faults) {
  Loader root = open_root(path, faults);
  const std::string found = schema_attribute(root);
  if (faults.empty() && std::ranges::find(schemas, found) == schemas.end())
    throw H5Error(
        fmt::format("expected schema '{}', found '{}'", fmt::join(schemas, "' or '"), found));
  return root;
}

std::string schema_of(const fs::path& path) {
  return read_untrusted(
      path, [&](FileFaults& faults) { return schema_attribute(open_root(path, faults)); });
}

void require_hdf5(const fs::path& path) {
  constexpr std::array<char, 8> signature{'\x89', 'H', 'D', 'F', '\r', '\n', '\x1a', '\n'};
  std::error_code error;
  if (!fs::is_regular_file(path, error))
    throw data_error(fmt::format("{} {}", path.string(),
                                 fs::exists(path, error) ? "is not a file" : "does not exist"),
                     "check the path");
  std::array<char, 8> start{};
  std::ifstream stream(path, std::ios::binary);
  if (!stream)
    throw data_error(fmt::format("cannot read {}", path.string()), "check its permissions");
  if (!stream.read(start.data(), start.size()) || start != signature)
    throw data_error(fmt::format("{} is not an HDF5 file", path.string()),
                     "give a recording or labels file; if it was one, it is damaged");
}

}  // namespace touchtrace::h5
