// Counts the program's heap allocations, those of all libraries included, by standing in front of glibc's malloc.
#pragma once

namespace controller {

// Allocations since the program started; always 0 when built with a sanitizer, which needs malloc for itself.
long heap_allocations() noexcept;

}  // namespace controller
