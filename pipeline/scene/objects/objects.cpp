#include <algorithm>

#include "engine/base/named.h"
#include "pipeline/scene/objects/object_file.h"
#include "pipeline/scene/objects/object_texts.h"

namespace touchtrace::scene {

std::string role_name(ObjectRole role) {
  switch (role) {
    case ObjectRole::seen:
      return "seen";
    case ObjectRole::unseen:
      return "unseen";
    case ObjectRole::outside:
      return "outside";
    case ObjectRole::tool:
      break;
  }
  return "tool";
}

const std::vector<ObjectSpec>& objects() {
  static const std::vector<ObjectSpec> table = [] {
    std::vector<ObjectSpec> all;
    for (const auto& [file, text] : object_texts())
      all.push_back(parse_object(std::filesystem::path(file).stem(), std::string(text), file));
    std::ranges::stable_sort(all, {}, &ObjectSpec::role);
    return all;
  }();
  return table;
}

const ObjectSpec& find_object(const std::string& name) {
  return find_named(objects(), "object", name);
}

}  // namespace touchtrace::scene
