#include <gtest/gtest.h>

#include "engine/base/error.h"
#include "engine/base/files.h"
#include "engine/base/progress.h"
#include "pipeline/acquire/import/formats/zip_file.h"
#include "tests/fuzz/fuzz_targets.h"

namespace touchtrace {
namespace {

/// Inputs of tests/data/fuzz, with which fuzzing begins.
TEST(FuzzCorpus, IsParsedWithoutACrash) {
  Progress::silence();
  for (const FuzzTarget& target : fuzz_targets()) {
    const std::string archive = read_file(std::filesystem::path(TOUCHTRACE_SOURCE_DIR) /
                                          "tests/data/fuzz" / (target.name + ".zip"));
    const auto entries = zip_entries(archive);
    EXPECT_GT(entries.size(), 0u) << target.name;
    for (const ZipEntry& entry : entries)
      EXPECT_NO_THROW(run_fuzz_target(target, bytes_of(zip_content(archive, entry))))
          << target.name << " " << entry.name;
  }
}

/// Targets detect invalid results: a parser that throws anything but Error, or Error of a bug.
TEST(FuzzTarget, FailsForOtherExceptions) {
  const auto run = [](auto parse) { run_fuzz_target({"test", "", parse}, {}); };
  EXPECT_NO_THROW(run([](auto&, ByteSpan) { throw data_error("invalid", ""); }));
  EXPECT_THROW(run([](auto&, ByteSpan) { throw failure("bug", ""); }), std::logic_error);
  EXPECT_THROW(run([](auto&, ByteSpan) { throw std::length_error("bug"); }), std::length_error);
}

}  // namespace
}  // namespace touchtrace
