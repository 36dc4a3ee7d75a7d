#include "engine/base/fault_list.h"

#include <fmt/core.h>

#include <utility>

#include "engine/base/error.h"

namespace touchtrace {

void FaultList::add(std::string fault, std::string hint) {
  faults_.push_back({std::move(fault), std::move(hint)});
}

void FaultList::throw_if_any(const std::string& source, const std::string& hint_for_all) const {
  if (faults_.empty()) return;
  const std::string prefix = source.empty() ? "" : source + ": ";
  if (faults_.size() == 1) throw usage_error(prefix + faults_[0].text, faults_[0].hint);
  std::string list = fmt::format("{}{} faults", prefix, faults_.size());
  for (const Fault& fault : faults_) list += "\n  " + fault.text;
  throw usage_error(list, hint_for_all);
}

}  // namespace touchtrace
