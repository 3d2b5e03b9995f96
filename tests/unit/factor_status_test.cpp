// Whether a mass matrix can be solved with, told from the pivots of its factors and from what cancellation has left of them.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <dalembert/pivots.hpp>
#include <limits>
#include <random>

namespace {

constexpr int n = 9, base = 6, slots = 8, stride = slots + 8;
constexpr int joint_slot[] = {5, 0, 2};  // of coordinates 6, 7, 8
constexpr double no_joint[slots] = {0, 1, 0, 1, 1, 0, 1, 1};
constexpr int above[n] = {-1, 0, 1, 2, 3, 4, 5, 6, 5};  // 7 beyond 6, 8 beside them

using Matrix = Eigen::Matrix<double, n, n>;
using Wrenches = Eigen::Matrix<double, 6, n>;

// Pivots, M's diagonal, V and J; and what they are as L'.
struct Factors {
  std::array<double, n> pivot, diagonal;
  Wrenches gain = Wrenches::Zero(), joint = Wrenches::Zero();

  Factors() {
    pivot.fill(2), diagonal.fill(3);
    gain.leftCols<base>().setIdentity(), joint.leftCols<base>().setIdentity();
  }

  Matrix upper() const {
    Matrix L = Matrix::Zero();
    for (int k = 0; k < n; ++k)
      for (int i = above[k]; i >= 0; i = above[i]) L(i, k) = gain.col(k).dot(joint.col(i));
    return L;
  }
  // e_k, by inverting U.
  double bound(int k) const {
    const Matrix unit = Matrix(upper()) + Matrix::Identity();
    const Eigen::RowVectorXd x = unit.inverse().row(k);
    return x.cwiseAbs2().dot(Eigen::Map<const Eigen::RowVectorXd>(diagonal.data(), n));
  }

