#include "pipeline/acquire/glove/protocol.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <mutex>

#include "engine/base/error.h"
#include "pipeline/acquire/glove/own_protocol.h"

namespace touchtrace {
namespace {

GloveInfo square_glove(int size, int bits, int polarity, double rate_hz) {
  GloveInfo info;
  info.rows = info.cols = size;
  info.bits = bits, info.polarity = polarity, info.rate_hz = rate_hz;
  return info;
}

/// Each file is read once.
const GloveProtocol& own_protocol(const std::string& file) {
  static std::mutex guard;
  static std::map<std::string, GloveProtocol> known;
  const std::lock_guard lock(guard);
  const auto found = known.find(file);
  return found != known.end() ? found->second
                              : known.emplace(file, read_glove_protocol(file)).first->second;
}

}  // namespace

const std::vector<GloveProtocol>& glove_protocols() {
  static const std::vector<GloveProtocol> table{
      {"actionsense", "MIT ActionSense: one line per frame, on request", 1'000'000, 12,
       encode_actionsense, parse_actionsense, square_glove(32, 12, 1, 15.0), 0, "a", false, true},
      {"mit-rows", "MIT gloves: one packet per row", 250'000, 16, encode_mit_rows, parse_mit_rows,
       square_glove(32, 12, 1, 10.0)},
      {"wiresens", "WiReSens Toolkit: packets of 120 counts", 250'000, 16, encode_wiresens,
       parse_wiresens, square_glove(32, 12, -1, 10.0), 0, "", true, true},
      {"stag", "ETH replica of STAG: one line of text per frame", 921'600, 16, encode_stag,
       parse_stag, square_glove(32, 12, 1, 7.5)},
      {"vitac", "3D-ViTac: one line of text per row", 2'000'000, 16, encode_vitac, parse_vitac,
       square_glove(16, 8, 1, 20.0)},
      {"jq20", "JQ20-XL: two packets per frame", 921'600, 8, encode_jq20, parse_jq20,
       square_glove(16, 8, 1, 100.0), 256},
  };
  return table;
}

std::vector<std::string> glove_protocol_names() {
  std::vector<std::string> names;
  for (const GloveProtocol& protocol : glove_protocols()) names.push_back(protocol.name);
  return names;
}

const GloveProtocol& find_glove_protocol(const std::string& name) {
  if (name.ends_with(".toml")) return own_protocol(name);
  const auto& table = glove_protocols();
  const auto row = std::ranges::find(table, name, &GloveProtocol::name);
  if (row == table.end())
    throw usage_error(fmt::format("unknown glove protocol '{}'", name),
                      fmt::format("choose one of: {}, or describe your own in a .toml file",
                                  fmt::join(glove_protocol_names(), ", ")));
  return *row;
}

void require_supported(const GloveProtocol& protocol, const GloveInfo& info) {
  if (protocol.fixed_taxels != 0 && info.taxels() != protocol.fixed_taxels)
    throw data_error(fmt::format("protocol '{}' transmits {} taxels, the glove has {}",
                                 protocol.name, protocol.fixed_taxels, info.taxels()),
                     "choose another protocol");
  if (info.bits > protocol.max_bits)
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
