// Sines and cosines of many angles together.
//
// Error at most 2 ulp for |x| ≤ 1e5: reduction by three parts of π/2, then the minimax polynomials of fdlibm, S1…S6 and
// C1…C6, on ±π/4, in as short a chain as they can be. Larger ones are handed to the standard library one by one: as accurate
// as that is, slower. With -DDALEMBERT_LIBRARY_SINES all are, to compare with. Infinities and NaN give NaN. What an angle gives
// does not depend on the others, not by a bit. Neither allocates nor locks.
#pragma once

#include <cmath>
#include <cstdint>

#include "dalembert/lanes.hpp"

#if (defined(__FAST_MATH__) || defined(__ASSOCIATIVE_MATH__)) && !defined(DALEMBERT_LIBRARY_SINES)
#error "-ffast-math and -fassociative-math drop the rounding by which angles are reduced: compile this file without"
#endif

namespace dalembert {

inline constexpr double sincos_fast_limit = 1e5;

namespace detail {

template <int n>
DALEMBERT_INLINE void sincos_reduced(const Lanes<double, n>& x, Lanes<double, n>& sine, Lanes<double, n>& cosine) {
  using V = Lanes<double, n>;
  using I = Lanes<std::int64_t, n>;
  constexpr double magic = 6755399441055744.0;         // 1.5·2⁵²: adding it rounds to an integer, kept in the low bits
  constexpr double half_pi_1 = 0x1.921fb54440000p0;    // π/2 in parts of 37, 37 and 53 bits: products with a quadrant of 16
  constexpr double half_pi_2 = 0x1.68c234c4c0000p-39;  // bits are exact
  constexpr double half_pi_3 = 0x1.98a2e03707345p-77;
  const V shifted = x * 0x1.45f306dc9c883p-1 + magic;
  const V k = shifted - magic;
  I quadrant;
  std::memcpy(&quadrant, &shifted, sizeof quadrant);

  // The first difference is exact. Where the second leaves much, it rounds and the third hardly changes it; where it leaves
  // little, it is exact and the third rounds. The square need not wait for the third: it changes that by less than 1e-17.
  const V nearly = (x - k * half_pi_1) - k * half_pi_2, r = nearly - k * half_pi_3;
  const V z = nearly * nearly, z2 = z * z;
  // clang-format off
  const V s = ((1.58969099521155010221e-10 * z - 2.50507602534068634195e-08) * z2 +
               (2.75573137070700676789e-06 * z - 1.98412698298579493134e-04)) * z2 +
              (8.33333333332248946124e-03 * z - 1.66666666666666324348e-01);
  const V c = ((-1.13596475577881948265e-11 * z + 2.08757232129817482790e-09) * z2 +
               (-2.75573143513906633035e-07 * z + 2.48015872894767294178e-05)) * z2 +
              (-1.38888888888741095749e-03 * z + 4.16666666666666019037e-02);
  // clang-format on
  const V sin_r = r + r * z * s;
  const V cos_r = 1.0 - z * (0.5 - z * c);

  I si, ci;
  std::memcpy(&si, &sin_r, sizeof si);
  std::memcpy(&ci, &cos_r, sizeof ci);
  const I sign_bit = I{} + INT64_MIN;
  const I change = (si ^ ci) & -(quadrant & 1);  // in odd quadrants sine and cosine change places
  const I out_s = si ^ change ^ ((quadrant << 62) & sign_bit);
  const I out_c = ci ^ change ^ (((quadrant + 1) << 62) & sign_bit);
  std::memcpy(&sine, &out_s, sizeof sine);
  std::memcpy(&cosine, &out_c, sizeof cosine);
}

// Angles that are taken together where there are n of them: up to eight, two registers of four come sooner than one of eight.
constexpr int angle_lanes(int n) {
  return native_lanes < 2 ? 2 : native_lanes > 4 && shuffles_in_registers && n > 8 ? 8 : least(native_lanes, 4);
}

#ifdef DALEMBERT_LIBRARY_SINES
inline constexpr double sincos_vector_limit = -1;  // of none
#else
inline constexpr double sincos_vector_limit = sincos_fast_limit;
#endif

// Of those among n angles that are too large to be taken together; what stands of the others' sines and cosines stays.
template <class T>
__attribute__((noinline, cold)) static void sincos_large(const T* angle, T* sine, T* cosine, int n) {
  for (int i = 0; i < n; ++i) {
    const double x = static_cast<double>(angle[i]);
    if (std::abs(x) <= sincos_vector_limit) continue;
    sine[i] = static_cast<T>(std::sin(x));
    cosine[i] = static_cast<T>(std::cos(x));
  }
}

// Limbs read what is written here at once, four slots at a time, and would wait for the whole of a store of eight: so eight are
// stored by halves.
template <int w, class T>
DALEMBERT_INLINE void store_for_limbs(T* to, const Lanes<double, w>& x) {
  if constexpr (w < 8) {
    store<w, T>(to, __builtin_convertvector(x, Lanes<T, w>));
  } else {
    store<4, T>(to, __builtin_convertvector((shuffled<double, 0, 1, 2, 3>(x, x)), Lanes<T, 4>));
    store<4, T>(to + 4, __builtin_convertvector((shuffled<double, 4, 5, 6, 7>(x, x)), Lanes<T, 4>));
  }
}

// Of `count` registers of w angles, angles(i) being the i-th, whose sines and cosines go to place(i) and behind it.
template <int count, int w, class T, class Place, class Angles>
DALEMBERT_BLOCK void sincos_each(const Place& place, const Angles& angles, T* sine, T* cosine) {
  const auto large_by_library = [&]() DALEMBERT_IN_BLOCK {
    T angle[count * w], s[count * w], c[count * w];
    for (int i = 0; i < count; ++i) {
      store<w, T>(angle + i * w, angles(i));
      if constexpr (sincos_vector_limit < 0) continue;
      store<w, T>(s + i * w, load<w>(sine + place(i)));
      store<w, T>(c + i * w, load<w>(cosine + place(i)));
    }
    sincos_large(angle, s, c, count * w);
    for (int i = 0; i < count; ++i) {
      store<w, T>(sine + place(i), load<w>(s + i * w));
      store<w, T>(cosine + place(i), load<w>(c + i * w));
    }
  };
  if constexpr (sincos_vector_limit < 0) return large_by_library();
  using V = Lanes<double, w>;
  V largest{}, smallest{};  // NaN is neither: one that nobody needs changes nothing else
  const auto of_register = [&](int i, V& s, V& c) DALEMBERT_IN_BLOCK {
    const V x = __builtin_convertvector(angles(i), V);
    largest = x > largest ? x : largest;
    smallest = x < smallest ? x : smallest;
    sincos_reduced<w>(x, s, c);
  };
  const auto stored = [&](int i, const V& s, const V& c) DALEMBERT_IN_BLOCK {
    store_for_limbs<w>(sine + place(i), s);
    store_for_limbs<w>(cosine + place(i), c);
  };
  const auto any_is_large = [&]() DALEMBERT_IN_BLOCK {
    const V size = largest > -smallest ? largest : -smallest;
    bool small = true;
    for (int j = 0; j < w; ++j) small &= size[j] <= sincos_vector_limit;
    return __builtin_expect(!small, 0);
  };
  // Of few registers, whoever reads numbers one by one takes them from these, sooner than they come from where they are stored,
  // as long as nobody else writes there; and as long as there are registers: of sixteen too many are held.
  constexpr int few = native_lanes < 8 || w > 4 ? 0 : 2;
  if constexpr (count <= few) {
    V s[count], c[count];
    for_constants<count>([&](auto i) DALEMBERT_IN_BLOCK { of_register(i, s[i], c[i]); });
    if (any_is_large()) {
      double angle[count * w], of_s[count * w], of_c[count * w];
      for_constants<count>([&](auto i) DALEMBERT_IN_BLOCK {
        store<w, double>(angle + i * w, __builtin_convertvector(angles(i), V));
        store<w, double>(of_s + i * w, s[i]), store<w, double>(of_c + i * w, c[i]);
      });
      sincos_large(angle, of_s, of_c, count * w);
      for_constants<count>([&](auto i) DALEMBERT_IN_BLOCK { s[i] = load<w>(of_s + i * w), c[i] = load<w>(of_c + i * w); });
    }
    for_constants<count>([&](auto i) DALEMBERT_IN_BLOCK { stored(i, s[i], c[i]); });
  } else {
    for (int i = 0; i < count; ++i) {
      V s, c;
      of_register(i, s, c);
      stored(i, s, c);
    }
    if (any_is_large()) large_by_library();
  }
}
// Of angles that stand at place(i) and behind it, too;
template <int count, int w, class T, class Place>
DALEMBERT_BLOCK void sincos_in_place(const T* angle, const Place& place, T* sine, T* cosine) {
  sincos_each<count, w>(
      place, [=](int i) DALEMBERT_IN_BLOCK { return load<w>(angle + place(i)); }, sine, cosine);
}
// or of angle[at[place(i)]] and so on. As long as they are few they are brought together ahead, with constants for indices:
// where a loop looks each one up, that is a third of its instructions.
template <int count, int w, class T, class Place>
DALEMBERT_BLOCK void sincos_gathered(const T* angle, const int* at, const Place& place, T* sine, T* cosine) {
  const auto gathered = [=](int i) DALEMBERT_IN_BLOCK { return gather<w>(angle, at + place(i)); };
  if constexpr (count <= 16) {
    alignas(64) T ahead[count * w];
    for_constants<count>([&](auto i) DALEMBERT_IN_BLOCK { store<w, T>(ahead + i * w, gathered(i)); });
    sincos_each<count, w>(
        place, [&](int i) DALEMBERT_IN_BLOCK { return load<w>(ahead + i * w); }, sine, cosine);
  } else {
    sincos_each<count, w>(place, gathered, sine, cosine);
  }
}

// Registers one behind the other, or at fours of slots.
template <int n>
struct AnglesInRow {
  static constexpr int w = angle_lanes(n), count = (n + w - 1) / w;
  DALEMBERT_INLINE int operator()(int i) const { return w * i; }
};
template <int slots, int fours, int most>
struct AnglesAtFours {
  static constexpr int w = least(angle_lanes(slots), most), count = fours * 4 / w;
  const int* first_of_four;
  DALEMBERT_INLINE int operator()(int i) const { return first_of_four[i * w / 4] + i * w % 4; }
};
template <int slots, int fours, int most>
DALEMBERT_INLINE auto places_of_slots([[maybe_unused]] const int* first_of_four) {
  if constexpr (least(angle_lanes(slots), most) == 8) return AnglesInRow<slots>{};
  else return AnglesAtFours<slots, fours, most>{first_of_four};
}

}  // namespace detail

// angle (rad), sine, cosine: arrays of padded(n) elements that do not overlap; angle's padding must hold numbers (zeros).
template <int n, class T>
DALEMBERT_BLOCK void sincos(const T* angle, T* sine, T* cosine) {
  using Row = detail::AnglesInRow<n>;
  detail::sincos_in_place<Row::count, Row::w>(angle, Row{}, sine, cosine);
}
// Of angle[at[0]], …, angle[at[n − 1]]; `at`, sine and cosine have padded(n) elements.
template <int n, class T>
DALEMBERT_BLOCK void sincos_at(const T* angle, const int* at, T* sine, T* cosine) {
  using Row = detail::AnglesInRow<n>;
  detail::sincos_gathered<Row::count, Row::w>(angle, at, Row{}, sine, cosine);
}

// Of the angles of limbs: those of the slots first_of_four[0], … and the three behind each of them, so many fours. Other slots,
// of `slots`, a multiple of eight, must hold numbers; theirs may be written or not. most: 4
// where what comes behind takes no more slots at a time, and so waits for no more.
template <int slots, int fours, int most = 8, class T>
DALEMBERT_BLOCK void sincos_of_slots(const T* angle, const int* first_of_four, T* sine, T* cosine) {
  const auto places = detail::places_of_slots<slots, fours, most>(first_of_four);
  detail::sincos_in_place<places.count, places.w>(angle, places, sine, cosine);
}
// The angle of a slot is angle[at[slot]].
template <int slots, int fours, int most = 8, class T>
DALEMBERT_BLOCK void sincos_of_slots_at(const T* angle, const int* at, const int* first_of_four, T* sine, T* cosine) {
  const auto places = detail::places_of_slots<slots, fours, most>(first_of_four);
  detail::sincos_gathered<places.count, places.w>(angle, at, places, sine, cosine);
}

}  // namespace dalembert
