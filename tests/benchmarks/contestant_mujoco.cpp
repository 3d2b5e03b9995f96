// MuJoCo, through the oracle that the tests use. It has no constraints here, so that its dynamics are the smooth ones alone: of
// its functions those are called that the quantity needs, in the order in which mj_forward calls them.
#include <benchmark/benchmark.h>

#include <memory>

#include "contestants.hpp"
#include "mujoco_oracle.hpp"
#include "oracle_request.hpp"

namespace dalembert::benchmarks {
namespace {

using ir::Quantity;
using oracle::MujocoOracle;

// One call: its inputs, in MuJoCo's coordinates of a floating base, and its result in these.
struct Computation {
  MujocoOracle oracle;
  Quantities quantities;
  std::vector<Eigen::VectorXd> qpos, qvel, qacc, forces;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> result, identity;
  Eigen::VectorXd between;

  Computation(const BenchmarkRobot& robot, Quantities wanted)
      : oracle(request_for(robot), oracle::Inertias::overwritten), quantities(wanted) {
    oracle.overwrite_inertias(robot.tree());
    if (quantities == Quantities::energy) oracle.model()->opt.enableflags |= mjENBL_ENERGY;  // else both are zero
    const int nv = oracle.model()->nv;
    const bool matrix = quantities == Quantities::M || quantities == Quantities::inverse_mass_matrix;
    result.resize(quantities == Quantities::center_of_mass ? 3 : nv,
                  matrix || quantities == Quantities::center_of_mass ? nv : 1);
    identity.setIdentity(nv, nv);
    between.resize(nv);
    for (int i = 0; i < BenchmarkRobot::state_count; ++i) {
      const testing::State& state = robot.states()[static_cast<size_t>(i)];
      const bool rest = quantities == Quantities::gravity;
      oracle.set_state(state.q, rest ? Eigen::VectorXd::Zero(nv) : state.v);
      qpos.emplace_back(Eigen::Map<Eigen::VectorXd>(oracle.data()->qpos, oracle.model()->nq));
      qvel.emplace_back(Eigen::Map<Eigen::VectorXd>(oracle.data()->qvel, nv));
      const auto [transform, drift] = oracle.change_of_coordinates(state.q, state.v);
      qacc.emplace_back(transform * robot.more(ir::Function::inverse_dynamics, i) + drift);
      forces.emplace_back(transform * robot.more(ir::Function::forward_dynamics, i));
    }
  }

  void run(int state) {
    const auto index = static_cast<size_t>(state);
    const mjModel* const m = oracle.model();
    mjData* const d = oracle.data();
    Eigen::Map<Eigen::VectorXd>(d->qpos, m->nq) = qpos[index];
    Eigen::Map<Eigen::VectorXd>(d->qvel, m->nv) = qvel[index];
    mj_kinematics(m, d);
    mj_comPos(m, d);
    switch (quantities) {
      case Quantities::M:
        mj_crb(m, d);
        mj_fullM(m, result.data(), d->qM);
        break;
      case Quantities::inverse_mass_matrix:
        mj_crb(m, d);
        mj_factorM(m, d);
        mj_solveM(m, d, result.data(), identity.data(), m->nv);
        break;
      case Quantities::gravity:
      case Quantities::bias:
        mj_comVel(m, d);
        mj_rne(m, d, 0, result.data());
        break;
      case Quantities::inverse_dynamics:
        Eigen::Map<Eigen::VectorXd>(d->qacc, m->nv) = qacc[index];
        mj_comVel(m, d);
        mj_rne(m, d, 1, result.data());
        break;
      case Quantities::forward_dynamics:
        mj_crb(m, d);
        mj_factorM(m, d);
        mj_comVel(m, d);
        mj_rne(m, d, 0, d->qfrc_bias);
        between = forces[index] - Eigen::Map<Eigen::VectorXd>(d->qfrc_bias, m->nv);
        mj_solveM(m, d, result.data(), between.data(), 1);
        break;
      case Quantities::center_of_mass: mj_jacSubtreeCom(m, d, result.data(), 0); break;  // 0: the world's subtree
      case Quantities::energy:
        mj_crb(m, d);  // of which mj_energyVel makes the kinetic energy
        mj_energyPos(m, d);
        mj_energyVel(m, d);
        break;
      default: break;
    }
    benchmark::DoNotOptimize(result.data());
  }

  // Of the call before, at this state, in our coordinates.
  Results in_ours(const testing::State& state) const {
    const auto [transform, drift] = oracle.change_of_coordinates(state.q, state.v);
    const mjData& d = *oracle.data();
    switch (quantities) {
      case Quantities::M: return {{Quantity::mass_matrix, transform.transpose() * result * transform}};
      case Quantities::inverse_mass_matrix:
        return {{Quantity::inverse_mass_matrix, transform.transpose() * result * transform}};  // the transform is orthogonal
      case Quantities::inverse_dynamics: return {{Quantity::inverse_dynamics, transform.transpose() * result}};
      case Quantities::forward_dynamics: return {{Quantity::forward_dynamics, transform.transpose() * (result - drift)}};
      case Quantities::center_of_mass:
        return {{Quantity::center_of_mass, Eigen::Map<const Eigen::Vector3d>(d.subtree_com)},
                {Quantity::center_of_mass_jacobian, result * transform}};
      case Quantities::energy:
        return {{Quantity::kinetic_energy, Eigen::MatrixXd::Constant(1, 1, d.energy[1])},
                {Quantity::potential_energy, Eigen::MatrixXd::Constant(1, 1, d.energy[0])}};
      default: return {};
    }
  }
};

}  // namespace

bool mujoco_offers(Quantities quantities) {
  switch (quantities) {
    case Quantities::M:
    case Quantities::gravity:
    case Quantities::bias:
    case Quantities::inverse_dynamics:
    case Quantities::forward_dynamics:
    case Quantities::inverse_mass_matrix:
    case Quantities::center_of_mass:
    case Quantities::energy: return true;
    default: return false;
  }
}

Contestant mujoco_contestant(const BenchmarkRobot& robot, Quantities quantities) {
  if (!mujoco_offers(quantities)) return {};
  const auto c = std::make_shared<Computation>(robot, quantities);
  Contestant contestant;
  contestant.run = [c](int state) { c->run(state); };
  contestant.results = [c, &robot, quantities](int index) -> Results {
    const testing::State& state = robot.states()[static_cast<size_t>(index)];
    // The base's drift enters the bias through M, which the timed call does not compute.
    if (quantities == Quantities::bias) return {{Quantity::bias, c->oracle.evaluate(state.q, state.v).bias}};
    if (quantities == Quantities::gravity) return {{Quantity::gravity, c->oracle.evaluate(state.q, state.v).gravity}};
    c->run(index);
    return c->in_ours(state);
  };
  return contestant;
}

}  // namespace dalembert::benchmarks
