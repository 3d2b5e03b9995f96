// MuJoCo and DART, through the oracles that the tests use: results are in our coordinates, the timed calls in their own.
#include <benchmark/benchmark.h>

#include "contestants.hpp"
#include "dart_oracle.hpp"
#include "mujoco_oracle.hpp"

namespace dalembert::benchmarks {
namespace {

oracle::Request request_for(const BenchmarkRobot& robot) {
  oracle::Request request{
      robot.urdf(), robot.tree().floating_base ? oracle::Base::floating : oracle::Base::fixed, {}, robot.gravity()};
  for (const ir::Body& body : robot.tree().bodies) request.joints.push_back(body.joint);
  return request;
}

Results from_oracle(const oracle::Dynamics& dynamics, Quantities quantities) {
  Results results;
  if (quantities == Quantities::M) results.mass_matrix = dynamics.mass_matrix;
  if (quantities == Quantities::gravity) results.gravity = dynamics.gravity;
  if (quantities == Quantities::bias) results.bias = dynamics.bias;
  return results;
}

}  // namespace

bool peers_offer(Quantities quantities) {
  return quantities == Quantities::M || quantities == Quantities::gravity || quantities == Quantities::bias;
}

Contestant mujoco_contestant(const BenchmarkRobot& robot, Quantities quantities) {
  if (!peers_offer(quantities)) return {};
  struct Computation {
    oracle::MujocoOracle oracle;
    std::vector<Eigen::VectorXd> qpos, qvel;
    Eigen::MatrixXd mass_matrix;
    Eigen::VectorXd forces;

    void set(int state) {
      const auto index = static_cast<size_t>(state);
      Eigen::Map<Eigen::VectorXd>(oracle.data()->qpos, oracle.model()->nq) = qpos[index];
      Eigen::Map<Eigen::VectorXd>(oracle.data()->qvel, oracle.model()->nv) = qvel[index];
    }
  };
  const auto c =
      std::make_shared<Computation>(Computation{{request_for(robot), oracle::Inertias::overwritten}, {}, {}, {}, {}});
  c->oracle.overwrite_inertias(robot.tree());
  mjModel* const model = c->oracle.model();
  mjData* const data = c->oracle.data();
  c->mass_matrix.resize(model->nv, model->nv);
  c->forces.resize(model->nv);
  for (const testing::State& state : robot.states()) {
    c->oracle.set_state(state.q, quantities == Quantities::gravity ? Eigen::VectorXd::Zero(state.v.size()) : state.v);
    c->qpos.emplace_back(Eigen::Map<Eigen::VectorXd>(data->qpos, model->nq));
    c->qvel.emplace_back(Eigen::Map<Eigen::VectorXd>(data->qvel, model->nv));
  }

  Contestant contestant;
  contestant.results = [c, quantities, states = robot.states()](int state) {
    const testing::State& ours = states[static_cast<size_t>(state)];
    return from_oracle(c->oracle.evaluate(ours.q, ours.v), quantities);
  };
  if (quantities == Quantities::M) {
    contestant.run = [c, model, data](int state) {
      c->set(state);
      mj_kinematics(model, data);
      mj_comPos(model, data);
      mj_crb(model, data);
      mj_fullM(model, c->mass_matrix.data(), data->qM);
      benchmark::DoNotOptimize(c->mass_matrix.data());
    };
  } else {
    contestant.run = [c, model, data](int state) {
      c->set(state);
      mj_kinematics(model, data);
      mj_comPos(model, data);
      mj_comVel(model, data);
      mj_rne(model, data, 0, c->forces.data());
      benchmark::DoNotOptimize(c->forces.data());
    };
  }
  return contestant;
}

Contestant dart_contestant(const BenchmarkRobot& robot, Quantities quantities) {
  if (!peers_offer(quantities)) return {};
  const auto dart = std::make_shared<oracle::DartOracle>(request_for(robot));
  std::vector<oracle::DartOracle::Coordinates> own;
  for (const testing::State& state : robot.states()) own.push_back(dart->own_coordinates(state.q, state.v));

  Contestant contestant;
  contestant.results = [dart, quantities, states = robot.states()](int state) {
    const testing::State& ours = states[static_cast<size_t>(state)];
    return from_oracle(dart->evaluate(ours.q, ours.v), quantities);
  };
  contestant.run = [dart, own, quantities](int state) {
    dart->set_state(own[static_cast<size_t>(state)]);
    const double* result = nullptr;
    if (quantities == Quantities::M) result = dart->own_mass_matrix().data();
    if (quantities == Quantities::gravity) result = dart->own_gravity().data();
    if (quantities == Quantities::bias) result = dart->own_bias().data();
    benchmark::DoNotOptimize(result);
  };
  return contestant;
}

}  // namespace dalembert::benchmarks
