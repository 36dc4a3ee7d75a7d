#include <gtest/gtest.h>

#include <filesystem>
#include <map>

#include "engine/base/random.h"
#include "pipeline/acquire/glove/protocol.h"

namespace touchtrace {
namespace {

const std::string gloves = TOUCHTRACE_SOURCE_DIR "/tests/data/gloves/";

struct Parsed {
  std::map<std::uint64_t, std::vector<std::uint16_t>> frames;
  std::vector<double> times_s;
  ParserCounts counts;
};

/// Random frames as the protocol's usual device sends them, of fewer taxels where possible.
GloveStream random_glove(const GloveProtocol& protocol, std::size_t frames) {
  RandomStream random(5, protocol.name);
  GloveStream glove;
  glove.info = protocol.usual_glove;
  if (protocol.fixed_taxels == 0) glove.info.rows = 6, glove.info.cols = 16;
  for (std::size_t i = 0; i < frames; ++i) {
    glove.sequence.push_back(1000 + i);
    for (int taxel = 0; taxel < glove.info.taxels(); ++taxel)
      glove.counts.push_back(static_cast<std::uint16_t>(random.below(1u << glove.info.bits)));
  }
  return glove;
}

std::vector<std::uint16_t> frame_of(const GloveStream& glove, std::size_t frame) {
  const auto taxels = static_cast<std::ptrdiff_t>(glove.info.taxels());
  const auto at = glove.counts.begin() + static_cast<std::ptrdiff_t>(frame) * taxels;
  return {at, at + taxels};
}

std::string encode(const GloveProtocol& protocol, const GloveStream& glove) {
  std::string bytes;
  for (std::size_t i = 0; i < glove.frames(); ++i) bytes += protocol.encode(glove, i);
  return bytes;
}

/// Feeds random pieces; piece number i arrives at i seconds.
Parsed parse(const GloveProtocol& protocol, const GloveInfo& info, const std::string& bytes,
             std::size_t max_piece = 300) {
  RandomStream random(6, "pieces");
  Parsed parsed;
  const auto parser = protocol.parse(info, [&](const GloveFrame& frame) {
    parsed.times_s.push_back(frame.host_time_s);
    parsed.frames[frame.sequence].assign(frame.counts.begin(), frame.counts.end());
  });
  double time_s = 0.0;
  for (std::size_t at = 0; at < bytes.size();) {
    const std::size_t size = std::min(bytes.size() - at, 1 + random.below(max_piece));
    parser->feed({reinterpret_cast<const std::uint8_t*>(bytes.data()) + at, size}, time_s++);
    at += size;
  }
  parsed.counts = parser->counts();
  return parsed;
}

/// Frames of `glove` by the number that their first parsed frame has in `reference`.
std::size_t wrong_frames(const Parsed& parsed, const Parsed& reference) {
  std::size_t wrong = 0;
  for (const auto& [sequence, counts] : parsed.frames)
    wrong += !reference.frames.contains(sequence) || reference.frames.at(sequence) != counts;
  return wrong;
}

class GloveParserTest : public ::testing::TestWithParam<std::string> {
 protected:
  static constexpr std::size_t frames = 300;  // more than the frame numbers of actionsense
  const GloveProtocol& protocol = find_glove_protocol(GetParam());
  const GloveStream glove = random_glove(protocol, frames);
  const std::string bytes = encode(protocol, glove);
  /// Text protocols start behind the first separator; some need the marker behind a frame.
  const std::size_t first = protocol.name == "stag" || protocol.name == "vitac" ? 1 : 0;
  const std::size_t last =
      protocol.name == "jq20" || protocol.name == "plain" ? frames - 1 : frames;
};

TEST_P(GloveParserTest, ReadsWhatTheEncoderWritesInPiecesOfAnySize) {
  for (const std::size_t max_piece : {1u, 7u, 5000u}) {
    const Parsed parsed = parse(protocol, glove.info, bytes, max_piece);
    ASSERT_EQ(parsed.frames.size(), last - first);
    std::size_t index = first;
    std::uint64_t sequence = parsed.frames.begin()->first;
    for (const auto& [number, counts] : parsed.frames) {
      EXPECT_EQ(number, sequence++);
      EXPECT_EQ(counts, frame_of(glove, index++));
    }
    EXPECT_TRUE(std::ranges::is_sorted(parsed.times_s));
    EXPECT_EQ(parsed.counts.torn + parsed.counts.dropped + parsed.counts.repeated, 0u);
  }
}

TEST_P(GloveParserTest, CountsRepeatedFrames) {
  GloveStream frozen = glove;
  for (std::size_t i = 0; i < frozen.counts.size(); ++i)
    frozen.counts[i] = frozen.counts[i % static_cast<std::size_t>(frozen.info.taxels())];
  EXPECT_EQ(parse(protocol, frozen.info, encode(protocol, frozen)).counts.repeated,
            last - first - 1);
}

/// Damages one place of the stream and requires that at most three frames are lost, none is wrong,
/// and the loss is counted.
template <class Damage>
void survive(const GloveProtocol& protocol, const GloveStream& glove, const std::string& bytes,
             Damage damage) {
  const Parsed reference = parse(protocol, glove.info, bytes);
  RandomStream random(7, protocol.name);
  for (int i = 0; i < 60; ++i) {
    std::string damaged = bytes;
    damage(damaged, bytes.size() / 10 + random.below(bytes.size() / 2), random);
    const Parsed parsed = parse(protocol, glove.info, damaged);
    EXPECT_EQ(wrong_frames(parsed, reference), 0u);
    EXPECT_GE(parsed.frames.size() + 3, reference.frames.size());
    EXPECT_EQ(parsed.frames.size() + parsed.counts.torn + parsed.counts.dropped,
              reference.frames.size());
  }
}

/// Digits that are removed, changed or inserted cannot be detected in text without a checksum.
bool is_text(const GloveProtocol& protocol) {
  return protocol.name == "stag" || protocol.name == "vitac";
}

TEST_P(GloveParserTest, DetectsRemovedBytes) {
  if (is_text(protocol)) GTEST_SKIP() << "a shorter number is valid text";
  survive(protocol, glove, bytes, [](std::string& text, std::size_t at, RandomStream& random) {
    text.erase(at, 1 + random.below(20));
  });
}

TEST_P(GloveParserTest, DetectsInsertedBytes) {
  if (is_text(protocol)) GTEST_SKIP() << "a longer number may be valid text";
  survive(protocol, glove, bytes, [](std::string& text, std::size_t at, RandomStream& random) {
    for (std::uint64_t i = random.below(20) + 1; i > 0; --i)
      text.insert(at, 1, static_cast<char>(random.below(256)));
  });
}

/// Protocols any byte of which may be part of a count.
constexpr const char* any_bytes[] = {"mit-rows", "wiresens", "jq20", "numbered", "plain"};

TEST_P(GloveParserTest, DetectsBytesOfAnotherAlphabet) {
  if (std::ranges::find(any_bytes, protocol.name) != std::end(any_bytes))
    GTEST_SKIP() << "any byte may be part of a count";
  survive(protocol, glove, bytes,
          [](std::string& text, std::size_t at, RandomStream&) { text[at] = '\xff'; });
}

TEST_P(GloveParserTest, FindsTheStreamAgainAfterGarbage) {
  const Parsed reference = parse(protocol, glove.info, bytes);
  RandomStream random(8, protocol.name);
  std::string damaged = bytes;
  std::string garbage(5000, '\0');
  for (char& byte : garbage) byte = static_cast<char>(random.below(256));
  damaged.insert(bytes.size() / 2 + 3, garbage);
  const Parsed parsed = parse(protocol, glove.info, damaged);
  EXPECT_GE(parsed.frames.size() + 4, reference.frames.size());
  EXPECT_GT(parsed.counts.torn + parsed.counts.dropped, 0u);
  EXPECT_GE(parsed.counts.skipped_bytes + 10, garbage.size());
}

TEST_P(GloveParserTest, SurvivesRandomBytes) {
  RandomStream random(9, protocol.name);
  std::uint64_t frames_seen = 0, previous = 0;
  const auto parser = protocol.parse(glove.info, [&](const GloveFrame& frame) {
    EXPECT_TRUE(frames_seen == 0 || frame.sequence > previous);
    ++frames_seen, previous = frame.sequence;
  });
  std::vector<std::uint8_t> piece;
  for (int i = 0; i < 20'000; ++i) {
    piece.resize(random.below(64));
    const bool is_valid_part = random.below(3) == 0;
    const std::size_t at = random.below(bytes.size() - piece.size());
    for (std::size_t k = 0; k < piece.size(); ++k)
      piece[k] = static_cast<std::uint8_t>(is_valid_part ? bytes[at + k] : random.below(256));
    parser->feed(piece, i);
  }
}

std::vector<std::string> all_protocols() {
  std::vector<std::string> names = glove_protocol_names();
  for (const char* own : {"numbered", "plain"}) names.push_back(gloves + own + ".toml");
  return names;
}

INSTANTIATE_TEST_SUITE_P(Protocols, GloveParserTest, ::testing::ValuesIn(all_protocols()),
                         [](const auto& protocol) {
                           std::string name = std::filesystem::path(protocol.param).stem();
                           std::erase(name, '-');
                           return name;
                         });

TEST(GloveParser, SkipsTheNumbersOfLostFrames) {
  const GloveProtocol& protocol = find_glove_protocol("actionsense");
  GloveStream glove = random_glove(protocol, 40);
  for (std::size_t i = 0; i < glove.frames(); ++i) glove.sequence[i] += i >= 20 ? 150 : i >= 10;
  const Parsed parsed = parse(protocol, glove.info, encode(protocol, glove));
  EXPECT_EQ(parsed.counts.frames, 40u);
  EXPECT_EQ(parsed.counts.dropped, 150u);
  EXPECT_EQ(parsed.frames.rbegin()->first - parsed.frames.begin()->first, 189u);
}

TEST(GloveParser, LastPacketWithoutAnEndIsPassedOn) {
  const GloveProtocol& protocol = find_glove_protocol("jq20");
  const GloveStream glove = random_glove(protocol, 3);
  const std::string bytes = encode(protocol, glove);
  std::size_t frames = 0;
  const auto parser = protocol.parse(glove.info, [&](const GloveFrame&) { ++frames; });
  parser->feed({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}, 0.0);
  EXPECT_EQ(frames, 2u);
  parser->finish(1.0);
  EXPECT_EQ(frames, 3u);
}

TEST(GloveParser, CountsPacketsWithCountsBeyondTheRange) {
  for (const char* name : {"mit-rows", "stag", "wiresens"}) {
    const GloveProtocol& protocol = find_glove_protocol(name);
    const GloveStream glove = random_glove(protocol, 4);
    EXPECT_EQ(parse(protocol, glove.info, encode(protocol, glove)).counts.out_of_range, 0u) << name;
    GloveInfo fewer_bits = glove.info;
    fewer_bits.bits = 4;
    EXPECT_GT(parse(protocol, fewer_bits, encode(protocol, glove)).counts.out_of_range, 0u) << name;
  }
}

TEST(GloveParser, WrongFrameNumberIsNotALoss) {
  const GloveProtocol& protocol = find_glove_protocol("actionsense");
  const GloveStream glove = random_glove(protocol, 40);
  for (int number = 11; number < 255; ++number) {
    std::string bytes = encode(protocol, glove);
    bytes[20 * (bytes.size() / 40)] = static_cast<char>(number);
    EXPECT_LE(parse(protocol, glove.info, bytes).counts.dropped, 1u) << number;
  }
}

TEST(GloveParser, RestartOfTheDeviceContinuesTheSequence) {
  const GloveProtocol& protocol = find_glove_protocol("wiresens");
  GloveStream glove = random_glove(protocol, 40);
  const std::string bytes = encode(protocol, glove);
  for (auto& sequence : glove.sequence) sequence -= 1000;
  const Parsed parsed = parse(protocol, glove.info, bytes + encode(protocol, glove));
  EXPECT_EQ(parsed.counts.restarts, 1u);
  EXPECT_LT(parsed.frames.rbegin()->first, 1100u);
}

}  // namespace
}  // namespace touchtrace
