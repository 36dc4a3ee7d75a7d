#include "pipeline/acquire/record/glove_source.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

#include "engine/base/error.h"
#include "engine/base/interrupt.h"
#include "pipeline/acquire/record/session.h"
#include "pipeline/recording/frame_pairs.h"

namespace touchtrace {
namespace {

constexpr double read_timeout_s = 0.1, max_answer_s = 1.0;

ParserCounts sum(const ParserCounts& a, const ParserCounts& b) {
  return {a.frames + b.frames,
          a.dropped + b.dropped,
          a.torn + b.torn,
          a.repeated + b.repeated,
          a.restarts + b.restarts,
          a.skipped_bytes + b.skipped_bytes,
          a.out_of_range + b.out_of_range};
}

int count_saturated(const GloveInfo& info, std::span<const std::uint16_t> counts) {
  const unsigned saturated = info.polarity > 0 ? (1u << info.bits) - 1 : 0;
  return static_cast<int>(std::ranges::count(counts, saturated));
}

}  // namespace

GloveSource::GloveSource(const GloveProtocol& protocol, const GloveInfo& info,
                         const Options& options, double start_s)
    : protocol_(protocol), info_(info), options_(options), start_s_(start_s) {
  open();
}

void GloveSource::open() {
  const SerialLine line{options_.baud > 0 ? options_.baud : protocol_.baud,
                        protocol_.holds_lines_low};
  port_ = open_port(options_.port, line);
  is_replay_ = is_replay(options_.port);
  opened_s_ = monotonic_s();
  replayed_number_.reset();
  parser_ = protocol_.parse(info_, [this](const GloveFrame& frame) { pass_on(frame); });
  restarts_ = 0;
}

/// Opens the port of a glove that was unplugged; waits a little if it is not there.
bool GloveSource::try_open() {
  try {
    open();
    return true;
  } catch (const Error&) {
    std::this_thread::sleep_for(std::chrono::duration<double>(read_timeout_s));
    return false;
  }
}

bool GloveSource::step(const RecordSink& sink) {
  sink_ = &sink;
  if (!port_ && !try_open()) return true;
  const Reading reading = port_->read(buffer_, request());
  if (reading.status == Reading::Status::ended) parser_->finish(monotonic_s());
  if (reading.status == Reading::Status::data) {
    is_answered_ = true;
    parser_->feed({buffer_.data(), reading.bytes}, reading.time_s);
  }
  const std::lock_guard lock(mutex_);
  status_.counts = sum(earlier_counts_, parser_->counts());
  status_.is_connected = reading.status != Reading::Status::unplugged;
  if (status_.is_connected) return reading.status != Reading::Status::ended;
  port_.reset();
  is_gap_ = is_started_;
  earlier_counts_ = status_.counts;
  return true;
}

/// Asks for a frame if the device waits for requests, has answered the last one, and the next is
/// due. Returns the time to wait for bytes [s].
double GloveSource::request() {
  if (protocol_.request.empty()) return read_timeout_s;
  const double period_s = is_answered_ ? 1.0 / info_.rate_hz : max_answer_s;
  const double now_s = monotonic_s();
  if (const double late_s = now_s - requested_s_ - period_s; late_s >= 0.0) {
    port_->write(protocol_.request);
    // The next request is due one period after this one was, or the rate would be too low.
    requested_s_ = is_answered_ && late_s < period_s ? requested_s_ + period_s : now_s;
    is_answered_ = false;
  }
  return std::clamp(requested_s_ + period_s - now_s, 1e-3, read_timeout_s);
}

/// Time of a frame of a file: its number at the nominal rate. Waits for it at the replay's speed.
double GloveSource::replayed_s(std::uint64_t number) {
  if (!replayed_number_) replayed_number_ = number;
  const double elapsed_s = static_cast<double>(number - *replayed_number_ + 1) / info_.rate_hz;
  if (options_.replay_speed > 0.0)
    while (!interrupted() && !wait_for_time(opened_s_ + elapsed_s / options_.replay_speed)) {
    }
  return opened_s_ + elapsed_s;
}

void GloveSource::pass_on(const GloveFrame& arrived) {
  GloveFrame frame = arrived;
  if (is_replay_) frame.host_time_s = replayed_s(frame.sequence);
  if (parser_->counts().restarts != restarts_) is_gap_ = true;
  restarts_ = parser_->counts().restarts;
  if (!protocol_.has_numbers && is_started_ &&
      is_pause(frame.host_time_s - last_.host_time_s, info_.rate_hz))
    is_gap_ = true;
  if (is_gap_ || !is_started_) begin_segment(frame);
  last_ = {frame.sequence + offset_, frame.host_time_s, {}};
  const FrameStamp stamp{last_.sequence, frame.host_time_s - start_s_,
                         frame.host_time_s - start_s_};
  (*sink_)(RecordKind::glove_frame, to_payload(stamp, frame.counts));
  const std::lock_guard lock(mutex_);
  status_.saturated_taxels = count_saturated(info_, frame.counts);
  status_.last_frame_s = frame.host_time_s;
  if (last_.host_time_s > first_.host_time_s)
    status_.rate_hz = static_cast<double>(last_.sequence - first_.sequence) /
                      (last_.host_time_s - first_.host_time_s);
}

/// Marks a gap; the sequence continues with as many frames as the gap is long.
void GloveSource::begin_segment(const GloveFrame& frame) {
  if (is_gap_) {
    const double missed = std::round((frame.host_time_s - last_.host_time_s) * info_.rate_hz);
    const auto step = static_cast<std::uint64_t>(std::clamp(missed, 1.0, 1e6));
    offset_ = last_.sequence + step - frame.sequence;
    (*sink_)(RecordKind::reconnection, {});
    const std::lock_guard lock(mutex_);
    ++status_.reconnections;
  }
  is_gap_ = false, is_started_ = true;
  first_ = {frame.sequence + offset_, frame.host_time_s, {}};
}

GloveStatus GloveSource::status() const {
  const std::lock_guard lock(mutex_);
  return status_;
}

}  // namespace touchtrace
