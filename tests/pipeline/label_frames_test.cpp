#include <gtest/gtest.h>

#include <chrono>
#include <future>
#include <stdexcept>
#include <thread>

#include "pipeline/label/frames_ahead.h"

namespace touchtrace::label {
namespace {

constexpr std::size_t first = 3, count = 20;

std::vector<ClipFrames> one_clip() { return {{first, count, {}, {}, "ball"}}; }

/// Its depth says which it is.
SeenFrame numbered(const ClipFrames&, std::size_t index) {
  return {{{}, {static_cast<std::uint16_t>(index)}}, {}, {}};
}

void expect_all_in_turn(FramesAhead::Reader& reader) {
  for (std::size_t i = first; i < first + count; ++i)
    EXPECT_EQ(reader.next().frame.depth.front(), i);
}

TEST(FramesAhead, ComeInTurnWhoeverSeesThem) {
  const auto clips = one_clip();
  for (const bool helped : {false, true}) {
    FramesAhead frames(clips, numbered);
    const std::jthread helper([&] {
      if (helped) frames.help();
    });
    FramesAhead::Reader reader(frames, 0);
    expect_all_in_turn(reader);
  }
}

TEST(FramesAhead, WhoHelpsTakesOverWork) {
  const auto clips = one_clip();
  FramesAhead frames(clips, numbered);
  const std::jthread helper([&] { frames.help(); });
  FramesAhead::Reader reader(frames, 0);
  std::promise<void> begun;
  auto meanwhile = std::future_status::deferred;
  reader.both([&] { begun.set_value(); },
              [&] { meanwhile = begun.get_future().wait_for(std::chrono::seconds(60)); });
  EXPECT_EQ(meanwhile, std::future_status::ready);
}

TEST(FramesAhead, WorkIsDoneWithoutHelpAndItsErrorsAreThrown) {
  const auto clips = one_clip();
  FramesAhead frames(clips, numbered);
  FramesAhead::Reader reader(frames, 0);
  int done = 0;
  const auto work = [&] { ++done; };
  const auto fault = [] { throw std::runtime_error("work that fails"); };
  reader.both(work, work);
  EXPECT_THROW(reader.both(fault, work), std::runtime_error);
  EXPECT_THROW(reader.both(work, fault), std::runtime_error);
  EXPECT_EQ(done, 4);
  expect_all_in_turn(reader);
}

}  // namespace
}  // namespace touchtrace::label
