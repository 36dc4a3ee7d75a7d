#include <gtest/gtest.h>

#include <chrono>
#include <future>
#include <stdexcept>
#include <thread>

#include "pipeline/label/track/frame_prefetcher.h"

namespace touchtrace::label {
namespace {

constexpr std::size_t first = 3, count = 20;

const ClipFrames clip{first, count, {}, {}, "ball", first};

std::vector<TrackingPass> one_clip() { return {{&clip, false}}; }

/// Frame whose depth is its index.
SegmentedFrame numbered(const ClipFrames&, std::size_t index) {
  return {{{}, {static_cast<std::uint16_t>(index)}}, {}, {}};
}

void expect_all_in_order(FramePrefetcher::Reader& reader) {
  for (std::size_t i = first; i < first + count; ++i)
    EXPECT_EQ(reader.next().frame.depth.front(), i);
}

TEST(FramePrefetcher, ReturnsFramesInOrderWithAndWithoutAWorker) {
  const auto clips = one_clip();
  for (const bool has_worker : {false, true}) {
    FramePrefetcher frames(clips, numbered);
    const std::jthread worker([&] {
      if (has_worker) frames.run_worker();
    });
    FramePrefetcher::Reader reader(frames, 0);
    expect_all_in_order(reader);
  }
}

TEST(FramePrefetcher, WorkerRunsOfferedTasks) {
  const auto clips = one_clip();
  FramePrefetcher frames(clips, numbered);
  const std::jthread worker([&] { frames.run_worker(); });
  FramePrefetcher::Reader reader(frames, 0);
  std::promise<void> begun;
  auto meanwhile = std::future_status::deferred;
  reader.run_in_parallel(
      [&] { begun.set_value(); },
      [&] { meanwhile = begun.get_future().wait_for(std::chrono::seconds(60)); });
  EXPECT_EQ(meanwhile, std::future_status::ready);
}

TEST(FramePrefetcher, RunsTasksWithoutAWorkerAndRethrows) {
  const auto clips = one_clip();
  FramePrefetcher frames(clips, numbered);
  FramePrefetcher::Reader reader(frames, 0);
  int done = 0;
  const auto task = [&] { ++done; };
  const auto failing = [] { throw std::runtime_error("failing task"); };
  reader.run_in_parallel(task, task);
  EXPECT_THROW(reader.run_in_parallel(failing, task), std::runtime_error);
  EXPECT_THROW(reader.run_in_parallel(task, failing), std::runtime_error);
  EXPECT_EQ(done, 4);
  expect_all_in_order(reader);
}

}  // namespace
}  // namespace touchtrace::label
