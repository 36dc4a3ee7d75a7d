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

FramesAhead::FramesAhead(const std::vector<ClipFrames>& clips, See see)
    : see_(std::move(see)), followed_(clips.size()) {
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
  --followed_;
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

/// What nobody has begun by the time that the rest is done is done here, too.
void FramesAhead::both(const std::function<void()>& one, const std::function<void()>& other) {
  const auto offered = std::make_shared<Work>(one);
  Work own(other);
  auto one_done = offered->get_future(), other_done = own.get_future();
  std::unique_lock lock(mutex_);
  offered_.push_back(offered);
  changed_.notify_all();
  lock.unlock();
  own();
  lock.lock();
  const bool is_left = std::erase(offered_, offered) > 0;
  lock.unlock();
  if (is_left) (*offered)();
  one_done.get();
  other_done.get();
}

void FramesAhead::take_over(std::unique_lock<std::mutex>& lock) {
  const auto work = std::move(offered_.front());
  offered_.pop_front();
  lock.unlock();
  (*work)();
  lock.lock();
}

void FramesAhead::help() {
  std::unique_lock lock(mutex_);
  while (followed_ > 0) {
    Clip* clip = neediest();
    if (!offered_.empty())
      take_over(lock);
    else if (clip && clip->ahead.size() < most_ahead)
      see_one(*clip, lock);
    else
      changed_.wait(lock);
  }
}

}  // namespace touchtrace::label
