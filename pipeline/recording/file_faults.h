#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace touchtrace {

/// Faults found in one file, in the order of discovery. Each object of the file (group, dataset or
/// attribute) has at most one, so that consequences of a fault are not reported again.
class FileFaults {
 public:
  /// Records a fault of the object at `path`, such as "/glove0/counts". Ignored if that object
  /// already has one.
  void add(const std::string& path, const std::string& fault);
  void require(bool condition, const std::string& path, const std::string& fault) {
    if (!condition) add(path, fault);
  }
  /// True if the object at `path`, or one below it, has a fault.
  bool contains(const std::string& path) const;
  bool empty() const { return faults_.empty(); }
  /// Throws data_error with the file's name and its faults (20 at most), if there is any.
  void throw_if_any(const std::filesystem::path& file) const;

 private:
  struct Fault {
    std::string path, text;
  };
  std::vector<Fault> faults_;
};

/// Name of an attribute of the object at `path`, for FileFaults.
std::string attribute_path(const std::string& path, const std::string& name);

}  // namespace touchtrace
