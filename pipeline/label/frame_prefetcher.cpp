#include "pipeline/label/frame_prefetcher.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace touchtrace::label {
namespace {

constexpr std::size_t max_prefetched = 4;  // per clip; bounds memory

bool is_first_ready(const std::deque<std::future<SegmentedFrame>>& ahead) {
  return !ahead.empty() &&
         ahead.front().wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

}  // namespace

FramePrefetcher::FramePrefetcher(const std::vector<ClipFrames>& clips, Segment segment)
    : segment_(std::move(segment)), open_clips_(clips.size()) {
  for (const auto& clip : clips) clips_.push_back({&clip, clip.first, clip.first + clip.count, {}});
}

/// While another thread still segments the first frame, segments later ones instead of waiting.
SegmentedFrame FramePrefetcher::next(std::size_t index) {
  std::unique_lock lock(mutex_);
  Clip& clip = clips_[index];
  while (!is_first_ready(clip.ahead) && clip.next < clip.end && clip.ahead.size() < max_prefetched)
    segment_next(clip, lock);
  auto frame = std::move(clip.ahead.front());
  clip.ahead.pop_front();
  changed_.notify_all();
  lock.unlock();
  return frame.get();
}

void FramePrefetcher::close(std::size_t index) {
  const std::lock_guard lock(mutex_);
  clips_[index].next = clips_[index].end;
  clips_[index].ahead.clear();
  --open_clips_;
  changed_.notify_all();
}

FramePrefetcher::Clip* FramePrefetcher::neediest() {
  Clip* result = nullptr;
  for (auto& clip : clips_)
    if (clip.next < clip.end && (!result || clip.ahead.size() < result->ahead.size()))
      result = &clip;
  return result;
}

void FramePrefetcher::segment_next(Clip& clip, std::unique_lock<std::mutex>& lock) {
  std::packaged_task<SegmentedFrame()> task(
      [this, &clip, frame = clip.next++] { return segment_(*clip.frames, frame); });
  clip.ahead.push_back(task.get_future());
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
  while (open_clips_ > 0) {
    Clip* clip = neediest();
    if (!offered_.empty())
      run_offered(lock);
    else if (clip && clip->ahead.size() < max_prefetched)
      segment_next(*clip, lock);
    else
      changed_.wait(lock);
  }
}

}  // namespace touchtrace::label
