#include "backend/emit_paragraph.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <set>

#include "backend/graph_printer.hpp"
#include "backend/literals.hpp"

namespace dalembert::backend {
namespace {

using ir::Direction;
using ir::InputKind;

class ParagraphWriter {
 public:
  ParagraphWriter(const CodeInput& code, size_t segment, const ir::Paragraph& paragraph)
      : code_(code),
        index_(segment),
        segment_(code.plan.segments[segment]),
        table_(code.rolled.segments[segment]),
        paragraph_(paragraph),
        width_(paragraph.direction != Direction::anywhere ? std::to_string(segment_.width)
               : segment_.is_short()                      ? "dalembert::short_lanes"
                                                          : "dalembert::native_lanes") {}

  std::string run() const {
    std::string text = fmt::format("  // {}\n  {{\n    using V [[maybe_unused]] = dalembert::Lanes<Scalar, {}>;\n",
                                   fmt::join(paragraph_.equations, "\n  // "), width_);
    if (paragraph_.direction != Direction::anywhere) text += carried_from_outside();
    text += loop_head();
    text += print(paragraph_.graph, sinks(), style());
    for (const ir::StateStore& c : paragraph_.carried)
      text += fmt::format("      {0} = next_{0};\n", variable(c.role, c.component));
    text += "    }\n";
    if (paragraph_.direction == Direction::inwards) text += carried_to_parents();
    return text + "  }\n";
  }

 private:
  std::string variable(int role, int component) const {
    const ir::Role& r = code_.rolled.roles[static_cast<size_t>(role)];
    return r.components == 1 ? "carried_" + r.name : fmt::format("carried_{}_{}", r.name, component);
  }

  std::string loop_head() const {
    switch (paragraph_.direction) {
      case Direction::anywhere:
        return fmt::format("    for (int i = 0; i < {}; i += {}) {{\n      const int slot = {} + i;\n", segment_.slots(),
                           width_, segment_.first_slot);
      case Direction::outwards:
        return fmt::format("    for (int i = 0; i < {}; i += {}) {{\n      const int slot = {} + i;\n", segment_.slots(),
                           segment_.width, segment_.first_slot);
      case Direction::inwards:
        return fmt::format("    for (int i = {}; i >= 0; i -= {}) {{\n      const int slot = {} + i;\n",
                           segment_.slots() - segment_.width, segment_.width, segment_.first_slot);
    }
    return "";
  }

  PrintStyle style() const {
    PrintStyle s;
    s.type = "V";
    s.scalar = code_.scene.scalar;
    s.indent = "      ";
    s.flat_sums = true;
    s.input = [this](const ir::Input& in) { return input(in); };
    s.input_name = [this](const ir::Input& in) { return input_name(in); };
    return s;
  }

  std::string input(const ir::Input& in) const {
    switch (in.kind) {
      case InputKind::carried: return variable(in.index, in.component);
      case InputKind::state: return fmt::format("dalembert::load<{}>({} + slot)", width_, kept(code_, in.index, in.component));
      case InputKind::table:
        return fmt::format("dalembert::load<{}>({}_{} + i)", width_, segment_.name,
                           table_.columns[static_cast<size_t>(in.index)].name);
      case InputKind::velocity:  // of the base
        return fmt::format("dalembert::broadcast<{}>({}[{}])", width_, kept(code_, "velocity", in.index), slot_of(code_, -1));
      default: return "";
    }
  }
  std::string input_name(const ir::Input& in) const {
    switch (in.kind) {
      case InputKind::carried: return variable(in.index, in.component);
      case InputKind::state: {
        const ir::Role& r = code_.rolled.roles[static_cast<size_t>(in.index)];
        return r.components == 1 ? r.name : fmt::format("{}_{}", r.name, in.component);
      }
      case InputKind::table: return table_.columns[static_cast<size_t>(in.index)].name + "_k";
      default: return fmt::format("base_velocity_{}", in.index);
    }
  }
  std::vector<Sink> sinks() const {
    std::vector<Sink> sinks;
    for (const ir::StateStore& s : paragraph_.stores) {
      const std::string to = fmt::format("dalembert::store<{}, Scalar>({} + slot, ", width_, kept(code_, s.role, s.component));
      if (paragraph_.graph.is_constant(s.node))
        sinks.push_back({s.node, to + fmt::format("dalembert::broadcast<{}, Scalar>(", width_), "));"});
      else sinks.push_back({s.node, to, ");"});
    }
    for (const ir::StateStore& c : paragraph_.carried) {
      const bool constant = paragraph_.graph.is_constant(c.node);
      sinks.push_back(
          {c.node, fmt::format("const V next_{} = {}", variable(c.role, c.component), constant ? "V{} + " : ""), ";"});
    }
    return sinks;
  }

