#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace touchtrace {

/// Result of Transport::read().
struct Reading {
  enum class Status { data, timeout, unplugged, ended };

  Status status;
  std::size_t bytes = 0;
  double time_s = 0.0;  ///< of arrival, on the clock of monotonic_s()
};

/// Source of a device's bytes. The destructor closes it.
class Transport {
 public:
  Transport() = default;
  virtual ~Transport() = default;
  Transport(const Transport&) = delete;
  Transport& operator=(const Transport&) = delete;

  /// Waits at most `timeout_s` for bytes and stores those that have arrived.
  virtual Reading read(std::span<std::uint8_t> buffer, double timeout_s) = 0;
  /// Sends bytes to the device; a device that is unplugged is noticed by read().
  virtual void write(std::string_view bytes) = 0;
};

/// Seconds of the machine's monotonic clock.
double monotonic_s();
/// Sleeps until a time of monotonic_s(), but for 0.1 s at most. Returns whether that time has come.
bool wait_for_time(double time_s);

struct SerialLine {
  int baud = 115200;
  bool holds_lines_low = false;  ///< DTR and RTS
};

/// Serial port such as /dev/ttyACM0, or a pseudo-terminal. Throws data_error if it cannot be
/// opened.
std::unique_ptr<Transport> open_tty(const std::string& path, const SerialLine& line);

/// USB device of class CDC-ACM, without the kernel's driver. Throws data_error if it is not
/// connected or cannot be opened.
std::unique_ptr<Transport> open_usb(std::uint16_t vendor, std::uint16_t product,
                                    const SerialLine& line);

/// Bytes of a file, without pauses.
std::unique_ptr<Transport> open_replay(const std::string& path);

/// Opens a port by its name: "usb:VENDOR:PRODUCT" (hexadecimal), a file, or a tty.
std::unique_ptr<Transport> open_port(const std::string& port, const SerialLine& line);

/// True if the port is a regular file, which open_port() replays.
bool is_replay(const std::string& port);

}  // namespace touchtrace
