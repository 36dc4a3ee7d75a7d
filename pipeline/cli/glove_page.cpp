#include "pipeline/cli/glove_page.h"

#include <fmt/core.h>

#include <chrono>

#include "pipeline/acquire/record/session.h"
#include "pipeline/acquire/transport/transport.h"
#include "pipeline/dataset/tactile_image.h"
#include "pipeline/study/live_prediction.h"

namespace touchtrace::cli {
namespace {

double unix_s() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

}  // namespace

GlovePage::GlovePage(int port, const GloveInfo& info) : page_(port), info_(info) {
  fmt::print(stderr, "the glove is shown at {} (Ctrl-C ends)\n", page_.url());
}

void GlovePage::show(nlohmann::json row, std::span<const float> pressure, const GloveStatus& status,
                     double arrival_s) {
  if (!page_.has_viewers()) return;
  row["arrival_unix_s"] = unix_s() - (monotonic_s() - arrival_s);
  row["glove"] = {{"rate_hz", status.rate_hz},          {"frames", status.counts.frames},
                  {"dropped", status.counts.dropped},   {"torn", status.counts.torn},
                  {"repeated", status.counts.repeated}, {"connected", status.is_connected}};
  page_.show(frame_event(std::move(row), pressure, info_.rows, info_.cols));
}

ShownGlove::ShownGlove(GloveSource& glove, const GloveInfo& info, double rest_s, int port)
    : glove_(glove),
      info_(study::with_all_taxels(info)),
      page_(port, info),
      pressure_(static_cast<std::size_t>(info.taxels())) {
  if (info.baseline_counts.empty() && rest_s > 0.0) rest_.emplace(pressure_.size(), rest_s);
}

bool ShownGlove::step(const RecordSink& sink) {
  return glove_.step([&](RecordKind kind, std::vector<std::uint8_t> payload) {
    if (kind == RecordKind::glove_frame) show(payload);
    sink(kind, std::move(payload));
  });
}

void ShownGlove::show(const std::vector<std::uint8_t>& payload) {
  FrameStamp stamp;
  if (!from_payload(payload, pressure_.size(), stamp, counts_)) return;
  nlohmann::json row{{"sequence", stamp.sequence}};
  if (rest_ && rest_->add(stamp.host_time_s, counts_)) {
    row["start"] = "rest";
  } else {
    if (rest_) info_.baseline_counts = rest_->baseline();
    rest_.reset();
    counts_to_pressure(info_, counts_, pressure_);
    row["touch"] = study::touch_summary(pressure_);
  }
  page_.show(std::move(row), pressure_, glove_.status(), monotonic_s());
}

}  // namespace touchtrace::cli
