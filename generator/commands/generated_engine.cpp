#include "commands/generated_engine.hpp"

#include <algorithm>
#include <chrono>
#include <new>
#include <type_traits>

namespace dalembert {

GeneratedEngine::GeneratedEngine(const Model& model, const std::vector<Output>& outputs, const std::string& optimisation)
    : name_(model.name),
      single_precision_(model.scene.scalar == ir::ScalarType::float32),
      code_(name_, compile(with_outputs(model, outputs)), {optimisation}),
      evaluate_(reinterpret_cast<void*>(code_.function<void()>(name_ + "_evaluate"))),
      workspace_(code_.function<Workspace*()>(name_ + "_create")(), code_.function<void(Workspace*)>(name_ + "_destroy")) {
  if (!workspace_) throw std::bad_alloc();
}

template <class Scalar>
void GeneratedEngine::call(const State& state) {
  const auto function = reinterpret_cast<void (*)(const Scalar*, const Scalar*, Workspace*)>(evaluate_);
  if constexpr (std::is_same_v<Scalar, double>) {
    function(state.q.data(), state.v.data(), workspace_.get());
  } else {
    const Eigen::VectorX<Scalar> q = state.q.cast<Scalar>(), v = state.v.cast<Scalar>();
    function(q.data(), v.data(), workspace_.get());
  }
}

template <class Scalar>
Eigen::MatrixXd GeneratedEngine::read(const Output& output) const {
  const Scalar* values = code_.function<const Scalar*(const Workspace*)>(name_ + "_" + output.name)(workspace_.get());
  return Eigen::Map<const Eigen::MatrixX<Scalar>>(values, output.rows, output.columns).template cast<double>();
}

void GeneratedEngine::evaluate(const State& state) { single_precision_ ? call<float>(state) : call<double>(state); }

Eigen::MatrixXd GeneratedEngine::result(const Output& output) const {
  return single_precision_ ? read<float>(output) : read<double>(output);
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
