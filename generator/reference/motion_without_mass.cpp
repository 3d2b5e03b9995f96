#include "reference/motion_without_mass.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <random>

#include "reference/digits50.hpp"

namespace dalembert::reference {

namespace {

size_t at(int index) { return static_cast<size_t>(index); }

// Uniform in ±1, the same on every system.
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : engine_(seed) {}
  double operator()() { return static_cast<double>(engine_() >> 11) * 0x1p-52 - 1; }

 private:
  std::mt19937_64 engine_;
};

template <class S>
using Matrix3 = Eigen::Matrix<S, 3, 3>;
template <class S>
using Matrix6 = Eigen::Matrix<S, 6, 6>;
template <class S>
using Vector3 = Eigen::Matrix<S, 3, 1>;
template <class S>
using Vector6 = Eigen::Matrix<S, 6, 1>;  // linear part first

template <class S>
Matrix3<S> cross(const Vector3<S>& a) {
  Matrix3<S> matrix;
  matrix << S(0), -a[2], a[1], a[2], S(0), -a[0], -a[1], a[0], S(0);
  return matrix;
}

template <class S>
Matrix6<S> spatial(const ir::Inertia& inertia) {
  const Matrix3<S> c = cross<S>(inertia.com.cast<S>());
  const S mass(inertia.mass);
  Matrix6<S> matrix;
  matrix << mass * Matrix3<S>::Identity(), -mass * c, mass * c, inertia.inertia.cast<S>() - mass * c * c;
  return matrix;
}

// The tree with every number off by at most 1e-15 of itself. Zeros stay: what they say is exact.
ir::KinematicTree differently_rounded(ir::KinematicTree tree, Draw& draw) {
  const auto round = [&](double& x) { x *= 1 + 1e-15 * draw(); };
  const auto round_inertia = [&](ir::Inertia& inertia) {
    round(inertia.mass);
    for (double& x : inertia.com) round(x);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j <= i; ++j) {
        round(inertia.inertia(i, j));
        inertia.inertia(j, i) = inertia.inertia(i, j);
      }
  };
  round_inertia(tree.base);
  for (ir::Body& body : tree.bodies) {
    round_inertia(body.inertia);
    for (int i = 0; i < 3; ++i) {
      round(body.axis[i]);
      for (int j = 0; j < 4; ++j) round(body.placement.matrix()(i, j));
    }
    round(body.armature);
  }
  return tree;
}

// One robot on its way from the tips to the base. Index 0 is the base, k + 1 body k.
template <class S>
struct Elimination {
  std::vector<Matrix6<S>> inertia;   // of the body and, articulated, of all beyond it
  std::vector<Matrix6<S>> to_child;  // takes the parent's twist to the body's
  std::vector<Vector6<S>> axis;      // twist of the body for its joint's rate 1
  std::vector<Vector6<S>> handed;    // Iᴬ s
  std::vector<S> pivot, whole;       // D; and M's element, before anything cancels
  Vector6<S> whole_base;             // likewise

  Elimination(const ir::KinematicTree& tree, const ir::Scene& scene, const std::vector<double>& q) {
    const size_t n = tree.bodies.size() + 1;
    inertia.push_back(spatial<S>(tree.base));
    to_child.assign(n, Matrix6<S>::Identity());
    axis.assign(n, Vector6<S>::Zero());
    handed = axis;
    pivot.assign(n, S(0));
    whole = pivot;
    for (size_t k = 1; k < n; ++k) {
      const ir::Body& body = tree.bodies[k - 1];
      inertia.push_back(spatial<S>(body.inertia));
      const Vector3<S> direction = body.axis.cast<S>();
      Matrix3<S> rotation = body.placement.linear().cast<S>();
      Vector3<S> position = body.placement.translation().cast<S>();
      using std::cos, std::sin;
      const S angle(q[k - 1]);
      if (!body.turns()) position += rotation * direction * angle;
      else {
        const Matrix3<S> a = cross<S>(direction);
        position += rotation * direction * (S(body.slide_per_unit()) * angle);
        rotation = (rotation * (Matrix3<S>::Identity() + sin(angle) * a + (S(1) - cos(angle)) * a * a)).eval();
      }
      axis[k].template head<3>() = S(body.slide_per_unit()) * direction;
      if (body.turns()) axis[k].template tail<3>() = direction;
      to_child[k] << rotation.transpose(), -rotation.transpose() * cross<S>(position), Matrix3<S>::Zero(), rotation.transpose();
    }
    const ir::Inertia something{1, {0.2, -0.3, 0.5}, Eigen::Vector3d(1, 1.2, 1.5).asDiagonal()};
    for (const ir::LinkPlacement& link : tree.links)
      if (scene.has_payload(link.link)) inertia[at(link.body + 1)] += spatial<S>(something);
    std::vector<Matrix6<S>> composite = inertia;
    for (size_t k = n; k-- > 1;) {
      const Vector6<S> along = axis[k].cwiseAbs();
      whole[k] = along.dot(composite[k].cwiseAbs() * along) + S(tree.bodies[k - 1].armature);
      composite[at(tree.bodies[k - 1].parent + 1)] += to_child[k].transpose() * composite[k] * to_child[k];
    }
    whole_base = composite[0].diagonal();
  }

