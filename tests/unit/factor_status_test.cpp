// Whether a mass matrix can be solved with, told from the pivots of its factors.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <dalembert/factor.hpp>
#include <limits>

namespace {

constexpr int n = 9, base = 6, slots = 8;
constexpr int joint_slot[] = {5, 0, 2};  // of coordinates 6, 7, 8
constexpr double no_joint[slots] = {0, 1, 0, 1, 1, 0, 1, 1};

// The same pivots, in coordinates and with the joints' at their slots; slots without a joint hold what nobody may look at.
struct Pivots {
  std::array<double, n> pivot, diagonal;
  Pivots() { pivot.fill(2), diagonal.fill(3); }

  dalembert::FactorStatus<double> in_coordinates() const { return dalembert::factor_status<n>(pivot.data(), diagonal.data()); }
  dalembert::FactorStatus<double> in_slots() const {
    std::array<double, slots> slot_pivot, slot_diagonal;
    slot_pivot.fill(std::nan("")), slot_diagonal.fill(std::nan(""));
    slot_pivot[1] = -1, slot_pivot[3] = 0;
    std::array<double, n> room{}, more_room{};
    for (int k = 0; k < n; ++k) {
      const auto at = static_cast<std::size_t>(k);
      (k < base ? room[at] : slot_pivot[static_cast<std::size_t>(joint_slot[k - base])]) = pivot[at];
      (k < base ? more_room[at] : slot_diagonal[static_cast<std::size_t>(joint_slot[k - base])]) = diagonal[at];
    }
    return dalembert::factor_status_of_slots<n, base, slots>(slot_pivot.data(), slot_diagonal.data(), no_joint, joint_slot,
                                                             room.data(), more_room.data());
  }
};

TEST(FactorStatus, IsGoodWhereAllPivotsAre) {
  const Pivots pivots;
  EXPECT_TRUE(pivots.in_coordinates().ok());
  EXPECT_TRUE(pivots.in_slots().ok());
}

TEST(FactorStatus, SaysWhichPivotIsNot) {
  for (std::size_t k = 0; k < n; ++k)
    for (const double bad : {0.0, -1.0, std::nan(""), 3 * n * 0.9 * std::numeric_limits<double>::epsilon()}) {
      Pivots pivots;
      pivots.pivot[k] = bad;
      for (const auto& status : {pivots.in_coordinates(), pivots.in_slots()}) {
        EXPECT_EQ(status.coordinate, static_cast<int>(k)) << bad;
        EXPECT_TRUE(status.pivot == bad || (std::isnan(status.pivot) && std::isnan(bad)));
      }
    }
}

TEST(FactorStatus, AllowsWhatIsAboveRounding) {
  for (std::size_t k = 0; k < n; ++k) {
    Pivots pivots;
    pivots.pivot[k] = 3 * n * 1.1 * std::numeric_limits<double>::epsilon();
    EXPECT_TRUE(pivots.in_coordinates().ok());
    EXPECT_TRUE(pivots.in_slots().ok());
  }
}

// Of a fixed base, in float.
TEST(FactorStatus, NeedsNoBase) {
  for (const float last : {1.0f, 0.0f, -1.0f, 2e-7f}) {
    const float slot_pivot[slots] = {1, 0, last, 0, 0, 1, 0, 0}, slot_diagonal[slots] = {1, 0, 1, 0, 0, 1, 0, 0};
    const float none[slots] = {0, 1, 0, 1, 1, 0, 1, 1};
    float room[3], more_room[3];
    const auto status =
        dalembert::factor_status_of_slots<3, 0, slots>(slot_pivot, slot_diagonal, none, joint_slot, room, more_room);
    EXPECT_EQ(status.coordinate, last == 1 ? -1 : 2) << last;
    EXPECT_EQ(status.pivot, last == 1 ? 0 : last);
  }
}

// M is factored from its last coordinate on.
TEST(FactorStatus, SaysTheFirstMet) {
  for (std::size_t k = 1; k < n; ++k) {
    Pivots pivots;
    std::fill_n(pivots.pivot.begin(), k, -1.0);
    EXPECT_EQ(pivots.in_coordinates().coordinate, static_cast<int>(k) - 1);
    EXPECT_EQ(pivots.in_slots().coordinate, static_cast<int>(k) - 1);
  }
}

}  // namespace
