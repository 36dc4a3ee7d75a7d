#include "pipeline/label/track/frame_prefetcher.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace touchtrace::label {
namespace {

constexpr std::size_t max_prefetched = 4;  // per pass; bounds memory

bool is_first_ready(const std::deque<std::future<SegmentedFrame>>& ahead) {
  return !ahead.empty() &&
         ahead.front().wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

}  // namespace

FramePrefetcher::FramePrefetcher(const std::vector<TrackingPass>& passes, Segment segment)
    : segment_(std::move(segment)), open_passes_(passes.size()) {
  for (const auto& pass : passes) passes_.push_back({pass, 0, pass.count(), {}});
}

/// While another thread still segments the first frame, segments later ones instead of waiting.
SegmentedFrame FramePrefetcher::next(std::size_t index) {
  std::unique_lock lock(mutex_);
  Pass& pass = passes_[index];
  while (!is_first_ready(pass.ahead) && pass.next < pass.end && pass.ahead.size() < max_prefetched)
    segment_next(pass, lock);
  auto frame = std::move(pass.ahead.front());
  pass.ahead.pop_front();
  changed_.notify_all();
  lock.unlock();
  return frame.get();
}

void FramePrefetcher::close(std::size_t index) {
  const std::lock_guard lock(mutex_);
  passes_[index].next = passes_[index].end;
  passes_[index].ahead.clear();
  --open_passes_;
  changed_.notify_all();
}

FramePrefetcher::Pass* FramePrefetcher::neediest() {
  Pass* result = nullptr;
  for (auto& pass : passes_)
    if (pass.next < pass.end && (!result || pass.ahead.size() < result->ahead.size()))
      result = &pass;
  return result;
}

void FramePrefetcher::segment_next(Pass& pass, std::unique_lock<std::mutex>& lock) {
  std::packaged_task<SegmentedFrame()> task([this, frames = pass.frames, i = pass.next++] {
    return segment_(*frames.clip, frames.frame(i));
  });
  pass.ahead.push_back(task.get_future());
  lock.unlock();
  task();
  lock.lock();
}

/// If no worker has begun the first task once the second is done, runs it here.
void FramePrefetcher::run_in_parallel(const std::function<void()>& first,
                                      const std::function<void()>& second) {
  const auto offered = std::make_shared<Task>(first);
  Task own(second);
  auto first_done = offered->get_future(), second_done = own.get_future();
  std::unique_lock lock(mutex_);
  offered_.push_back(offered);
  changed_.notify_all();
  lock.unlock();
  own();
  lock.lock();
  const bool is_left = std::erase(offered_, offered) > 0;
  lock.unlock();
  if (is_left) (*offered)();
  first_done.get();
  second_done.get();
}

void FramePrefetcher::run_offered(std::unique_lock<std::mutex>& lock) {
  const auto task = std::move(offered_.front());
  offered_.pop_front();
  lock.unlock();
  (*task)();
  lock.lock();
}

void FramePrefetcher::run_worker() {
  std::unique_lock lock(mutex_);
  while (open_passes_ > 0) {
    Pass* pass = neediest();
    if (!offered_.empty())
      run_offered(lock);
    else if (pass && pass->ahead.size() < max_prefetched)
      segment_next(*pass, lock);
    else
      changed_.wait(lock);
  }
}

}  // namespace touchtrace::label
