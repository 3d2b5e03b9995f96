#include "commands/generated_engine.hpp"

#include <dalembert/self_test.hpp>
#include <new>

#include "ir/identifier.hpp"

namespace dalembert {

namespace {
std::vector<backend::OutputFile> files_of(const Model& model, bool self_test) {
  return self_test ? compile(model) : compile_without_self_test(model);
}
}  // namespace

GeneratedEngine::GeneratedEngine(const Model& model, const std::vector<Output>& outputs, const CompilerOptions& options,
                                 bool self_test)
    : name_(model.name),
      single_precision_(model.scene.scalar == ir::ScalarType::float32),
      code_(name_, files_of(with_outputs(model, outputs), self_test), options),
      workspace_(code_.function<Workspace*()>(name_ + "_create")(), code_.function<void(Workspace*)>(name_ + "_destroy")) {
  if (!workspace_) throw std::bad_alloc();
  for (const ir::EmittedFunction& f : ir::functions_of(with_outputs(model, outputs).scene))
    calls_.push_back({reinterpret_cast<void*>(code_.function<void()>(name_ + "_" + f.name)), *f.input() != 0});
  for (const ir::ExternalWrench& wrench : model.scene.wrenches)
    wrench_setters_.push_back(
        reinterpret_cast<void*>(code_.function<void()>(name_ + "_set_wrench_" + ir::identifier(wrench.link))));
}

template <class Scalar>
void GeneratedEngine::call(const Call& call, const Scalar* q, const Scalar* v, const Scalar* more) {
  using V = const Scalar*;
  if (call.takes_more) reinterpret_cast<void (*)(V, V, V, Workspace*)>(call.function)(q, v, more, workspace_.get());
  else reinterpret_cast<void (*)(V, V, Workspace*)>(call.function)(q, v, workspace_.get());
}

template <class Scalar>
void GeneratedEngine::set_wrenches(const State& state) {
  const Eigen::VectorX<Scalar> values = state.wrenches.cast<Scalar>();
  for (size_t i = 0; i < wrench_setters_.size() && values.size() > 0; ++i)
    reinterpret_cast<void (*)(const Scalar*, Workspace*)>(wrench_setters_[i])(values.data() + 6 * i, workspace_.get());
}

template <class Scalar>
void GeneratedEngine::call(const State& state) {
  set_wrenches<Scalar>(state);
  const Eigen::VectorX<Scalar> q = state.q.cast<Scalar>(), v = state.v.cast<Scalar>(), more = state.more.cast<Scalar>();
  for (const Call& c : calls_) call<Scalar>(c, q.data(), v.data(), more.data());
}

template <class Scalar>
Eigen::MatrixXd GeneratedEngine::read(const Output& output) const {
  const Scalar* values =
      code_.function<const Scalar*(const Workspace*)>(name_ + "_" + ir::c_accessor(output.name))(workspace_.get());
  return Eigen::Map<const Eigen::MatrixX<Scalar>>(values, output.rows, output.columns).template cast<double>();
}

void GeneratedEngine::evaluate(const State& state) { single_precision_ ? call<float>(state) : call<double>(state); }

Eigen::MatrixXd GeneratedEngine::result(const Output& output) const {
  return single_precision_ ? read<float>(output) : read<double>(output);
}

int GeneratedEngine::status(const Output& output) const {
  const std::string name = name_ + "_" + output.function.own_name("status");
  return code_.has(name) ? code_.function<int(const Workspace*)>(name)(workspace_.get()) : -1;
}

template <class Scalar>
CallTime GeneratedEngine::time_in(const std::vector<State>& states) {
  set_wrenches<Scalar>(states.front());
  std::vector<Eigen::VectorX<Scalar>> q, v, more;
  for (const State& state : states) {
    q.push_back(state.q.cast<Scalar>());
    v.push_back(state.v.cast<Scalar>());
    more.push_back(state.more.cast<Scalar>());
  }
  return time_calls(states.size(), [&](size_t s) {
    for (const Call& c : calls_) call<Scalar>(c, q[s].data(), v[s].data(), more[s].data());
  });
}

CallTime GeneratedEngine::time_per_call(const std::vector<State>& states) {
  return single_precision_ ? time_in<float>(states) : time_in<double>(states);
}

std::string GeneratedEngine::self_test() const {
  // NAME_self_test_report of c_api.h.
  struct Report {
    const char* output;
    int state, row, column;
    double expected, obtained, error, tolerance;
  } report;
  if (code_.function<int(Report*)>(name_ + "_self_test")(&report)) return "";
  char text[512];
  describe({report.output, report.state, report.row, report.column, report.expected, report.obtained, report.error,
            report.tolerance},
           text, sizeof text);
  return text;
}

}  // namespace dalembert
