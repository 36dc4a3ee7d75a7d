#pragma once

#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pipeline/recording/recording.h"

namespace touchtrace {

/// Description of a recording, at the start of its log.
struct SessionInfo {
  std::string activity = "record", object = "object", protocol;
  double epoch_unix_s = 0.0;
  double rest_s = 0.0;  ///< at the start, during which nothing is touched; 0: no baseline is known
  /// Without mask and positions. With a baseline, if it is known: then `rest_s` is not used.
  std::optional<GloveInfo> glove;
  std::optional<CameraInfo> camera;  ///< without gravity
  Provenance provenance;
};

std::vector<std::uint8_t> to_bytes(const SessionInfo& session);
/// Throws data_error for text that is not a valid description.
SessionInfo parse_session(std::span<const std::uint8_t> bytes);

/// Payload of a record with a frame.
struct FrameStamp {
  std::uint64_t sequence;
  double host_time_s, device_time_s;  ///< device_time_s: host time if the device has no clock
};

/// Stamp and values one after the other, low bytes first.
template <class Value>
std::vector<std::uint8_t> to_payload(const FrameStamp& stamp, std::span<const Value> values) {
  std::vector<std::uint8_t> payload(sizeof stamp + values.size_bytes());
  std::memcpy(payload.data(), &stamp, sizeof stamp);
  if (!values.empty())
    std::memcpy(payload.data() + sizeof stamp, values.data(), values.size_bytes());
  return payload;
}

/// Reverses to_payload(); false if the payload does not have `size` values.
template <class Value>
bool from_payload(std::span<const std::uint8_t> payload, std::size_t size, FrameStamp& stamp,
                  std::vector<Value>& values) {
  if (payload.size() != sizeof stamp + size * sizeof(Value)) return false;
  std::memcpy(&stamp, payload.data(), sizeof stamp);
  values.resize(size);
  if (size > 0) std::memcpy(values.data(), payload.data() + sizeof stamp, size * sizeof(Value));
  return true;
}

}  // namespace touchtrace
