#include "backend/emit_self_test.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "backend/code_name.hpp"
#include "backend/code_text.hpp"
#include "backend/literals.hpp"
#include "backend/templates.hpp"
#include "ir/identifier.hpp"
#include "ir/run_time_inputs.hpp"

namespace dalembert::backend {
namespace {

using Kind = ir::Expectation::Kind;

class SelfTestText {
 public:
  SelfTestText(const Folder& folder, const ir::SelfTest& test)
      : folder_(folder), code_(folder.common()), arrays_(folder.arrays()), test_(test) {}

  std::string tables() const {
    std::string text;
    for (size_t s = 0; s < test_.states.size(); ++s) {
      const ir::SelfTest::State& state = test_.states[s];
      text += table(fmt::format("q_{}", s), {state.q.begin(), state.q.end()});
      text += table(fmt::format("v_{}", s), {state.v.begin(), state.v.end()});
      if (takes_more()) text += table(fmt::format("input_{}", s), {state.input.begin(), state.input.end()});
    }
    for (const ir::Expectation& e : test_.implicit) text += table(implicit_table_name(e), e.values);
    for (const ir::Expectation& e : test_.expectations) {
      if (!e.complete) {
        std::vector<std::string> items;
        for (const int column : e.columns) items.push_back(std::to_string(column));
        text += fmt::format("constexpr int {}_columns[] = {{{}}};\n", table_name(e), fmt::join(items, ", "));
      }
      text += table(table_name(e), e.values);
    }
    return text;
  }

  // Run-time inputs have values of their own.
  std::string inputs() const {
    std::string text;
    for (const ir::RunTimeInput& input : ir::run_time_inputs(code_.scene)) {
      if (input.kind == ir::InputKind::constraint) continue;  // as in a new workspace
      const std::vector<double> values = test_.given(input);
      for (int i = 0; i < input.size(); ++i)
        text += fmt::format("  workspace.{} = {};\n", input.element(i),
                            literal(values[static_cast<size_t>(i)], code_.scene.scalar));
    }
    return text;
  }

  // Pointers to the functions.
  std::string runs() const {
    std::string text;
    for (const CodeInput& f : folder_.functions) {
      text +=
          fmt::format("void (*volatile const {})({}, Workspace&) noexcept = {};\n", own_name(f, "run"),
                      fmt::join(std::vector<std::string>(vectors_of(f).size(), "const Scalar*"), ", "), function_of(f).name);
      if (f.scene.batch)
        text += fmt::format(
            "dalembert::BatchError (*volatile const {})(const Batch&, const {}&, std::size_t, std::size_t) noexcept = "
            "{}_batch;\n",
            own_name(f, "run_batch"), own_type(f, "BatchResults"), function_of(f).name);
      if (acceleration(f))
        text += fmt::format(
            "dalembert::BatchError (*volatile const {})(const Batch&, const dalembert::Rollout<Scalar>&, std::size_t, "
            "std::size_t) noexcept = {}_rollout;\n",
            own_name(f, "run_rollout"), function_of(f).name);
    }
    return text;
  }

  std::string comparisons() const {
    std::string text;
    for (size_t s = 0; s < test_.states.size(); ++s) {
      for (const CodeInput& f : folder_.functions)
        text += fmt::format("  {0}(q_{1}, v_{1}{2}, workspace);\n", own_name(f, "run"), s,
                            vectors_of(f).size() > 2 ? fmt::format(", input_{}", s) : "");
      for (const ir::Expectation& e : test_.expectations)
        if (e.state == static_cast<int>(s)) text += comparison(e);
      text += batches(s);
    }
    return text;
  }

  // For the reader: a line per output.
  std::string compared() const {
    std::string text;
    for (size_t a = 0; a < arrays_.size(); ++a)
      text += fmt::format("//   {:<24} {}\n", array(static_cast<int>(a)).name, coverage(static_cast<int>(a)));
    return text;
  }

