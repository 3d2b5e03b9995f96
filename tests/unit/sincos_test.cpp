// Sines and cosines in lanes, against Boost.Multiprecision: 50 digits for angles of the fast path, 400 for the largest ones.
#include "dalembert/sincos.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <boost/math/constants/constants.hpp>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <vector>

namespace {

namespace mp = boost::multiprecision;
using Digits50 = mp::cpp_bin_float_50;
using Digits400 = mp::number<mp::cpp_bin_float<400>, mp::et_off>;

constexpr int together = 8;

struct SineCosine {
  double sine, cosine;
};

std::vector<SineCosine> computed(std::vector<double> angles) {
  const std::size_t count = angles.size();
  angles.resize((count + together - 1) / together * together, 0);
  std::vector<SineCosine> result;
  for (std::size_t i = 0; i < angles.size(); i += together) {
    std::array<double, together> sine{}, cosine{};
    dalembert::sincos<together, double>(angles.data() + i, sine.data(), cosine.data());
    for (std::size_t j = 0; j < together; ++j) result.push_back({sine[j], cosine[j]});
  }
  result.resize(count);
  return result;
}

// |value - exact| in units of the last place of `exact` rounded to S.
template <class S, class Exact>
double ulps(S value, const Exact& exact) {
  const S rounded = static_cast<S>(exact);
  const S size = std::abs(rounded);
  int exponent = 0;
  std::frexp(size, &exponent);
  const S unit = std::max(std::ldexp(S(1), exponent - std::numeric_limits<S>::digits), std::numeric_limits<S>::denorm_min());
  const Exact error = mp::abs(Exact(value) - exact) / Exact(unit);
  return static_cast<double>(error);
}

// Sine and cosine of x by Taylor's series after reduction to within ±π/4; Exact must hold x's digits and forty more.
template <class Exact>
void exact_sincos(double x, Exact& sine, Exact& cosine) {
  static const Exact half_pi = boost::math::constants::half_pi<Exact>();
  const Exact k = mp::round(Exact(x) / half_pi);
  const Exact r = Exact(x) - k * half_pi, z = r * r;
  Exact s = r, c = 1, s_term = r, c_term = 1;
  for (int n = 1; n < 20; ++n) {
    c_term *= -z / ((2 * n - 1) * (2 * n));
    s_term *= -z / ((2 * n) * (2 * n + 1));
    c += c_term;
    s += s_term;
  }
  int quadrant = static_cast<int>(k - 4 * mp::floor(k / 4));
  for (; quadrant > 0; --quadrant) {
    const Exact turned = -s;
    s = c;
    c = turned;
  }
  sine = s;
  cosine = c;
}

template <class Exact>
void expect_within(double limit, const std::vector<double>& angles) {
  const std::vector<SineCosine> results = computed(angles);
  double worst = 0, worst_angle = 0;
  for (std::size_t i = 0; i < angles.size(); ++i) {
    Exact sine, cosine;
    exact_sincos<Exact>(angles[i], sine, cosine);
    const double error = std::max(ulps(results[i].sine, sine), ulps(results[i].cosine, cosine));
    if (!(error <= worst)) worst = error, worst_angle = angles[i];
  }
  EXPECT_LE(worst, limit) << "ulp at " << std::hexfloat << worst_angle << " rad";
  ::testing::Test::RecordProperty("worst_ulp", std::to_string(worst));
}

TEST(Sincos, IsWithinTwoUlpWhereverRobotsAre) {
  std::mt19937_64 random(1);
  std::vector<double> angles;
  for (const double range : {0.8, 3.2, 100.0, 1e5}) {
    std::uniform_real_distribution<double> uniform(-range, range);
    for (int i = 0; i < 10000; ++i) angles.push_back(uniform(random));
  }
  expect_within<Digits50>(2, angles);
}

TEST(Sincos, IsWithinTwoUlpBesideTheMultiplesOfAQuarterTurn) {
  std::vector<double> angles;
  const double largest = dalembert::sincos_fast_limit;
  for (int k = 0; k * 0x1.921fb54442d18p-1 < largest; k += k < 400 ? 1 : 61) {  // odd multiples: between two quadrants
    const double nearest = static_cast<double>(k * boost::math::constants::half_pi<Digits50>() / 2);
    const double above = std::nextafter(nearest, 2 * largest);
    for (const double x : {nearest, above, std::nextafter(nearest, -1.0), nearest + 1e-9}) {
      angles.push_back(x);
      angles.push_back(-x);
    }
  }
  expect_within<Digits50>(2, angles);
}

TEST(Sincos, IsWithinTwoUlpOfTinyAngles) {
  std::vector<double> angles{0.0, std::numeric_limits<double>::denorm_min(), 3 * std::numeric_limits<double>::denorm_min(),
                             std::numeric_limits<double>::min()};
  for (int exponent = -1074; exponent < 0; exponent += 3) angles.push_back(std::ldexp(1.37, exponent));
  for (std::size_t i = angles.size(); i-- > 0;) angles.push_back(-angles[i]);
  expect_within<Digits50>(2, angles);
}

TEST(Sincos, OfZeroIsExact) {
  for (const SineCosine& result : computed({0.0, -0.0})) {
    EXPECT_EQ(result.sine, 0.0);
    EXPECT_EQ(result.cosine, 1.0);
  }
}

TEST(Sincos, HandsOverAtItsLimitWithoutAStep) {
  const double limit = dalembert::sincos_fast_limit;
  expect_within<Digits50>(2, {limit, -limit, std::nextafter(limit, 0.0), std::nextafter(limit, 2 * limit),
                              -std::nextafter(limit, 2 * limit), 1.1 * limit});
}

TEST(Sincos, IsWithinOneUlpOfLargeAngles) {
  std::vector<double> angles{1e6, 1e15, 1e22, 1e300, std::numeric_limits<double>::max()};
  for (std::size_t i = angles.size(); i-- > 0;) angles.push_back(-angles[i]);
  expect_within<Digits400>(1, angles);
}

// The double that comes closest to a multiple of π/2: glibc 2.36 is 8 ulp off there, and we promise no more than it has.
TEST(Sincos, IsTheLibrarysBesideALargeMultipleOfAQuarterTurn) {
  const volatile double x = 0x1.6ac5b262ca1ffp+849;  // volatile: the compiler's own sine is another one
  const SineCosine result = computed({x}).front();
  EXPECT_EQ(result.sine, std::sin(x));
  EXPECT_EQ(result.cosine, std::cos(x));
  EXPECT_NEAR(result.cosine, -4.68716592425462761112e-19, 1e-32);
}

// Large ones go to the standard library one by one: the others must be as good as ever.
TEST(Sincos, TakesLargeAnglesBesideOthers) {
  for (std::size_t where = 0; where < together; ++where) {
    std::vector<double> angles{0.1, -0.7, 1.3, 2.9, -3.1, 40.0, 1e4, 0.0};
    angles[where] = where % 2 == 0 ? 1e300 : -1e6;
    expect_within<Digits400>(2, angles);
  }
}

TEST(Sincos, OfNoNumberIsNoNumber) {
  const double infinity = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
  for (const double x : {infinity, -infinity, nan}) {
    for (std::size_t where = 0; where < together; ++where) {
      std::vector<double> angles(together, 0.5);
      angles[where] = x;
      const std::vector<SineCosine> results = computed(angles);
      for (std::size_t i = 0; i < together; ++i) {
        EXPECT_EQ(std::isnan(results[i].sine), i == where) << x << " at " << where;
        EXPECT_EQ(std::isnan(results[i].cosine), i == where) << x << " at " << where;
      }
    }
  }
}

template <int slots, std::size_t fours>
std::array<std::vector<double>, 2> at_slots(const std::array<int, fours>& first_of_four, const std::vector<double>& angle) {
  std::vector<double> sine(slots), cosine(slots);
  dalembert::sincos_of_slots<slots, fours>(angle.data(), first_of_four.data(), sine.data(), cosine.data());
  return {sine, cosine};
}

bool same_bits(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0; }

// By the bit, whatever the others are: in one register, in several, and at the slots of limbs. A thousand angles each, of which
// the library and the polynomials round some differently.
TEST(Sincos, OfAnAngleDoesNotDependOnTheOthers) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform(-10, 10);
  constexpr std::array<int, 3> fours{0, 8, 12};
  int otherwise_by_library = 0;
  for (const double intruder : {2e5, -1e6, 1e300, std::numeric_limits<double>::infinity(),
                                -std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()})
    for (int round = 0; round < 60; ++round) {
      std::vector<double> angles(16), disturbed;
      for (double& x : angles) x = uniform(random);
      const std::size_t where = static_cast<std::size_t>(round) % 16;
      disturbed = angles;
      disturbed[where] = intruder;
      std::array<std::array<double, 16>, 4> row{};  // sines and cosines of all 16 together, before and after
      dalembert::sincos<16, double>(angles.data(), row[0].data(), row[1].data());
      dalembert::sincos<16, double>(disturbed.data(), row[2].data(), row[3].data());
      const std::vector<SineCosine> eights = computed(angles), disturbed_eights = computed(disturbed);
      const auto slots = at_slots<16>(fours, angles), disturbed_slots = at_slots<16>(fours, disturbed);
      for (std::size_t i = 0; i < 16; ++i) {
        if (i == where) continue;
        EXPECT_TRUE(same_bits(row[0][i], row[2][i]) && same_bits(row[1][i], row[3][i])) << intruder << " at " << where;
        EXPECT_TRUE(same_bits(eights[i].sine, disturbed_eights[i].sine) &&
                    same_bits(eights[i].cosine, disturbed_eights[i].cosine))
            << intruder << " at " << where;
        EXPECT_TRUE(same_bits(slots[0][i], disturbed_slots[0][i]) && same_bits(slots[1][i], disturbed_slots[1][i]))
            << intruder << " at " << where;
        const volatile double x = angles[i];
        otherwise_by_library += !same_bits(row[0][i], std::sin(x));
      }
      const volatile double x = intruder;
      if (std::isfinite(intruder)) {
        EXPECT_TRUE(same_bits(row[2][where], std::sin(x)) && same_bits(row[3][where], std::cos(x))) << intruder;
      } else {
        EXPECT_TRUE(std::isnan(row[2][where]) && std::isnan(row[3][where])) << intruder;
      }
    }
  EXPECT_GT(otherwise_by_library, 50);  // else this could not tell
}

