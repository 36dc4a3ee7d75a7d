#include "engine/train/safetensors.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "engine/base/error.h"
#include "engine/base/files.h"
#include "engine/base/scratch_folder.h"
#include "tests/support/expect_error.h"

namespace touchtrace {
namespace {

class Safetensors : public ::testing::Test {
 protected:
  std::filesystem::path path() const { return folder_.path() / "file.safetensors"; }

  /// Writes a header, its length (or `length`) and data, and reads the file.
  TensorFile read_back(const std::string& header, const std::string& data,
                       std::uint64_t length = 0) {
    const std::uint64_t size = length ? length : header.size();
    std::string bytes(sizeof size, '\0');
    std::memcpy(bytes.data(), &size, sizeof size);
    write_file(path(), bytes + header + data, true);
    return read_safetensors(path());
  }

  void expect_rejected(const std::string& header, const std::string& data,
                       std::uint64_t length = 0) {
    SCOPED_TRACE(header.substr(0, 200));
    testing::expect_error([&] { read_back(header, data, length); }, "file.safetensors");
  }

  ScratchFolder folder_;
};

const std::string four(4, '\1'), eight(8, '\1');

TEST_F(Safetensors, RoundTrips) {
  const TensorFile file{
      {{"spec", R"({"touch":true})"}},
      {{"b", {2, 3}, {1, 2, 3, 4, 5, 6}}, {"a", {}, {-0.5f}}, {"none", {0, 4}, {}}}};
  write_safetensors(path(), file, false);
  const auto read = read_safetensors(path());
  EXPECT_EQ(read.metadata, file.metadata);
  ASSERT_EQ(read.tensors.size(), 3u);
  EXPECT_EQ(read.at("b", 6).values, file.tensors[0].values);
  EXPECT_EQ(read.at("b", 6).shape, file.tensors[0].shape);
  EXPECT_EQ(read.at("a", 1).values, file.tensors[1].values);
  EXPECT_THROW(read.at("b", 5), Error);
  EXPECT_THROW(read.at("c", 1), Error);
  EXPECT_THROW(write_safetensors(path(), file, false), Error) << "an existing file was overwritten";
}

TEST_F(Safetensors, IsReadableByPlainPython) {
  write_safetensors(path(), {{{"note", "x"}}, {{"w", {2, 2}, {1, 2, 3, 4.5f}}, {"v", {1}, {7}}}},
                    false);
  const std::string script =
      "import json,struct,sys;b=open(sys.argv[1],'rb').read();n,=struct.unpack('<Q',b[:8]);"
      "h=json.loads(b[8:8+n]);d=b[8+n:];assert n%8==0;assert "
      "h.pop('__metadata__').keys()=={'checksum','note'};"
      "t={k:struct.unpack('<%df'%((r['data_offsets'][1]-r['data_offsets'][0])//4),"
      "d[r['data_offsets'][0]:r['data_offsets'][1]]) for k,r in h.items()};"
      "assert t=={'w':(1,2,3,4.5),'v':(7,)},t;assert h['w']['shape']==[2,2];"
      "assert h['w']['dtype']=='F32'";
  EXPECT_EQ(std::system(("/usr/bin/python3 -c \"" + script + "\" " + path().string()).c_str()), 0);
}

TEST_F(Safetensors, IsReadableByPythonPackage) {
  if (std::system("python3 -c 'import safetensors, numpy' 2>/dev/null") != 0)
    GTEST_SKIP() << "Python package safetensors not installed";
  write_safetensors(path(), {{{"note", "x"}}, {{"w", {2, 2}, {1, 2, 3, 4.5f}}, {"v", {1}, {7}}}},
                    false);
  const std::string script =
      "import sys;from safetensors import safe_open;f=safe_open(sys.argv[1],'numpy');"
      "m=f.metadata();assert m.keys()=={'note','checksum'} and m['note']=='x';"
      "assert f.get_tensor('w').tolist()==[[1,2],[3,4.5]];"
      "assert f.get_tensor('v').tolist()==[7]";
  EXPECT_EQ(std::system(("python3 -c \"" + script + "\" " + path().string()).c_str()), 0);
}

TEST_F(Safetensors, AcceptsPaddedHeadersAndAnyOrder) {
  const auto file = read_back(R"({"b":{"dtype":"F32","shape":[1],"data_offsets":[4,8]},)"
                              R"("a":{"dtype":"F32","shape":[1],"data_offsets":[0,4]}}   )",
                              eight);
  EXPECT_EQ(file.tensors.front().name, "a");
}

TEST_F(Safetensors, RejectsIncompleteFiles) {
  const std::string header = R"({"a":{"dtype":"F32","shape":[2],"data_offsets":[0,8]}})";
  EXPECT_NO_THROW(read_back(header, eight));
  expect_rejected(header, four);
  expect_rejected(header, eight + four);
  expect_rejected(header, eight, header.size() + 100);
  expect_rejected(header, eight, ~std::uint64_t{0});
  expect_rejected(header, eight, std::uint64_t{1} << 40);
  expect_rejected(header.substr(0, 20), "");
  expect_rejected("", "");
  expect_rejected("[1]", "");
  write_file(path(), "abc", true);
  EXPECT_THROW(read_safetensors(path()), Error);
}

TEST_F(Safetensors, RejectsEveryTruncation) {
  write_safetensors(path(), {{{"k", "v"}}, {{"w", {3}, {1, 2, 3}}, {"x", {1}, {4}}}}, false);
  const auto whole = read_file(path());
  for (std::size_t size = 0; size < whole.size(); ++size) {
    write_file(path(), whole.substr(0, size), true);
    EXPECT_THROW(read_safetensors(path()), Error) << size << " bytes of " << whole.size();
  }
}

TEST_F(Safetensors, RejectsEveryFlippedBit) {
  write_safetensors(path(), {{{"k", "v"}}, {{"w", {3}, {1, 2, 3}}}}, false);
  auto bytes = read_file(path());
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    bytes[bit / 8] ^= static_cast<char>(1 << bit % 8);
    write_file(path(), bytes, true);
    bytes[bit / 8] ^= static_cast<char>(1 << bit % 8);
    EXPECT_THROW(read_safetensors(path()), Error) << bit;
  }
}

/// The checksum is the SHA-256 of the file with zeros in its place.
TEST_F(Safetensors, ChecksumIsThatOfPython) {
  write_safetensors(path(), {{}, {{"w", {1}, {1}}}}, false);
  const std::string script =
      "import hashlib,re,sys;b=open(sys.argv[1],'rb').read();"
      "p=rb'(sha256-with-zeros-here:)([0-9a-f]{64})';d=re.search(p,b)[2].decode();"
      "assert hashlib.sha256(re.sub(p,rb'\\g<1>'+b'0'*64,b)).hexdigest()==d";
  EXPECT_EQ(std::system(("/usr/bin/python3 -c \"" + script + "\" " + path().string()).c_str()), 0);
}

TEST_F(Safetensors, RejectsOverlapsGapsAndInvalidEntries) {
  const auto two = [](const std::string& first, const std::string& second) {
    return R"({"a":{"dtype":"F32","shape":[1],"data_offsets":)" + first +
           R"(},"b":{"dtype":"F32","shape":[1],"data_offsets":)" + second + "}}";
  };
  EXPECT_NO_THROW(read_back(two("[0,4]", "[4,8]"), eight));
  for (const std::string bad :
       {"[0,4]", "[2,6]", "[5,9]", "[8,4]", "[-4,0]", "[4]", "[4,8,9]", "[4.0,8.0]", "\"x\"",
        "[18446744073709551612,18446744073709551616]"})
    expect_rejected(two("[0,4]", bad), eight);
}

TEST_F(Safetensors, RejectsInvalidShapesTypesAndKeys) {
  const auto one = [](const std::string& dtype, const std::string& shape) {
    return R"({"a":{"dtype":)" + dtype + R"(,"shape":)" + shape + R"(,"data_offsets":[0,8]}})";
  };
  EXPECT_NO_THROW(read_back(one(R"("F32")", "[2]"), eight));
  for (const std::string shape : {"[3]", "[-2]", "[2.0]", "2", "[[2]]", "[4294967296,4294967296]",
                                  "[9223372036854775809,2]", "null"})
    expect_rejected(one(R"("F32")", shape), eight);
  for (const std::string dtype : {R"("F64")", R"("I32")", "7"})
    expect_rejected(one(dtype, "[2]"), eight);
  expect_rejected(R"({"a":{"shape":[2],"data_offsets":[0,8]}})", eight);
  expect_rejected(R"({"a":7})", "");
  expect_rejected(R"({"__metadata__":{"k":7}})", "");
  expect_rejected(R"({"a":{"dtype":"F32","shape":[1],"data_offsets":[0,4]},)"
                  R"("a":{"dtype":"F32","shape":[1],"data_offsets":[4,8]}})",
                  eight);
  expect_rejected(R"({"a":{"dtype":"F32","shape":[2],"shape":[2],"data_offsets":[0,8]}})", eight);
  expect_rejected("{\"a\":" + std::string(100'000, '['), "");
}

}  // namespace
}  // namespace touchtrace
