#include "pipeline/cli/live_glove.h"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <optional>

#include "engine/base/error.h"
#include "engine/base/interrupt.h"
#include "engine/base/progress.h"
#include "pipeline/acquire/glove/baseline.h"
#include "pipeline/cli/glove_page.h"
#include "pipeline/study/live_prediction.h"

namespace touchtrace::cli {
namespace {

using nlohmann::json;

constexpr std::size_t max_latencies = 2'000;

/// Prints a line at once.
void put_line(const std::string& line) {
  if (std::fwrite(line.data(), 1, line.size(), stdout) != line.size() ||
      std::fputc('\n', stdout) == EOF || std::fflush(stdout) != 0)
    throw failure("cannot write standard output", "check the reader of the pipe, or the disk");
}

/// The last latencies, up to max_latencies.
class Latencies {
 public:
  void add(double latency_s) {
    if (seconds_.size() < max_latencies)
      seconds_.push_back(latency_s);
    else
      seconds_[next_++ % max_latencies] = latency_s;
  }
  /// "latency 0.5 ms (median), 1.2 ms (99 %)"; empty without any.
  std::string text() const {
    if (seconds_.empty()) return {};
    auto sorted = seconds_;
    std::ranges::sort(sorted);
    return fmt::format(", latency {:.2f} ms (median), {:.2f} ms (99 %)",
                       1e3 * sorted[sorted.size() / 2], 1e3 * sorted[sorted.size() * 99 / 100]);
  }

 private:
  std::vector<double> seconds_;
  std::size_t next_ = 0;
};

class LiveGlove {
 public:
  LiveGlove(Runtime& runtime, const std::string& model, const LiveOptions& options)
      : options_(options.devices),
        info_(glove_info(options.devices)),
        prediction_(runtime, model, info_, options.devices.glove),
        is_paced_(!is_replay(options.devices.glove) || options.devices.speed == 1.0) {
    if (info_.baseline_counts.empty() && options.rest_s > 0.0)
      rest_.emplace(static_cast<std::size_t>(info_.taxels()), options.rest_s);
    if (options.page) page_.emplace(options.port, info_);
    glove_ = open_glove(options.devices, info_, 0.0);
  }

  void run() {
    const RecordSink sink = [this](RecordKind kind, const std::vector<std::uint8_t>& payload) {
      if (kind == RecordKind::reconnection) prediction_.reset();
      if (kind == RecordKind::glove_frame) add_frame(payload);
    };
    const double period_s = isatty(STDERR_FILENO) ? 1.0 : 10.0;
    double next_report_s = monotonic_s() + period_s;
    while (!interrupted() && glove_->step(sink)) {
      if (monotonic_s() < next_report_s) continue;
      Progress::report(status());
      next_report_s += period_s;
    }
    clear_interrupt();
    require_glove_frames(glove_->status().counts, options_.glove);
    Progress::report(status());
  }

 private:
  std::string status() const {
    return fmt::format("glove {}, {} lost frames bridged{}", glove_text(glove_->status()),
                       prediction_.bridged_frames(), latencies_.text());
  }

  void add_frame(const std::vector<std::uint8_t>& payload) {
    FrameStamp stamp;
    if (!from_payload(payload, static_cast<std::size_t>(info_.taxels()), stamp, counts_)) return;
    arrival_s_ = stamp.host_time_s;
    if (rest_ && rest_->add(arrival_s_, counts_)) return emit(rest_row(stamp));
    if (rest_) prediction_.set_baseline(rest_->baseline());
    rest_.reset();
    prediction_.add(stamp.sequence, arrival_s_, counts_,
                    [this](json row) { emit(std::move(row)); });
  }

  /// Row of a frame from which the baseline is learnt.
  json rest_row(const FrameStamp& stamp) const {
    const double period_s = 1.0 / prediction_.card().rate_hz;
    return {{"step", 0},         {"start", "rest"},
            {"object", nullptr}, {"hand", nullptr},
            {"clip", 0},         {"sequence", stamp.sequence},
            {"received", true},  {"time_s", stamp.host_time_s + period_s},
            {"touch", nullptr},  {"embedding", "none"}};
  }

  void emit(json row) {
    const double latency_s = monotonic_s() - arrival_s_;
    row["latency_s"] = is_paced_ ? json(latency_s) : json();
    put_line(row.dump());
    if (is_paced_) latencies_.add(monotonic_s() - arrival_s_);
    if (page_) page_->show(std::move(row), prediction_.pressure(), glove_->status(), arrival_s_);
  }

  DeviceOptions options_;
  GloveInfo info_;
  study::LivePrediction prediction_;
  bool is_paced_;
  std::optional<RestBaseline> rest_;  ///< until the baseline is known
  std::optional<GlovePage> page_;
  std::unique_ptr<GloveSource> glove_;
  std::vector<std::uint16_t> counts_;
  double arrival_s_ = 0.0;
  Latencies latencies_;
};

}  // namespace

void describe(OptionSet& set, LiveOptions& o) {
  set.group("Live");
  set.flag("page", o.page, "show glove and predictions on a page that is served on 127.0.0.1");
  set.integer("port", o.port, "of the page; 0: any free one", 0, 65535);
  set.number("rest-seconds", o.rest_s,
             "time at the start in which nothing is touched: gives the baseline; 0: none", 0.0,
             1e4);
  describe_known_glove(set, o.devices);
}

void predict_live(Runtime& runtime, const std::string& model, const LiveOptions& options) {
  LiveGlove(runtime, model, options).run();
}

}  // namespace touchtrace::cli
