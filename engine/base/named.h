#pragma once

#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/text.h"

namespace touchtrace {

/// Row of a table by its `name`. `kind`: what the rows are, for the message. Throws usage_error
/// with a suggestion for an unknown name.
template <class Row>
const Row& find_named(const std::vector<Row>& rows, const char* kind, const std::string& name) {
  std::vector<std::string> names;
  for (const Row& row : rows) {
    if (row.name == name) return row;
    names.push_back(row.name);
  }
  throw usage_error("unknown " + std::string(kind) + " '" + name + "'", suggestion(name, names));
}

}  // namespace touchtrace
