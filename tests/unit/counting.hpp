// A number that counts the operations done with it, and lanes of such numbers: generated code whose Scalar it is counts what it
// executes. Included before generated code is.
#pragma once

#include <cmath>
#include <dalembert/lanes.hpp>

namespace dalembert {

struct Counted {
  double value = 0;

  constexpr Counted() = default;
  constexpr Counted(double x) : value(x) {}  // NOLINT: literals become counted numbers
  constexpr explicit operator double() const { return value; }

  static inline long add = 0, multiply = 0, divide = 0, sincos = 0;

  friend Counted operator+(Counted a, Counted b) { return ++add, a.value + b.value; }
  friend Counted operator-(Counted a, Counted b) { return ++add, a.value - b.value; }
  friend Counted operator*(Counted a, Counted b) { return ++multiply, a.value * b.value; }
  friend Counted operator/(Counted a, Counted b) { return ++divide, a.value / b.value; }
  friend Counted operator-(Counted a) { return -a.value; }
  friend bool operator<(Counted a, Counted b) { return a.value < b.value; }
  friend bool operator>(Counted a, Counted b) { return a.value > b.value; }
  Counted& operator+=(Counted b) { return *this = *this + b; }
  Counted& operator-=(Counted b) { return *this = *this - b; }
  Counted& operator*=(Counted b) { return *this = *this * b; }
};

template <int n>
struct CountedLanes {
  Counted at[n];

  CountedLanes() = default;
  CountedLanes(Counted x) {  // NOLINT: a number in all lanes, as of the compiler's own vectors
    for (Counted& to : at) to = x;
  }
  CountedLanes(double x) : CountedLanes(Counted(x)) {}
  template <class... More>
  CountedLanes(Counted x, Counted y, More... more) : at{x, y, more...} {
    static_assert(sizeof...(more) + 2 == n);
  }
  Counted& operator[](int i) { return at[i]; }
  const Counted& operator[](int i) const { return at[i]; }

  friend CountedLanes operator+(const CountedLanes& a, const CountedLanes& b) {
    return each(a, b, [](Counted x, Counted y) { return x + y; });
  }
  friend CountedLanes operator-(const CountedLanes& a, const CountedLanes& b) {
    return each(a, b, [](Counted x, Counted y) { return x - y; });
  }
  friend CountedLanes operator*(const CountedLanes& a, const CountedLanes& b) {
    return each(a, b, [](Counted x, Counted y) { return x * y; });
  }
  friend CountedLanes operator/(const CountedLanes& a, const CountedLanes& b) {
    return each(a, b, [](Counted x, Counted y) { return x / y; });
  }
  friend CountedLanes operator-(const CountedLanes& a) {
    return each(a, a, [](Counted x, Counted) { return -x; });
  }
  CountedLanes& operator+=(const CountedLanes& b) { return *this = *this + b; }
  CountedLanes& operator-=(const CountedLanes& b) { return *this = *this - b; }
  CountedLanes& operator*=(const CountedLanes& b) { return *this = *this * b; }

 private:
  template <class F>
  static CountedLanes each(const CountedLanes& a, const CountedLanes& b, const F& f) {
    CountedLanes out;
    for (int i = 0; i < n; ++i) out.at[i] = f(a.at[i], b.at[i]);
    return out;
  }
};

namespace detail {
template <int n>
struct LanesOf<Counted, n> {
  using type = CountedLanes<n>;
};
template <>
struct LanesOf<Counted, 1> {
  using type = Counted;
};
}  // namespace detail

// No operation, though the runtime writes one.
template <>
inline CountedLanes<2> broadcast<2, Counted>(Counted x) {
  return x;
}
template <>
inline CountedLanes<4> broadcast<4, Counted>(Counted x) {
  return x;
}
template <>
inline CountedLanes<8> broadcast<8, Counted>(Counted x) {
  return x;
}
template <>
inline Counted broadcast<1, Counted>(Counted x) {
  return x;
}

template <class T, int... which, int n>
CountedLanes<sizeof...(which)> shuffled(const CountedLanes<n>& a, const CountedLanes<n>& b) {
  return {(which < n ? a[which % n] : b[which % n])...};
}

}  // namespace dalembert

#include <dalembert/sincos.hpp>

namespace dalembert {

inline void sine_and_cosine(Counted angle, Counted& sine, Counted& cosine) {
  sine = std::sin(angle.value), cosine = std::cos(angle.value);
  ++Counted::sincos;
}
template <int n>
void sincos(const Counted* angle, Counted* sine, Counted* cosine) {
  for (int i = 0; i < (n + 3) / 4 * 4; ++i) sine_and_cosine(angle[i], sine[i], cosine[i]);
}
template <int n>
void sincos_at(const Counted* angle, const int* at, Counted* sine, Counted* cosine) {
  for (int i = 0; i < (n + 3) / 4 * 4; ++i) sine_and_cosine(angle[at[i]], sine[i], cosine[i]);
}
template <int slots, int fours, int most = 8>
void sincos_of_slots(const Counted* angle, const int* first_of_four, Counted* sine, Counted* cosine) {
  for (int i = 0; i < fours; ++i)
    for (int slot = first_of_four[i]; slot < first_of_four[i] + 4; ++slot)
      sine_and_cosine(angle[slot], sine[slot], cosine[slot]);
}
template <int slots, int fours, int most = 8>
void sincos_of_slots_at(const Counted* angle, const int* at, const int* first_of_four, Counted* sine, Counted* cosine) {
  for (int i = 0; i < fours; ++i)
    for (int slot = first_of_four[i]; slot < first_of_four[i] + 4; ++slot)
      sine_and_cosine(angle[at[slot]], sine[slot], cosine[slot]);
}

}  // namespace dalembert
