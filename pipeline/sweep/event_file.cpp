#include "pipeline/sweep/event_file.h"

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>

#include "engine/base/crc32c.h"

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

std::string varint(std::uint64_t value) {
  std::string bytes;
  for (; value > 127; value >>= 7) bytes += static_cast<char>((value & 127) | 128);
  return bytes + static_cast<char>(value);
}

// Fields of a protocol buffer message.
std::string field_key(int field, int wire_type) {
  return varint(static_cast<std::uint64_t>(field << 3 | wire_type));
}
std::string bytes_field(int field, const std::string& bytes) {
  return field_key(field, 2) + varint(bytes.size()) + bytes;
}
std::string double_field(int field, double value) {
  return field_key(field, 1) + little_endian(value);
}
std::string float_field(int field, float value) {
  return field_key(field, 5) + little_endian(value);
}

std::string event(const ordered_json& entry) {
  std::string values;
  for (const auto& [name, value] : entry.items())
    if (value.is_number() && name != "update" && name != "seconds")
      values += bytes_field(1, bytes_field(1, name) + float_field(2, value.get<float>()));
  const double seconds = entry.contains("seconds") && entry["seconds"].is_number()
                             ? entry["seconds"].get<double>()
                             : 0.0;
  return double_field(1, seconds) + field_key(2, 0) + varint(entry["update"].get<std::uint64_t>()) +
         bytes_field(5, values);
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
  std::string bytes = record(double_field(1, 0.0) + bytes_field(3, "brain.Event:2"));
  for (const auto& entry : *log) bytes += record(event(entry));
  return bytes;
}

}  // namespace touchtrace::sweep
