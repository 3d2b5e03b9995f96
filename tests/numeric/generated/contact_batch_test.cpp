// Batches of what contacts and loops hold are what single calls give, each state with contacts of its own.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <dalembert/batch.hpp>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "held_quadruped/batch.hpp"
#include "held_quadruped/dynamics.hpp"
#include "welded_arm/batch.hpp"
#include "welded_arm/dynamics.hpp"

namespace {

using dalembert::BatchError;
namespace quadruped = held_quadruped;

constexpr std::size_t n = 21;
constexpr int nq = quadruped::nq, nv = quadruped::nv, rows = 12;

std::vector<double> random_numbers(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> number(-1, 1);
  std::vector<double> numbers(count);
  for (double& x : numbers) x = number(random);
  return numbers;
}

template <class T>
auto state(const std::vector<T>& of_all, std::size_t s, std::size_t size) {
  return Eigen::Map<const Eigen::VectorX<T>>(of_all.data() + s * size, static_cast<Eigen::Index>(size));
}

template <class T, std::size_t size>
auto single(const T (&numbers)[size]) {
  return Eigen::Map<const Eigen::VectorX<T>>(numbers, static_cast<Eigen::Index>(size));
}
template <std::size_t size>
auto single(const double (&numbers)[size], Eigen::Index columns) {
  return Eigen::Map<const Eigen::MatrixXd>(numbers, static_cast<Eigen::Index>(size) / columns, columns);
}

// What a contact or loop is given, one number behind the other as its members stand.
template <int of_rows, bool anchored>
struct Given {
  static constexpr std::size_t size = 4 + (anchored ? 7 : 0) + 2 * of_rows;
  std::vector<double> numbers;

  explicit Given(unsigned seed) : numbers(random_numbers(n * size, seed)) {
    for (std::size_t s = 0; s < n; ++s) {
      double* const own = numbers.data() + s * size;
      own[0] = (s + seed) % 3 != 0;
      own[1] = 100 * own[1] * own[1], own[2] = 20 * own[2] * own[2], own[3] *= own[3];
      if (anchored) Eigen::Map<Eigen::Vector4d>(own + 7).normalize();
      for (int r = 0; r < of_rows; ++r) own[size - 2 * of_rows + r] = r == 1 ? 0.3 : 0;
    }
  }
  template <class Constraint>
  void set(std::size_t s, Constraint& to) const {
    const double* from = numbers.data() + s * size;
    to.active = from[0] > 0, to.kp = from[1], to.kd = from[2], to.restitution = from[3];
    if constexpr (anchored) std::copy_n(from + 4, 7, to.anchor);
    std::copy_n(from + size - 2 * of_rows, of_rows, to.regularization);
    std::copy_n(from + size - of_rows, of_rows, to.weight);
  }
  void scale_weights(double times) {
    for (std::size_t s = 0; s < n; ++s)
      for (int r = 0; r < of_rows; ++r) {
        double& weight = numbers[(s + 1) * size - of_rows + static_cast<std::size_t>(r)];
        weight = times * (0.1 + std::abs(weight));
      }
  }
};

struct ContactBatches : testing::Test {
  std::vector<double> q = random_numbers(n * nq, 1), v = random_numbers(n * nv, 2), tau = random_numbers(n * nv, 3),
                      accelerations = std::vector<double>(n * nv), forces = std::vector<double>(n * rows);
  std::vector<int> status = std::vector<int>(n, 7);
  Given<3, true> front{0};
  Given<6, true> hind{1};
  Given<3, false> rod{2};
  quadruped::Workspace workspace;

  ContactBatches() {
    for (std::size_t s = 0; s < n; ++s) Eigen::Map<Eigen::Vector4d>(q.data() + s * nq + 3).normalize();
    workspace.payload_base.mass = 3, workspace.payload_base.com[0] = 0.2;
  }

