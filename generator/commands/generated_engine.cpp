#include "commands/generated_engine.hpp"

#include <algorithm>
#include <chrono>

namespace dalembert {

GeneratedEngine::GeneratedEngine(const Model& model, std::vector<Output> outputs, const std::string& optimisation)
    : name_(model.name),
      code_(name_, compile(with_outputs(model, outputs)), {optimisation}),
      outputs_(std::move(outputs)),
      evaluate_(code_.function<void(const double*, const double*, Workspace*)>(name_ + "_evaluate")),
      workspace_(code_.function<Workspace*()>(name_ + "_create")(), code_.function<void(Workspace*)>(name_ + "_destroy")) {
  if (!workspace_) throw std::bad_alloc();
}

void GeneratedEngine::evaluate(const State& state) {
  evaluate_(state.q.data(), state.v.data(), workspace_.get());
}

Eigen::MatrixXd GeneratedEngine::result(const Output& output) const {
  const double* values = code_.function<const double*(const Workspace*)>(name_ + "_" + output.name)(workspace_.get());
  return Eigen::Map<const Eigen::MatrixXd>(values, output.rows, output.columns);
}

double GeneratedEngine::time_per_call(const std::vector<State>& states) {
  using Clock = std::chrono::steady_clock;
  constexpr int repetitions = 5;  // the best of them: the least disturbed
  constexpr int calls = 2000;
  double best = 0;
  for (int r = 0; r < repetitions; ++r) {
    const Clock::time_point start = Clock::now();
    for (int i = 0; i < calls; ++i) evaluate(states[static_cast<size_t>(i) % states.size()]);
    const double time = std::chrono::duration<double, std::nano>(Clock::now() - start).count() / calls;
    best = r == 0 ? time : std::min(best, time);
  }
  return best;
}

}  // namespace dalembert
