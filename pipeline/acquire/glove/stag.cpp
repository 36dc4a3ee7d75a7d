#include <fmt/core.h>

#include <algorithm>

#include "pipeline/acquire/glove/count_line.h"
#include "pipeline/acquire/glove/protocol.h"

namespace touchtrace {
namespace {

/// The first line may lack its start, which cannot be seen. It is never passed on.
class StagParser : public GloveParser {
 public:
  StagParser(const GloveInfo& info, FrameSink sink)
      : GloveParser(info, std::move(sink)), line_(taxels(), max_count()) {}

  void feed(std::span<const std::uint8_t> bytes, double host_time_s) override {
    for (const std::uint8_t byte : bytes) {
      if (!line_.put(byte)) continue;
      if (is_synchronized_) end_line(host_time_s);
      is_synchronized_ = true;
      line_.clear();
    }
  }

 private:
  void end_line(double host_time_s) {
    if (const auto counts = line_.complete(); !counts.empty())
      return pass_on(number_++, counts, host_time_s);
    is_in_range(line_.largest());
    const std::size_t frames = std::max<std::size_t>(1, (line_.size() + taxels() / 2) / taxels());
    count_torn(frames), count_skipped(line_.bytes());
    number_ += frames;
  }

  CountLine line_;
  bool is_synchronized_ = false;
  std::uint64_t number_ = 0;
};

}  // namespace

/// Decimal counts separated by tabs, "\n" at the end. Source: firmware of ETH's replica of STAG
/// (STM32F769).
std::string encode_stag(const GloveStream& glove, std::size_t frame) {
  const auto taxels = static_cast<std::size_t>(glove.info.taxels());
  std::string line;
  for (std::size_t i = 0; i < taxels; ++i)
    line += fmt::format("{}{}", i ? "\t" : "", glove.counts[frame * taxels + i]);
  return line + '\n';
}

std::unique_ptr<GloveParser> parse_stag(const GloveInfo& info, FrameSink sink) {
  return std::make_unique<StagParser>(info, std::move(sink));
}

}  // namespace touchtrace
