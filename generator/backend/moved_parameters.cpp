#include "backend/moved_parameters.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <vector>

#include "backend/literals.hpp"

namespace dalembert::backend {
namespace {

std::string list_of(const ir::Moments& moved, bool turns) {
  std::vector<std::string> parts;
  const auto add = [&](bool any, const char* name) {
    if (any) parts.emplace_back(name);
  };
  add(moved.mass != 0, "m");
  add(!moved.first.isZero(0), "h_z");
  add(!moved.second.isZero(0), turns ? "S_zz" : "S");
  add(moved.half_trace != 0, "t");
  return fmt::format("{}", fmt::join(parts, ", "));
}

}  // namespace

std::string moved_parameters(const CodeInput& code) {
  std::string text;
  const auto name_of = [&](int body) {
    return body < 0 ? code.tree.base_link : code.tree.bodies[static_cast<size_t>(body)].name;
  };
  bool weightless = code.scene.payloads.empty(), turns = false;
  for (size_t k = 0; k < code.normal.bodies.size(); ++k) {
    const ir::NormalBody& n = code.normal.bodies[k];
    weightless = weightless && n.moments.mass == 0;
    turns = turns || n.turning != 0;
    if (const std::string list = list_of(n.moved, n.turning != 0); !list.empty())
      text += comment_lines(fmt::format("  {:<32} {:<32} {}", name_of(static_cast<int>(k)), name_of(n.parent), list), 0, 4);
  }
  if (text.empty()) return "";
  std::string head =
      "//\n" + comment_lines(
                   "Base-parameter regrouping: inertial parameters that move in the same way with a body and with its "
                   "parent count as the parent's; the results do not change, and what is zero costs nothing. In a frame "
                   "whose z is the joint's axis they are, of a body that turns, the mass m, the first moment's h_z and the "
                   "second moment's S_zz, a distribution of mass along the axis; of one that slides, S and t, half the "
                   "trace of its inertia.");
  if (weightless && turns)
    head +=
        comment_lines("No body that moves has mass left, and no subtree: F = A* J and G = A* dJ + B* J have no term with m.");
  return head + "// From, to, what (with what the body got from its descendants):\n" + text;
}

}  // namespace dalembert::backend
