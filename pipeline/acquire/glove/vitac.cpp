#include <fmt/core.h>

#include <algorithm>

#include "pipeline/acquire/glove/count_line.h"
#include "pipeline/acquire/glove/protocol.h"

namespace touchtrace {
namespace {

/// The frame before the first blank line may lack its start and is not passed on.
class VitacParser : public GloveParser {
 public:
  VitacParser(const GloveInfo& info, FrameSink sink)
      : GloveParser(info, std::move(sink)),
        rows_(static_cast<std::size_t>(info.rows)),
        cols_(static_cast<std::size_t>(info.cols)),
        line_(cols_, max_count()),
        frame_(taxels()) {}

  void feed(std::span<const std::uint8_t> bytes, double host_time_s) override {
    for (const std::uint8_t byte : bytes) {
      if (!line_.put(byte)) continue;
      if (line_.is_blank())
        end_frame(host_time_s);
      else
        end_row();
      line_.clear();
    }
  }

 private:
  void end_row() {
    const auto counts = line_.complete();
    is_valid_ &= !counts.empty();
    is_in_range(line_.largest());
    if (is_valid_ && num_rows_ < rows_)
      std::ranges::copy(counts, frame_.begin() + static_cast<std::ptrdiff_t>(num_rows_ * cols_));
    ++num_rows_;
    frame_bytes_ += line_.bytes();
  }

  void end_frame(double host_time_s) {
    const std::size_t rows = std::exchange(num_rows_, 0), bytes = std::exchange(frame_bytes_, 0);
    const bool is_valid = std::exchange(is_valid_, true);
    if (!std::exchange(is_synchronized_, true) || rows == 0) return;
    if (is_valid && rows == rows_) return pass_on(number_++, frame_, host_time_s);
    const std::size_t frames = std::max<std::size_t>(1, (rows + rows_ / 2) / rows_);
    count_torn(frames), count_skipped(bytes);
    number_ += frames;
  }

  std::size_t rows_, cols_;
  CountLine line_;
  std::vector<std::uint16_t> frame_;
  std::size_t num_rows_ = 0, frame_bytes_ = 0;  ///< of the current frame
  bool is_valid_ = true, is_synchronized_ = false;
  std::uint64_t number_ = 0;
};

}  // namespace

/// One line of decimal counts per row, a blank line behind the last one. Source: 3D-ViTac (Huang et
/// al. 2024).
std::string encode_vitac(const GloveStream& glove, std::size_t frame) {
  const auto taxels = static_cast<std::size_t>(glove.info.taxels()),
             cols = static_cast<std::size_t>(glove.info.cols);
  std::string text;
  for (std::size_t i = 0; i < taxels; ++i)
    text += fmt::format("{}{}", glove.counts[frame * taxels + i], (i + 1) % cols ? ' ' : '\n');
  return text + '\n';
}

std::unique_ptr<GloveParser> parse_vitac(const GloveInfo& info, FrameSink sink) {
  return std::make_unique<VitacParser>(info, std::move(sink));
}

}  // namespace touchtrace
