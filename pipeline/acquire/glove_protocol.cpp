#include "pipeline/acquire/glove_protocol.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "engine/base/error.h"

namespace touchtrace {

const std::vector<GloveProtocol>& glove_protocols() {
  static const std::vector<GloveProtocol> table{
      {"actionsense", "MIT ActionSense: one line per frame, on request", 1'000'000, 12,
       encode_actionsense},
      {"mit-rows", "MIT gloves: one packet per row", 250'000, 16, encode_mit_rows},
      {"wiresens", "WiReSens Toolkit: packets of 120 counts", 250'000, 16, encode_wiresens},
      {"stag", "ETH replica of STAG: one line of text per frame", 921'600, 16, encode_stag},
  };
  return table;
}

std::vector<std::string> glove_protocol_names() {
  std::vector<std::string> names;
  for (const GloveProtocol& protocol : glove_protocols()) names.push_back(protocol.name);
  return names;
}

const GloveProtocol& find_glove_protocol(const std::string& name) {
  const auto& table = glove_protocols();
  const auto row = std::ranges::find(table, name, &GloveProtocol::name);
  if (row == table.end())
    throw usage_error(fmt::format("unknown glove protocol '{}'", name),
                      fmt::format("choose one of: {}", fmt::join(glove_protocol_names(), ", ")));
  return *row;
}

void require_supported(const GloveProtocol& protocol, const GloveInfo& info) {
  if (info.bits <= protocol.max_bits) return;
  throw data_error(fmt::format("protocol '{}' transmits {} bits per count, the glove has {}",
                               protocol.name, protocol.max_bits, info.bits),
                   "choose another protocol");
}

std::string little_endian(std::uint64_t value, int bytes) {
  std::string low;
  for (int i = 0; i < bytes; ++i) low += static_cast<char>(value >> (8 * i));
  return low;
}

}  // namespace touchtrace
