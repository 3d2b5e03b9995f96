#include "reference/trajectory.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <boost/numeric/odeint.hpp>
#include <boost/version.hpp>
#include <memory>
#include <vector>

#include "reference/engine.hpp"
#include "reference/generic_model.hpp"
#include "reference/instances.hpp"

namespace dalembert::reference {
namespace {

using Long = long double;
using Flat = std::vector<Long>;  // q, then v

class FreeMotion {
 public:
  FreeMotion(const ir::KinematicTree& tree, const ir::Scene& scene)
      : robot_(to_generic<Long>(tree, scene.gravity)), nq_(tree.nq()), nv_(tree.nv()) {}

  void operator()(const Flat& state, Flat& rate, Long) const {
    if (++*evaluations_ > 100'000) throw NoTrajectory("the motion from a random state is too fast to be followed");
    const VectorX<Long> q = Eigen::Map<const VectorX<Long>>(state.data(), nq_);
    const VectorX<Long> v = Eigen::Map<const VectorX<Long>>(state.data() + nq_, nv_);
    Eigen::Map<VectorX<Long>> q_rate(rate.data(), nq_), v_rate(rate.data() + nq_, nv_);
    const Eigen::Index base = robot_.floating_base ? 6 : 0;
    if (base) {
      const Eigen::Quaternion<Long> turned(q[6], q[3], q[4], q[5]), turning(0, v[3], v[4], v[5]);
      q_rate.head<3>() = rotation_of_quaternion<Long>(q[3], q[4], q[5], q[6]) * v.head<3>();
      q_rate.segment<4>(3) = (turned * turning).coeffs() / 2;
    }
    Eigen::Index at = base ? 7 : 0;  // in q
    for (Eigen::Index i = base; i < nv_;) {
      const generic::Body<Long>* const joint = with_quaternion(static_cast<int>(i - base));
      if (!joint) {
        q_rate[at++] = v[i++];
        continue;
      }
      if (joint->parts == 6) {
        q_rate.segment<3>(at) = rotation_of_quaternion<Long>(q[at + 3], q[at + 4], q[at + 5], q[at + 6]) * v.segment<3>(i);
        at += 3, i += 3;
      }
      const Eigen::Quaternion<Long> turned(q[at + 3], q[at], q[at + 1], q[at + 2]), turning(0, v[i], v[i + 1], v[i + 2]);
      q_rate.segment<4>(at) = (turned * turning).coeffs() / 2;
      at += 4, i += 3;
    }
    v_rate = -generic::mass_matrix<Long>(robot_, q).ldlt().solve(generic::bias<Long>(robot_, q, v));
    if (!v_rate.allFinite()) throw NoTrajectory("the mass matrix is singular");
  }

 private:
  // The joint whose coordinates begin there, if it has a quaternion.
  const generic::Body<Long>* with_quaternion(int coordinate) const {
    for (int k = 0; k < robot_.joints(); ++k)
      if (const auto& body = robot_.bodies[static_cast<size_t>(k)];
          body.part == 0 && (robot_.coordinates.empty() ? k : robot_.coordinates[static_cast<size_t>(k)].index) == coordinate)
        return &body;
    return nullptr;
  }

  generic::Model<Long> robot_;
  Eigen::Index nq_, nv_;
  std::shared_ptr<int> evaluations_ = std::make_shared<int>(0);  // the integrator copies us
};

}  // namespace

Motion trajectory(const ir::KinematicTree& tree, const ir::Scene& scene, const Motion& start, double seconds) {
  namespace odeint = boost::numeric::odeint;
  Flat state(start.q.data(), start.q.data() + start.q.size());
  state.insert(state.end(), start.v.data(), start.v.data() + start.v.size());
  const auto stepper = odeint::make_controlled<odeint::runge_kutta_fehlberg78<Flat, Long>>(Long(1e-16), Long(1e-16));
  try {
    odeint::integrate_adaptive(stepper, FreeMotion(tree, scene), state, Long(0), Long(seconds), Long(1e-3));
  } catch (const odeint::step_adjustment_error&) {
    throw NoTrajectory("the motion from a random state is too uneven to be followed");
  }
  const Eigen::Map<const VectorX<Long>> end(state.data(), static_cast<Eigen::Index>(state.size()));
  return {end.head(start.q.size()).cast<double>(), end.tail(start.v.size()).cast<double>()};
}

std::string trajectory_program() {
  return "Boost.Odeint " + std::to_string(BOOST_VERSION / 100000) + "." + std::to_string(BOOST_VERSION / 100 % 1000) + "." +
         std::to_string(BOOST_VERSION % 100);
}

double kinetic_energy(const ir::KinematicTree& tree, const ir::Scene& scene, const Motion& at) {
  const Eigen::MatrixXd M = evaluate(tree, scene, {{ir::Quantity::mass_matrix, ""}}, {at.q, at.v}, Precision::float64).front();
  return at.v.dot(M * at.v) / 2;
}

double potential_energy(const ir::KinematicTree& tree, const ir::Scene& scene, const Motion& at) {
  return evaluate(tree, scene, {{ir::Quantity::potential_energy, ""}}, {at.q, at.v}, Precision::float64).front()(0, 0);
}

}  // namespace dalembert::reference
