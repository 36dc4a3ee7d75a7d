#include "pipeline/acquire/glove/packet_parser.h"
#include "pipeline/acquire/glove/protocol.h"

namespace touchtrace {
namespace {

class MitRowsParser : public PacketParser {
 public:
  MitRowsParser(const GloveInfo& info, FrameSink sink)
      : PacketParser(info, std::move(sink), 4 + 2 * static_cast<std::size_t>(info.cols),
                     static_cast<std::uint64_t>(info.rows)),
        rows_(static_cast<std::uint64_t>(info.rows)),
        cols_(static_cast<std::size_t>(info.cols)),
        frame_(taxels()) {}

 private:
  std::optional<std::uint64_t> number_of(const std::uint8_t* packet) override {
    const std::uint8_t* end = packet + 2 + 2 * cols_;
    if (packet[0] != 0 || packet[1] >= rows_ || end[0] != 'w' || end[1] != 'r') return {};
    for (const std::uint8_t* at = packet + 2; at < end; at += 2)
      if (!is_in_range(from_little_endian(at, 2))) return {};
    return packet[1];
  }

  void accept(const Packet& packet) override {
    if (packet.advance == 0 || packet.number <= last_row_) begin_frame();
    is_whole_ &= packet.number == num_rows_ && (packet.skipped == 0 || num_rows_ == 0);
    if (is_whole_) copy_row(packet);
    last_row_ = packet.number;
    if (last_row_ == rows_ - 1) end_frame(packet.host_time_s);
  }

  void begin_frame() {
    if (is_open_) end_frame(0.0);
    is_open_ = is_whole_ = true;
    num_rows_ = 0;
  }

  void copy_row(const Packet& packet) {
    std::uint16_t* row = &frame_[num_rows_++ * cols_];
    for (std::size_t col = 0; col < cols_; ++col)
      row[col] = static_cast<std::uint16_t>(from_little_endian(packet.bytes + 2 + 2 * col, 2));
  }

  /// The first frame may have begun before the first byte.
  void end_frame(double host_time_s) {
    is_open_ = false;
    if (num_rows_ == rows_)
      pass_on(number_, frame_, host_time_s);
    else if (number_ > 0)
      count_torn(1);
    ++number_;
  }

  std::uint64_t rows_;
  std::size_t cols_;
  std::vector<std::uint16_t> frame_;
  bool is_open_ = false, is_whole_ = false;    ///< a frame has begun, no row is missing
  std::uint64_t num_rows_ = 0, last_row_ = 0;  ///< of the current frame
  std::uint64_t number_ = 0;                   ///< of the current frame
};

}  // namespace

/// One packet per row: [glove, 1 byte][row, 1 byte][2 bytes per count, low byte first]["wr"].
/// Frames have no number.
std::string encode_mit_rows(const GloveStream& glove, std::size_t frame) {
  const auto rows = static_cast<std::size_t>(glove.info.rows),
             cols = static_cast<std::size_t>(glove.info.cols);
  std::string bytes;
  for (std::size_t row = 0; row < rows; ++row) {
    bytes += '\0';
    bytes += static_cast<char>(row);
    for (std::size_t col = 0; col < cols; ++col)
      bytes += little_endian(glove.counts[(frame * rows + row) * cols + col], 2);
    bytes += "wr";
  }
  return bytes;
}

std::unique_ptr<GloveParser> parse_mit_rows(const GloveInfo& info, FrameSink sink) {
  return std::make_unique<MitRowsParser>(info, std::move(sink));
}

}  // namespace touchtrace