  // What of the body's inertia its joint hands on to the parent: all of it, where the joint moves none.
  void hand_on(size_t k, size_t parent, bool moves_none) {
    Matrix6<S> rest = inertia[k];
    if (!moves_none) rest -= handed[k] * handed[k].transpose() / pivot[k];
    inertia[parent] += to_child[k].transpose() * rest * to_child[k];
  }
};

// The pivots of one robot, or of one and its neighbours step by step.
template <class S>
class Pivots {
 public:
  // Keeps a reference to the robots. `least`: what counts as zero, of the size of M's element.
  Pivots(const std::vector<ir::KinematicTree>& robots, const ir::Scene& scene, const std::vector<double>& q, double least)
      : tree_(robots.front()), least_(least), zero_(tree_.bodies.size() + 1, false) {
    for (const ir::KinematicTree& robot : robots) all_.emplace_back(robot, scene, q);
  }

  // Whether a pivot was zero, or M is not positive semidefinite: known after motions().
  bool any_zero() const { return any_zero_ || indefinite_; }

  // Motions without mass at this state, by the coordinate that starts them (0 to 5: the base's, 6 + k: of body k); empty as
  // well where M is not positive semidefinite.
  std::map<int, MotionWithoutMass> motions() {
    const size_t n = tree_.bodies.size() + 1;
    std::map<int, MotionWithoutMass> motions;
    for (size_t k = n; k-- > 1;) {
      for (Elimination<S>& one : all_) {
        one.handed[k] = one.inertia[k] * one.axis[k];
        one.pivot[k] = one.axis[k].dot(one.handed[k]) + S(tree_.bodies[k - 1].armature);
      }
      std::vector<S> pivots;
      for (const Elimination<S>& one : all_) pivots.push_back(one.pivot[k]);
      zero_[k] = is_zero(pivots, all_.front().whole[k]);
      if (indefinite_) return {};
      if (zero_[k]) add(motions, 5 + static_cast<int>(k), Vector6<S>::Zero());
      for (Elimination<S>& one : all_) one.hand_on(k, at(tree_.bodies[k - 1].parent + 1), zero_[k]);
    }
    if (tree_.base_coordinates() > 0) base(motions);
    return indefinite_ ? std::map<int, MotionWithoutMass>{} : motions;
  }

 private:
  // A pivot of each of the robots, and the size of M's element, before anything cancels.
  bool is_zero(const std::vector<S>& pivots, const S& whole) {
    S noise(0);
    for (const S& pivot : pivots) {
      using std::abs;
      noise = std::max<S>(noise, abs(pivot - pivots.front()));
    }
    const S limit = S(4) * noise + S(least_) * whole;
    if (pivots.front() < -limit) indefinite_ = true;
    const bool zero = !(pivots.front() > limit);
    any_zero_ = any_zero_ || zero;
    return zero;
  }

