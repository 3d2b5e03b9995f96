// What a thread does while it looks again and again whether another is done.
#pragma once

namespace dalembert::detail {

// Leaves the core to its other thread for some tens of cycles.
static inline void pause() {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  __asm__ volatile("yield");
#endif
}

}  // namespace dalembert::detail
