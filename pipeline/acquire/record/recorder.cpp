#include "pipeline/acquire/record/recorder.h"

#include <malloc.h>

#include "pipeline/acquire/transport/transport.h"

namespace touchtrace {
namespace {

constexpr std::size_t max_queued_bytes = std::size_t{1} << 28;
// A loss of power loses what came since the last synchronisation began: this period, a step, and
// the duration of two synchronisations, which must not exceed 1 s together.
constexpr double sync_period_s = 0.4, step_s = 0.1;

}  // namespace

void RecordQueue::push(RecordKind kind, std::vector<std::uint8_t> payload) {
  const std::lock_guard lock(mutex_);
  if (bytes_ + payload.size() > max_queued_bytes) {
    ++discarded_;
    return;
  }
  bytes_ += payload.size();
  items_.push_back({kind, std::move(payload)});
  arrived_.notify_one();
}

std::deque<RecordQueue::Item> RecordQueue::pop(double timeout_s) {
  std::unique_lock lock(mutex_);
  arrived_.wait_for(lock, std::chrono::duration<double>(timeout_s),
                    [this] { return !items_.empty(); });
  bytes_ = 0;
  return std::exchange(items_, {});
}

Recorder::Recorder(const std::filesystem::path& log, const SessionInfo& session,
                   const std::vector<RecordSource*>& sources)
    : log_(log), synced_s_(monotonic_s()) {
  const auto description = to_bytes(session);
  log_.append(RecordKind::description, description);
  log_.append(RecordKind::description, description);  // a copy, in case the first one is damaged
  num_running_ = static_cast<int>(sources.size());
  for (RecordSource* source : sources) threads_.emplace_back([this, source] { run(*source); });
}

Recorder::~Recorder() { stop(); }

void Recorder::run(RecordSource& source) {
  const RecordSink sink = [this](RecordKind kind, std::vector<std::uint8_t> payload) {
    queue_.push(kind, std::move(payload));
  };
  try {
    while (!is_stopping_ && source.step(sink)) {
    }
  } catch (...) {
    const std::lock_guard lock(error_mutex_);
    if (!error_) error_ = std::current_exception();
  }
  --num_running_;
}

bool Recorder::step() {
  const bool is_running = num_running_ > 0;
  write_arrived(step_s);
  if (monotonic_s() - synced_s_ >= sync_period_s) {
    log_.sync();
    synced_s_ = monotonic_s();
    malloc_trim(0);  // frames that waited would occupy memory for good
  }
  const std::lock_guard lock(error_mutex_);
  if (error_) std::rethrow_exception(error_);
  return is_running;
}

void Recorder::write_arrived(double timeout_s) {
  for (const auto& [kind, payload] : queue_.pop(timeout_s)) {
    log_.append(kind, payload);
    written_frames_ += kind != RecordKind::reconnection;
  }
}

void Recorder::stop() {
  is_stopping_ = true;
  for (std::thread& thread : threads_)
    if (thread.joinable()) thread.join();
}

void Recorder::finish() {
  stop();
  write_arrived(0.0);
  log_.sync();
}

}  // namespace touchtrace
