#include "pipeline/acquire/glove_protocol.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "engine/base/error.h"

namespace touchtrace {

const std::vector<GloveProtocol>& glove_protocols() {
  static const std::vector<GloveProtocol> table{
      {"actionsense", "MIT ActionSense: a line a frame, answered to a request", 1'000'000, 12,
       actionsense_bytes},
      {"mit-rows", "MIT gloves that send row by row", 250'000, 16, mit_row_bytes},
      {"wiresens", "WiReSens Toolkit: packets of 120 counts", 250'000, 16, wiresens_bytes},
      {"stag", "ETH's replica of STAG: a line of text a frame", 921'600, 16, stag_bytes},
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
    throw usage_error(fmt::format("no glove sends by a protocol called '{}'", name),
                      fmt::format("one of: {}", fmt::join(glove_protocol_names(), ", ")));
  return *row;
}

void check_carries(const GloveProtocol& protocol, const GloveInfo& info) {
  if (info.bits <= protocol.most_bits) return;
  throw data_error(fmt::format("{} carries counts of {} bits, the glove's have {}", protocol.name,
                               protocol.most_bits, info.bits),
                   "choose another protocol");
}

std::string little_endian(std::uint64_t value, int bytes) {
  std::string low;
  for (int i = 0; i < bytes; ++i) low += static_cast<char>(value >> (8 * i));
  return low;
}

}  // namespace touchtrace