// Every count pads to whole registers, whatever their width: results are those of eight together, and no more are written.
template <int n>
void expect_same_for_count() {
  constexpr int room = dalembert::padded(n);
  std::vector<double> angles(room, 0), sine(room + 1, 7), cosine(room + 1, 7);
  const volatile double first =
      -1;  // volatile: what the compiler works out by itself, it rounds more often than a multiply-add
  for (int i = 0; i < n; ++i) angles[static_cast<std::size_t>(i)] = 0.37 * i + first;
  dalembert::sincos<n, double>(angles.data(), sine.data(), cosine.data());
  const std::vector<SineCosine> expected = computed(angles);
  for (std::size_t i = 0; i < n; ++i) {
    EXPECT_EQ(sine[i], expected[i].sine) << n << " angles";
    EXPECT_EQ(cosine[i], expected[i].cosine) << n << " angles";
  }
  EXPECT_EQ(sine[room], 7);
  EXPECT_EQ(cosine[room], 7);
}

TEST(Sincos, TakesAnyCount) {
  expect_same_for_count<1>();
  expect_same_for_count<2>();
  expect_same_for_count<3>();
  expect_same_for_count<5>();
  expect_same_for_count<7>();
  expect_same_for_count<12>();
  expect_same_for_count<16>();
  expect_same_for_count<31>();
}

