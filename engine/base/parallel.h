#pragma once

#include <cstddef>
#include <functional>

namespace touchtrace {

/// One a core for 0.
std::size_t thread_count(int threads);

/// Calls work(0) .. work(count - 1) on `threads` threads (0: one a core), each index once, begun in
/// this order. The first exception ends the rest and is thrown again here.
void for_each_index(std::size_t count, int threads, const std::function<void(std::size_t)>& work);

}  // namespace touchtrace
