#include "pipeline/acquire/glove/own_protocol.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>

#include "engine/base/files.h"
#include "engine/base/text.h"
#include "engine/base/toml_table.h"
#include "pipeline/acquire/glove/packet_parser.h"

namespace touchtrace {
namespace {

constexpr int max_packet_bytes = 1 << 18;

/// Checksum of one byte.
enum class Checksum { none, sum8, xor8 };

/// Places in a packet [bytes from its start].
struct PacketLayout {
  std::string start, end;
  std::size_t length = 0, number_at = 0, counts_at = 0;
  Checksum checksum = Checksum::none;
  std::size_t checksum_from = 0;  ///< first byte that it covers; it covers all before itself
  int number_bytes = 0;           ///< 0: packets have no number
  int count_bytes = 2;
  bool is_big_endian = false, is_by_columns = false;

  std::size_t end_at() const { return length - end.size(); }
  /// End of the bytes before checksum and end marker.
  std::size_t content_end() const { return end_at() - (checksum == Checksum::none ? 0 : 1); }
  std::uint64_t modulus() const { return std::uint64_t{1} << (8 * number_bytes); }
  /// Only the next packet shows where one ends that has no end marker.
  std::size_t lookahead_bytes() const { return end.empty() ? start.size() : 0; }
};

/// Index in the packet of taxel `index` of the image.
std::size_t place_of(const PacketLayout& layout, const GloveInfo& info, std::size_t index) {
  if (!layout.is_by_columns) return index;
  const auto rows = static_cast<std::size_t>(info.rows), cols = static_cast<std::size_t>(info.cols);
  return index % cols * rows + index / cols;
}

std::uint64_t read_number(const PacketLayout& layout, const std::uint8_t* at, int bytes) {
  std::uint64_t value = 0;
  for (int i = 0; i < bytes; ++i) value = value << 8 | at[layout.is_big_endian ? i : bytes - 1 - i];
  return value;
}

void write_number(const PacketLayout& layout, std::uint64_t value, int bytes, char* at) {
  std::string number = little_endian(value, bytes);
  if (layout.is_big_endian) std::ranges::reverse(number);
  std::ranges::copy(number, at);
}

std::uint8_t checksum_of(const PacketLayout& layout, const std::uint8_t* packet) {
  unsigned value = 0;
  for (std::size_t i = layout.checksum_from; i < layout.content_end(); ++i)
    value = layout.checksum == Checksum::sum8 ? value + packet[i] : value ^ packet[i];
  return static_cast<std::uint8_t>(value);
}

class OwnParser : public PacketParser {
 public:
  OwnParser(const PacketLayout& layout, const GloveInfo& info, FrameSink sink)
      : PacketParser(info, std::move(sink), layout.length, layout.modulus(),
                     layout.lookahead_bytes()),
        layout_(layout),
        frame_(taxels()) {
    for (std::size_t i = 0; i < taxels(); ++i)
      count_at_.push_back(layout.counts_at +
                          place_of(layout, info, i) * static_cast<std::size_t>(layout.count_bytes));
  }

 private:
  static bool is_at(const std::string& marker, const std::uint8_t* at) {
    return std::ranges::equal(marker, std::span(at, marker.size()), {},
                              [](char c) { return static_cast<std::uint8_t>(c); });
  }

  std::optional<std::uint64_t> number_of(const std::uint8_t* packet) override {
    if (!is_at(layout_.start, packet) || !is_at(layout_.end, packet + layout_.end_at())) return {};
    if (layout_.end.empty() && !is_at(layout_.start, packet + layout_.length)) return {};
    if (layout_.checksum != Checksum::none &&
        packet[layout_.content_end()] != checksum_of(layout_, packet))
      return {};
    for (const std::size_t at : count_at_)
      if (!is_in_range(read_number(layout_, packet + at, layout_.count_bytes))) return {};
    return read_number(layout_, packet + layout_.number_at, layout_.number_bytes);
  }

  void accept(const Packet& packet) override {
    const std::uint64_t advance =
        layout_.number_bytes > 0 ? packet.advance : 1 + skipped_packets(packet);
    if (is_started_ && advance > 1)
      count_torn(std::min<std::uint64_t>(advance - 1, skipped_packets(packet)));
    number_ = is_started_ ? number_ + advance : packet.number;
    is_started_ = true;
    for (std::size_t i = 0; i < frame_.size(); ++i)
      frame_[i] = static_cast<std::uint16_t>(
          read_number(layout_, packet.bytes + count_at_[i], layout_.count_bytes));
    pass_on(number_, frame_, packet.host_time_s);
  }