  quadruped::Batch batch() {
    quadruped::Batch batch;
    batch.count = n, batch.q = q.data(), batch.v = v.data(), batch.input = tau.data(), batch.workspace = &workspace;
    batch.contacts_front = front.numbers.data(), batch.contacts_hind = hind.numbers.data();
    batch.loops_rod = rod.numbers.data();
    return batch;
  }
  void run(const quadruped::Batch& batch) {
    quadruped::HeldBatchResults results;
    results.held_constrained_forward_dynamics = accelerations.data(), results.held_constraint_forces = forces.data();
    results.status = status.data();
    ASSERT_EQ(quadruped::held_batch(batch, results), BatchError::none);
  }
  void set(std::size_t s) {
    front.set(s, workspace.contact_front), hind.set(s, workspace.contact_hind), rod.set(s, workspace.loop_rod);
  }
};

template <class A, class B>
void expect_near(const A& given, const B& expected, double tolerance, const std::string& what) {
  EXPECT_LE((given - expected).cwiseAbs().maxCoeff(), tolerance * (1e-3 + expected.cwiseAbs().maxCoeff())) << what;
}

TEST_F(ContactBatches, GiveWhatSingleCallsGive) {
  run(batch());
  for (std::size_t s = 0; s < n; ++s) {
    set(s);
    quadruped::held(&q[s * nq], &v[s * nv], &tau[s * nv], workspace);
    expect_near(state(accelerations, s, nv), single(workspace.held_constrained_forward_dynamics), 1e-11, "dv");
    expect_near(state(forces, s, rows), single(workspace.held_constraint_forces), 1e-11, "f");
    EXPECT_EQ(status[s], -1);
    for (int r = 0; r < 3 && !workspace.contact_front.active; ++r) EXPECT_EQ(state(forces, s, rows)[r], 0);
  }
}

TEST_F(ContactBatches, TellRowsAndImpacts) {
  std::vector<double> J(n * rows * nv), bias(n * rows), delassus(n * rows * rows), after(n * nv);
  quadruped::ToldBatchResults told;
  told.told_constraint_jacobian = J.data(), told.told_constraint_bias = bias.data();
  told.told_delassus_matrix = delassus.data();
  ASSERT_EQ(quadruped::told_batch(batch(), told), BatchError::none);
  quadruped::StruckBatchResults struck;
  struck.struck_impact = after.data();
  ASSERT_EQ(quadruped::struck_batch(batch(), struck), BatchError::none);
  using ByRows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const auto matrix = [](const std::vector<double>& of, std::size_t s, int columns) {
    return Eigen::Map<const ByRows>(of.data() + s * static_cast<std::size_t>(rows * columns), rows, columns);
  };
  for (std::size_t s = 0; s < n; ++s) {
    set(s);
    quadruped::told(&q[s * nq], &v[s * nv], workspace);
    quadruped::struck(&q[s * nq], &v[s * nv], workspace);
    expect_near(matrix(J, s, nv), single(workspace.told_constraint_jacobian, nv), 1e-14, "J");
    expect_near(state(bias, s, rows), single(workspace.told_constraint_bias), 1e-13, "dJ v");
    expect_near(matrix(delassus, s, rows), single(workspace.told_delassus_matrix, rows), 1e-12, "J M^-1 J'");
    expect_near(state(after, s, nv), single(workspace.struck_impact), 1e-11, "v after");
  }
}

// Whatever the weights are in all: their ratios count. What is none bears nothing.
TEST_F(ContactBatches, BearWhatSingleCallsSay) {
  using Limits = std::numeric_limits<double>;
  quadruped::BorneBatchResults results;
  results.borne_constrained_inverse_dynamics = accelerations.data(), results.borne_inverse_constraint_forces = forces.data();
  for (const double size : {1.0, 1e-290, 1e200, Limits::max() / 4}) {
    for (std::size_t s = 0; s < n; ++s) hind.numbers[s * hind.size] = 1;  // six rows bear all
    const Given<3, true> front_before = front;
    const Given<6, true> hind_before = hind;
    const Given<3, false> rod_before = rod;
    front.scale_weights(size), hind.scale_weights(size), rod.scale_weights(size);
    front.numbers[2 * front.size - 2] = -size, front.numbers[3 * front.size - 1] = Limits::infinity();
    front.numbers[4 * front.size - 3] = Limits::quiet_NaN();
    ASSERT_EQ(quadruped::borne_batch(batch(), results), BatchError::none);
    for (std::size_t s = 0; s < n; ++s) {
      set(s);
      quadruped::borne(&q[s * nq], &v[s * nv], &tau[s * nv], workspace);
      expect_near(state(accelerations, s, nv), single(workspace.borne_constrained_inverse_dynamics), 1e-11, "tau");
      expect_near(state(forces, s, rows), single(workspace.borne_inverse_constraint_forces), 1e-11, "f");
    }
    front = front_before, hind = hind_before, rod = rod_before;
  }
}

// Without numbers of each state they are the workspace's, and without that a new one's.
TEST_F(ContactBatches, HoldAsTheWorkspaceSays) {
  quadruped::Batch one = batch();
  one.contacts_front = one.contacts_hind = one.loops_rod = nullptr;
  for (const bool with_workspace : {true, false}) {
    if (with_workspace) set(4);
    else workspace = {}, one.workspace = nullptr;
    run(one);
    for (std::size_t s = 0; s < n; ++s) {
      quadruped::held(&q[s * nq], &v[s * nv], &tau[s * nv], workspace);
      expect_near(state(accelerations, s, nv), single(workspace.held_constrained_forward_dynamics), 1e-11, "dv");
    }
  }
}

// What is off may be given no numbers, and changes nobody's bits; nor does what another state is given.
TEST_F(ContactBatches, WhatIsOffIsNotRead) {
  run(batch());
  const std::vector<double> accelerations_before = accelerations, forces_before = forces;
  std::size_t off = 0;
  for (std::size_t s = 0; s < n; ++s) {
    double* const own = front.numbers.data() + s * front.size;
    if (own[0] > 0) continue;
    std::fill_n(own + 1, front.size - 1, std::numeric_limits<double>::quiet_NaN()), ++off;
  }
  ASSERT_GT(off, 0u);
  run(batch());
  EXPECT_EQ(accelerations, accelerations_before);
  EXPECT_EQ(forces, forces_before);
}

// Six rows of two joints, in float: rows that say the same twice bear something, and the arm stays where it is held.
TEST(RedundantContactBatches, GiveWhatSingleCallsGive) {
  constexpr int size = welded_arm::nv;
  std::vector<float> q, v(n * size, 0.f), tau, accelerations(n * size), forces(n * 6);
  for (const double x : random_numbers(n * size, 4)) q.push_back(static_cast<float>(x));
  for (const double x : random_numbers(n * size, 5)) tau.push_back(static_cast<float>(x));
  welded_arm::Batch batch;
  batch.count = n, batch.q = q.data(), batch.v = v.data(), batch.input = tau.data();
  welded_arm::ForwardDynamicsBatchResults results;
  results.constrained_forward_dynamics = accelerations.data(), results.constraint_forces = forces.data();
  ASSERT_EQ(welded_arm::forward_dynamics_batch(batch, results), BatchError::none);
  welded_arm::Workspace workspace;
  for (std::size_t s = 0; s < n; ++s) {
    welded_arm::forward_dynamics(&q[s * size], &v[s * size], &tau[s * size], workspace);
    EXPECT_LE(state(accelerations, s, size).cwiseAbs().maxCoeff(), 1e-3f);
    const auto expected = single(workspace.constraint_forces);
    EXPECT_LE((state(forces, s, 6) - expected).cwiseAbs().maxCoeff(), 5e-2f * expected.cwiseAbs().maxCoeff());
  }
}

}  // namespace
