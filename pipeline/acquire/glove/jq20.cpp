

#include "pipeline/acquire/glove/packet_parser.h"
#include "pipeline/acquire/glove/protocol.h"

namespace touchtrace {
namespace {

constexpr std::size_t half_taxels = 128, imu_bytes = 16, header_bytes = 6, marker_bytes = 4;
constexpr std::size_t first_bytes = header_bytes + half_taxels;
constexpr std::uint8_t left_hand = 1, max_sensor_type = 6;

std::string header_of(std::uint8_t packet) {
  return {'\xaa', '\x55', '\x03', '\x99', static_cast<char>(packet), static_cast<char>(left_hand)};
}

/// Takes both packets of a frame, which have no frame number, as one. The next frame's marker must
/// follow them.
class Jq20Parser : public PacketParser {
 public:
  Jq20Parser(const GloveInfo& info, FrameSink sink)
      : PacketParser(info, std::move(sink), first_bytes + header_bytes + half_taxels + imu_bytes, 1,
                     marker_bytes),
        frame_(taxels()) {}

 private:
  static bool is_marker(const std::uint8_t* at) {
    return at[0] == 0xaa && at[1] == 0x55 && at[2] == 0x03 && at[3] == 0x99;
  }
  static bool is_header(const std::uint8_t* at, std::uint8_t packet) {
    return is_marker(at) && at[4] == packet && at[5] >= 1 && at[5] <= max_sensor_type;
  }

  std::optional<std::uint64_t> number_of(const std::uint8_t* packet) override {
    const std::uint8_t* second = packet + first_bytes;
    if (!is_header(packet, 1) || !is_header(second, 2) || packet[5] != second[5] ||
        !is_marker(second + header_bytes + half_taxels + imu_bytes))
      return {};
    return 0;
  }

  void accept(const Packet& packet) override {
    if (is_started_) {
      count_torn(skipped_packets(packet));
      number_ += skipped_packets(packet);
    }
    is_started_ = true;
    const std::uint8_t* first = packet.bytes + header_bytes;
    std::copy_n(first, half_taxels, frame_.begin());
    std::copy_n(first + half_taxels + header_bytes, half_taxels, frame_.begin() + half_taxels);
    pass_on(number_++, frame_, packet.host_time_s);
  }

  std::vector<std::uint16_t> frame_;
  bool is_started_ = false;
  std::uint64_t number_ = 0;
};

}  // namespace

/// Two packets per frame: [aa 55 03 99][1][sensor type][128 counts] and [aa 55 03 99][2][sensor
/// type][128 counts][orientation of the inertial unit, 4 floats], which is 0 here. Source:
/// published readers of the JQ20-XL.
std::string encode_jq20(const GloveStream& glove, std::size_t frame) {
  const auto counts = glove.counts.begin() + static_cast<std::ptrdiff_t>(2 * half_taxels * frame);
  std::string bytes = header_of(1);
  bytes.append(counts, counts + half_taxels);
  bytes += header_of(2);
  bytes.append(counts + half_taxels, counts + 2 * half_taxels);
  return bytes + std::string(imu_bytes, '\0');
}

std::unique_ptr<GloveParser> parse_jq20(const GloveInfo& info, FrameSink sink) {
  return std::make_unique<Jq20Parser>(info, std::move(sink));
}

}  // namespace touchtrace