  std::string includes() const { return any_batch() ? "#include \"batch.hpp\"\n" : ""; }

 private:
  bool any_batch() const { return code_.scene.batch; }

  // The result of a function that its rollouts move by; null: it has none.
  static const ir::OutputArray* acceleration(const CodeInput& f) {
    if (!f.scene.batch) return nullptr;
    const std::string name = function_of(f).acceleration_result();
    for (const ir::OutputArray& a : f.program.arrays)
      if (!a.internal && !name.empty() && a.name == name) return &a;
    return nullptr;
  }

  // Declares a batch of that state alone.
  std::string batch_of(size_t s) const {
    std::string text = "    Batch batch;\n    batch.count = 1;\n    batch.matrices = dalembert::MatrixLayout::by_columns;\n";
    text += fmt::format("    batch.q = q_{0};\n    batch.v = v_{0};\n", s);
    if (takes_more()) text += fmt::format("    batch.input = input_{};\n", s);
    if (!ir::run_time_inputs(code_.scene).empty()) text += "    batch.workspace = &workspace;\n";
    return text;
  }

  // The same results, of batches of that state alone, in place of those there are; then of a motion of one step.
  std::string batches(size_t s) const {
    if (!any_batch()) return "";
    std::string text = "  {\n" + batch_of(s);
    std::vector<std::string> own;
    for (const CodeInput& f : folder_.functions) {
      const std::string results = own_name(f, "results");
      text += fmt::format("    {} {};\n", own_type(f, "BatchResults"), results);
      for (const ir::OutputArray& a : f.program.arrays) {
        if (a.internal) continue;
        text +=
            fmt::format("    for (Scalar& x : workspace.{0}) x = Scalar(-1);\n    {1}.{0} = workspace.{0};\n", a.name, results);
        own.push_back(a.name);
      }
      text += fmt::format("    (void){}(batch, {}, 0, 1);\n", own_name(f, "run_batch"), results);
    }
    text += "  }\n";
    for (const ir::Expectation& e : test_.expectations)
      if (e.state == static_cast<int>(s) && std::find(own.begin(), own.end(), array(e.array).name) != own.end())
        text += comparison(e);
    return text + rollouts(s);
  }

  // Of semi-implicit Euler's step, which changes v by that many times dv/dt: so long that v's rounding does not show.
  std::string rollouts(size_t s) const {
    std::string text;
    for (const CodeInput& f : folder_.functions) {
      const ir::OutputArray* const a = acceleration(f);
      if (!a) continue;
      text += fmt::format(
          "  {{\n{0}    Scalar last[nv];\n    dalembert::Rollout<Scalar> rollout;\n"
          "    rollout.steps = 1, rollout.time_step = 1024, rollout.last_v = last;\n"
          "    for (int i = 0; i < nv; ++i) last[i] = Scalar(-1);\n"
          "    (void){1}(batch, rollout, 0, 1);\n"
          "    for (int i = 0; i < nv; ++i) workspace.{2}[i] = (last[i] - v_{3}[i]) / 1024;\n  }}\n",
          batch_of(s), own_name(f, "run_rollout"), a->name, s);
      for (const ir::Expectation& e : test_.expectations)
        if (e.state == static_cast<int>(s) && array(e.array).name == a->name) text += comparison(e);
      for (const ir::Expectation& e : test_.implicit)
        if (e.state == static_cast<int>(s) && array(e.array).name == a->name) text += implicit_step(f, *a, e);
    }
    return text;
  }

