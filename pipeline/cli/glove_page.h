#pragma once

#include <optional>

#include "pipeline/acquire/glove/baseline.h"
#include "pipeline/acquire/record/glove_source.h"
#include "pipeline/live/live_page.h"

namespace touchtrace::cli {

/// Page that shows a glove and, in `predict`, predictions. Its address is printed on stderr.
class GlovePage {
 public:
  GlovePage(int port, const GloveInfo& info);

  /// Shows a frame if a page is open. `row`: of live_prediction.h or some of its members;
  /// `arrival_s`: on the clock of monotonic_s().
  void show(nlohmann::json row, std::span<const float> pressure, const GloveStatus& status,
            double arrival_s);

 private:
  LivePage page_;
  GloveInfo info_;
};

/// Glove that is recorded and shown on a page.
class ShownGlove : public RecordSource {
 public:
  /// The baseline is that of `info`, else the median of the first `rest_s` seconds.
  ShownGlove(GloveSource& glove, const GloveInfo& info, double rest_s, int port);

  bool step(const RecordSink& sink) override;

 private:
  void show(const std::vector<std::uint8_t>& payload);

  GloveSource& glove_;
  GloveInfo info_;
  GlovePage page_;
  std::optional<RestBaseline> rest_;  ///< until the baseline is known
  std::vector<std::uint16_t> counts_;
  std::vector<float> pressure_;
};

}  // namespace touchtrace::cli
