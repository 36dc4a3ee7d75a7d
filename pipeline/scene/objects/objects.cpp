#include <fmt/core.h>

#include <algorithm>

#include "engine/base/error.h"
#include "engine/base/text.h"
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
  std::vector<std::string> names;
  for (const ObjectSpec& object : objects()) {
    if (object.name == name) return object;
    names.push_back(object.name);
  }
  throw usage_error(fmt::format("there is no object '{}'", name), suggestion(name, names));
}

}  // namespace touchtrace::scene
