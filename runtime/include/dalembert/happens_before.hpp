// Tells ThreadSanitizer what oneTBB orders. The library is not compiled for it, so that every hand-over from one task to the
// next would be reported as a race. Nothing at all in other builds.
#pragma once

// GCC's name for it first: __has_feature is Clang's, but where GCC has none Eigen defines one that always says no.
#if defined(__SANITIZE_THREAD__)
#define DALEMBERT_THREAD_SANITIZER
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define DALEMBERT_THREAD_SANITIZER
#endif
#endif

#ifdef DALEMBERT_THREAD_SANITIZER
#include <sanitizer/tsan_interface.h>
#endif

namespace dalembert::detail {

// What this thread did before happens_before(event) comes before what another does after happens_after(event).
static inline void happens_before([[maybe_unused]] void* event) {
#ifdef DALEMBERT_THREAD_SANITIZER
  __tsan_release(event);
#endif
}
static inline void happens_after([[maybe_unused]] void* event) {
#ifdef DALEMBERT_THREAD_SANITIZER
  __tsan_acquire(event);
#endif
}

}  // namespace dalembert::detail
#undef DALEMBERT_THREAD_SANITIZER
