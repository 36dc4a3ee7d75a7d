#include "pipeline/recording/h5_file.h"

#include <array>
#include <fstream>

namespace touchtrace::h5 {
namespace {

namespace fs = std::filesystem;

Handle latest_format() {
  Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "file access");
  check(H5Pset_libver_bounds(access, H5F_LIBVER_LATEST, H5F_LIBVER_LATEST), "file format");
  // Closing fails while a dataset is open, rather than leaving the file open behind our back.
  check(H5Pset_fclose_degree(access, H5F_CLOSE_SEMI), "file access");
  return access;
}

Loader root_of(const fs::path& path) {
  const Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose, "opening");
  return {Handle(H5Gopen2(file, "/", H5P_DEFAULT), H5Gclose, "the root group"),
          fs::file_size(path)};
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
  check(H5Fflush(file, H5F_SCOPE_GLOBAL), "flushing");
  file.close("closing");
}

Loader open_root(const fs::path& path, const std::string& schema) {
  Loader root = root_of(path);
  const std::string found = schema_attribute(root);
  if (found != schema) throw H5Error(fmt::format("it is a '{}', not a '{}'", found, schema));
  return root;
}

std::string schema_of(const fs::path& path) {
  return read_untrusted(path, [&] { return schema_attribute(root_of(path)); });
}

void check_is_hdf5(const fs::path& path) {
  constexpr std::array<char, 8> signature{'\x89', 'H', 'D', 'F', '\r', '\n', '\x1a', '\n'};
  std::error_code error;
  if (!fs::is_regular_file(path, error))
    throw data_error(fmt::format("{} {}", path.string(),
                                 fs::exists(path, error) ? "is no file" : "does not exist"),
                     "check the path");
  std::array<char, 8> start{};
  std::ifstream stream(path, std::ios::binary);
  if (!stream)
    throw data_error(fmt::format("cannot read {}", path.string()), "check its permissions");
  if (!stream.read(start.data(), start.size()) || start != signature)
    throw data_error(fmt::format("{} is no HDF5 file", path.string()),
                     "give a file that touchtrace wrote, or make it again if it was one");
}

}  // namespace touchtrace::h5
