#include "backend/kernel_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <initializer_list>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>

#include "backend/literals.hpp"
#include "ir/coordinate_tree.hpp"
#include "ir/kernel.hpp"

namespace dalembert::backend {

namespace {

using KernelKind = ir::Kernel::Kind;
using ir::Operand;

std::string name(const CodeInput& code, int array) {
  return "workspace." + code.algorithm.arrays[static_cast<size_t>(array)].name;
}

template <class Of>
bool any_kernel(const CodeInput& code, const Of& of) {
  return std::any_of(code.algorithm.kernels.begin(), code.algorithm.kernels.end(), of);
}

std::string chains_text(const ir::CoordinateTree& tree) {
  std::vector<int> begin, above, depth;
  for (const ir::Chain& chain : ir::chains(tree)) {
    const int directly_above = tree.above[static_cast<size_t>(chain.first)];
    const auto of = std::upper_bound(begin.begin(), begin.end(), directly_above) - begin.begin() - 1;
    above.push_back(static_cast<int>(of));  // coordinates before the first chain: none
    begin.push_back(chain.first);
    depth.push_back(tree.depth(chain.first));
  }
  begin.push_back(tree.size());
  return fmt::format(
      "  static constexpr int chain_begin[] = {{{}}}, chain_above[] = {{{}}}, chain_depth[] = {{{}}};\n"
      "  static constexpr dalembert::Chains chains{{{}, chain_begin, chain_above, chain_depth}};\n",
      fmt::join(begin, ", "), fmt::join(above, ", "), fmt::join(depth, ", "), above.size());
}

// What stands above each chain that M's inverse and products with it go by, and its name, by the chain's first coordinate.
std::map<int, std::string> coordinates_above(const CodeInput& code, const ir::CoordinateTree& tree, std::string& text) {
  std::map<int, std::string> names;
  std::map<int, std::string> by_parent;  // chains that hang on one coordinate share a table
  for (const ir::Kernel& kernel : code.algorithm.kernels) {
    if (kernel.kind != KernelKind::invert && kernel.kind != KernelKind::negative_product) continue;
    for (const ir::Chain& chain : ir::chains(tree, kernel.first)) {
      const int parent = tree.above[static_cast<size_t>(chain.first)];
      const auto [at, is_new] = by_parent.try_emplace(parent, "{nullptr, 0}");
      if (is_new && parent >= 0) {
        std::vector<int> path;
        for (int k = parent; k >= 0; k = tree.above[static_cast<size_t>(k)]) path.push_back(k);
        text += fmt::format("  static constexpr int coordinate_{}_and_above[] = {{{}}};\n", parent, fmt::join(path, ", "));
        at->second = fmt::format("{{coordinate_{}_and_above, {}}}", parent, path.size());
      }
      names[chain.first] = at->second;
    }
  }
  return names;
}

// dalembert::ConstraintRows of the kernels' constraints.
std::string rows_type(const ir::ConstraintPaths& paths) {
  std::vector<std::string> all;
  for (size_t c = 0; c + 1 < paths.first.size(); ++c) {
    const int rows = paths.first[c + 1] - paths.first[c], length = paths.length(c);
    const bool forked = paths.common[c] < length;
    std::string type = fmt::format("RowPath<{}", rows);
    if (forked || paths.linear[c] != std::min(rows, 3))
      type = fmt::format("LoopPath<{}, {}, {}, {}", rows, paths.linear[c], paths.common[c], paths.split[c]);
    for (int i = 0; i < length; ++i) type += fmt::format(", {}", paths.path[static_cast<size_t>(paths.begin[c] + i)]);
    all.push_back("dalembert::" + type + ">");
  }
  return fmt::format("dalembert::ConstraintRows<\n      {}>", fmt::join(all, ",\n      "));
}

// dalembert::ChainTree of the robot's coordinates.
std::string tree_type(const ir::CoordinateTree& tree) {
  std::vector<std::string> all;
  for (const ir::Chain& chain : ir::chains(tree)) {
    std::string runs;
    int begin = -1, behind = -1;
    const auto add = [&] {
      if (begin >= 0) runs += fmt::format(", {}, {}", begin, behind);
    };
    for (int k = tree.above[static_cast<size_t>(chain.first)]; k >= 0; k = tree.above[static_cast<size_t>(k)]) {
      if (k != begin - 1) add(), behind = k + 1;
      begin = k;
    }
    add();
    all.push_back(fmt::format("dalembert::ChainBelow<{}, {}{}>", chain.first, chain.count, runs));
  }
  return fmt::format("dalembert::ChainTree<\n      {}>", fmt::join(all, ",\n      "));
}

// What kernels of constraints are called with besides arrays.
std::string constraint_declarations(const CodeInput& code) {
  const auto& kernels = code.algorithm.kernels;
  const auto first = std::find_if(kernels.begin(), kernels.end(), [](const ir::Kernel& k) { return k.of_constraints(); });
  if (first == kernels.end()) return "";
  std::string text = fmt::format("  using ConstraintsOfScene = {};\n", rows_type(first->paths));
  const auto any = [&](std::initializer_list<KernelKind> kinds) {
    return any_kernel(code, [&](const ir::Kernel& k) { return std::find(kinds.begin(), kinds.end(), k.kind) != kinds.end(); });
  };
  const bool supported = any({KernelKind::support, KernelKind::support_by_wrenches, KernelKind::support_at_points}),
             responds = any({KernelKind::respond, KernelKind::respond_as_solved}),
             solved = any({KernelKind::solve_constrained, KernelKind::solve_constrained_by_limbs, KernelKind::impact,
                           KernelKind::impact_by_limbs});
  if (!solved && !responds && !supported) return text;
  std::vector<std::string> active, regularization, weights;
  for (const ir::Constraint& constraint : code.scene.constraints()) {
    const std::string member = "workspace." + constraint.member;
    active.push_back(fmt::format("{}.active ? Scalar(1) : Scalar(0)", member));
    for (int i = 0; i < constraint.rows; ++i) {
      regularization.push_back(fmt::format("{}.regularization[{}]", member, i));
      weights.push_back(fmt::format("{}.weight[{}]", member, i));
    }
  }
  if (solved) text += fmt::format("  using CoordinateTree = {};\n", tree_type(ir::coordinate_tree(code.tree)));
  text += fmt::format("  const Scalar row_active[] = {{{}}};\n", fmt::join(active, ", "));
  if (solved || responds)
    text += fmt::format("  const Scalar row_regularization[] = {{\n      {}}};\n", wrapped(regularization, 6));
  if (supported) text += fmt::format("  const Scalar row_weight[] = {{\n      {}}};\n", wrapped(weights, 6));
  return text;
}

// How many of the coordinates without a motor are the base's, and all of them.
std::string undriven_text(const ir::Kernel& kernel) {
  std::string text = std::to_string(kernel.base_undriven);
  for (const int k : kernel.undriven) text += fmt::format(", {}", k);
  return text;
}

// A call's arguments in their places. others: what its row names besides operands.
std::string call_text(const CodeInput& code, const ir::Kernel& kernel, const std::string& call,
                      const std::map<std::string, std::string>& others) {
  std::string text;
  for (size_t at = 0; at < call.size();) {
    const size_t open = call.find('{', at), close = call.find('}', open);
    text += call.substr(at, open - at);
    if (open == std::string::npos) break;
    at = close + 1;
    const ir::KernelArgument argument = ir::kernel_argument(call.substr(open + 1, close - open - 1));
    if (argument.operand == Operand::count) {
      text += others.at(argument.name);
    } else if (const int array = kernel[argument.operand]; array >= 0) {
      text += (argument.may_be_absent ? ", " : "") + name(code, array);
    } else if (argument.access == ir::KernelArgument::Access::may_be_null) {
      text += "nullptr";
    } else if (!argument.may_be_absent) {
      throw std::logic_error(fmt::format("kernel {} has no {}", ir::row_of(kernel.kind).name, argument.name));
    }
  }
  return text;
}

}  // namespace

std::string kernel_statements(const CodeInput& code, const std::string& limbs, const std::string& axes) {
  if (code.algorithm.kernels.empty()) return "";
  const ir::CoordinateTree tree = ir::coordinate_tree(code.tree);
  std::string text;
  const std::map<int, std::string> above = coordinates_above(code, tree, text);
  if (solves(code)) text += chains_text(tree);
  text += constraint_declarations(code);
  bool limbs_unsaid = true;
  for (const ir::Kernel& kernel : code.algorithm.kernels) {
    if (kernel.by_limbs() && std::exchange(limbs_unsaid, false))
      text += limbs.empty() ? fmt::format("  const dalembert::LimbsInArrays<Scalar> branches{{{}, {}, {}}};\n",
                                          name(code, kernel[Operand::gain]), name(code, kernel[Operand::joint]),
                                          name(code, kernel[Operand::pivots]))
                            : limbs;
    if (kernel.by_wrenches())
      text += axes.empty()
                  ? fmt::format("  const dalembert::AxesInArray<Scalar> axes{{{}}};\n", name(code, kernel[Operand::axes]))
                  : axes;
    std::map<std::string, std::string> others{{"longest_path", std::to_string(ir::most_above(tree) + 1)},
                                              {"first_column", std::to_string(kernel.first)},
                                              {"of_forces", kernel.of_forces ? "true" : "false"},
                                              {"turning_rows", std::to_string(kernel.turning_rows)},
                                              {"undriven", undriven_text(kernel)}};
    const std::string status = ir::row_of(kernel.kind).status,
                      into = status.empty() ? "" : fmt::format("workspace.{} = ", own_name(code, status));
    const auto add = [&](const std::string& call) {
      text += fmt::format("  {}dalembert::{};\n", into, call_text(code, kernel, call, others));
    };
    for (const ir::KernelCall& call : ir::calls_of(kernel)) {
      if (!call.each_chain) {
        add(call.text);
        continue;
      }
      for (const ir::Chain& chain : ir::chains(tree, kernel.first)) {
        others["chain_first"] = std::to_string(chain.first);
        others["chain_count"] = std::to_string(chain.count);
        others["chain_end"] = std::to_string(chain.first + chain.count);
        others["chain_last"] = std::to_string(tree.last[static_cast<size_t>(chain.first)]);
        others["chain_above"] = above.at(chain.first);
        add(call.text);
      }
    }
  }
  return text;
}

std::vector<std::string> kernel_includes(const CodeInput& code) {
  std::set<std::string> headers;
  for (const ir::Kernel& kernel : code.algorithm.kernels)
    if (const std::string header = ir::row_of(kernel.kind).header; !header.empty()) headers.insert(header);
  return {headers.begin(), headers.end()};
}

bool solves(const CodeInput& code) {
  return any_kernel(code, [](const ir::Kernel& kernel) { return kernel.kind == KernelKind::factor; });
}

std::string solve_definition(const CodeInput& code) {
  if (code.algorithm.factor < 0) return "";
  return fmt::format(
      "bool {}(Scalar* b, int columns, int stride, const Workspace& workspace) noexcept {{\n"
      "{}"
      "  return dalembert::solve<nv>(chains, workspace.{}, b, columns, stride);\n"
      "}}\n\n",
      own_name(code, "solve"), chains_text(ir::coordinate_tree(code.tree)),
      code.algorithm.arrays[static_cast<size_t>(code.algorithm.factor)].name);
}

}  // namespace dalembert::backend