  // Outwards: the parents' values; inwards: nothing yet.
  std::string carried_from_outside() const {
    std::string text;
    std::set<int> parents;
    std::vector<int> slots;
    for (size_t lane = 0; lane < segment_.parents.size(); ++lane) {
      slots.push_back(slot_of(code_, segment_.parents[lane]));
      if (segment_.bodies[lane].front() >= 0) parents.insert(segment_.parents[lane]);
    }
    const bool together = parents.size() == 1;
    const bool outwards = paragraph_.direction == Direction::outwards;
    if (outwards && !together && !paragraph_.carried.empty())
      text += fmt::format("    static constexpr int parents[] = {{{}}};\n", fmt::join(slots, ", "));
    for (const ir::StateStore& c : paragraph_.carried) {
      std::string from = "V{}";
      if (outwards)
        from = together ? fmt::format("dalembert::broadcast<{}>({}[{}])", width_, kept(code_, c.role, c.component),
                                      slot_of(code_, *parents.begin()))
                        : fmt::format("dalembert::gather<{}>({}, parents)", width_, kept(code_, c.role, c.component));
      text += fmt::format("    V {} = {};\n", variable(c.role, c.component), from);
    }
    return text;
  }

  std::string carried_to_parents() const {
    std::string text;
    std::map<int, std::vector<size_t>> lanes_of;  // by parent
    for (size_t lane = 0; lane < segment_.parents.size(); ++lane)
      if (segment_.bodies[lane].front() >= 0 && (segment_.parents[lane] >= 0 || code_.tree.floating_base))
        lanes_of[segment_.parents[lane]].push_back(lane);
    for (const ir::StateStore& c : paragraph_.carried)
      for (const auto& [parent, lanes] : lanes_of) {
        std::vector<std::string> terms;
        for (size_t lane : lanes)
          terms.push_back(fmt::format("dalembert::lane<{}, Scalar>({}, {})", width_, variable(c.role, c.component), lane));
        text += fmt::format("    {}[{}] {} {};\n", kept(code_, c.role, c.component), slot_of(code_, parent),
                            arrives_first(parent, c) ? "=" : "+=", fmt::join(terms, " + "));
      }
    return text;
  }

  // Whether nothing was kept in the parent's slot before: no share of its own, and no other limb's. Last segments come first.
  bool arrives_first(int parent, const ir::StateStore& c) const {
    if (parent < 0) return false;  // the root stores its own share
    const auto& received = code_.rolled.segments[static_cast<size_t>(code_.plan.segment_of(parent))].received;
    if (std::find(received.begin(), received.end(), ir::StateValue{c.role, c.component}) == received.end()) return false;
    for (size_t s = index_ + 1; s < code_.plan.segments.size(); ++s) {
      const ir::Segment& other = code_.plan.segments[s];
      for (size_t lane = 0; lane < other.parents.size(); ++lane)
        if (other.bodies[lane].front() >= 0 && other.parents[lane] == parent) return false;
    }
    return true;
  }

  const CodeInput& code_;
  size_t index_;
  const ir::Segment& segment_;
  const ir::SegmentCode& table_;
  const ir::Paragraph& paragraph_;
  std::string width_;
};

}  // namespace

std::string kept(const CodeInput& code, int role, int component) {
  const ir::Role& r = code.rolled.roles[static_cast<size_t>(role)];
  const bool own = r.place < 0;
  return fmt::format("kept.{}{}{}{}", r.name, own ? '[' : '(', component, own ? ']' : ')');
}

std::string kept(const CodeInput& code, std::string_view role, int component) {
  const auto& roles = code.rolled.roles;
  const auto at = std::find_if(roles.begin(), roles.end(), [&](const ir::Role& r) { return r.name == role; });
  return at == roles.end() ? "" : kept(code, static_cast<int>(at - roles.begin()), component);
}

int slot_of(const CodeInput& code, int body) {
  return body < 0 ? code.plan.root_slot : code.plan.slot_of[static_cast<size_t>(body)];
}

std::string paragraph_text(const CodeInput& code, size_t segment, const ir::Paragraph& paragraph) {
  return ParagraphWriter(code, segment, paragraph).run();
}

std::string segment_tables(const CodeInput& code, size_t segment) {
  const ir::Segment& s = code.plan.segments[segment];
  const ir::SegmentCode& c = code.rolled.segments[segment];
  std::set<int> read;
  for (const ir::Paragraph& p : c.paragraphs) {
    std::vector<ir::NodeId> roots;
    for (const auto& x : p.stores) roots.push_back(x.node);
    for (const auto& x : p.carried) roots.push_back(x.node);
    const auto uses = ir::uses(p.graph, roots);
    for (ir::NodeId id = 0; id < p.graph.size(); ++id)
      if (uses[static_cast<size_t>(id)] > 0 && p.graph[id].op == ir::Op::input && p.graph[id].input.kind == InputKind::table)
        read.insert(p.graph[id].input.index);
  }
  std::string text;
  for (int column : read) {
    const ir::Column& values = c.columns[static_cast<size_t>(column)];
    text += fmt::format("alignas(64) constexpr Scalar {}_{}[{}] = {{\n", s.name, values.name, (s.slots() + 7) / 8 * 8);
    for (int step = 0; step < s.steps; ++step) {
      std::string row;
      for (int lane = 0; lane < s.width; ++lane)
        row += literal(values.values[static_cast<size_t>(step * s.width + lane)], code.scene.scalar) + ", ";
      text += fmt::format("    {}\n", row.substr(0, row.size() - 1));
    }
    text += "};\n";
  }
  return text;
}

}  // namespace dalembert::backend
