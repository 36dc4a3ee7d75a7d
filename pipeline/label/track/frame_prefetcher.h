#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <vector>

#include "pipeline/label/learn/scene_model.h"
#include "pipeline/label/track/box_tracker.h"

namespace touchtrace::label {

/// A camera frame with its foreground points.
struct SegmentedFrame {
  RgbdFrame frame;
  Surface surface;
  MaskedImage image;  ///< empty if no image tracker is used
};

/// Segmented frames of several passes, for one tracking thread per pass plus workers. A tracking
/// thread segments its frames itself unless a worker has done so before. This keeps all cores busy
/// until the last pass is done. Thread-safe.
class FramePrefetcher {
 public:
  using Segment = std::function<SegmentedFrame(const ClipFrames&, std::size_t index)>;

  /// The passes' clips must outlive this object.
  FramePrefetcher(const std::vector<TrackingPass>& passes, Segment segment);

  /// Frames of one pass, for its tracking thread. Destruction cancels the remaining frames.
  class Reader {
   public:
    Reader(FramePrefetcher& frames, std::size_t pass) : frames_(frames), pass_(pass) {}
    ~Reader() { frames_.close(pass_); }
    Reader(const Reader&) = delete;
    Reader& operator=(const Reader&) = delete;

    /// Next frame in order. Rethrows what the segmentation threw.
    SegmentedFrame next() { return frames_.next(pass_); }
    /// Calls both functions and waits; a free worker may run the first one. Rethrows exceptions.
    void run_in_parallel(const std::function<void()>& first, const std::function<void()>& second) {
      frames_.run_in_parallel(first, second);
    }

   private:
    FramePrefetcher& frames_;
    std::size_t pass_;
  };

  /// Segments frames ahead and runs offered tasks until all readers are destroyed. Call only once
  /// every pass has a thread that makes its reader, else it never returns.
  void run_worker();

 private:
  struct Pass {
    TrackingPass frames;
    std::size_t next, end;                          ///< next: first frame that no thread has begun
    std::deque<std::future<SegmentedFrame>> ahead;  ///< frames begun but not taken
  };
  using Task = std::packaged_task<void()>;

  SegmentedFrame next(std::size_t pass);
  void run_in_parallel(const std::function<void()>& first, const std::function<void()>& second);
  /// Runs the oldest offered task with the lock released.
  void run_offered(std::unique_lock<std::mutex>& lock);
  void close(std::size_t pass);
  /// Pass with the fewest frames ahead; null if all frames are begun.
  Pass* neediest();
  /// Segments a pass's next frame with the lock released.
  void segment_next(Pass& pass, std::unique_lock<std::mutex>& lock);

  Segment segment_;
  std::deque<Pass> passes_;
  std::size_t open_passes_;                    ///< passes whose readers are not destroyed
  std::deque<std::shared_ptr<Task>> offered_;  ///< by threads that wait for them
  std::mutex mutex_;
  std::condition_variable changed_;
};

}  // namespace touchtrace::label
