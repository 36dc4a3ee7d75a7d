#pragma once

#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <unistd.h>

#include <string>
#include <string_view>

namespace touchtrace::testing {

/// Device end of a pseudo-terminal, whose other end a program opens as a serial port.
class PseudoTerminal {
 public:
  PseudoTerminal() : device_(posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK)) {
    grantpt(device_), unlockpt(device_);
    path_ = ptsname(device_);
  }
  ~PseudoTerminal() { unplug(); }
  PseudoTerminal(const PseudoTerminal&) = delete;
  PseudoTerminal& operator=(const PseudoTerminal&) = delete;

  const std::string& path() const { return path_; }
  void unplug() {
    if (device_ >= 0) ::close(device_);
    device_ = -1;
  }

  /// Writes all bytes; gives up if nobody reads for 5 s. Returns whether all were written.
  bool send(std::string_view bytes) const {
    while (!bytes.empty()) {
      pollfd event{device_, POLLOUT, 0};
      if (poll(&event, 1, 5000) <= 0) return false;
      const ssize_t size = ::write(device_, bytes.data(), bytes.size());
      if (size > 0) bytes.remove_prefix(static_cast<std::size_t>(size));
      if (size < 0) usleep(1000);
    }
    return true;
  }

  /// Bytes that the program has sent.
  std::string receive() const {
    std::string bytes(4096, '\0');
    pollfd event{device_, POLLIN, 0};
    poll(&event, 1, 1000);
    const ssize_t size = ::read(device_, bytes.data(), bytes.size());
    bytes.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
    return bytes;
  }

 private:
  int device_;
  std::string path_;
};

}  // namespace touchtrace::testing
