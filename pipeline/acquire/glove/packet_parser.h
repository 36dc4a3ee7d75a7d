#pragma once

#include <optional>

#include "pipeline/acquire/glove/parser.h"

namespace touchtrace {

/// Parser of packets that have a fixed length and a number which counts up to a modulus.
///
/// A packet is accepted if it is plausible and has the number after that of the previous packet, or
/// if the packet behind it is plausible and confirms a gap: its number must follow both. Otherwise
/// the search continues one byte later. Markers alone never start a packet, because data may
/// contain them.
class PacketParser : public GloveParser {
 public:
  void feed(std::span<const std::uint8_t> bytes, double host_time_s) final;
  /// The bytes behind the last packet are those with which it starts.
  void finish(double host_time_s) final;

 protected:
  struct Packet {
    const std::uint8_t* bytes;
    std::uint64_t number;
    std::uint64_t advance;  ///< numbers since the previous packet; 0: the first packet
    std::size_t skipped;    ///< bytes between the previous packet and this one
    double host_time_s;
  };

  /// `modulus`: 1 if packets have no number; then each plausible packet is accepted.
  /// `lookahead_bytes`: bytes behind a packet that number_of() reads, too.
  PacketParser(const GloveInfo& info, FrameSink sink, std::size_t packet_bytes,
               std::uint64_t modulus, std::size_t lookahead_bytes = 0);

  /// Number of a packet; nullopt if its bytes are not plausible.
  virtual std::optional<std::uint64_t> number_of(const std::uint8_t* packet) = 0;
  virtual void accept(const Packet& packet) = 0;
  /// Number of packets in the skipped bytes; less than a quarter of a packet is none.
  std::size_t skipped_packets(const Packet& packet) const {
    return (packet.skipped + 3 * length_ / 4) / length_;
  }

 private:
  std::uint64_t advance(std::uint64_t from, std::uint64_t to) const {
    return (to + modulus_ - from) % modulus_;
  }
  bool confirms(std::uint64_t number, std::uint64_t next) const;
  void scan(double host_time_s);
  void take(std::uint64_t number);
  void remove(std::size_t bytes, double host_time_s);

  std::size_t length_, lookahead_;
  std::uint64_t modulus_;
  std::vector<std::uint8_t> buffer_;  ///< its bytes [begin_, end_) are not parsed yet
  std::size_t begin_ = 0, end_ = 0;
  std::size_t needed_;        ///< bytes for the next decision
  double head_time_s_ = 0.0;  ///< arrival of the last byte of the packet at begin_
  std::size_t skipped_ = 0;   ///< bytes since the last packet
  std::optional<std::uint64_t> last_number_;
};

/// Lowest `bytes` bytes, lowest first.
inline std::uint64_t from_little_endian(const std::uint8_t* at, int bytes) {
  std::uint64_t value = 0;
  for (int i = bytes - 1; i >= 0; --i) value = value << 8 | at[i];
  return value;
}

}  // namespace touchtrace
