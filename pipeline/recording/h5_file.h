#pragma once

#include <fmt/core.h>

#include <filesystem>
#include <functional>
#include <string>

#include "engine/base/error.h"
#include "pipeline/recording/h5_archive.h"

namespace touchtrace::h5 {

/// A new file, libver latest: its metadata carry checksums. Replaces one that exists. No time
/// stamps: the same content makes the same bytes.
Handle create_file(const std::filesystem::path& path);

/// Flushes and closes. H5Fclose alone returns 0 on a full disk.
void close_file(Handle& file);

/// The file's root group with the file's size; checks that it is of `schema`, e.g.
/// "touchtrace/recording/1". Throws H5Error.
Loader open_root(const std::filesystem::path& path, const std::string& schema);

/// The schema that a file says it has. Untrusted files are safe; throws data_error.
std::string schema_of(const std::filesystem::path& path);

/// Runs `read` in a child process with bounds on memory and time. Throws the data_error that `read`
/// threw there, or one that says that the file cannot be read if the child did not come to its end.
void try_in_child(const std::filesystem::path& path, const std::function<void()>& read);

/// Throws data_error unless `path` is a regular file that starts as HDF5 does.
void check_is_hdf5(const std::filesystem::path& path);

/// What `read` returns, once a child process has shown that reading this file is safe.
template <class Read>
auto read_untrusted(const std::filesystem::path& path, Read read) {
  check_is_hdf5(path);
  const LibraryLock lock;
  const auto named = [&] {
    try {
      return read();
    } catch (const H5Error& fault) {
      throw data_error(
          fmt::format("{} cannot be used: {}", path.string(), fault.what()),
          "copy it again from where it came from, or make it again; `touchtrace check` "
          "says what a file holds");
    }
  };
  try_in_child(path, [&] { named(); });
  return named();
}

/// Runs `write`; an H5Error becomes a failure that says what to do.
template <class Write>
void write_checked(const std::filesystem::path& path, Write write) {
  const LibraryLock lock;
  try {
    write();
  } catch (const H5Error& fault) {
    throw failure(fmt::format("cannot write {}: {}", path.string(), fault.what()),
                  "check that the disk has room and that the folder can be written");
  }
}

}  // namespace touchtrace::h5
