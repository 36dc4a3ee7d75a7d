#pragma once

#include <cstddef>
#include <functional>

namespace touchtrace {

/// `threads`, or the number of cores if it is 0.
std::size_t thread_count(int threads);

/// Calls work(0) .. work(count - 1), each once, on `threads` threads (0: one per core). Calls start
/// in ascending order. The first exception cancels the calls that have not started and is rethrown.
void parallel_for(std::size_t count, int threads, const std::function<void(std::size_t)>& work);

}  // namespace touchtrace