TEST(Sincos, ReadsAnglesWhereTheyAre) {
  const std::array<double, 9> angles{0.1, -0.2, 0.3, 1.4, -2.5, 3.6, 1e6, -1e300, 9.9};
  for (const std::array<int, 4> at : {std::array<int, 4>{3, 1, 1, 8}, {0, 6, 2, 4}, {7, 5, 5, 0}}) {
    std::array<double, dalembert::padded(4)> sine{}, cosine{};
    dalembert::sincos_at<4, double>(angles.data(), at.data(), sine.data(), cosine.data());
    for (std::size_t i = 0; i < 4; ++i) {
      Digits400 exact_sine, exact_cosine;
      exact_sincos<Digits400>(angles[static_cast<std::size_t>(at[i])], exact_sine, exact_cosine);
      EXPECT_LE(ulps(sine[i], exact_sine), 2) << at[i];
      EXPECT_LE(ulps(cosine[i], exact_cosine), 2) << at[i];
    }
  }
}

// Limbs stand at some of the slots, in fours; one of them may be large.
template <int slots, std::size_t fours>
void expect_at_slots(const std::array<int, fours>& first_of_four, double large) {
  constexpr std::size_t room = slots;
  std::array<double, room> angle{}, sine{}, cosine{}, sine_at{}, cosine_at{}, turned{};
  std::array<int, room> at{};
  for (std::size_t i = 0; i < room; ++i) {
    angle[i] = 0.37 * static_cast<double>(i) - 2;
    at[i] = static_cast<int>(room - 1 - i);
  }
  angle[static_cast<std::size_t>(first_of_four.back()) + 2] = large;
  std::reverse_copy(angle.begin(), angle.end(), turned.begin());
  dalembert::sincos_of_slots<slots, fours>(angle.data(), first_of_four.data(), sine.data(), cosine.data());
  dalembert::sincos_of_slots_at<slots, fours>(turned.data(), at.data(), first_of_four.data(), sine_at.data(), cosine_at.data());
  for (const int first : first_of_four)
    for (std::size_t i = static_cast<std::size_t>(first); i < static_cast<std::size_t>(first) + 4; ++i) {
      Digits400 exact_sine, exact_cosine;
      exact_sincos<Digits400>(angle[i], exact_sine, exact_cosine);
      EXPECT_LE(ulps(sine[i], exact_sine), 2) << slots << " slots, " << i;
      EXPECT_LE(ulps(cosine[i], exact_cosine), 2) << slots << " slots, " << i;
      EXPECT_EQ(sine_at[i], sine[i]);
      EXPECT_EQ(cosine_at[i], cosine[i]);
    }
}

