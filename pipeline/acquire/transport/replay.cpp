#include <fmt/core.h>

#include <chrono>
#include <fstream>
#include <thread>

#include "engine/base/error.h"
#include "pipeline/acquire/transport/transport.h"

namespace touchtrace {
namespace {

class Replay : public Transport {
 public:
  Replay(const std::string& path, double bytes_per_s, double speed)
      : stream_(path, std::ios::binary), bytes_per_s_(bytes_per_s), speed_(speed) {
    if (!stream_) throw data_error(fmt::format("cannot read {}", path), "check the path");
  }

  Reading read(std::span<std::uint8_t> buffer, double timeout_s) override {
    const auto piece = static_cast<std::streamsize>(std::min<std::size_t>(buffer.size(), 64));
    if (const double wait_s = due_s(static_cast<double>(piece)) - monotonic_s(); wait_s > 0.0) {
      std::this_thread::sleep_for(std::chrono::duration<double>(std::min(wait_s, timeout_s)));
      if (wait_s > timeout_s) return {Reading::Status::timeout};
    }
    stream_.read(reinterpret_cast<char*>(buffer.data()), piece);
    const auto size = static_cast<std::size_t>(stream_.gcount());
    if (size == 0) return {Reading::Status::ended};
    position_ += static_cast<double>(size);
    return {Reading::Status::data, size, start_s_ + position_ / bytes_per_s_};
  }

  void write(std::string_view) override {}

 private:
  /// Time at which the next `bytes` are replayed.
  double due_s(double bytes) const {
    return speed_ > 0.0 ? start_s_ + (position_ + bytes) / (bytes_per_s_ * speed_) : 0.0;
  }

  std::ifstream stream_;
  double bytes_per_s_, speed_;
  double start_s_ = monotonic_s(), position_ = 0.0;  ///< position_: bytes
};

}  // namespace

std::unique_ptr<Transport> open_replay(const std::string& path, double bytes_per_s, double speed) {
  return std::make_unique<Replay>(path, bytes_per_s, speed);
}

}  // namespace touchtrace
