#include "backend/emit_c.hpp"

#include <fmt/format.h>

#include <utility>

#include "backend/code_text.hpp"
#include "backend/literals.hpp"
#include "ir/identifier.hpp"

namespace dalembert::backend {
namespace {

class CInterface {
 public:
  explicit CInterface(const Folder& folder)
      : folder_(folder), code_(folder.common()), n_(code_.name), s_(scalar_name(code_.scene.scalar)) {}

  CText run() {
    calls();
    linkages();
    factors();
    results();
    gravity_and_wrenches();
    constraints();
    constraint_status();
    payloads();
    return std::move(text_);
  }

 private:
  void add(const std::string& comment, const std::string& signature, const std::string& body) {
    text_.declarations += comment_lines(comment) + signature + ";\n\n";
    text_.definitions += fmt::format("{} {{\n{}}}\n\n", signature, body);
  }

  void calls() {
    for (const CodeInput& f : folder_.functions) {
      const ir::EmittedFunction& function = function_of(f);
      const std::string input =
          *function.input() ? fmt::format(", {}: {}_nv() {}", function.input(), n_, function.meaning()) : "";
      add(fmt::format("Computes {}. q: {}_nq() positions, v: {}_nv() velocities{}. Does not allocate.", quantities(f), n_, n_,
                      input),
          fmt::format("void {}_{}({}, {}_workspace* workspace)", n_, function.name,
                      parameters_of(f, fmt::format("const {}* ", s_)), n_),
          fmt::format("  {}::{}({}, *workspace);\n", n_, function.name, arguments_of(f)));
    }
  }

  void linkages() {
    if (!code_.tree.linkages.empty())
      add("Closes the embedded loops: q's dependent joints move. error: the largest that is left, m or rad; least_pivot: as in "
          "dalembert::LinkageStatus; null: not wanted. The linkage at a toggle point, counted from 0; -1: none is",
          fmt::format("int {0}_close_loops({1}* q, {1}* error, {1}* least_pivot)", n_, s_),
          fmt::format("  const dalembert::LinkageStatus<{1}> status = {0}::close_loops(q);\n"
                      "  if (error) *error = status.error;\n"
                      "  if (least_pivot) *least_pivot = status.least_pivot;\n"
                      "  return status.linkage;\n",
                      n_, s_));
    for (const CodeInput& f : folder_.functions) {
      if (!f.algorithm.embedding) continue;
      const std::string status = own_name(f, "linkage_status");
      add("The linkage at a toggle point, counted from 0, as of the last call; -1: none is. error, m or rad, least_pivot: as "
          "in "
          "dalembert::LinkageStatus; null: not wanted",
          fmt::format("int {1}_{2}({0}* error, {0}* least_pivot, const {1}_workspace* workspace)", s_, n_, status),
          fmt::format("  if (error) *error = workspace->{0}.error;\n"
                      "  if (least_pivot) *least_pivot = workspace->{0}.least_pivot;\n"
                      "  return workspace->{0}.linkage;\n",
                      status));
    }
  }

  // Whether M is positive definite, and what its factors solve.
  void factors() {
    for (const CodeInput& f : folder_.functions) {
      if (!f.algorithm.guard) continue;
      const std::string status = own_name(f, "status");
      add(fmt::format(
              "The coordinate whose pivot shows that the mass matrix is not positive definite, as of the last call; -1: it is"),
          fmt::format("int {}_{}(const {}_workspace* workspace)", n_, status, n_),
          fmt::format("  return workspace->{}.coordinate;\n", status));
    }
    for (const CodeInput& f : folder_.functions) {
      if (f.algorithm.factor < 0) continue;
      const std::string name = own_name(f, "solve");
      add(fmt::format("b becomes M^-1 b, by the factors that {}_{}() left: columns of {}_nv() numbers, one after another. 1; 0 "
                      "where M is not positive definite, and b is zero then",
                      n_, function_of(f).name, n_),
          fmt::format("int {}_{}({}* b, int columns, const {}_workspace* workspace)", n_, name, s_, n_),
          fmt::format("  return {0}::{1}(b, columns, {0}::nv, *workspace) ? 1 : 0;\n", n_, name));
    }
  }

  void results() {
    for (const ir::OutputArray& a : folder_.arrays())
      add(result_words(folder_, a),
          fmt::format("const {}* {}_{}(const {}_workspace* workspace)", s_, n_, ir::c_accessor(a.name), n_),
          fmt::format("  return workspace->{};\n", a.name));
  }