TEST(Sincos, TakesLimbsAtTheirSlots) {
  for (const double large : {0.5, 1e300}) {
    expect_at_slots<8, 1>({4}, large);
    expect_at_slots<8, 2>({0, 4}, large);
    expect_at_slots<16, 3>({0, 8, 12}, large);
    expect_at_slots<40, 8>({0, 8, 12, 16, 20, 24, 32, 36}, large);
  }
}

TEST(Sincos, OfFloatsIsWithinOneUlp) {
  std::mt19937_64 random(2);
  double worst = 0;
  for (const float range : {1e-30f, 0.8f, 10.0f, 1e5f, 1e7f, 1e38f}) {
    std::uniform_real_distribution<float> uniform(-range, range);
    for (int i = 0; i < 100; ++i) {
      std::array<float, together> angle{}, sine{}, cosine{};
      for (float& x : angle) x = uniform(random);
      dalembert::sincos<together, float>(angle.data(), sine.data(), cosine.data());
      for (std::size_t j = 0; j < together; ++j) {
        mp::cpp_bin_float_100 exact_sine, exact_cosine;
        exact_sincos<mp::cpp_bin_float_100>(angle[j], exact_sine, exact_cosine);
        worst = std::max({worst, ulps(sine[j], exact_sine), ulps(cosine[j], exact_cosine)});
      }
    }
  }
  EXPECT_LE(worst, 1);
}

}  // namespace
