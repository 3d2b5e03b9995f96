// SIMD lanes: a few scalars that are computed on side by side.
//
// Lanes<T, n> is the compiler's own vector type (GCC and Clang), so the arithmetic operators are the language's and (but for
// two instructions of AVX-512 that no compiler finds by itself) no vendor's intrinsics are needed: where the target's registers
// are narrower the compiler splits the lanes, where there are none it computes one by one. Lanes<T, 1> is T itself. Loads and
// stores need no alignment.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <type_traits>
#include <utility>

#if defined(__AVX512VL__)
#include <immintrin.h>
#endif

#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wpsabi"  // lanes never cross a call: everything here is inlined
#endif

#define DALEMBERT_ALWAYS __attribute__((always_inline))
#define DALEMBERT_INLINE inline DALEMBERT_ALWAYS

// Blocks are large functions, made of many small ones, that lanes do not enter or leave by value. Optimised code has them
// inlined, since their sizes are constants; elsewhere that would take a debug build minutes and a sanitized one hours. They
// have internal linkage: files that are compiled for different targets must not share one.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define DALEMBERT_SANITIZED 1
#elif defined(__has_feature)
#define DALEMBERT_SANITIZED \
  (__has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __has_feature(undefined_behavior_sanitizer))
#else
#define DALEMBERT_SANITIZED 0
#endif
#if defined(__OPTIMIZE__) && !DALEMBERT_SANITIZED
#define DALEMBERT_IN_BLOCK DALEMBERT_ALWAYS  // of a block's lambdas
#else
#define DALEMBERT_IN_BLOCK
#endif
#define DALEMBERT_BLOCK static inline DALEMBERT_IN_BLOCK

// Before a loop that is to stay one.
#if defined(__clang__)
#define DALEMBERT_KEEP_LOOP _Pragma("clang loop unroll(disable)")
#else
#define DALEMBERT_KEEP_LOOP _Pragma("GCC unroll 1")
#endif

