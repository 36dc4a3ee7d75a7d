#pragma once

#include <fmt/core.h>

#include <filesystem>
#include <functional>
#include <string>

#include "engine/base/error.h"
#include "pipeline/recording/h5_archive.h"

namespace touchtrace::h5 {

/// Creates a file, replacing an existing one. Format: libver latest, so that metadata have
/// checksums; no time stamps, so that equal content gives equal bytes.
Handle create_file(const std::filesystem::path& path);

/// Flushes and closes. H5Fclose alone reports no error on a full disk.
void close_file(Handle& file);

/// Opens the root group of any HDF5 file. Throws H5Error.
Loader open_root(const std::filesystem::path& path, FileFaults& faults);
/// Opens the root group. Throws H5Error unless the attribute `schema` is one of `schemas`, such as
/// "touchtrace/recording/2".
Loader open_root(const std::filesystem::path& path, const std::vector<std::string>& schemas,
                 FileFaults& faults);

/// Returns the attribute `schema` of an untrusted file. Throws data_error.
std::string schema_of(const std::filesystem::path& path);

/// Runs `read` in a child process with limited memory (4 GiB more than now) and time (60 CPU
/// seconds). Throws the Error that `read` threw there, or a data_error if the child crashed or
/// reached a limit.
void run_in_child(const std::filesystem::path& path, const std::function<void()>& read);

/// Throws data_error unless `path` is a regular file with the signature of HDF5.
void require_hdf5(const std::filesystem::path& path);

/// Returns read(faults) after a trial run in a child process, because damaged files can crash the
/// HDF5 library. Throws data_error if `read` throws H5Error or records faults.
template <class Read>
auto read_untrusted(const std::filesystem::path& path, Read read) {
  require_hdf5(path);
  const LibraryLock lock;
  const auto checked = [&] {
    FileFaults faults;
    try {
      auto result = read(faults);
      faults.throw_if_any(path);
      return result;
    } catch (const H5Error& fault) {
      faults.add("/", fault.what());
      faults.throw_if_any(path);
      throw;
    }
  };
  run_in_child(path, [&] { checked(); });
  return checked();
}

/// Runs `write`; an H5Error becomes a failure.
template <class Write>
void write_checked(const std::filesystem::path& path, Write write) {
  const LibraryLock lock;
  try {
    write();
  } catch (const H5Error& fault) {
    throw failure(fmt::format("cannot write {}: {}", path.string(), fault.what()),
                  "check free disk space and write permission");
  }
}

}  // namespace touchtrace::h5
