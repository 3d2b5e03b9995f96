#include "commands/generated_engine.hpp"

#include <fmt/format.h>

#include <dalembert/self_test.hpp>
#include <new>

#include "backend/templates.hpp"
#include "ir/identifier.hpp"

namespace dalembert {

namespace {

Model asked_for(const Model& model, const std::vector<Output>& outputs, Besides besides) {
  Model result = with_outputs(model, outputs);
  if (besides == Besides::task_graphs) result.scene.parallel = ir::Parallel::tasks;
  return result;
}

std::string task_graphs_call(const std::string& name, const std::string& function) {
  return name + "_" + function + "_by_task_graph";
}

// C functions that run the task graphs; generated code has none.
backend::OutputFile task_graphs_source(const Model& model) {
  std::string graphs, initializers, calls;
  for (const ir::EmittedFunction& f : ir::functions_of(model.scene)) {
    const std::string more = f.input(), graph = f.name + "_graph";
    graphs += fmt::format("  {}::{}TaskGraph {};\n", model.name, f.type, graph);
    initializers += fmt::format("{}{}(workspace)", initializers.empty() ? "" : ", ", graph);
    calls += fmt::format(
        "void {1}(const {0}::Scalar* q, const {0}::Scalar* v{2}, {0}_task_graphs* graphs) {{\n"
        "  graphs->{3}.{4}(q, v{5});\n}}\n",
        model.name, task_graphs_call(model.name, f.name),
        more.empty() ? "" : fmt::format(", const {}::Scalar* {}", model.name, more), graph, f.name,
        more.empty() ? "" : ", " + more);
  }
  return {"task_graphs.cpp",
          backend::render("task_graphs.cpp",
                          {{"name", model.name}, {"graphs", graphs}, {"initializers", initializers}, {"calls", calls}})};
}

std::vector<backend::OutputFile> files_of(const Model& model, Besides besides) {
  if (besides == Besides::self_test) return compile(model);
  std::vector<backend::OutputFile> files = compile_without_self_test(model);
  if (besides == Besides::task_graphs) files.push_back(task_graphs_source(model));
  return files;
}

CompilerOptions linked(CompilerOptions options, Besides besides) {
  if (besides == Besides::task_graphs) options.libraries = "-ltbb";
  return options;
}

}  // namespace

GeneratedEngine::GeneratedEngine(const Model& whole, const std::vector<Output>& outputs, const CompilerOptions& options,
                                 Besides besides)
    : name_(whole.name),
      single_precision_(whole.scene.scalar == ir::ScalarType::float32),
      code_(name_, files_of(asked_for(whole, outputs, besides), besides), linked(options, besides)),
      workspace_(code_.function<Workspace*()>(name_ + "_create")(), code_.function<void(Workspace*)>(name_ + "_destroy")),
      task_graphs_(nullptr, nullptr) {
  if (!workspace_) throw std::bad_alloc();
  const Model model = asked_for(whole, outputs, besides);
  if (besides == Besides::task_graphs) {
    task_graphs_ = {code_.function<TaskGraphs*(Workspace*)>(name_ + "_create_task_graphs")(workspace_.get()),
                    code_.function<void(TaskGraphs*)>(name_ + "_destroy_task_graphs")};
    if (!task_graphs_) throw std::bad_alloc();
    by_task_graph_ = true;
  }
  const auto function = [&](const std::string& name) { return reinterpret_cast<void*>(code_.function<void()>(name)); };
  for (const ir::EmittedFunction& f : ir::functions_of(model.scene))
    calls_.push_back({f.name, function(name_ + "_" + f.name), *f.input() != 0,
                      task_graphs_ ? function(task_graphs_call(name_, f.name)) : nullptr});
  for (const ir::ExternalWrench& wrench : model.scene.wrenches)
    wrench_setters_.push_back(function(name_ + "_set_wrench_" + ir::identifier(wrench.link)));
  input_setters_ = InputSetters(model, code_);
}

template <class Scalar>
void GeneratedEngine::call(const Call& call, const Scalar* q, const Scalar* v, const Scalar* more) {
  using V = const Scalar*;
  void* const function = by_task_graph_ ? call.by_task_graph : call.function;
  void* const last = by_task_graph_ ? task_graphs_.get() : workspace_.get();
  if (call.takes_more) reinterpret_cast<void (*)(V, V, V, void*)>(function)(q, v, more, last);
  else reinterpret_cast<void (*)(V, V, void*)>(function)(q, v, last);
}

template <class Scalar>
void GeneratedEngine::set_inputs(const State& state) {
  const Eigen::VectorX<Scalar> values = state.wrenches.cast<Scalar>();
  for (size_t i = 0; i < wrench_setters_.size() && values.size() > 0; ++i)
    reinterpret_cast<void (*)(const Scalar*, Workspace*)>(wrench_setters_[i])(values.data() + 6 * i, workspace_.get());
  input_setters_.set<Scalar>(state.acting, state.loading, workspace_.get());
}

template <class Scalar>
void GeneratedEngine::call(const State& state) {
  set_inputs<Scalar>(state);
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
CallTime GeneratedEngine::time_in(const std::vector<State>& states, const std::vector<Call>& calls) {
  set_inputs<Scalar>(states.front());
  std::vector<Eigen::VectorX<Scalar>> q, v, more;
  for (const State& state : states) {
    q.push_back(state.q.cast<Scalar>());
    v.push_back(state.v.cast<Scalar>());
    more.push_back(state.more.cast<Scalar>());
  }
  return time_calls(states.size(), [&](size_t s) {
    for (const Call& c : calls) call<Scalar>(c, q[s].data(), v[s].data(), more[s].data());
  });
}

CallTime GeneratedEngine::time_per_call(const std::vector<State>& states) {
  return single_precision_ ? time_in<float>(states, calls_) : time_in<double>(states, calls_);
}

std::vector<GeneratedEngine::FunctionTime> GeneratedEngine::time_per_function(const std::vector<State>& states) {
  std::vector<FunctionTime> times;
  for (const Call& c : calls_)
    times.push_back({c.name, single_precision_ ? time_in<float>(states, {c}) : time_in<double>(states, {c})});
  return times;
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
