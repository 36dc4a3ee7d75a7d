#pragma once

#include <hdf5.h>

#include <stdexcept>
#include <string>

namespace touchtrace::h5 {

/// What HDF5 refused to do, in its own words. Readers and writers turn it into a data_error or a
/// failure.
class H5Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Held around every call into the library, which serves one thread at a time. One thread may hold
/// several. Counts them itself: a recursive mutex would lock out its owner's forked child.
class LibraryLock {
 public:
  LibraryLock();
  ~LibraryLock();
  LibraryLock(const LibraryLock&) = delete;
  LibraryLock& operator=(const LibraryLock&) = delete;
};

/// Throws H5Error with the library's message if `result` is negative; returns it otherwise.
hid_t check_id(hid_t result, const std::string& what);
void check(herr_t result, const std::string& what);

/// An HDF5 identifier and the way to close it.
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
  /// Closing writes what is still held back, so a writer closes by this and learns of a full disk.
  void close(const std::string& what);

 private:
  hid_t id_ = H5I_INVALID_HID;
  Closer closer_ = nullptr;
};

}  // namespace touchtrace::h5
