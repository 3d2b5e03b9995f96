#include "commands/batch_engine.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <dalembert/batch_layout.hpp>
#include <memory>
#include <new>
#include <stdexcept>

#include "diagnostics.hpp"
#include "ir/run_time_inputs.hpp"

namespace dalembert {
namespace {

Model asked_for(const Model& model, const std::vector<Output>& outputs) {
  Model result = with_outputs(model, outputs);
  result.scene.batch = true;
  return result;
}

size_t scalar_bytes(const Model& model) { return model.scene.scalar == ir::ScalarType::float32 ? 4 : 8; }

template <class Scalar>
void append(std::vector<char>& to, const Eigen::VectorXd& numbers) {
  const Eigen::VectorX<Scalar> values = numbers.cast<Scalar>();
  const char* const bytes = reinterpret_cast<const char*>(values.data());
  to.insert(to.end(), bytes, bytes + sizeof(Scalar) * static_cast<size_t>(values.size()));
}

}  // namespace

BatchEngine::BatchEngine(const Model& whole, const std::vector<Output>& outputs, const CompilerOptions& options)
    : model_(asked_for(whole, outputs)),
      code_(model_.name, compile_without_self_test(model_), options),
      input_setters_(model_, code_) {
  for (const ir::EmittedFunction& f : ir::functions_of(model_.scene)) {
    const std::string name = model_.name + "_batch_" + f.name;
    Call call{f.name, reinterpret_cast<void*>(code_.function<void()>(name)), {}, {}, {}};
    // In the order of c_api.h.
    std::vector<std::string> names;
    for (const ir::Quantity quantity : f.quantities) names.push_back(f.result(quantity));
    for (const ir::LinkOutput& output : f.of_links) names.push_back(f.result(output));
    for (const std::string& result : names)
      for (const Output& output : outputs_of(model_))
        if (output.name == result) call.outputs.push_back(output);
    if (call.outputs.size() != names.size()) throw std::logic_error("results of " + f.name);
    calls_.push_back(std::move(call));
  }
}

template <class Scalar>
BatchEngine::Columns BatchEngine::columns(const std::vector<State>& states) const {
  Columns columns;
  columns.count = states.size();
  columns.of_wrench.resize(model_.scene.wrenches.size());
  for (const State& state : states) {
    append<Scalar>(columns.q, state.q);
    append<Scalar>(columns.v, state.v);
    append<Scalar>(columns.more, state.more);
    for (size_t w = 0; w < columns.of_wrench.size() && state.wrenches.size() > 0; ++w)
      append<Scalar>(columns.of_wrench[w], state.wrenches.segment<6>(6 * static_cast<Eigen::Index>(w)));
  }
  return columns;
}

std::vector<char> BatchEngine::options(const Columns& columns, const void* workspace) const {
  // NAME_batch_options of c_api.h: a workspace for all states, then an array for each of its inputs.
  std::vector<const void*> given{workspace};
  for (const ir::RunTimeInput& input : ir::run_time_inputs(model_.scene)) {
    const bool is_wrench = input.kind == ir::InputKind::wrench;
    const std::vector<char>* const own = is_wrench ? &columns.of_wrench[static_cast<size_t>(input.index)] : nullptr;
    given.push_back(own && !own->empty() ? own->data() : nullptr);
  }
  if (model_.scene.impacts) given.push_back(nullptr);  // all as in a new workspace
  std::vector<char> options(4 * sizeof(int) + given.size() * sizeof(void*), 0);
  const int numbers[] = {0, 0, static_cast<int>(MatrixLayout::by_columns), 0};
  std::memcpy(options.data(), numbers, sizeof numbers);
  std::memcpy(options.data() + sizeof numbers, given.data(), given.size() * sizeof(void*));
  return options;
}

void BatchEngine::run(const Columns& columns, const void* workspace) {
  const std::vector<char> options = this->options(columns, workspace);
  const size_t bytes = scalar_bytes(model_);
  for (Call& call : calls_) {
    std::vector<void*> pointers;
    call.results.resize(call.outputs.size());
    for (size_t o = 0; o < call.outputs.size(); ++o) {
      call.results[o].resize(columns.count * bytes * static_cast<size_t>(call.outputs[o].rows * call.outputs[o].columns));
      pointers.push_back(call.results[o].data());
    }
    call.status.resize(columns.count);
    using Function =
        int(const void* q, const void* v, const void* more, size_t n, void* const* results, int* status, const void* options);
    const int error =
        reinterpret_cast<Function*>(call.address)(columns.q.data(), columns.v.data(), columns.more.data(), columns.count,
                                                  pointers.data(), call.status.data(), options.data());
    if (error != 0) throw std::runtime_error(call.function + ": " + describe(static_cast<BatchError>(error)));
  }
}

void BatchEngine::evaluate(const std::vector<State>& states) {
  const bool single = scalar_bytes(model_) == 4;
  const Columns all = single ? columns<float>(states) : columns<double>(states);
  run(all);
  const auto otherwise = [](const State& state) { return !state.acting.active.empty() || !state.loading.empty(); };
  if (std::none_of(states.begin(), states.end(), otherwise)) return;
  const std::unique_ptr<void, void (*)(void*)> workspace(code_.function<void*()>(model_.name + "_create")(),
                                                         code_.function<void(void*)>(model_.name + "_destroy"));
  if (!workspace) throw std::bad_alloc();
  std::vector<Call> results = calls_;
  for (size_t s = 0; s < states.size(); ++s) {
    if (!otherwise(states[s])) continue;
    single ? input_setters_.set<float>(states[s].acting, states[s].loading, workspace.get())
           : input_setters_.set<double>(states[s].acting, states[s].loading, workspace.get());
    run(all, workspace.get());
    for (size_t c = 0; c < results.size(); ++c) {
      results[c].status[s] = calls_[c].status[s];
      for (size_t o = 0; o < results[c].results.size(); ++o) {
        std::vector<char>& to = results[c].results[o];
        const std::vector<char>& from = calls_[c].results[o];
        const auto begin = static_cast<std::ptrdiff_t>(s * (from.size() / states.size())),
                   end = begin + static_cast<std::ptrdiff_t>(from.size() / states.size());
        std::copy(from.begin() + begin, from.begin() + end, to.begin() + begin);
      }
    }
  }
  calls_ = std::move(results);
}

const BatchEngine::Call& BatchEngine::call_of(const Output& output, size_t& index) const {
  for (const Call& call : calls_)
    for (index = 0; index < call.outputs.size(); ++index)
      if (call.outputs[index].name == output.name) return call;
  throw std::logic_error("no output " + output.name);
}

Eigen::MatrixXd BatchEngine::result(const Output& output, size_t state) const {
  size_t index = 0;
  const Call& call = call_of(output, index);
  const size_t bytes = scalar_bytes(model_);
  const char* const from = call.results[index].data() + state * bytes * static_cast<size_t>(output.rows * output.columns);
  if (bytes == 4)
    return Eigen::Map<const Eigen::MatrixXf>(reinterpret_cast<const float*>(from), output.rows, output.columns).cast<double>();
  return Eigen::Map<const Eigen::MatrixXd>(reinterpret_cast<const double*>(from), output.rows, output.columns);
}

int BatchEngine::status(const Output& output, size_t state) const {
  size_t index = 0;
  return call_of(output, index).status[state];
}

std::vector<Output> BatchEngine::accelerations() const {
  std::vector<Output> all;
  for (const Call& call : calls_) {
    const Output* found = nullptr;
    for (const Output& output : call.outputs) {
      if (output.quantity == ir::Quantity::constrained_forward_dynamics) found = &output;
      if (output.quantity == ir::Quantity::forward_dynamics && !found) found = &output;
    }
    if (found) all.push_back(*found);
  }
  return all;
}

template <class Scalar>
BatchEngine::Ends BatchEngine::roll_out_in(const Output& acceleration, const std::vector<State>& states, size_t steps,
                                           double time_step, RolloutMethod method) {
  size_t index = 0;
  const std::string& function = call_of(acceleration, index).function;
  Columns from = columns<Scalar>(states);
  from.more.clear();
  for (const State& state : states)
    for (size_t step = 0; step < steps; ++step) append<Scalar>(from.more, state.more);
  const std::vector<char> options = this->options(from);
  const Eigen::Index nq = model_.tree.nq(), nv = model_.tree.nv(), n = static_cast<Eigen::Index>(states.size());
  Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic> q(nq, n), v(nv, n);
  Ends ends;
  ends.stopped.resize(states.size());
  using Function = int(const void* q, const void* v, const void* more, size_t n, size_t steps, Scalar time_step, int method,
                       void* last_q, void* last_v, void* path_q, void* path_v, int* stopped, const void* options);
  const int error = code_.function<Function>(model_.name + "_rollout_" + function)(
      from.q.data(), from.v.data(), from.more.data(), states.size(), steps, static_cast<Scalar>(time_step),
      static_cast<int>(method), q.data(), v.data(), nullptr, nullptr, ends.stopped.data(), options.data());
  if (error != 0) throw std::runtime_error(function + ": " + describe(static_cast<BatchError>(error)));
  for (Eigen::Index s = 0; s < n; ++s) {
    ends.q.emplace_back(q.col(s).template cast<double>());
    ends.v.emplace_back(v.col(s).template cast<double>());
  }
  return ends;
}

BatchEngine::Ends BatchEngine::roll_out(const Output& acceleration, const std::vector<State>& states, size_t steps,
                                        double time_step, RolloutMethod method) {
  return scalar_bytes(model_) == 4 ? roll_out_in<float>(acceleration, states, steps, time_step, method)
                                   : roll_out_in<double>(acceleration, states, steps, time_step, method);
}

double BatchEngine::time_per_state(const std::vector<State>& states) {
  std::vector<State> many;
  while (many.size() < 1024) many.insert(many.end(), states.begin(), states.end());
  const Columns all = scalar_bytes(model_) == 4 ? columns<float>(many) : columns<double>(many);
  std::vector<double> times;
  using Clock = std::chrono::steady_clock;
  for (const auto end = Clock::now() + std::chrono::milliseconds(50); times.size() < 5 || Clock::now() < end;) {
    const auto start = Clock::now();
    run(all);
    times.push_back(std::chrono::duration<double, std::nano>(Clock::now() - start).count() / static_cast<double>(many.size()));
  }
  std::nth_element(times.begin(), times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2), times.end());
  return times[times.size() / 2];
}

}  // namespace dalembert
