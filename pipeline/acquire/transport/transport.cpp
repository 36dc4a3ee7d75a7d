#include "pipeline/acquire/transport/transport.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <filesystem>
#include <thread>

#include "engine/base/error.h"
#include "engine/base/text.h"

namespace touchtrace {
namespace {

constexpr const char* usb_prefix = "usb:";

std::uint16_t parse_usb_id(const std::string& text, const std::string& port) {
  std::uint16_t id = 0;
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, id, 16);
  if (error != std::errc() || rest != end)
    throw usage_error(fmt::format("cannot read the port '{}'", port),
                      "write usb:VENDOR:PRODUCT in hexadecimal, as in usb:2341:0043; `lsusb` lists "
                      "both numbers");
  return id;
}

}  // namespace

double monotonic_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

bool wait_for_time(double time_s) {
  constexpr double max_wait_s = 0.1;
  const double wait_s = time_s - monotonic_s();
  std::this_thread::sleep_for(std::chrono::duration<double>(std::clamp(wait_s, 0.0, max_wait_s)));
  return wait_s <= max_wait_s;
}

bool is_replay(const std::string& port) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(port, ignored);
}

std::unique_ptr<Transport> open_port(const std::string& port, const SerialLine& line) {
  if (port.starts_with(usb_prefix)) {
    const auto parts = split_text(port, ':');
    return open_usb(parse_usb_id(parts.size() == 3 ? parts[1] : "", port),
                    parse_usb_id(parts.size() == 3 ? parts[2] : "", port), line);
  }
  if (is_replay(port)) return open_replay(port);
  return open_tty(port, line);
}

}  // namespace touchtrace
