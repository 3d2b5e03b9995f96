// Counts what this program asks of the heap, in any thread and by any road: malloc and its kin, operator new.
#pragma once

#include <cstdint>

namespace dalembert::testing {

// Allocations since the program started.
std::uint64_t heap_allocations();

}  // namespace dalembert::testing
