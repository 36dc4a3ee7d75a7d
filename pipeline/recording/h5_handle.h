#pragma once

#include <hdf5.h>

#include <stdexcept>
#include <string>

namespace touchtrace::h5 {

/// Error of the HDF5 library or fault of a file. Readers turn it into a data_error, writers into a
/// failure.
class H5Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Lock for calls into the HDF5 library, which is not thread-safe. Recursive. Counts by itself,
/// because a std::recursive_mutex would lock out a forked child of its owner.
class LibraryLock {
 public:
  LibraryLock();
  ~LibraryLock();
  LibraryLock(const LibraryLock&) = delete;
  LibraryLock& operator=(const LibraryLock&) = delete;
};

/// Returns `result`; throws H5Error ("`what`: message of the library") if it is negative.
hid_t check_id(hid_t result, const std::string& what);
void check(herr_t result, const std::string& what);

/// Owner of an HDF5 identifier.
class Handle {
 public:
  using Closer = herr_t (*)(hid_t);

  Handle() = default;
  Handle(hid_t id, Closer closer, const std::string& what)
      : id_(check_id(id, what)), closer_(closer) {}
  ~Handle();
  Handle(Handle&& other) noexcept;
  Handle& operator=(Handle&& other) noexcept;

  operator hid_t() const noexcept { return id_; }
  /// Closes and throws H5Error on failure. Closing flushes: writers call it to notice a full disk.
  void close(const std::string& what);

 private:
  hid_t id_ = H5I_INVALID_HID;
  Closer closer_ = nullptr;
};

}  // namespace touchtrace::h5
