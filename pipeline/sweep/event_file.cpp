#include "pipeline/sweep/event_file.h"

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>

#include "engine/base/crc32c.h"
#include "engine/base/protobuf_writer.h"

// Records: tensorflow/core/lib/io/record_writer.cc; messages: tensorflow/core/util/event.proto.
namespace touchtrace::sweep {
namespace {

using nlohmann::ordered_json;

template <class T>
std::string little_endian(T value) {
  static_assert(std::endian::native == std::endian::little);
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  return bytes;
}

std::string masked_crc(const std::string& bytes) {
  const std::uint32_t crc =
      crc32c({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
  return little_endian(std::rotr(crc, 15) + 0xa282ead8u);
}

std::string record(const std::string& data) {
  const auto length = little_endian(std::uint64_t{data.size()});
  return length + masked_crc(length) + data + masked_crc(data);
}

std::string event(const ordered_json& entry) {
  ProtobufWriter summary, event;
  for (const auto& [name, value] : entry.items()) {
    if (!value.is_number() || name == "update" || name == "seconds") continue;
    ProtobufWriter scalar;
    scalar.add(1, std::string_view(name));
    scalar.add(2, value.get<float>());
    summary.add(1, std::string_view(scalar.bytes()));
  }
  const bool has_time = entry.contains("seconds") && entry["seconds"].is_number();
  event.add(1, has_time ? entry["seconds"].get<double>() : 0.0);
  event.add(2, entry["update"].get<std::int64_t>());
  event.add(5, std::string_view(summary.bytes()));
  return event.bytes();
}

std::string version_event() {
  ProtobufWriter event;
  event.add(1, 0.0);
  event.add(3, std::string_view("brain.Event:2"));
  return event.bytes();
}

bool is_log(const ordered_json& value) {
  if (!value.is_array() || value.empty()) return false;
  for (const auto& entry : value)
    if (!entry.is_object() || !entry.contains("update") || !entry["update"].is_number_unsigned())
      return false;
  return true;
}

const ordered_json* find_log(const ordered_json& value) {
  if (is_log(value)) return &value;
  if (value.is_object())
    for (const auto& member : value)
      if (const auto* log = find_log(member)) return log;
  return nullptr;
}

}  // namespace

std::string event_file_of(const ordered_json& result) {
  const auto* log = find_log(result);
  if (!log) return "";
  std::string bytes = record(version_event());
  for (const auto& entry : *log) bytes += record(event(entry));
  return bytes;
}

}  // namespace touchtrace::sweep
