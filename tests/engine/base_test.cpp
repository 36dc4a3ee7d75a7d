#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <limits>
#include <vector>

#include "engine/base/child_process.h"
#include "engine/base/error.h"
#include "engine/base/files.h"
#include "engine/base/integer_math.h"
#include "engine/base/json_number.h"
#include "engine/base/options.h"
#include "engine/base/provenance.h"
#include "engine/base/random.h"
#include "engine/base/statistics.h"
#include "engine/base/text.h"
#include "tests/support/expect_error.h"
#include "tests/support/scratch.h"
#include "tests/verify/support/figure.h"

namespace touchtrace {
namespace {

namespace fs = std::filesystem;

// Known answers of Random123 (kat_vectors).
TEST(Random, PhiloxMatchesKnownAnswers) {
  using Block = std::array<std::uint32_t, 4>;
  EXPECT_EQ(philox4x32({0, 0, 0, 0}, {0, 0}),
            (Block{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  constexpr std::uint32_t ones = 0xffffffff;
  EXPECT_EQ(philox4x32({ones, ones, ones, ones}, {ones, ones}),
            (Block{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
  EXPECT_EQ(philox4x32({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}),
            (Block{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

TEST(Random, StreamsDifferByNameAndSeedAndSupportSeek) {
  RandomStream a(7, "a"), b(7, "b"), c(8, "a");
  EXPECT_NE(a.uniform_at(0), b.uniform_at(0));
  EXPECT_NE(a.uniform_at(0), c.uniform_at(0));
  for (int i = 0; i < 5; ++i) a.normal();
  const double sixth = a.normal();
  a.seek(5);
  EXPECT_EQ(a.normal(), sixth);
}

// Bounds: five standard errors of each moment with n draws.
TEST(Random, NormalMomentsAndUniformRangeAreCorrect) {
  constexpr int n = 200000;
  RandomStream stream(1, "moments");
  double sum = 0, squares = 0, fourth = 0, low = 1, high = 0;
  for (int i = 0; i < n; ++i) {
    const double x = stream.normal(), u = stream.uniform();
    sum += x, squares += x * x, fourth += x * x * x * x;
    low = std::min(low, u), high = std::max(high, u);
  }
  EXPECT_LT(std::abs(sum / n), 5 / std::sqrt(double{n}));
  EXPECT_LT(std::abs(squares / n - 1), 5 * std::sqrt(2.0 / n));
  EXPECT_LT(std::abs(fourth / n - 3), 5 * std::sqrt(96.0 / n));
  EXPECT_GE(low, 0.0);
  EXPECT_LT(high, 1.0);
}

TEST(Random, BelowIsUnbiased) {
  std::array<int, 3> seen{};
  RandomStream stream(3, "below");
  constexpr int n = 30000;
  for (int i = 0; i < n; ++i) ++seen[stream.below(3)];
  for (int count : seen) EXPECT_LT(std::abs(count - n / 3), 5 * std::sqrt(n * 2.0 / 9.0));
}

TEST(IntegerMath, RoundsUp) {
  EXPECT_EQ(ceil_div(0, 4), 0);
  EXPECT_EQ(ceil_div(8, 4), 2);
  EXPECT_EQ(ceil_div(9, 4), 3);
  EXPECT_EQ(round_up(9, 4), 12);
  EXPECT_EQ(round_up(std::size_t{8}, std::size_t{8}), 8u);
}

TEST(Median, IsTheMiddleOrUpperMiddleValue) {
  EXPECT_EQ(median({3, 1, 2}), 2);
  EXPECT_EQ(median({4, 1, 3, 2}), 3);
  EXPECT_TRUE(std::isnan(median({})));
  EXPECT_EQ(quantile({3, 1, 2, 5}, 0.7), 3);
  EXPECT_EQ(quantile({3, 1, 2}, 1.0), 3);
  EXPECT_TRUE(std::isnan(quantile({}, 0.5)));
}

/// Quantiles as tabulated.
TEST(NormalQuantile, MatchesKnownValues) {
  EXPECT_NEAR(normal_quantile(0.1), -1.2815515655446004, 1e-12);
  EXPECT_NEAR(normal_quantile(0.5), 0.0, 1e-12);
  EXPECT_NEAR(normal_quantile(0.975), 1.959963984540054, 1e-12);
  EXPECT_NEAR(normal_quantile(0.001), -3.090232306167813, 1e-12);
}

TEST(Text, ParseWholeNeedsTheWholeText) {
  int number = 7;
  for (const char* text : {"", "1x", " 1", "1.5", "99999999999"}) {
    EXPECT_FALSE(parse_whole(text, number)) << text;
    EXPECT_EQ(number, 7) << text;
  }
  EXPECT_TRUE(parse_whole("-12", number));
  EXPECT_EQ(number, -12);
}

TEST(Text, NearestNameIsFoundUnlessTooFar) {
  const std::vector<std::string> names{"wave", "throw", "pingpong"};
  EXPECT_EQ(nearest_name("wav", names), "wave");
  EXPECT_EQ(nearest_name("trhow", names), "throw");
  EXPECT_EQ(nearest_name("elephant", names), "");
}

struct SomeOptions {
  int count = 3;
  double rate_hz = 15;
  std::string kind = "a";
  std::string output;
};

OptionSet describe(SomeOptions& o) {
  OptionSet set;
  set.integer("count", o.count, "number of samples", 1, 10);
  set.number("rate-hz", o.rate_hz, "sampling rate [Hz]", 0.1, 100);
  set.choice("kind", o.kind, "kind of sample", {"a", "b"});
  set.path("output", o.output, "output file");
  return set;
}

void expect_usage_error(SomeOptions options) {
  try {
    describe(options).validate();
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::usage);
    EXPECT_FALSE(error.hint().empty());
  }
}

TEST(Options, InvalidValuesAreUsageErrors) {
  SomeOptions good{3, 15, "a", "x"};
  const OptionSet set = describe(good);
  EXPECT_NO_THROW(set.validate());
  EXPECT_EQ(set.values().dump(), R"({"count":3,"kind":"a","output":"x","rate_hz":15.0})");
  expect_usage_error({0, 15, "a", "x"});
  expect_usage_error({3, std::numeric_limits<double>::quiet_NaN(), "a", "x"});
  expect_usage_error({3, 15, "c", "x"});
  expect_usage_error({3, 15, "a", ""});
}

TEST(Options, AllInvalidValuesAreReported) {
  SomeOptions invalid{0, 15, "c", ""};
  EXPECT_EQ(testing::expect_error([&] { describe(invalid).validate(); }, "; correct all of them",
                                  ExitCode::usage),
            "3 faults\n  --count must be from 1 to 10, not 0\n"
            "  --kind cannot be 'c'; did you mean 'a'?\n  missing --output");
}

TEST(Options, ListsOfNumbersHaveTheirLength) {
  std::vector<double> gravity;
  OptionSet set;
  set.numbers("gravity", gravity, "gravity [m/s^2]", 3, -100.0, 100.0);
  EXPECT_NO_THROW(set.validate());
  EXPECT_EQ(set.values().dump(), R"({"gravity":[]})");
  gravity = {0.0, 9.81, 0.0};
  EXPECT_NO_THROW(set.validate());
  EXPECT_EQ(set.values().dump(), R"({"gravity":[0.0,9.81,0.0]})");
  gravity = {0.0, 9.81};
  EXPECT_THROW(set.validate(), Error);
  gravity = {0.0, 981.0, 0.0};
  EXPECT_THROW(set.validate(), Error);
}

TEST(Figures, NaNNeverPasses) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(at_most("x", nan, "", 1).passes());
  EXPECT_FALSE(reported("x", nan, "").passes());
  EXPECT_TRUE(within("x", 1.0, "", 0.9, 1.1).passes());
  EXPECT_FALSE(at_least("x", 1.0, "", 2.0).passes());
}

class Files : public ::testing::Test {
 protected:
  Files() : folder_(testing::scratch_folder()) { fs::remove_all(folder_); }
  ~Files() override { fs::remove_all(folder_); }
  std::size_t entries() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), {}));
  }
  fs::path folder_;
};

TEST_F(Files, OutputIsWrittenAtomically) {
  {
    OutputFile output(folder_ / "a", false);
    std::ofstream(output.temporary()) << "half";
  }
  EXPECT_FALSE(fs::exists(folder_));  // created for the output, removed without commit()
  write_file(folder_ / "a", "whole", false);
  EXPECT_EQ(read_file(folder_ / "a"), "whole");
  EXPECT_EQ(entries(), 1u);
}

TEST_F(Files, TemporaryFilesOfKilledProcessesAreRemoved) {
  write_file(folder_ / "a", "first", false);
  const pid_t child = fork();
  if (child == 0) {
    OutputFile output(folder_ / "a", true);
    std::ofstream(output.temporary()) << "half";
    kill(getpid(), SIGKILL);
  }
  waitpid(child, nullptr, 0);
  EXPECT_EQ(entries(), 2u);
  EXPECT_EQ(read_file(folder_ / "a"), "first");
  OutputFile other(folder_ / "a", true);
  std::ofstream(other.temporary()) << "of a running process";
  write_file(folder_ / "b", "whole", false);
  EXPECT_EQ(entries(), 3u) << "a, b and the temporary file";
}

TEST_F(Files, ExistingOutputIsOnlyReplacedWithOverwrite) {
  write_file(folder_ / "a", "first", false);
  EXPECT_THROW(write_file(folder_ / "a", "second", false), Error);
  EXPECT_EQ(read_file(folder_ / "a"), "first");
  write_file(folder_ / "a", "second", true);
  EXPECT_EQ(read_file(folder_ / "a"), "second");
}

TEST_F(Files, Sha256MatchesKnownAnswer) {
  write_file(folder_ / "abc", "abc", false);
  EXPECT_EQ(sha256_of_file(folder_ / "abc"),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

/// HDF5's files would stay locked while a child runs. The child runs this test, too, and lists its
/// files.
TEST_F(Files, ChildProcessesInheritNone) {
  constexpr const char* is_child = "TOUCHTRACE_TEST_CHILD";
  if (std::getenv(is_child)) {
    for (const auto& entry : fs::directory_iterator("/proc/self/fd")) {
      std::error_code closed;
      std::cout << "file: " << fs::read_symlink(entry.path(), closed).string() << "\n";
    }
    return;
  }
  write_file(folder_ / "inherited", "", false);
  const int file = open((folder_ / "inherited").c_str(), O_RDONLY);  // not O_CLOEXEC, as in HDF5
  ASSERT_GE(file, 0);
  const auto child =
      run_self({"--gtest_filter=Files.ChildProcessesInheritNone"}, {{is_child, "1"}}, 60.0);
  close(file);
  EXPECT_EQ(child.exit_code, 0);
  EXPECT_NE(child.output.find("file: "), std::string::npos) << child.output;
  EXPECT_EQ(child.output.find("inherited"), std::string::npos) << child.output;
}

TEST(ProvenanceJson, RoundTripsAndFindsInputsByFileName) {
  Provenance made = start_provenance("touchtrace/test/1", "test");
  made.inputs.push_back({"/data/wave.h5", "0123"});
  made.options = {{"count", 3}};
  const Provenance read = nlohmann::json(made).get<Provenance>();
  EXPECT_EQ(nlohmann::json(read), nlohmann::json(made));
  EXPECT_EQ(read.input_hash("elsewhere/wave.h5"), "0123");
  EXPECT_EQ(read.input_hash("throw.h5"), "");
  nlohmann::json older = made;
  older["verb"] = older.at("command");
  older.erase("command");
  EXPECT_EQ(older.get<Provenance>().command, "test");
}

TEST(JsonNumber, NumbersThatDoNotFitAreRefused) {
  using nlohmann::json;
  EXPECT_EQ(whole_number(json(-3), "n", -5, 5), -3);
  EXPECT_EQ(whole_number(json(4.0), "n", -5, 5), 4);
  for (const char* text : {"6", "0.5", "1e50", "-1e400", "18446744073709551615", "null", "\"1\""})
    EXPECT_THROW(whole_number(json::parse(text, nullptr, false), "n", -5, 5), Error) << text;
}

}  // namespace
}  // namespace touchtrace