  void gravity_and_wrenches() {
    if (code_.scene.gravity_kind == ir::GravityKind::run_time)
      add("gravity: 3 numbers, m/s^2, world axes",
          fmt::format("void {}_set_gravity(const {}* gravity, {}_workspace* workspace)", n_, s_, n_),
          "  for (int i = 0; i < 3; ++i) workspace->gravity_vector[i] = gravity[i];\n");
    for (const ir::ExternalWrench& wrench : code_.scene.wrenches) {
      const std::string id = ir::identifier(wrench.link);
      add(fmt::format("wrench: force (N), then moment (N m) on the link at its origin, along {} axes",
                      wrench.in_world ? "the world's" : "its"),
          fmt::format("void {0}_set_wrench_{1}(const {2}* wrench, {0}_workspace* workspace)", n_, id, s_),
          fmt::format("  for (int i = 0; i < 6; ++i) workspace->wrench_{}[i] = wrench[i];\n", id));
    }
  }

  void constraints() {
    // A contact's first, then every weight, a loop's behind its own.
    for (const ir::Constraint& c : code_.scene.constraints())
      if (!c.loop) acting(c);
    for (const ir::Constraint& c : code_.scene.constraints()) {
      add(fmt::format("weight: {} numbers, of the rows' forces in inverse dynamics", c.rows),
          fmt::format("void {0}_weigh_{1}(const {2}* weight, {0}_workspace* workspace)", n_, c.member, s_),
          fmt::format("  for (int i = 0; i < {1}; ++i) workspace->{0}.weight[i] = weight[i];\n", c.member, c.rows));
      if (c.loop) acting(c);
    }
  }

  // How a contact or loop acts.
  void acting(const ir::Constraint& c) {
    const char *const type = c.loop ? "Loop" : "Contact", *const it = c.loop ? "loop" : "contact";
    std::string body = fmt::format("  {0}::{1}& {2} = workspace->{3};\n  {2}.active = active != 0;\n", n_, type, it, c.member);
    for (const char* number : {"kp", "kd", "restitution"}) body += fmt::format("  {0}.{1} = {1};\n", it, number);
    const auto numbers = [&](const char* name, int count) {
      body += fmt::format("  for (int i = 0; {1} && i < {2}; ++i) {0}.{1}[i] = {1}[i];\n", it, name, count);
    };
    if (!c.loop) numbers("anchor", 7);
    numbers("regularization", c.rows);
    add(fmt::format("active: 1 or 0, kp (1/s^2), kd (1/s), restitution: as in {}::{}; {}regularization: {}; null: {}", n_, type,
                    c.loop ? "" : "anchor: 7 numbers, ", c.rows, c.loop ? "as it is" : "as they are"),
        fmt::format("void {0}_set_{1}(int active, {2} kp, {2} kd, {2} restitution, {3}{4}const {2}* regularization{5}"
                    "{0}_workspace* workspace)",
                    n_, c.member, s_, c.loop ? "" : fmt::format("const {}* anchor,", s_), c.loop ? "" : "\n    ",
                    c.loop ? ",\n    " : ", "),
        body);
  }

  void constraint_status() {
    for (const CodeInput& f : folder_.functions)
      for (const ir::Kernel& kernel : f.algorithm.kernels)
        if (const char* status = ir::row_of(kernel.kind).status; *status)
          add("The largest error that is left of a constraint's row; least_pivot, rank: as in dalembert::ConstraintStatus; "
              "null: "
              "not wanted",
              fmt::format("{0} {1}_{2}({0}* least_pivot, int* rank, const {1}_workspace* workspace)", s_, n_,
                          own_name(f, status)),
              fmt::format("  if (least_pivot) *least_pivot = workspace->{0}.least_pivot;\n"
                          "  if (rank) *rank = workspace->{0}.rank;\n"
                          "  return workspace->{0}.residual;\n",
                          own_name(f, status)));
  }

  void payloads() {
    for (const std::string& link : code_.scene.payloads) {
      const std::string id = ir::identifier(link);
      add("mass (kg), com: 3 numbers (m, link axes), inertia: xx xy xz yy yz zz about the com (kg m^2, link axes)",
          fmt::format("void {0}_set_payload_{1}({2} mass, const {2}* com, const {2}* inertia, {0}_workspace* workspace)", n_,
                      id, s_),
          fmt::format("  {0}::Payload& payload = workspace->payload_{1};\n"
                      "  payload.mass = mass;\n"
                      "  for (int i = 0; i < 3; ++i) payload.com[i] = com[i];\n"
                      "  for (int i = 0; i < 6; ++i) payload.inertia[i] = inertia[i];\n",
                      n_, id));
    }
  }

  const Folder& folder_;
  const CodeInput& code_;
  const std::string n_, s_;  // the folder's name and its scalar
  CText text_;
};

}  // namespace

CText c_functions(const Folder& folder) { return CInterface(folder).run(); }

}  // namespace dalembert::backend