  void base(std::map<int, MotionWithoutMass>& motions) {
    std::array<bool, 6> zero{};
    std::vector<Matrix6<S>> rest;
    for (const Elimination<S>& one : all_) rest.push_back(one.inertia[0]);
    Matrix6<S> rows = Matrix6<S>::Zero();  // as they stood when eliminated
    for (int i = 0; i < 6; ++i) {
      std::vector<S> pivots;
      for (const Matrix6<S>& matrix : rest) pivots.push_back(matrix(i, i));
      zero[at(i)] = is_zero(pivots, all_.front().whole_base[i]);
      rows.row(i) = rest.front().row(i);
      if (zero[at(i)]) {
        Vector6<S> twist = Vector6<S>::Unit(i);
        for (int j = i; j-- > 0;)
          if (!zero[at(j)]) twist[j] = -rows.row(j).tail(5 - j).dot(twist.tail(5 - j)) / rows(j, j);
        add(motions, i, twist);
        continue;
      }
      for (Matrix6<S>& matrix : rest) matrix -= (matrix.col(i) * matrix.row(i) / matrix(i, i)).eval();
    }
  }

  // The motion that begins with rate 1 of a coordinate; every joint beyond it moves as it would by itself.
  void add(std::map<int, MotionWithoutMass>& motions, int start, const Vector6<S>& base) {
    const Elimination<S>& robot = all_.front();
    std::vector<Vector6<S>> twist(robot.axis.size(), Vector6<S>::Zero());
    std::vector<S> rate(robot.axis.size(), S(0));
    twist[0] = base;
    S largest(start < 6 ? 1 : 0);
    using std::abs;
    for (size_t k = 1; k < rate.size(); ++k) {
      if (5 + static_cast<int>(k) < start) continue;
      const Vector6<S> carried = robot.to_child[k] * twist[at(tree_.bodies[k - 1].parent + 1)];
      if (5 + static_cast<int>(k) == start) rate[k] = S(1);
      else if (!zero_[k]) rate[k] = -robot.handed[k].dot(carried) / robot.pivot[k];
      twist[k] = carried + robot.axis[k] * rate[k];
      if (abs(rate[k]) > largest) largest = abs(rate[k]);
    }
    MotionWithoutMass motion{start < 6, {}};
    const S none = S(1e-9) * largest;
    for (size_t k = 0; k < tree_.bodies.size(); ++k) {
      if (abs(rate[k + 1]) > none) motion.bodies.push_back(static_cast<int>(k));
      const ir::Body& body = tree_.bodies[k];
      if (body.driven() && abs(rate[k + 1] - S(body.multiplier) * rate[at(body.driven_by + 1)]) > none) return;
    }
    motions.emplace(start, motion);
  }

  const ir::KinematicTree& tree_;
  double least_;
  std::vector<Elimination<S>> all_;
  std::vector<bool> zero_;
  bool any_zero_ = false, indefinite_ = false;
};

}  // namespace

std::optional<MotionWithoutMass> motion_without_mass(const ir::KinematicTree& tree, const ir::Scene& scene) {
  Draw draw(28);
  const auto position = [&] {
    std::vector<double> q;
    for (size_t k = 0; k < tree.bodies.size(); ++k) q.push_back(draw());
    for (size_t k = 0; k < q.size(); ++k)
      if (const ir::Body& body = tree.bodies[k]; body.driven())
        q[k] = body.multiplier * q[at(body.driven_by)] + body.offset;  // a driver is never driven
    return q;
  };
  const std::vector<ir::KinematicTree> itself{tree};
  Pivots<double> in_double(itself, scene, position(), 1e-10);
  in_double.motions();
  if (!in_double.any_zero()) return std::nullopt;

  std::map<int, MotionWithoutMass> always;
  for (int state = 0; state < 3; ++state) {
    const std::vector<ir::KinematicTree> robots{tree, differently_rounded(tree, draw), differently_rounded(tree, draw)};
    std::map<int, MotionWithoutMass> here = Pivots<Digits50>(robots, scene, position(), 1e-40).motions();
    if (state > 0) std::erase_if(here, [&](const auto& motion) { return !always.count(motion.first); });
    always = std::move(here);
    if (always.empty()) return std::nullopt;
  }
  return always.begin()->second;
}

}  // namespace dalembert::reference
