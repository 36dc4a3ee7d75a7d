#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <vector>

#include "pipeline/label/box_tracker.h"
#include "pipeline/label/scene_model.h"

namespace touchtrace::label {

/// A camera frame and what moves in it, told apart by colour.
struct SeenFrame {
  RgbdFrame frame;
  Surface surface;
  MaskedImage image;  ///< empty unless a tracker follows
};

/// The frames of several clips. Whoever follows a clip sees its frames one after the other, unless
/// a thread that has no clip to follow has seen them ahead of it or takes over other work: so all
/// cores are busy to the end.
class FramesAhead {
 public:
  using See = std::function<SeenFrame(const ClipFrames&, std::size_t index)>;

  /// `clips` must outlive this.
  FramesAhead(const std::vector<ClipFrames>& clips, See see);

  /// Gives a clip's frames in turn. No more of them are wanted once it is gone.
  class Reader {
   public:
    Reader(FramesAhead& frames, std::size_t clip) : frames_(frames), clip_(clip) {}
    ~Reader() { frames_.close(clip_); }
    Reader(const Reader&) = delete;
    Reader& operator=(const Reader&) = delete;

    SeenFrame next() { return frames_.next(clip_); }
    /// Calls both, one of them in a thread that has no clip to follow, if there is one.
    void both(const std::function<void()>& one, const std::function<void()>& other) {
      frames_.both(one, other);
    }

   private:
    FramesAhead& frames_;
    std::size_t clip_;
  };

  /// Sees frames ahead and takes over work until all clips are followed. To be called only once
  /// every clip is in the hands of a thread that makes its reader.
  void help();

 private:
  struct Clip {
    const ClipFrames* frames;
    std::size_t begun, end;                    ///< begun: the first that nobody sees yet
    std::deque<std::future<SeenFrame>> ahead;  ///< of those before it, what was not taken yet
  };
  using Work = std::packaged_task<void()>;

  SeenFrame next(std::size_t clip);
  void both(const std::function<void()>& one, const std::function<void()>& other);
  /// The oldest of the work that is to be taken over, without the lock.
  void take_over(std::unique_lock<std::mutex>& lock);
  void close(std::size_t clip);
  /// The clip that will be out of frames first; null if none needs any more.
  Clip* neediest();
  /// A clip's first frame that nobody sees yet, without the lock.
  void see_one(Clip& clip, std::unique_lock<std::mutex>& lock);

  See see_;
  std::deque<Clip> clips_;
  std::size_t followed_;                       ///< clips whose readers are not gone
  std::deque<std::shared_ptr<Work>> offered_;  ///< to be taken over; who offers it waits for it
  std::mutex mutex_;
  std::condition_variable changed_;
};

}  // namespace touchtrace::label
