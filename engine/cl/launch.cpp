#include "engine/cl/launch.h"

namespace touchtrace {

std::string name_of(Purpose purpose) {
  switch (purpose) {
    case Purpose::data_movement:
      return "data movement";
    case Purpose::forward:
      return "forward";
    case Purpose::rollout:
      return "roll-out";
    case Purpose::loss:
      return "loss";
    case Purpose::data_gradient:
      return "data gradient";
    case Purpose::weight_gradient:
      return "weight gradient";
    case Purpose::optimiser:
      return "optimiser";
  }
  return {};
}

void Launch::enqueue(Runtime& runtime) const {
  if (!created_()) {
    created_ = runtime.create(kernel_);
    for (cl_uint i = 0; i < arguments_.size(); ++i) set_created(i);
  }
  if (local_)
    runtime.launch(created_, global_, *local_);
  else
    runtime.launch(created_, global_);
  if (runtime.launch_observer()) runtime.launch_observer()(*this);
}

Launch Launch::with_local_size(std::size_t local_size) && {
  const std::size_t* groups = global_.get();
  if (global_.dimensions() == 1) {
    global_ = {groups[0] * local_size}, local_ = cl::NDRange(local_size);
  } else if (global_.dimensions() == 2) {
    global_ = {groups[0] * local_size, groups[1]}, local_ = cl::NDRange(local_size, 1);
  } else {
    global_ = {groups[0] * local_size, groups[1], groups[2]};
    local_ = cl::NDRange(local_size, 1, 1);
  }
  return std::move(*this);
}

void Launch::set_created(cl_uint index) const {
  std::visit([&](const auto& value) { created_.setArg(index, value); }, arguments_[index]);
}

std::map<cl_uint, cl::Buffer> Launch::buffers() const {
  std::map<cl_uint, cl::Buffer> found;
  for (cl_uint i = 0; i < arguments_.size(); ++i)
    if (const auto* buffer = std::get_if<cl::Buffer>(&arguments_[i])) found[i] = *buffer;
  return found;
}

double Launch::buffer_bytes() const {
  std::map<cl_mem, double> bytes;
  for (const auto& [index, buffer] : buffers())
    if (buffer()) bytes[buffer()] = static_cast<double>(buffer.getInfo<CL_MEM_SIZE>());
  double sum = 0.0;
  for (const auto& [handle, size] : bytes) sum += size;
  return sum;
}

}  // namespace touchtrace
