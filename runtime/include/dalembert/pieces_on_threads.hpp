// Work on many things, handed out some at a time to the threads of the calling thread's arena of oneTBB, which allocate.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cstddef>

#include "happens_before.hpp"

namespace dalembert {

// work(first, how many) for `count` things, `together` or more at a time, by many threads at once. Returns when all is done.
// While it waits, the calling thread takes no other task of oneTBB's, which might work on the same things.
template <class Work>
void pieces_on_threads(std::size_t count, std::size_t together, const Work& work) {
  const std::size_t pieces = (count + together - 1) / together;
  char begun, done;  // for the thread sanitizer
  detail::happens_before(&begun);
  tbb::this_task_arena::isolate([&] {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, pieces), [&](const tbb::blocked_range<std::size_t>& some) {
      detail::happens_after(&begun);
      const std::size_t first = some.begin() * together, end = std::min(count, some.end() * together);
      work(first, end - first);
      detail::happens_before(&done);
    });
  });
  detail::happens_after(&done);
}

}  // namespace dalembert
