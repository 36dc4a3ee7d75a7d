#include <fmt/core.h>

#include <algorithm>
#include <fstream>

#include "engine/base/error.h"
#include "pipeline/acquire/transport/transport.h"

namespace touchtrace {
namespace {

constexpr std::size_t max_piece_bytes = 64;

class Replay : public Transport {
 public:
  explicit Replay(const std::string& path) : stream_(path, std::ios::binary) {
    if (!stream_) throw data_error(fmt::format("cannot read {}", path), "check the path");
  }

  Reading read(std::span<std::uint8_t> buffer, double) override {
    const auto piece = static_cast<std::streamsize>(std::min(buffer.size(), max_piece_bytes));
    stream_.read(reinterpret_cast<char*>(buffer.data()), piece);
    const auto size = static_cast<std::size_t>(stream_.gcount());
    if (size == 0) return {Reading::Status::ended};
    return {Reading::Status::data, size, monotonic_s()};
  }

  void write(std::string_view) override {}

 private:
  std::ifstream stream_;
};

}  // namespace

std::unique_ptr<Transport> open_replay(const std::string& path) {
  return std::make_unique<Replay>(path);
}

}  // namespace touchtrace