  PacketLayout layout_;
  std::vector<std::size_t> count_at_;  ///< [taxels] in the packet
  std::vector<std::uint16_t> frame_;
  bool is_started_ = false;
  std::uint64_t number_ = 0;  ///< frames counted without the modulus
};

std::string encode(const PacketLayout& layout, const GloveStream& glove, std::size_t frame) {
  const auto taxels = static_cast<std::size_t>(glove.info.taxels());
  std::string packet(layout.length, '\0');
  std::ranges::copy(layout.start, packet.begin());
  std::ranges::copy(layout.end, packet.begin() + static_cast<std::ptrdiff_t>(layout.end_at()));
  write_number(layout, glove.sequence[frame], layout.number_bytes, &packet[layout.number_at]);
  for (std::size_t i = 0; i < taxels; ++i)
    write_number(layout, glove.counts[frame * taxels + i], layout.count_bytes,
                 &packet[layout.counts_at + place_of(layout, glove.info, i) *
                                                static_cast<std::size_t>(layout.count_bytes)]);
  if (layout.checksum != Checksum::none)
    packet[layout.content_end()] = static_cast<char>(
        checksum_of(layout, reinterpret_cast<const std::uint8_t*>(packet.data())));
  return packet;
}

/// Bytes of a text such as "aa 55".
std::string read_bytes(TomlTable& table, const std::string& key) {
  std::string bytes;
  for (const std::string& word : split_text(table.text(key, 64), ' ')) {
    unsigned value = 0;
    const auto [end, fault] = std::from_chars(word.data(), word.data() + word.size(), value, 16);
    if (word.size() != 2 || fault != std::errc() || end != word.data() + word.size())
      table.reject(key, "is not a list of bytes in hexadecimal, such as \"aa 55\"");
    bytes += static_cast<char>(value);
  }
  return bytes;
}

GloveInfo read_glove(TomlTable& table) {
  GloveInfo info;
  info.rows = table.integer("rows", 1, 255);
  info.cols = table.integer("cols", 1, 255);
  info.bits = table.integer("bits", 1, 16);
  info.rate_hz = table.number("rate_hz", 0.1, 1e4);
  if (table.has("polarity")) info.polarity = table.choice("polarity", {"up", "down"}) == 0 ? 1 : -1;
  return info;
}

int integer_or(TomlTable& table, const std::string& key, int min, int max, std::size_t otherwise) {
  return table.has(key) ? table.integer(key, min, max) : static_cast<int>(otherwise);
}

void require_room(TomlTable& table, const PacketLayout& layout, std::size_t counts_end) {
  if (layout.counts_at < layout.start.size() || counts_end > layout.content_end())
    table.reject("counts_at", fmt::format("puts counts at bytes {} to {} of a packet of {}",
                                          layout.counts_at, counts_end, layout.length));
  const std::size_t number_end = layout.number_at + static_cast<std::size_t>(layout.number_bytes);
  if (layout.number_bytes > 0 &&
      (layout.number_at < layout.start.size() || number_end > layout.content_end() ||
       (number_end > layout.counts_at && layout.number_at < counts_end)))
    table.reject("number_at", "puts the number on other bytes of the packet");
}

PacketLayout read_layout(TomlTable& table, const GloveInfo& info) {
  PacketLayout layout;
  layout.start = read_bytes(table, "start");
  if (layout.start.empty()) table.reject("start", "has no byte");
  if (table.has("end")) layout.end = read_bytes(table, "end");
  layout.number_bytes = integer_or(table, "number_bytes", 1, 4, 0);
  if (layout.number_bytes == 0 && table.has("number_at"))
    table.reject("number_at", "needs number_bytes");
  layout.number_at = integer_or(table, "number_at", 0, max_packet_bytes, layout.start.size());
  layout.counts_at = integer_or(table, "counts_at", 0, max_packet_bytes,
                                layout.start.size() + std::size_t(layout.number_bytes));
  layout.count_bytes = integer_or(table, "count_bytes", 1, 2, info.bits > 8 ? 2 : 1);
  if (8 * layout.count_bytes < info.bits) table.reject("count_bytes", "is too small for the bits");
  const std::size_t counts_end =
      layout.counts_at + std::size_t(info.taxels()) * std::size_t(layout.count_bytes);
  if (table.has("checksum"))
    layout.checksum =
        table.choice("checksum", {"sum8", "xor8"}) == 0 ? Checksum::sum8 : Checksum::xor8;
  const std::size_t behind = layout.end.size() + (layout.checksum == Checksum::none ? 0 : 1);
  layout.length = integer_or(table, "length", 1, max_packet_bytes, counts_end + behind);
  if (table.has("byte_order"))
    layout.is_big_endian = table.choice("byte_order", {"little", "big"}) == 1;
  if (table.has("order")) layout.is_by_columns = table.choice("order", {"rows", "columns"}) == 1;
  require_room(table, layout, counts_end);
  layout.checksum_from = integer_or(table, "checksum_from", 0,
                                    static_cast<int>(layout.content_end()), layout.start.size());
  return layout;
}

}  // namespace

GloveProtocol read_glove_protocol(const std::filesystem::path& file) {
  GloveProtocol protocol;
  protocol.name = file.stem().string();
  protocol.summary = "described in " + file.string();
  read_toml(read_file(file, 1 << 16), file.string(),
            "pipeline/acquire/README.md, A protocol of your own, describes the file",
            [&](TomlTable& table) {
              protocol.baud = table.integer("baud", 1, 12'000'000);
              protocol.usual_glove = read_glove(table);
              const PacketLayout layout = read_layout(table, protocol.usual_glove);
              protocol.has_numbers = layout.number_bytes > 0;
              protocol.encode = [layout](const GloveStream& glove, std::size_t frame) {
                return encode(layout, glove, frame);
              };
              protocol.parse = [layout](const GloveInfo& info, FrameSink sink) {
                return std::make_unique<OwnParser>(layout, info, std::move(sink));
              };
            });
  protocol.max_bits = protocol.usual_glove.bits;
  protocol.fixed_taxels = protocol.usual_glove.taxels();
  return protocol;
}

}  // namespace touchtrace