  // Of a linearly implicit step, so long that dampers and springs count.
  std::string implicit_step(const CodeInput& f, const ir::OutputArray& a, const ir::Expectation& e) const {
    return fmt::format(
               "  {{\n{0}    Scalar last[nv];\n    dalembert::Rollout<Scalar> rollout;\n"
               "    rollout.steps = 1, rollout.time_step = Scalar({4}), rollout.last_v = last;\n"
               "    rollout.method = dalembert::RolloutMethod::linearly_implicit;\n"
               "    for (int i = 0; i < nv; ++i) last[i] = Scalar(-1);\n"
               "    (void){1}(batch, rollout, 0, 1);\n"
               "    for (int i = 0; i < nv; ++i) workspace.{2}[i] = (last[i] - v_{3}[i]) / Scalar({4});\n  }}\n",
               batch_of(static_cast<size_t>(e.state)), own_name(f, "run_rollout"), a.name, e.state, test_.step) +
           comparison(e, implicit_table_name(e));
  }

  const ir::OutputArray& array(int index) const { return arrays_[static_cast<size_t>(index)]; }

  std::string table_name(const ir::Expectation& e) const {
    return fmt::format("{}_{}{}", array(e.array).name, e.kind == Kind::products ? "rows_" : "", e.state);
  }

  std::string table(const std::string& name, const std::vector<double>& values) const {
    std::vector<std::string> items;
    for (const double x : values) items.push_back(x == 0 ? "0" : literal(x, code_.scene.scalar));
    if (items.empty()) items.push_back("0");  // C++ has no empty arrays
    return fmt::format("constexpr Scalar {}[] = {{\n    {}}};\n", name, wrapped(items, 4));
  }

  std::string implicit_table_name(const ir::Expectation& e) const {
    return fmt::format("{}_implicit_{}", array(e.array).name, e.state);
  }

  std::string comparison(const ir::Expectation& e) const { return comparison(e, table_name(e)); }
  std::string comparison(const ir::Expectation& e, const std::string& name) const {
    const ir::OutputArray& a = array(e.array);
    const std::string what =
        fmt::format("{{\"{}\", {}, {}, {}}}, workspace.{}, {}", a.name, e.state, e.scale, e.tolerance, a.name, a.rows);
    if (e.kind == Kind::products) return fmt::format("  test.products({}, {}, {});\n", what, a.columns, name);
    return fmt::format("  test.{}({}, {}, {}, {});\n", e.kind == Kind::elements ? "elements" : "symmetric_elements", what,
                       e.complete ? "nullptr" : name + "_columns", e.columns.size(), name);
  }

  std::string coverage(int index) const {
    for (const ir::Expectation& e : test_.expectations) {
      if (e.array != index) continue;
      if (array(index).columns == 1) return "every element at every state";
      const std::string rows = "; at every state each row's weighted sum";
      if (e.complete) return "every element at state 0" + rows;
      return fmt::format("{} of {} columns at state 0{}", e.columns.size(), array(index).columns, rows);
    }
    return fmt::format("nothing: {} cannot hold its values at these states", scalar_name(code_.scene.scalar));
  }

  bool takes_more() const {
    return std::any_of(folder_.functions.begin(), folder_.functions.end(),
                       [](const CodeInput& f) { return vectors_of(f).size() > 2; });
  }

  const Folder& folder_;
  const CodeInput& code_;
  const std::vector<ir::OutputArray> arrays_;
  const ir::SelfTest& test_;
};

}  // namespace

std::vector<OutputFile> self_test_files(const Folder& folder, const ir::SelfTest& test, const std::string& banner) {
  const SelfTestText text(folder, test);
  const std::string& name = folder.common().name;
  return {{"self_test.hpp", render("self_test.hpp", {{"banner", banner},
                                                     {"name", name},
                                                     {"code", code_mark},
                                                     {"precision", test.precision},
                                                     {"compared", text.compared()}})},
          {"self_test.cpp", render("self_test.cpp", {{"banner", banner},
                                                     {"name", name},
                                                     {"code", code_mark},
                                                     {"tables", text.tables()},
                                                     {"includes", text.includes()},
                                                     {"runs", text.runs()},
                                                     {"inputs", text.inputs()},
                                                     {"comparisons", text.comparisons()}})}};
}

}  // namespace dalembert::backend
