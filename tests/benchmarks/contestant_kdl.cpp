// KDL, whose solver for M knows chains only. Built from our tree: its own parser drops the root's inertia.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <kdl/chain.hpp>
#include <kdl/chaindynparam.hpp>
#include <kdl/chainfdsolver_recursive_newton_euler.hpp>
#include <kdl/chainidsolver_recursive_newton_euler.hpp>
#include <memory>
#include <vector>

#include "contestants.hpp"

namespace dalembert::benchmarks {
namespace {

KDL::Vector to_kdl(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

KDL::Frame to_kdl(const Eigen::Isometry3d& pose) {
  const Eigen::Matrix3d R = pose.linear();
  return {KDL::Rotation(R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1), R(1, 2), R(2, 0), R(2, 1), R(2, 2)),
          to_kdl(pose.translation())};
}

KDL::RigidBodyInertia to_kdl(const ir::Inertia& inertia) {
  const Eigen::Matrix3d& I = inertia.inertia;
  return KDL::RigidBodyInertia(inertia.mass, to_kdl(inertia.com),
                               KDL::RotationalInertia(I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2)));
}

KDL::Chain chain_of(const ir::KinematicTree& tree) {
  KDL::Chain chain;
  for (const ir::Body& body : tree.bodies) {
    // A segment begins with its joint, which KDL places in the parent's frame.
    const KDL::Joint joint(body.joint, to_kdl(body.placement.translation()), to_kdl(body.placement.linear() * body.axis),
                           body.turns() ? KDL::Joint::RotAxis : KDL::Joint::TransAxis);
    chain.addSegment(KDL::Segment(body.name, joint, to_kdl(body.placement), to_kdl(body.inertia)));
  }
  return chain;
}

}  // namespace

bool kdl_offers(Quantities quantities) {
  return quantities == Quantities::M || quantities == Quantities::gravity || quantities == Quantities::bias ||
         quantities == Quantities::inverse_dynamics || quantities == Quantities::forward_dynamics;
}

Contestant kdl_contestant(const BenchmarkRobot& robot, Quantities quantities) {
  const auto& bodies = robot.tree().bodies;
  const bool chain =
      std::is_sorted(bodies.begin(), bodies.end(), [](const auto& a, const auto& b) { return a.parent < b.parent; });
  if (!kdl_offers(quantities) || robot.tree().base_coordinates() > 0 || !chain) return {};
  struct Computation {
    KDL::Chain chain;
    KDL::ChainDynParam parameters;
    KDL::ChainIdSolver_RNE newton_euler;
    KDL::ChainFdSolver_RNE forward;
    std::vector<KDL::JntArray> q, v, accelerations, efforts;
    KDL::JntArray zero, forces;
    KDL::JntSpaceInertiaMatrix mass_matrix;
    KDL::Wrenches external;

    Computation(const KDL::Chain& c, const KDL::Vector& gravity)
        : chain(c),
          parameters(chain, gravity),
          newton_euler(chain, gravity),
          forward(chain, gravity),
          zero(chain.getNrOfJoints()),
          forces(chain.getNrOfJoints()),
          mass_matrix(chain.getNrOfJoints()),
          external(chain.getNrOfSegments(), KDL::Wrench::Zero()) {}

    void run(int state, Quantities wanted) {
      const auto index = static_cast<size_t>(state);
      if (wanted == Quantities::M) parameters.JntToMass(q[index], mass_matrix);
      if (wanted == Quantities::gravity) parameters.JntToGravity(q[index], forces);
      if (wanted == Quantities::bias) newton_euler.CartToJnt(q[index], v[index], zero, external, forces);
      if (wanted == Quantities::inverse_dynamics)
        newton_euler.CartToJnt(q[index], v[index], accelerations[index], external, forces);
      if (wanted == Quantities::forward_dynamics) forward.CartToJnt(q[index], v[index], efforts[index], external, forces);
      benchmark::DoNotOptimize(forces.data.data());
      benchmark::DoNotOptimize(mass_matrix.data.data());
    }
  };
  const auto c = std::make_shared<Computation>(chain_of(robot.tree()), to_kdl(robot.gravity()));
  const auto array = [](const Eigen::VectorXd& values) {
    KDL::JntArray result(static_cast<unsigned>(values.size()));
    result.data = values;
    return result;
  };
  for (int i = 0; i < BenchmarkRobot::state_count; ++i) {
    const testing::State& state = robot.states()[static_cast<size_t>(i)];
    c->q.push_back(array(state.q));
    c->v.push_back(array(state.v));
    c->accelerations.push_back(array(robot.more(ir::Function::inverse_dynamics, i)));
    c->efforts.push_back(array(robot.more(ir::Function::forward_dynamics, i)));
  }
  return {[c, quantities](int state) { c->run(state, quantities); },
          [c, quantities](int state) {
            c->run(state, quantities);
            Results results;
            switch (quantities) {
              case Quantities::M: results[ir::Quantity::mass_matrix] = c->mass_matrix.data; break;
              case Quantities::gravity: results[ir::Quantity::gravity] = c->forces.data; break;
              case Quantities::bias: results[ir::Quantity::bias] = c->forces.data; break;
              case Quantities::inverse_dynamics: results[ir::Quantity::inverse_dynamics] = c->forces.data; break;
              case Quantities::forward_dynamics: results[ir::Quantity::forward_dynamics] = c->forces.data; break;
              default: break;
            }
            return results;
          }};
}

}  // namespace dalembert::benchmarks