namespace dalembert {

namespace detail {
template <class T, int n>
struct LanesOf {
  typedef T type __attribute__((vector_size(sizeof(T) * n)));
};
template <class T>
struct LanesOf<T, 1> {
  using type = T;
};
}  // namespace detail

template <class T, int n>
using Lanes = typename detail::LanesOf<T, n>::type;

constexpr int least(int a, int b) { return a < b ? a : b; }

// Doubles a register of the target holds.
#if defined(__AVX512F__)
inline constexpr int doubles_in_register = 8;
#elif defined(__AVX__)
inline constexpr int doubles_in_register = 4;
#elif defined(__SSE2__) || defined(__ARM_NEON)
inline constexpr int doubles_in_register = 2;
#else
inline constexpr int doubles_in_register = 1;
#endif

// The width of loops over bodies. What depends on it is static, or has it for a parameter: of a program with code of two widths
// one would else be taken for the other where it is not inlined.
#if defined(DALEMBERT_LANES)
static_assert(DALEMBERT_LANES == 1 || DALEMBERT_LANES == 2 || DALEMBERT_LANES == 4 || DALEMBERT_LANES == 8,
              "DALEMBERT_LANES is 1, 2, 4 or 8, or is not defined: the target's own registers");
inline constexpr int native_lanes = DALEMBERT_LANES;
#else
inline constexpr int native_lanes = doubles_in_register;
#endif

// The same where no more than four slots are to be written.
inline constexpr int short_lanes = least(native_lanes, 4);

// Lanes that limbs side by side stand in: a power of two.
constexpr int lanes_for(int limbs) {
  int lanes = 1;
  while (lanes < limbs) lanes *= 2;
  return lanes;
}

// Of these, the lanes that are computed together: as many as share a register.
template <class T, int limbs>
inline constexpr int lanes_together = least(lanes_for(limbs),
                                            doubles_in_register* static_cast<int>(sizeof(double) / sizeof(T)));

// Arrays over bodies are padded to this many elements, so that whole lanes can be read and written at their end.
constexpr int padded(int n) { return (n + 7) / 8 * 8; }

// Of an array that is written before it is read, where a compiler does not see that and would warn; costs no instruction.
template <class T, std::size_t n>
DALEMBERT_INLINE void written_before_read([[maybe_unused]] T (&x)[n]) {
#if defined(__GNUC__)
  if constexpr (std::is_arithmetic_v<T>) __asm__("" : "=m"(x));
#endif
}

template <int n, class T>
DALEMBERT_INLINE Lanes<T, n> load(const T* from) {
  Lanes<T, n> x;
  std::memcpy(&x, from, sizeof x);
  return x;
}

template <int n, class T>
DALEMBERT_INLINE void store(T* to, const Lanes<T, n>& x) {
  std::memcpy(to, &x, sizeof x);
}

// Whether the target has an instruction that stores some lanes of a register.
#if defined(__AVX512VL__)
template <class T, int n>
inline constexpr bool stores_some = std::is_same_v<T, double> && (n == 4 || n == 8);
#else
template <class T, int n>
inline constexpr bool stores_some = false;
#endif

// The first `count` lanes only, which the compiler need not know.
template <int n, class T>
DALEMBERT_INLINE void store_some(T* to, const Lanes<T, n>& x, int count) {
#if defined(__AVX512VL__)
  const auto mask = static_cast<__mmask8>((1 << count) - 1);
  if constexpr (stores_some<T, n> && n == 4) return _mm256_mask_storeu_pd(to, mask, x);
  else if constexpr (stores_some<T, n>) return _mm512_mask_storeu_pd(to, mask, x);
#endif
  for (int i = 0; i < count; ++i) to[i] = x[i];
}

// The first `count` lanes only. A power of two has a store of its own, which what reads it soon after need not wait for.
template <int count, int n, class T>
DALEMBERT_INLINE void store_first(T* to, const Lanes<T, n>& x) {
  if constexpr (stores_some<T, n> && (count & (count - 1)) != 0) store_some<n, T>(to, x, count);
  else std::memcpy(to, &x, sizeof(T) * count);
}

// The first `count` lanes only, zeros behind them.
template <int count, int n, class T>
DALEMBERT_INLINE Lanes<T, n> load_first(const T* from) {
#if defined(__AVX512VL__)
  constexpr auto mask = static_cast<__mmask8>((1 << count) - 1);
  if constexpr (stores_some<T, n> && n == 4) return _mm256_maskz_loadu_pd(mask, from);
  else if constexpr (stores_some<T, n>) return _mm512_maskz_loadu_pd(mask, from);
#endif
  Lanes<T, n> x{};
  std::memcpy(&x, from, sizeof(T) * count);
  return x;
}

template <int n, class T>
DALEMBERT_INLINE Lanes<T, n> broadcast(T x) {
  return x - Lanes<T, n>{};  // not a sum: 0 + x is another number than x = -0
}

// One value per lane: f(0), f(1), … Built in registers: writing lanes one by one would go through memory.
template <int n, class T, class F>
DALEMBERT_INLINE Lanes<T, n> each_lane(const F& f) {
  static_assert(n == 1 || n == 2 || n == 4 || n == 8, "lanes come in powers of two up to eight");
  if constexpr (n == 1) {
    return f(0);
  } else if constexpr (n == 2) {
    return Lanes<T, 2>{f(0), f(1)};
  } else if constexpr (n == 4) {
    return Lanes<T, 4>{f(0), f(1), f(2), f(3)};
  } else {
    return Lanes<T, 8>{f(0), f(1), f(2), f(3), f(4), f(5), f(6), f(7)};
  }
}

// One value per lane from anywhere: from[at[0]], from[at[1]], …
template <int n, class T>
DALEMBERT_INLINE Lanes<T, n> gather(const T* from, const int* at) {
  return each_lane<n, T>([=](int i) { return from[at[i]]; });
}

template <int n, class T>
DALEMBERT_INLINE T lane(const Lanes<T, n>& x, int i) {
  if constexpr (n == 1) {
    (void)i;
    return x;
  } else {
    return x[i];
  }
}

// The same lanes but for one, which is y's. No product with zeros and ones: those take the units that multiply.
template <int n, class T, int which>
DALEMBERT_INLINE Lanes<T, n> with_lane_of(const Lanes<T, n>& x, const Lanes<T, n>& y) {
  if constexpr (n == 1) return y;
  else return each_lane<n, T>([](int i) { return T(i); }) == broadcast<n, T>(T(which)) ? y : x;
}

// Chosen lanes of a and b, counted through both: a's first. g++ 11 has no builtin for it and moves lanes one by one.
#if defined(__clang__) || __GNUC__ >= 12
inline constexpr bool shuffles_in_registers = true;
#else
inline constexpr bool shuffles_in_registers = false;
#endif
template <class T, int... at, class V>
DALEMBERT_INLINE Lanes<T, sizeof...(at)> shuffled(const V& a, const V& b) {
#if defined(__clang__) || __GNUC__ >= 12
  return __builtin_shufflevector(a, b, at...);
#else
  constexpr int n = sizeof(V) / sizeof(T);
  return Lanes<T, sizeof...(at)>{(at < n ? a[at % n] : b[at % n])...};
#endif
}

// a, and behind it b; and one half of such lanes, 0 or 1.
namespace detail {
template <class T, class V, int... lane>
DALEMBERT_INLINE auto all_of(const V& a, const V& b, std::integer_sequence<int, lane...>) {
  return shuffled<T, lane...>(a, b);
}
template <class T, class V>
DALEMBERT_INLINE auto joined(const V& a, const V& b) {
  return all_of<T>(a, b, std::make_integer_sequence<int, 2 * sizeof(V) / sizeof(T)>{});
}
template <class T, int begin, class V, int... lane>
DALEMBERT_INLINE auto part_of(const V& x, std::integer_sequence<int, lane...>) {
  return shuffled<T, begin + lane...>(x, x);
}
template <class T, int which, class V>
DALEMBERT_INLINE auto half(const V& x) {
  constexpr int n = sizeof(V) / sizeof(T) / 2;
  return part_of<T, which * n>(x, std::make_integer_sequence<int, n>{});
}
}  // namespace detail

// n numbers, and the same n again.
template <int n, class T>
DALEMBERT_INLINE Lanes<T, 2 * n> load_twice(const T* from) {
#if defined(__AVX512VL__)  // g++ 12 loads, and then shuffles
  // With a mask, of all lanes: what has none reads a register that g++ 12's header never sets, and warns of it in users' code.
  if constexpr (n == 4 && std::is_same_v<T, double>) return _mm512_maskz_broadcast_f64x4(0xff, _mm256_loadu_pd(from));
#endif
  const Lanes<T, n> x = load<n, T>(from);
  return detail::joined<T>(x, x);
}

// Has a value that several operations take stay in its register: g++ reads it again for each, where reading is what bounds.
// Vectors of less than 16 bytes have no register of their own.
template <class T, class V>
DALEMBERT_INLINE void keep_in_register([[maybe_unused]] V& x) {
#if defined(__x86_64__)
  constexpr bool fits = std::is_arithmetic_v<V> || (sizeof(V) >= 16 && sizeof(V) <= 8 * doubles_in_register);
  if constexpr ((std::is_same_v<T, double> || std::is_same_v<T, float>)&&fits) __asm__("" : "+v"(x));
#endif
}

// The value, as if it had been computed. A loop that stores nothing but a table is taken for a memcpy of constants, which g++
// 12.2 expands wrongly for targets with AVX-512: it writes 32 bytes {a, a, 0, 0} as {a, a, a, a}.
template <class V>
DALEMBERT_INLINE V computed(V x) {
  __asm__("" : "+m"(x));
  return x;
}

namespace detail {

// f(0), …, f(count - 1), written out, with constants for arguments: what they index stays in registers.
template <class F, int... i>
DALEMBERT_INLINE void write_out_constants(std::integer_sequence<int, i...>, const F& f) {
  (void)std::initializer_list<int>{0, (f(std::integral_constant<int, i>{}), 0)...};
}
template <int count, class F>
DALEMBERT_INLINE void for_constants(const F& f) {
  write_out_constants(std::make_integer_sequence<int, count>{}, f);
}

}  // namespace detail

// The same for generated code: what short loops look up in tables of constants is known while compiling.
template <int count, class F>
DALEMBERT_INLINE void each_constant(const F& f) {
  detail::for_constants<count>(f);
}

// What a loop hands from step to step, and what it hands on at its end. Written out, not loops: arrays that only constants
// index stay in registers.
namespace detail {

template <class V, int n, int... i>
DALEMBERT_INLINE void carry_each(V (&to)[n], const V (&from)[n], std::integer_sequence<int, i...>) {
  (void)std::initializer_list<int>{(to[i] = from[i], 0)...};
}

template <class T, int width, class V, int n, int... i>
DALEMBERT_INLINE void keep_each(T (&to)[n][width], const V (&from)[n], int first, std::integer_sequence<int, i...>) {
  (void)std::initializer_list<int>{(store<sizeof(V) / sizeof(T), T>(to[i] + first, from[i]), 0)...};
}

template <class T, int n>
DALEMBERT_INLINE T one_of(const Lanes<T, n>& x, int i) {
  return lane<n, T>(x, i);
}
template <class T, int n>
DALEMBERT_INLINE T one_of(const T (&x)[n], int i) {
  return x[i];
}

template <class T, int n, int first, int... more, class V>
DALEMBERT_INLINE T sum_of_lanes(const V& x) {
  T sum = one_of<T, n>(x, first);
  (void)std::initializer_list<int>{0, (sum += one_of<T, n>(x, more), 0)...};
  return sum;
}

template <bool set, class T>
DALEMBERT_INLINE T plus(const T& before, T sum) {
  return set ? sum : before + sum;
}

template <bool set, int n, int... which, int... i, class V, class T>
DALEMBERT_INLINE void hand_on(std::integer_sequence<int, i...>, const V& values, int from, T* to, int stride) {
  (void)std::initializer_list<int>{
      (to[i * stride] = plus<set>(to[i * stride], sum_of_lanes<T, n, which...>(values[from + i])), 0)...};
}

}  // namespace detail

template <class V, int n>
DALEMBERT_INLINE void carry(V (&to)[n], const V (&from)[n]) {
  detail::carry_each(to, from, std::make_integer_sequence<int, n>{});
}

// f(how many, first lane), for limbs that are computed together and then for the next; what is left takes smaller registers.
template <class T, int limbs, class F>
DALEMBERT_BLOCK void each_part(const F& f) {
  constexpr int some = lanes_together<T, limbs>;
  if constexpr (some >= limbs) {
    f(std::integral_constant<int, some>{}, 0);
  } else {
    constexpr int whole = limbs / some * some, left = limbs - whole;
    for (int lane = 0; lane < whole; lane += some) f(std::integral_constant<int, some>{}, lane);
    if constexpr (left > 0) f(std::integral_constant<int, lanes_for(left)>{}, whole);
  }
}

// What all limbs hand on, where not all are computed together.
template <class T, int limbs>
using AllLanes =
    std::conditional_t<lanes_together<T, limbs> == lanes_for(limbs), Lanes<T, lanes_for(limbs)>, T[lanes_for(limbs)]>;

template <class V, int n>
DALEMBERT_INLINE void keep_lanes(V (&to)[n], const V (&from)[n], int) {
  carry(to, from);
}
template <class T, int width, class V, int n>
DALEMBERT_INLINE void keep_lanes(T (&to)[n][width], const V (&from)[n], int first) {
  detail::keep_each(to, from, first, std::make_integer_sequence<int, n>{});
}

// The sum of some lanes of values[from], values[from + 1], …, `count` of them: added to, or set as, to[0], to[stride], …
template <int n, int count, int... which, class V, class T>
DALEMBERT_INLINE void add_lanes(const V& values, int from, T* to, int stride) {
  detail::hand_on<false, n, which...>(std::make_integer_sequence<int, count>{}, values, from, to, stride);
}
template <int n, int count, int... which, class V, class T>
DALEMBERT_INLINE void set_lanes(const V& values, int from, T* to, int stride) {
  detail::hand_on<true, n, which...>(std::make_integer_sequence<int, count>{}, values, from, to, stride);
}

}  // namespace dalembert
