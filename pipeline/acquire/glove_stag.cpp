#include <fmt/core.h>

#include "pipeline/acquire/glove_protocol.h"

namespace touchtrace {

/// Decimal counts separated by tabs, "\n" at the end. Source: firmware of ETH's replica of STAG
/// (STM32F769).
std::string encode_stag(const GloveStream& glove, std::size_t frame) {
  const auto taxels = static_cast<std::size_t>(glove.info.taxels());
  std::string line;
  for (std::size_t i = 0; i < taxels; ++i)
    line += fmt::format("{}{}", i ? "\t" : "", glove.counts[frame * taxels + i]);
  return line + '\n';
}

}  // namespace touchtrace