  dalembert::FactorStatus<double> by_factor() const {
    const Matrix L = upper();
    return dalembert::factor_status<n>(above, L.data(), pivot.data(), diagonal.data());
  }
  dalembert::FactorStatus<double> by_gains() const {
    return dalembert::factor_status_by_gains<n>(above, gain.data(), joint.data(), pivot.data(), diagonal.data());
  }
  // The joints' at their slots; slots without a joint hold what nobody may look at.
  dalembert::FactorStatus<double> in_slots() const {
    std::array<double, stride> slot_pivot, slot_diagonal;
    slot_pivot.fill(std::nan("")), slot_diagonal.fill(std::nan(""));
    slot_pivot[1] = -1, slot_pivot[3] = 0;
    Eigen::Matrix<double, stride, 6> slot_gain, slot_joint;
    slot_gain.setConstant(std::nan("")), slot_joint.setConstant(std::nan(""));
    std::array<double, n> room{}, more_room{};
    Wrenches gain_room = Wrenches::Zero(), joint_room = Wrenches::Zero();
    gain_room.leftCols<base>() = gain.leftCols<base>(), joint_room.leftCols<base>() = joint.leftCols<base>();
    for (int k = 0; k < n; ++k) {
      const auto at = static_cast<std::size_t>(k);
      if (k < base) {
        room[at] = pivot[at], more_room[at] = diagonal[at];
        continue;
      }
      const int slot = joint_slot[k - base];
      slot_pivot[static_cast<std::size_t>(slot)] = pivot[at], slot_diagonal[static_cast<std::size_t>(slot)] = diagonal[at];
      slot_gain.row(slot) = gain.col(k), slot_joint.row(slot) = joint.col(k);
    }
    const dalembert::JointSlots<double> joints{slot_pivot.data(), slot_diagonal.data(),     no_joint, slot_gain.data(),
                                               slot_joint.data(), slot_joint.col(3).data(), stride,   joint_slot};
    return dalembert::factor_status_of_slots<n, base, slots>(joints, above, gain_room.data(), joint_room.data(), room.data(),
                                                             more_room.data());
  }
  std::array<dalembert::FactorStatus<double>, 3> all() const { return {by_factor(), by_gains(), in_slots()}; }
};

constexpr double rounding = 4096 * std::numeric_limits<double>::epsilon();

TEST(FactorStatus, IsGoodWhereAllPivotsAre) {
  for (const auto& status : Factors().all()) EXPECT_TRUE(status.ok());
}

TEST(FactorStatus, SaysWhichPivotIsNot) {
  for (std::size_t k = 0; k < n; ++k)
    for (const double bad : {0.0, -1.0, std::nan(""), 3 * 0.9 * rounding}) {
      Factors factors;
      factors.pivot[k] = bad;
      for (const auto& status : factors.all()) {
        EXPECT_EQ(status.coordinate, static_cast<int>(k)) << bad;
        EXPECT_TRUE(status.pivot == bad || (std::isnan(status.pivot) && std::isnan(bad)));
      }
    }
}

TEST(FactorStatus, AllowsWhatIsAboveRounding) {
  for (std::size_t k = 0; k < n; ++k) {
    Factors factors;
    factors.pivot[k] = 3 * 1.1 * rounding;
    for (const auto& status : factors.all()) EXPECT_TRUE(status.ok());
  }
}

// M is factored from its last coordinate on.
TEST(FactorStatus, SaysTheFirstMet) {
  for (std::size_t k = 1; k < n; ++k) {
    Factors factors;
    std::fill_n(factors.pivot.begin(), k, -1.0);
    for (const auto& status : factors.all()) EXPECT_EQ(status.coordinate, static_cast<int>(k) - 1);
  }
}

// A pivot that would do on its own does not where what is beyond moves much as it moves.
TEST(FactorStatus, CountsWhatEarlierPivotsLost) {
  Factors factors;
  factors.gain.col(7) << 1e4, 0, 0, 0, 0, 0;
  factors.joint.col(6) << 1, 0, 0, 0, 0, 0;
  factors.pivot[6] = 3 * 1e3 * rounding;
  for (const auto& status : factors.all()) EXPECT_EQ(status.coordinate, 6);
  factors.pivot[6] = 3 * 1.1e8 * rounding;
  for (const auto& status : factors.all()) EXPECT_TRUE(status.ok());
}

// Three ways to the same bounds: U inverted, motions from U, and sums from V and J.
TEST(FactorStatus, HasTheBoundsOfTheInverse) {
  std::mt19937 engine(3);
  const auto uniform = [&] { return static_cast<double>(engine()) * 0x1p-31 - 1; };
  for (int round = 0; round < 200; ++round) {
    Factors factors;
    for (int k = 0; k < n; ++k) {
      factors.diagonal[static_cast<std::size_t>(k)] = std::pow(10, 3 * uniform());
      factors.pivot[static_cast<std::size_t>(k)] = 0.9 * factors.bound(k);
      for (int i = 0; i < 6; ++i) {
        if (k >= base) factors.joint(i, k) = uniform();
        if (k >= base || i < k) factors.gain(i, k) = 3 * uniform();
      }
      if (k >= base)
        factors.gain.col(k) += (1 - factors.gain.col(k).dot(factors.joint.col(k))) * factors.joint.col(k) /
                               factors.joint.col(k).squaredNorm();  // V.J = 1
    }
    for (int k = 0; k < n; ++k) factors.pivot[static_cast<std::size_t>(k)] = 1e-3 * factors.bound(k);
    for (int k = 0; k < n; ++k) {
      const auto at = static_cast<std::size_t>(k);
      const double kept = factors.pivot[at];
      factors.pivot[at] = 1.001 * rounding * factors.bound(k);
      for (const auto& status : factors.all()) EXPECT_TRUE(status.ok()) << k << ": " << status.coordinate;
      factors.pivot[at] = 0.999 * rounding * factors.bound(k);
      for (const auto& status : factors.all()) EXPECT_EQ(status.coordinate, k);
      factors.pivot[at] = kept;
    }
  }
}

// Of more coordinates than registers hold, in trees drawn at random.
TEST(FactorStatus, HasTheBoundsOfTheInverseOfLargeTrees) {
  constexpr int many = 29;
  constexpr double left = rounding / 12 * many;
  using Large = Eigen::Matrix<double, many, many>;
  std::mt19937 engine(4);
  const auto uniform = [&] { return static_cast<double>(engine()) * 0x1p-31 - 1; };
  for (int round = 0; round < 60; ++round) {
    int parent[many];
    Eigen::Matrix<double, 6, many> gain, joint;
    Eigen::Matrix<double, many, 1> pivot, diagonal;
    Large upper = Large::Constant(std::nan(""));  // of others nothing is read
    Large unit = Large::Identity();
    for (int k = 0; k < many; ++k) {
      parent[k] = k - 1;
      while (parent[k] >= 0 && round % 4 > 0 && uniform() > 0.2 * round / 4 - 1) parent[k] = parent[parent[k]];
      for (int i = 0; i < 6; ++i) joint(i, k) = uniform(), gain(i, k) = 0.8 * uniform();
      gain.col(k) += (1 - gain.col(k).dot(joint.col(k))) * joint.col(k) / joint.col(k).squaredNorm();
      diagonal[k] = std::pow(10, 2 * uniform());
      for (int i = parent[k]; i >= 0; i = parent[i]) unit(i, k) = upper(i, k) = gain.col(k).dot(joint.col(i));
    }
    const Large inverse = unit.inverse();
    Eigen::Matrix<double, many, 1> bound;
    for (int k = 0; k < many; ++k) bound[k] = inverse.row(k).cwiseAbs2().dot(diagonal), pivot[k] = 1e-3 * bound[k];
    pivot[0] = std::min(pivot[0], diagonal[0] / 1000);  // so that bounds are asked for
    for (int k = 0; k < many; ++k) {
      const double kept = pivot[k];
      for (const bool good : {true, false}) {
        pivot[k] = (good ? 1.001 : 0.999) * left * bound[k];
        for (const auto& status :
             {dalembert::factor_status<many>(parent, upper.data(), pivot.data(), diagonal.data()),
              dalembert::factor_status_by_gains<many>(parent, gain.data(), joint.data(), pivot.data(), diagonal.data())})
          EXPECT_EQ(status.coordinate, good ? -1 : k) << round;
      }
      pivot[k] = kept;
    }
  }
}

// Of a fixed base, in float.
TEST(FactorStatus, NeedsNoBase) {
  for (const float last : {1.0f, 0.0f, -1.0f, 5e-5f}) {
    const float slot_pivot[slots] = {1, 0, last, 0, 0, 1, 0, 0}, slot_diagonal[slots] = {1, 0, 1, 0, 0, 1, 0, 0};
    const float none[slots] = {0, 1, 0, 1, 1, 0, 1, 1}, nothing[6 * slots] = {};
    constexpr int chain[] = {-1, 0, 1};
    float room[3], more_room[3], gain[18] = {}, joint[18] = {};
    const dalembert::JointSlots<float> joints{slot_pivot, slot_diagonal, none, nothing, nothing, nothing, slots, joint_slot};
    const auto status = dalembert::factor_status_of_slots<3, 0, slots>(joints, chain, gain, joint, room, more_room);
    EXPECT_EQ(status.coordinate, last == 1 ? -1 : 2) << last;
    EXPECT_EQ(status.pivot, last == 1 ? 0 : last);
  }
}

}  // namespace
