#include "pipeline/label/frames_ahead.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace touchtrace::label {
namespace {

constexpr std::size_t most_ahead = 4;  // of a clip: memory is bounded, a slow frame waited for

bool is_first_seen(const std::deque<std::future<SeenFrame>>& ahead) {
  return !ahead.empty() &&
         ahead.front().wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

}  // namespace

FramesAhead::FramesAhead(const std::vector<ClipFrames>& clips, See see) : see_(std::move(see)) {
  for (const auto& clip : clips) clips_.push_back({&clip, clip.first, clip.first + clip.count, {}});
}

/// Rather than wait for a frame that another thread is at, sees one after it.
SeenFrame FramesAhead::next(std::size_t index) {
  std::unique_lock lock(mutex_);
  Clip& clip = clips_[index];
  while (!is_first_seen(clip.ahead) && clip.begun < clip.end && clip.ahead.size() < most_ahead)
    see_one(clip, lock);
  auto seen = std::move(clip.ahead.front());
  clip.ahead.pop_front();
  changed_.notify_all();
  lock.unlock();
  return seen.get();
}

void FramesAhead::close(std::size_t index) {
  const std::lock_guard lock(mutex_);
  clips_[index].begun = clips_[index].end;
  clips_[index].ahead.clear();
  changed_.notify_all();
}

FramesAhead::Clip* FramesAhead::neediest() {
  Clip* result = nullptr;
  for (auto& clip : clips_)
    if (clip.begun < clip.end && (!result || clip.ahead.size() < result->ahead.size()))
      result = &clip;
  return result;
}

void FramesAhead::see_one(Clip& clip, std::unique_lock<std::mutex>& lock) {
  std::packaged_task<SeenFrame()> task(
      [this, &clip, frame = clip.begun++] { return see_(*clip.frames, frame); });
  clip.ahead.push_back(task.get_future());
  lock.unlock();
  task();
  lock.lock();
}

void FramesAhead::help() {
  std::unique_lock lock(mutex_);
  while (Clip* clip = neediest())
    if (clip->ahead.size() < most_ahead)
      see_one(*clip, lock);
    else
      changed_.wait(lock);
}

}  // namespace touchtrace::label
