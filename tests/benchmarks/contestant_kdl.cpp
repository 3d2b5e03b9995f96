// KDL, whose solver for M knows chains only. Built from our tree: its own parser drops the root's inertia.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <kdl/chain.hpp>
#include <kdl/chaindynparam.hpp>
#include <kdl/chainidsolver_recursive_newton_euler.hpp>

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
                           body.prismatic() ? KDL::Joint::TransAxis : KDL::Joint::RotAxis);
    chain.addSegment(KDL::Segment(body.name, joint, to_kdl(body.placement), to_kdl(body.inertia)));
  }
  return chain;
}

}  // namespace

Contestant kdl_contestant(const BenchmarkRobot& robot, Quantities quantities) {
  const auto& bodies = robot.tree().bodies;
  const bool chain =
      std::is_sorted(bodies.begin(), bodies.end(), [](const auto& a, const auto& b) { return a.parent < b.parent; });
  if (!peers_offer(quantities) || robot.tree().floating_base || !chain) return {};
  struct Computation {
    KDL::Chain chain;
    KDL::ChainDynParam parameters;
    KDL::ChainIdSolver_RNE newton_euler;
    std::vector<KDL::JntArray> q, v;
    KDL::JntArray zero, forces;
    KDL::JntSpaceInertiaMatrix mass_matrix;
    KDL::Wrenches external;

    Computation(const KDL::Chain& c, const KDL::Vector& gravity)
        : chain(c),
          parameters(chain, gravity),
          newton_euler(chain, gravity),
          zero(chain.getNrOfJoints()),
          forces(chain.getNrOfJoints()),
          mass_matrix(chain.getNrOfJoints()),
          external(chain.getNrOfSegments(), KDL::Wrench::Zero()) {}

    void run(int state, Quantities wanted) {
      const auto index = static_cast<size_t>(state);
      if (wanted == Quantities::M) parameters.JntToMass(q[index], mass_matrix);
      if (wanted == Quantities::gravity) parameters.JntToGravity(q[index], forces);
      if (wanted == Quantities::bias) newton_euler.CartToJnt(q[index], v[index], zero, external, forces);
      benchmark::DoNotOptimize(forces.data.data());
      benchmark::DoNotOptimize(mass_matrix.data.data());
    }
  };
  const auto c = std::make_shared<Computation>(chain_of(robot.tree()), to_kdl(robot.gravity()));
  for (const testing::State& state : robot.states()) {
    KDL::JntArray q(static_cast<unsigned>(state.q.size())), v(static_cast<unsigned>(state.v.size()));
    q.data = state.q;
    v.data = state.v;
    c->q.push_back(q);
    c->v.push_back(v);
  }
  return {[c, quantities](int state) { c->run(state, quantities); },
          [c, quantities](int state) {
            c->run(state, quantities);
            Results results;
            if (quantities == Quantities::M) results.mass_matrix = c->mass_matrix.data;
            if (quantities == Quantities::gravity) results.gravity = c->forces.data;
            if (quantities == Quantities::bias) results.bias = c->forces.data;
            return results;
          }};
}

}  // namespace dalembert::benchmarks
