#include "backend/emit_header.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "backend/code_name.hpp"
#include "backend/code_text.hpp"
#include "backend/emit_embedded.hpp"
#include "backend/emit_notes.hpp"
#include "backend/emit_rolled.hpp"
#include "backend/kept.hpp"
#include "backend/layout.hpp"
#include "backend/literals.hpp"
#include "backend/moved_parameters.hpp"
#include "backend/templates.hpp"
#include "dalembert/version.hpp"
#include "ir/identifier.hpp"
#include "ir/joint_words.hpp"
#include "ir/moved_links.hpp"
#include "ir/run_time_inputs.hpp"

namespace dalembert::backend {
namespace {

// What stands in the workspace for a function in either form.
std::vector<ir::OutputArray> stored_arrays(const CodeInput& code) {
  std::vector<ir::OutputArray> stored;
  for (const CodeInput* form : {&code, code.elsewhere}) {
    if (!form) continue;
    for (const ir::OutputArray& a : form->algorithm.own_arrays())
      if (!a.written_out &&
          std::none_of(stored.begin(), stored.end(), [&](const ir::OutputArray& b) { return b.name == a.name; }))
        stored.push_back(a);
  }
  return stored;
}

std::string results(const Folder& folder) {
  std::string text;
  for (const CodeInput* section : folder.sections()) {
    const CodeInput& code = *section;
    for (const ir::OutputArray& a : stored_arrays(code)) {
      const std::string size = a.columns == 1 ? std::to_string(a.rows) : fmt::format("{} * {}", a.rows, a.columns);
      text += fmt::format("  alignas(64) Scalar {}[{}] = {{}};{}\n", a.name, size, a.internal ? "  // scratch" : "");
    }
    if (const std::optional<ir::Guard>& guard = code.algorithm.guard; guard && code.algorithm.section.is_first()) {
      std::vector<std::string> names;
      for (const int array : guard->arrays) names.push_back(code.program.arrays[static_cast<size_t>(array)].name);
      text += comment_lines(fmt::format("Whether M is positive definite, to rounding; where it is not, {} {} zero.",
                                        fmt::join(names, ", "), names.size() == 1 ? "is" : "are"),
                            2) +
              fmt::format("  dalembert::FactorStatus<Scalar> {};\n", own_name(code, "status"));
    }
    if (code.algorithm.embedding)
      text += comment_lines(
                  "What dependent joints came to; at a toggle point, where loops do not tell where they are, all results "
                  "of the function are zero.",
                  2) +
              fmt::format("  dalembert::LinkageStatus<Scalar> {};\n", own_name(code, "linkage_status"));
    for (const ir::Kernel& kernel : code.algorithm.kernels)
      if (const char* status = ir::row_of(kernel.kind).status; *status)
        text += fmt::format("  dalembert::ConstraintStatus<Scalar> {};  // what is left of the constraints' rows\n",
                            own_name(code, status));
  }
  return text;
}

std::string run_time_inputs(const CodeInput& code) {
  std::string text;
  for (const ir::RunTimeInput& input : ir::run_time_inputs(code.scene)) {
    std::vector<std::string> start;
    if (std::any_of(input.start.begin(), input.start.end(), [](double x) { return x != 0; }))
      for (const double x : input.start) start.push_back(literal(x, code.scene.scalar));
    text += with_comment(input.type.empty()
                             ? fmt::format("  Scalar {}[{}] = {{{}}};", input.name, input.size(), fmt::join(start, ", "))
                             : fmt::format("  {} {};", input.type, input.name),
                         input.meaning);
  }
  return text.empty() ? "" : "\n  // Run-time inputs: set them as you need, before a call.\n" + text;
}

// What a run-time input is that is no array.
struct Structure {
  const char* name;
  int numbers;
  const char* text;
};
constexpr Structure structures[] = {
    {"Payload", 10, R"(// A rigid body welded to a link, given at run time.
struct Payload {
  Scalar mass = 0;          // kg
  Scalar com[3] = {};       // centre of mass, m, in the link's frame
  Scalar inertia[6] = {};   // xx xy xz yy yz zz about the centre of mass, kg m^2, the link's axes
};

)"},
    {"Contact", 23,
     R"(// How a contact acts, given at run time. Its rows' accelerations shall be -kd J v - kp e, e being how far it is from
// its anchor.
struct Contact {
  bool active = true;             // else it exerts nothing
  Scalar kp = 0, kd = 0;          // 1/s^2, 1/s
  Scalar restitution = 0;         // of an impact: J v becomes -restitution J v
  Scalar anchor[7] = {0, 0, 0, 0, 0, 0, 1};  // place in the world, m, and quaternion x y z w; matters where kp does
  Scalar regularization[6] = {};  // added to the diagonal of J M^-1 J', per row: rows give way
  Scalar weight[6] = {1, 1, 1, 1, 1, 1};  // per row, of its force in inverse dynamics: 0: it bears nothing
};

)"},
    {"Loop", 16,
     R"(// How a loop acts, given at run time. Its rows' accelerations shall be -kd J v - kp e, e being how far it is from closed.
struct Loop {
  bool active = true;             // else it exerts nothing
  Scalar kp = 0, kd = 0;          // 1/s^2, 1/s
  Scalar restitution = 0;         // of an impact: J v becomes -restitution J v
  Scalar regularization[6] = {};  // added to the diagonal of J M^-1 J', per row: rows give way
  Scalar weight[6] = {1, 1, 1, 1, 1, 1};  // per row, of its force in inverse dynamics: 0: it bears nothing
};

)"},
};

std::string types_of_inputs(const CodeInput& code) {
  const std::vector<ir::RunTimeInput> inputs = ir::run_time_inputs(code.scene);
  std::string text;
  for (const Structure& structure : structures)
    if (std::any_of(inputs.begin(), inputs.end(), [&](const auto& input) { return input.type == structure.name; }))
      text += structure.text;
  return text;
}

std::size_t numbers_of_inputs(const CodeInput& code) {
  std::size_t numbers = 0;
  for (const ir::RunTimeInput& input : ir::run_time_inputs(code.scene)) {
    const auto* const structure =
        std::find_if(std::begin(structures), std::end(structures), [&](const Structure& s) { return input.type == s.name; });
    numbers += static_cast<std::size_t>(structure == std::end(structures) ? input.size() : structure->numbers);
  }
  return numbers;
}

std::string views(const Folder& folder) {
  std::string text;
  for (const ir::OutputArray& a : folder.arrays())
    text += "\n" + comment_lines(result_words(folder, a)) +
            fmt::format("inline Result<{}, {}> {}(const Workspace& workspace);\n", a.rows, a.columns, a.name);
  return text;
}

std::string view_definitions(const Folder& folder) {
  std::string text;
  for (const ir::OutputArray& a : folder.arrays())
    text += fmt::format(
        "inline Result<{1}, {2}> {0}(const Workspace& workspace) {{\n"
        "  return Result<{1}, {2}>(workspace.{0});\n"
        "}}\n"
        "void {0}(const Workspace&&) = delete;\n",
        a.name, a.rows, a.columns);
  return text;
}

// Of indices into q or v behind the base's own those that are not read, counted from there.
std::vector<int> joints_not_read(const std::set<int>& read, int base, int all) {
  std::vector<int> joints;
  for (int i = base; i < all; ++i)
    if (!read.contains(i)) joints.push_back(i - base);
  return joints;
}

std::string unread(const CodeInput& code) {
  if (code.algorithm.embedding) return "";
  const ir::InputsRead read = ir::inputs_read(code.program, ir::uses(code.program.graph, code.program.roots()));
  const std::string input = code.algorithm.section.input();
  std::vector<std::string> parts;
  if (code.robot->base_coordinates() > 0 && !read.base_pose()) parts.emplace_back("the base's pose");
  const std::vector<int> still = ir::coordinates_at(
                             joints_not_read(read.positions, code.robot->base_positions(), code.robot->nq()), *code.robot),
                         slow = joints_not_read(read.velocities, code.robot->base_coordinates(), code.robot->nv());
  if (!still.empty()) parts.push_back("positions of " + ir::joints_in_words(still, *code.robot));
  if (read.velocities.empty()) parts.emplace_back("v");
  else if (!slow.empty()) parts.push_back("rates of " + ir::joints_in_words(slow, *code.robot));
  if (!input.empty() && !read.input) parts.push_back(input);
  return parts.empty() ? "" : comment_lines(fmt::format("Not read: {}.", fmt::join(parts, "; ")));
}

// The functions that the function calls in this order, for the task graph.
std::string stage_declarations(const CodeInput& code) {
  if (!code.plan.tasks || !code.is_rolled()) return "";
  const std::string scope = own_name(code, "stages");
  std::string text =
      fmt::format("// What {}() is made of, for the task graph.\nnamespace {} {{\n\n", code.algorithm.section.name, scope);
  for (const Stage& s : rolled_stages(code)) text += fmt::format("void {}({}) noexcept;\n", s.name, arguments_of(code, s));
  return text + "\n}  // namespace " + scope + "\n\n";
}

// What a function takes besides q and v: for the comment above it.
std::string input_meaning(const CodeInput& code) {
  const ir::EmittedFunction& function = function_of(code);
  if (!*function.input()) return "";
  return comment_lines(fmt::format("{}: {}.", function.input(), function.meaning()));
}

std::string solve_declaration(const CodeInput& code) {
  if (code.algorithm.factor < 0) return "";
  const std::string name = own_name(code, "solve");
  return comment_lines(fmt::format("b becomes M^-1 b, by the factors that {}() left: nv numbers each in columns that begin "
                                   "`stride` apart. Zero, and false, where there are none, M not being positive definite.",
                                   function_of(code).name)) +
         fmt::format(
             "bool {0}(Scalar* b, int columns, int stride, const Workspace& workspace) noexcept;\n\n"
             "// A vector, a matrix or a block of one; where its rows, known at run time only, are not nv, false and b as it "
             "was.\n"
             "template <class B>\n"
             "dalembert::Checked<bool, B> {0}(B&& b, const Workspace& workspace) noexcept {{\n"
             "  return dalembert::call_on_columns<VectorV>(\n"
             "      b, [&](auto... columns) {{ return {0}(columns..., workspace); }});\n"
             "}}\n\n",
             name);
}

std::string function_declaration(const CodeInput& code) {
  const EigenVectors eigen = eigen_vectors_of(code);
  return render("function.hpp", {{"computes", comment_lines("Computes " + quantities(code) + ".")},
                                 {"unread", unread(code)},
                                 {"input", input_meaning(code)},
                                 {"function", function_of(code).name},
                                 {"parameters", parameters_of(code)},
                                 {"arguments", arguments_of(code)},
                                 {"eigen_templates", eigen.templates},
                                 {"eigen_types", eigen.types},
                                 {"eigen_vectors", eigen.vectors},
                                 {"eigen_parameters", eigen.parameters}}) +
         solve_declaration(code);
}

// Text of each function, one after another.
template <class Of>
std::string of_functions(const Folder& folder, const Of& of) {
  std::string text;
  for (const CodeInput& code : folder.functions) text += of(code);
  return text;
}

// … of each of their sections.
template <class Of>
std::string of_sections(const Folder& folder, const Of& of) {
  std::string text;
  for (const CodeInput* section : folder.sections()) text += of(*section);
  return text;
}

// Room to work in of every function that needs it, at the end of the workspace.
std::string scratch_members(const Folder& folder) {
  std::string text;
  for (const CodeInput* code : folder.sections())
    if (const CodeInput* const rolled = code->rolled_form())
      text += kept_definition(*rolled) + fmt::format("  {} {};\n", own_type(*code, "Scratch"), own_name(*code, "scratch"));
  return text.empty() ? "" : "\n  // Scratch, which nobody needs to read.\n" + text;
}

// How the code is called, for the first lines of the header; left out behind a command of many lines, so that the interface
// begins on the first page all the same.
std::string usage(const Folder& folder, const std::string& top) {
  constexpr std::ptrdiff_t most_lines = 5;
  if (std::count(top.begin(), top.end(), '\n') >= most_lines) return "";
  const std::vector<ir::OutputArray> arrays = folder.arrays();
  if (arrays.empty()) return "";
  const CodeInput& called = folder.common();
  const std::string name = called.name, result = arrays.front().name;
  return "//\n// One call fills a workspace; results are matrices that look into it:\n" +
         fmt::format("//   {}::Workspace workspace;\n", name) +
         fmt::format("//   {}::{}({}, workspace);\n", name, function_of(called).name, arguments_of(called)) +
         fmt::format("//   const auto result = {}::{}(workspace);\n", name, result) +
         "// Behind the interface: operations counted, inputs not read, which link moves with which body.\n";
}

bool any_guard(const Folder& folder) {
  return std::any_of(folder.functions.begin(), folder.functions.end(),
                     [](const CodeInput& f) { return f.algorithm.guard.has_value(); });
}

bool any_constraints(const Folder& folder) {
  return std::any_of(folder.functions.begin(), folder.functions.end(), [](const CodeInput& f) {
    return std::any_of(f.algorithm.kernels.begin(), f.algorithm.kernels.end(),
                       [](const auto& k) { return k.of_constraints(); });
  });
}

}  // namespace

OutputFile header(const Folder& folder, const std::string& banner) {
  const CodeInput& code = folder.common();
  std::vector<std::string> joints, joint_names, body_names;
  for (const ir::Body* b : own_coordinates(code)) {
    joints.push_back(ir::identifier(b->joint));
    joint_names.push_back(quoted(b->joint));
  }
  for (const std::string& name : ir::names_of_links(*code.robot)) body_names.push_back(quoted(name));
  std::string report;
  for (const std::string& line : folder.report) report += comment_lines(line, 0, 2);
  return {
      "dynamics.hpp",
      render("dynamics.hpp",
             {{"banner", banner},
              {"usage", usage(folder, banner)},
              {"report", report},
              {"standard_includes",
               code.robot->any_quaternion() || !code.robot->linkages.empty() ? "#include <array>\n#include <cstddef>\n\n" : ""},
              {"includes", (any_constraints(folder) ? "#include <dalembert/constraint_rows.hpp>\n" : "") +
                               std::string(code.tree.linkages.empty() ? "" : "#include <dalembert/linkage.hpp>\n") +
                               std::string(any_guard(folder) ? "#include <dalembert/factor.hpp>\n" : "") +
                               (code.robot->any_quaternion() ? "#include <dalembert/quaternion_joint.hpp>\n" : "")},
              {"runtime_version", std::to_string(runtime_version)},
              {"name", code.name},
              {"code", code_mark},
              {"scalar", scalar_name(code.scene.scalar)},
              {"nq", std::to_string(code.robot->nq())},
              {"nv", std::to_string(code.robot->nv())},
              {"position_layout", position_layout(code)},
              {"velocity_layout", velocity_layout(code)},
              {"joints", std::to_string(joints.size())},
              {"joint_indices", joint_indices(code)},
              {"quaternion_joints", quaternion_joints(code)},
              {"bodies", std::to_string(body_names.size())},
              {"position_index", position_index(code)},
              {"joint_enum", wrapped(joints, 2)},
              {"joint_names", joint_names.empty() ? "nullptr" : wrapped(joint_names, 4)},
              {"body_names", wrapped(body_names, 4)},
              {"link_table", tables_of_robot(code) + moved_parameters(code)},
              {"types", types_of_inputs(code)},
              {"results", results(folder)},
              {"run_time_inputs", run_time_inputs(code)},
              {"scratch", scratch_members(folder)},
              {"functions", of_functions(folder, function_declaration) + closing_declaration(code)},
              {"views", views(folder)},
              {"view_definitions", view_definitions(folder)},
              {"workspace_bytes", std::to_string(workspace_bytes(folder))},
              {"stages", of_sections(folder, stage_declarations)}})};
}

std::size_t workspace_bytes(const Folder& folder) {
  const ir::Scene& scene = folder.common().scene;
  const std::size_t scalar = scene.scalar == ir::ScalarType::float32 ? 4 : 8;
  std::size_t bytes = 0;
  const auto align = [&] { bytes = (bytes + 63) / 64 * 64; };
  for (const CodeInput* section : folder.sections()) {
    const CodeInput& f = *section;
    for (const ir::OutputArray& a : stored_arrays(f)) {
      align();
      bytes += scalar * static_cast<std::size_t>(a.rows) * static_cast<std::size_t>(a.columns);
    }
    if (f.algorithm.embedding) bytes = (bytes + scalar - 1) / scalar * scalar + 2 * scalar + std::max<std::size_t>(scalar, 4);
    if (f.algorithm.guard && f.algorithm.section.is_first()) bytes = (bytes + scalar - 1) / scalar * scalar + 2 * scalar;
    for (const ir::Kernel& kernel : f.algorithm.kernels)
      if (*ir::row_of(kernel.kind).status) bytes = (bytes + scalar - 1) / scalar * scalar + 3 * scalar;
  }
  bytes += numbers_of_inputs(folder.common()) * scalar;
  align();
  for (const CodeInput* f : folder.sections()) {
    if (const CodeInput* rolled = f->rolled_form()) bytes += kept_bytes(*rolled);
    align();
  }
  return bytes;
}

}  // namespace dalembert::backend
