#include "pipeline/label/frames_ahead.h"

#include <algorithm>
#include <utility>

namespace touchtrace::label {
namespace {

constexpr std::size_t most_ahead = 4;  // of a clip: memory is bounded, a slow frame waited for

}  // namespace

FramesAhead::FramesAhead(const std::vector<ClipFrames>& clips, See see) : see_(std::move(see)) {
  for (const auto& clip : clips) clips_.push_back({&clip, clip.first, clip.first + clip.count, {}});
}

SeenFrame FramesAhead::next(std::size_t index) {
  std::unique_lock lock(mutex_);
  Clip& clip = clips_[index];
  if (clip.ahead.empty()) {
    const std::size_t frame = clip.begun++;
    lock.unlock();
    return see_(*clip.frames, frame);
  }
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

FramesAhead::Task FramesAhead::begin(Clip& clip) {
  Task task([this, &clip, frame = clip.begun++] { return see_(*clip.frames, frame); });
  clip.ahead.push_back(task.get_future());
  return task;
}

void FramesAhead::help() {
  std::unique_lock lock(mutex_);
  while (Clip* clip = neediest()) {
    if (clip->ahead.size() >= most_ahead) {
      changed_.wait(lock);
      continue;
    }
    auto task = begin(*clip);
    lock.unlock();
    task();
    lock.lock();
  }
}

}  // namespace touchtrace::label
