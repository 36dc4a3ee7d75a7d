#pragma once

#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/text.h"

namespace touchtrace {

/// The row of a table whose `name` that is. Throws usage_error with the known names.
template <class Row>
const Row& find_named(const std::vector<Row>& rows, const char* kind, const std::string& name) {
  std::vector<std::string> names;
  for (const Row& row : rows) {
    if (row.name == name) return row;
    names.push_back(row.name);
  }
  throw usage_error("there is no " + std::string(kind) + " '" + name + "'",
                    suggestion(name, names));
}

}  // namespace touchtrace
