#include "engine/train/safetensors.h"

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>

#include "engine/base/checksum.h"
#include "engine/base/error.h"
#include "engine/base/files.h"
#include "engine/base/integer_math.h"

namespace touchtrace {
namespace {

static_assert(std::endian::native == std::endian::little, "safetensors is little endian");

constexpr std::size_t length_bytes = 8, max_header_bytes = 100'000'000, max_tensors = 10'000;
constexpr int max_depth = 4;
constexpr const char* metadata_key = "__metadata__";

[[noreturn]] void reject(const std::string& problem) {
  throw data_error(problem, "use a file that touchtrace train wrote, or write it again");
}

/// Parses the header, rejecting duplicate keys and deep nesting, which nlohmann::json accepts.
nlohmann::json parse_header(std::string_view text) {
  std::vector<std::set<std::string>> keys;
  const auto watch = [&](int depth, nlohmann::json::parse_event_t event, nlohmann::json& value) {
    using Event = nlohmann::json::parse_event_t;
    if (depth > max_depth) reject("header is nested too deeply");
    if (event == Event::object_start) keys.emplace_back();
    if (event == Event::object_end) keys.pop_back();
    if (event == Event::key && !keys.back().insert(value.get<std::string>()).second)
      reject(fmt::format("duplicate key {} in the header", value.dump()));
    return true;
  };
  if (text.empty() || text.front() != '{') reject("header does not start with '{'");
  try {
    return nlohmann::json::parse(text, watch);
  } catch (const nlohmann::json::exception&) {
    reject("header is not valid JSON");
  }
}

/// Number of values of a shape. Rejects what exceeds `limit`.
std::size_t value_count(const std::vector<std::size_t>& shape, std::size_t limit) {
  std::size_t count = 1;
  for (const std::size_t extent : shape) {
    if (extent != 0 && count > limit / extent) reject("a shape exceeds the size of the file");
    count *= extent;
  }
  return count;
}

struct Range {
  std::size_t begin, end;
};

/// Entry of the header, without values, and the range of these.
std::pair<Tensor, Range> parse_row(const std::string& name, const nlohmann::json& row,
                                   std::size_t data_bytes) {
  if (row.at("dtype") != "F32") reject(fmt::format("tensor '{}' does not have dtype F32", name));
  const auto sizes = [&](const char* key) {
    for (const auto& number : row.at(key))
      if (!number.is_number_unsigned())
        reject(fmt::format("tensor '{}' has an invalid {}", name, key));
    return row.at(key).get<std::vector<std::size_t>>();
  };
  Tensor tensor{name, sizes("shape"), {}};
  const auto offsets = sizes("data_offsets");
  if (offsets.size() != 2 || offsets[0] > offsets[1] || offsets[1] > data_bytes)
    reject(fmt::format("tensor '{}' is outside the file", name));
  const std::size_t count = value_count(tensor.shape, data_bytes / sizeof(float));
  if (count * sizeof(float) != offsets[1] - offsets[0])
    reject(fmt::format("shape of tensor '{}' does not match its offsets", name));
  return {std::move(tensor), {offsets[0], offsets[1]}};
}

void read_values(std::vector<std::pair<Tensor, Range>>& rows, std::string_view data) {
  std::ranges::sort(rows, {},
                    [](const auto& row) { return std::pair(row.second.begin, row.second.end); });
  std::size_t end = 0;
  for (auto& [tensor, range] : rows) {
    if (range.begin != end)
      reject(fmt::format("tensor '{}' overlaps another or leaves a gap", tensor.name));
    end = range.end;
    tensor.values.resize((range.end - range.begin) / sizeof(float));
    if (!tensor.values.empty())
      std::memcpy(tensor.values.data(), data.data() + range.begin, range.end - range.begin);
  }
  if (end != data.size()) reject("the file has bytes that belong to no tensor");
}

TensorFile parse(std::string_view bytes) {
  std::uint64_t header_bytes = 0;
  if (bytes.size() < length_bytes) reject("file is too short");
  if (bytes.starts_with("\x89HDF")) reject("it is an HDF5 file, such as a recording or labels");
  std::memcpy(&header_bytes, bytes.data(), length_bytes);
  if (header_bytes > std::min(bytes.size() - length_bytes, max_header_bytes))
    reject("header exceeds the file");
  const auto header = parse_header(bytes.substr(length_bytes, header_bytes));
  const auto data = bytes.substr(length_bytes + header_bytes);
  verify_checksum(bytes, bytes.substr(0, length_bytes + header_bytes));
  if (header.size() > max_tensors) reject("too many tensors");
  TensorFile file;
  std::vector<std::pair<Tensor, Range>> rows;
  for (const auto& [name, row] : header.items()) {
    if (name == metadata_key)
      row.get_to(file.metadata);
    else
      rows.push_back(parse_row(name, row, data.size()));
  }
  file.metadata.erase(checksum_key);
  read_values(rows, data);
  for (auto& row : rows) file.tensors.push_back(std::move(row.first));
  return file;
}

}  // namespace

const Tensor& TensorFile::at(const std::string& name, std::size_t size) const {
  const auto found = std::ranges::find(tensors, name, &Tensor::name);
  const auto prefix = path.empty() ? std::string() : path.string() + ": ";
  if (found == tensors.end()) reject(fmt::format("{}no tensor '{}'", prefix, name));
  if (found->values.size() != size)
    reject(fmt::format("{}tensor '{}' has {} values; expected {}", prefix, name,
                       found->values.size(), size));
  return *found;
}

void write_safetensors(const std::filesystem::path& path, const TensorFile& file, bool overwrite) {
  nlohmann::ordered_json header;
  header[metadata_key] = file.metadata;
  header[metadata_key][checksum_key] = empty_checksum();
  std::string data;
  for (const auto& tensor : file.tensors) {
    const std::size_t begin = data.size();
    data.append(reinterpret_cast<const char*>(tensor.values.data()),
                tensor.values.size() * sizeof(float));
    header[tensor.name] = {
        {"dtype", "F32"}, {"shape", tensor.shape}, {"data_offsets", {begin, data.size()}}};
  }
  std::string text = header.dump();
  text.resize(round_up(text.size(), length_bytes), ' ');
  const std::uint64_t header_bytes = text.size();
  const std::string length(reinterpret_cast<const char*>(&header_bytes), length_bytes);
  write_file(path, with_checksum(length + text + data), overwrite);
}

TensorFile read_safetensors(const std::filesystem::path& path) {
  const std::string bytes = read_file(path);
  try {
    auto file = parse(bytes);
    file.path = path;
    return file;
  } catch (const nlohmann::json::exception&) {
    throw data_error(path.string() + ": header is not that of a safetensors file",
                     "use a file that touchtrace train wrote, or write it again");
  } catch (const Error& error) {
    throw data_error(fmt::format("{}: {}", path.string(), error.what()), error.hint());
  }
}

}  // namespace touchtrace
