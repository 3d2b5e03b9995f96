#include "backend/emit_paragraph.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <set>
#include <sstream>
#include <stdexcept>

#include "backend/graph_printer.hpp"
#include "backend/kept.hpp"
#include "backend/literals.hpp"
#include "backend/target.hpp"

namespace dalembert::backend {
namespace {

using ir::Direction;
using ir::InputKind;

// All names of a column in one: first_x_y for first_x and first_y.
std::string joined_names(const ir::Column& column) {
  std::string name = column.names.front();
  const std::string prefix = name.substr(0, name.rfind('_') + 1);
  for (size_t i = 1; i < column.names.size(); ++i) {
    const std::string& next = column.names[i];
    name += next.starts_with(prefix) ? "_" + next.substr(prefix.size()) : "_and_" + next;
  }
  return name;
}

// The same, numbered where an earlier column has it: a body's first moment and that of what hangs on it may both be constant.
std::string column_name(const std::vector<ir::Column>& columns, int index) {
  const std::string name = joined_names(columns[static_cast<size_t>(index)]);
  const auto before = std::count_if(columns.begin(), columns.begin() + index,
                                    [&](const ir::Column& column) { return joined_names(column) == name; });
  return before == 0 ? name : fmt::format("{}_{}", name, before + 1);
}

class ParagraphWriter {
 public:
  ParagraphWriter(const CodeInput& code, size_t segment, const ir::Paragraph& paragraph)
      : code_(code),
        segment_(code.plan.segments[segment]),
        rolled_(code.rolled.segments[segment]),
        paragraph_(paragraph),
        loop_(paragraph.loop),
        target_(lanes_of(loop_)) {
    for (const ir::Carried& c : paragraph.carried) carried_[c.role].push_back(&c);
  }

  std::string run() const {
    const std::string body = paragraph_.written.empty() ? text_of_loop()
                             : segment_.width == 1      ? written_out()
                                                        : written_out_in_lanes();
    return fmt::format("  // {}\n  {{\n{}  }}\n", fmt::join(paragraph_.equations, "\n  // "), body);
  }

 private:
  std::string text_of_loop() const {
    std::string step;
    for (const auto& [role, components] : carried_)
      step += fmt::format("      V next_{}[{}];\n", name(role), components.size());
    step += print(paragraph_.graph, sinks(), style());
    for (const auto& [role, components] : carried_) step += fmt::format("      dalembert::carry({0}, next_{0});\n", name(role));
    // Of limbs that move no mass there may be nothing to read or write at a slot.
    if (step.find(" + slot") != step.npos) step = fmt::format("      const int slot = {} + i;\n", loop_.first_slot) + step;
    std::string loop = fmt::format("    using V [[maybe_unused]] = {};\n", target_.type()) + carried_from_outside() +
                       loop_head() + step + "    }\n";
    if (loop_.in_parts()) loop = part_by_part(loop);
    return loop + handed_on();
  }

  // Body after body, with its constants in place.
  std::string written_out() const {
    std::string text;
    for (size_t i = 0; i < paragraph_.written.size(); ++i) text += step_text(i);
    const size_t last = paragraph_.written.size() - 1;
    for (const auto& [role, components] : carried_) {
      if (!hands_on(role)) continue;
      std::vector<std::string> values;
      for (const ir::Carried* c : components) values.push_back(carried_text(last, *c));
      text += fmt::format("    const dalembert::Lanes<Scalar, 1> {}[] = {{{}}};\n", name(role), fmt::join(values, ", "));
    }
    return text + handed_on();
  }

  // Step after step, with what all limbs' constants are in place.
  std::string written_out_in_lanes() const {
    std::string text = fmt::format("    using V [[maybe_unused]] = {};\n", target_.type());
    if (loop_.direction == Direction::outwards) text += carried_from_outside();
    for (size_t i = 0; i < paragraph_.written.size(); ++i) text += lanes_text(i);
    const size_t last = paragraph_.written.size() - 1;
    for (const auto& [role, components] : carried_) {
      if (!hands_on(role)) continue;
      std::vector<std::string> values;
      for (const ir::Carried* c : components) values.push_back(carried_text(last, *c));
      text += fmt::format("    const V {}[] = {{{}}};\n", name(role), fmt::join(values, ", "));
    }
    if (loop_.in_parts()) text = part_by_part(text);
    return text + handed_on();
  }

  std::string lanes_text(size_t i) const {
    const ir::LimbStep& step = paragraph_.written[i];
    const std::string lane = loop_.in_parts() ? " + lane" : "";
    const std::string in_table = fmt::format("{}{}", step.place * loop_.width, lane),
                      slot = fmt::format("{}{}", loop_.first_slot + step.place * loop_.width, lane);
    int temporaries = 0;
    PrintStyle s;
    s.type = "V";
    s.scalar = code_.scene.scalar;
    s.indent = "    ";
    s.flat_sums = true;
    s.broadcast = [this](const std::string& number) { return target_.broadcast(number); };
    s.name = [&](ir::NodeId) { return fmt::format("t{}_{}", ++temporaries, i + 1); };
    const auto carried = [&](const ir::Input& in) { return i == 0 ? variable(in.index, in.component) : variable(in, i); };
    const auto own = [&](const ir::Address& a) { return fmt::format("{} + {}", kept(code_, a.role, a.component), slot); };
    s.input = [&](const ir::Input& in) {
      switch (in.kind) {
        case InputKind::carried: return carried(in);
        case InputKind::kept: return in.body == ir::Address::own ? target_.load(own(address(in))) : of_all(address(in));
        default:
          return target_.load(fmt::format("{}_{} + {}", segment_.name, column_name(rolled_.columns, in.index), in_table));
      }
    };
    s.input_name = [&](const ir::Input& in) {
      return in.kind == InputKind::carried ? carried(in) : fmt::format("{}_{}", input_name(in), i + 1);
    };
    std::vector<Sink> sinks;
    for (const ir::Store& store : step.stores) sinks.push_back(stored(step.graph, store.node, own(store.to)));
    const bool last = i + 1 == paragraph_.written.size();
    for (const ir::Carried& c : step.carried)
      if (!step.graph.is_constant(c.node) && (!last || hands_on(c.role)))
        sinks.push_back({c.node, fmt::format("const V {} = ", carried_name(c, i)), ";"});
    std::vector<std::string> bodies;
    for (const int l : paragraph_.live_lanes)
      if (const int body = segment_.bodies[static_cast<size_t>(l)][static_cast<size_t>(step.place)]; body >= 0)
        bodies.push_back(body_text(body));
    return fmt::format("    // {}\n", fmt::join(bodies, ", ")) + print(step.graph, sinks, s);
  }

  std::string step_text(size_t i) const {
    const ir::LimbStep& step = paragraph_.written[i];
    int temporaries = 0;
    PrintStyle s;
    s.type = "Scalar";
    s.scalar = code_.scene.scalar;
    s.indent = "    ";
    s.flat_sums = true;
    s.name = [&](ir::NodeId) { return fmt::format("t{}_{}", ++temporaries, i + 1); };
    s.input = [&](const ir::Input& in) { return in.kind == InputKind::carried ? variable(in, i) : number(code_, address(in)); };
    s.input_name = [&](const ir::Input& in) {
      if (in.kind == InputKind::carried) return variable(in, i);
      return fmt::format("{}_{}", kept_name(address(in), step.body), i + 1);
    };
    // What the body's own values are stored over.
    s.held = [&](const ir::Input& in) {
      return in.kind == InputKind::kept && std::any_of(step.stores.begin(), step.stores.end(),
                                                       [&](const ir::Store& store) { return store.to == address(in); });
    };
    std::vector<Sink> sinks;
    std::string constants;  // at the end: they may go over what is read
    for (const ir::Store& store : step.stores) {
      const std::string to = number(code_, store.to) + " = ";
      const ir::Node& n = step.graph[store.node];
      if (n.op == ir::Op::constant) constants += fmt::format("    {}{};\n", to, literal(n.value, code_.scene.scalar));
      else sinks.push_back({store.node, to, ";"});
    }
    const bool last = i + 1 == paragraph_.written.size();
    for (const ir::Carried& c : step.carried)
      if (!step.graph.is_constant(c.node) && (!last || hands_on(c.role)))
        sinks.push_back({c.node, fmt::format("const Scalar {} = ", carried_name(c, i)), ";"});
    return fmt::format("    // {}\n", body_text(step.body)) + print(step.graph, sinks, s) + constants;
  }
  std::string body_text(int body) const { return comment_text(code_.tree.bodies[static_cast<size_t>(body)].name); }

  std::string carried_name(const ir::Carried& c, size_t step) const {
    const ir::Role& r = code_.rolled.roles[static_cast<size_t>(c.role)];
    const std::string suffix = ir::component_suffix(r.shape, c.component);
    return fmt::format("{}{}{}_{}", loop_.direction == Direction::inwards ? "handed_" : "of_", r.name,
                       suffix.empty() ? "" : "_" + suffix, step + 1);
  }
  std::string carried_text(size_t step, const ir::Carried& c) const {
    for (const ir::Carried& own : paragraph_.written[step].carried)
      if (own.role == c.role && own.component == c.component) {
        const ir::Node& n = paragraph_.written[step].graph[own.node];
        if (n.op != ir::Op::constant) return carried_name(own, step);
        const std::string number = literal(n.value, code_.scene.scalar);
        return segment_.width == 1 ? number : target_.broadcast(number);
      }
    throw std::logic_error("a value is read of a branch that it does not leave");
  }
  // Of the step before.
  std::string variable(const ir::Input& in, size_t step) const {
    ir::Carried c;
    c.role = in.index, c.component = in.component;
    return carried_name(c, step - 1);
  }

  static std::string lanes_of(const ir::SlotLoop& loop) {
    switch (loop.lanes) {
      case ir::SlotLoop::Lanes::along: return "dalembert::native_lanes";
      case ir::SlotLoop::Lanes::by_fours: return "dalembert::short_lanes";
      case ir::SlotLoop::Lanes::in_parts: return "together";
      default: return std::to_string(loop.width);
    }
  }

  // The loop for as many limbs at a time as share a register; sums over limbs are taken of all of them.
  std::string part_by_part(const std::string& loop) const {
    std::string text;
    std::string body = "    constexpr int together = decltype(some)::value;\n" + loop;
    for (const auto& [role, components] : carried_) {
      if (!hands_on(role)) continue;
      text += fmt::format("    dalembert::AllLanes<Scalar, {}> {}[{}];\n", loop_.limbs, all(role), components.size());
      body += fmt::format("    dalembert::keep_lanes({}, {}, lane);\n", all(role), name(role));
    }
    text += fmt::format("    dalembert::each_part<Scalar, {}>([&](auto some, int lane) DALEMBERT_IN_BLOCK {{\n", loop_.limbs);
    std::istringstream lines(body);
    for (std::string line; std::getline(lines, line);) text += "  " + line + "\n";
    return text + "    });\n";
  }
  bool hands_on(int role) const {
    return std::any_of(paragraph_.handed.begin(), paragraph_.handed.end(),
                       [&](const ir::HandedOn& h) { return h.role == role; });
  }
  // What the lanes of a carried role hand on.
  std::string all(int role) const { return loop_.in_parts() ? "all_" + name(role) : name(role); }

  std::string name(int role) const {
    const bool inwards = loop_.direction == Direction::inwards;
    return (inwards ? "below_" : "above_") + code_.rolled.roles[static_cast<size_t>(role)].name;
  }
  // Where among the carried components of a role this one is.
  size_t place(int role, int component) const {
    const auto& components = carried_.at(role);
    const auto at =
        std::find_if(components.begin(), components.end(), [&](const auto* c) { return c->component == component; });
    if (at == components.end()) throw std::logic_error("a value is read of the step before that is not carried");
    return static_cast<size_t>(at - components.begin());
  }
  std::string variable(int role, int component) const { return fmt::format("{}[{}]", name(role), place(role, component)); }

  std::string loop_head() const {
    const bool inwards = loop_.direction == Direction::inwards;
    const std::string begin = std::to_string(loop_.step(0) * loop_.width),
                      each = loop_.by_steps() ? std::to_string(loop_.width) : target_.width();
    return fmt::format("    for (int i = {}; i {}; i {}= {}) {{\n",
                       !loop_.in_parts() ? begin
                       : inwards         ? begin + " + lane"
                                         : "lane",
                       inwards ? ">= 0" : fmt::format("< {}", loop_.slots()), inwards ? '-' : '+', each);
  }

  PrintStyle style() const {
    PrintStyle s;
    s.type = "V";
    s.scalar = code_.scene.scalar;
    s.indent = "      ";
    s.flat_sums = true;
    s.broadcast = [this](const std::string& number) { return target_.broadcast(number); };
    s.input = [this](const ir::Input& in) { return input(in); };
    s.input_name = [this](const ir::Input& in) { return input_name(in); };
    return s;
  }

  std::string input(const ir::Input& in) const {
    switch (in.kind) {
      case InputKind::carried: return variable(in.index, in.component);
      case InputKind::kept: return in.body == ir::Address::own ? target_.load(own(address(in))) : of_all(address(in));
      case InputKind::table:
        return target_.load(fmt::format("{}_{} + i", segment_.name, column_name(rolled_.columns, in.index)));
      default: throw std::logic_error("an input of the function is read by a body");
    }
  }
  std::string input_name(const ir::Input& in) const {
    if (in.kind == InputKind::carried) return variable(in.index, in.component);
    if (in.kind == InputKind::table) return column_name(rolled_.columns, in.index) + "_k";
    return kept_name(address(in), ir::Address::own);
  }
  // own: whose numbers are called by their role alone.
  std::string kept_name(const ir::Address& a, int own) const {
    const ir::Role& r = code_.rolled.roles[static_cast<size_t>(a.role)];
    const std::string suffix = ir::component_suffix(r.shape, a.component);
    const std::string whose = a.body == own ? "" : a.body < 0 ? "base_" : fmt::format("body_{}_", a.body);
    return whose + r.name + (suffix.empty() ? "" : "_" + suffix);
  }
  // The numbers of a step's slots, and one number for all of them.
  std::string own(const ir::Address& a) const { return kept(code_, a.role, a.component) + " + slot"; }
  std::string of_all(const ir::Address& a) const { return target_.broadcast(number(code_, a)); }

  Sink stored(const ir::Graph& graph, ir::NodeId node, const std::string& to) const {
    const ir::Node& n = graph[node];
    if (n.op == ir::Op::constant) return {node, target_.store_constant(to), "));"};
    if (n.op == ir::Op::input && n.input.kind == InputKind::table) return {node, target_.store_column(to), "));"};
    return {node, target_.store(to), ");"};
  }

  std::vector<Sink> sinks() const {
    std::vector<Sink> sinks;
    for (const ir::Store& s : paragraph_.stores) sinks.push_back(stored(paragraph_.graph, s.node, own(s.to)));
    for (const auto& [role, components] : carried_)
      for (size_t i = 0; i < components.size(); ++i) {
        const std::string to = fmt::format("next_{}[{}] = ", name(role), i);
        if (paragraph_.graph.is_constant(components[i]->node))
          sinks.push_back({components[i]->node, to + target_.constant(), ");"});
        else sinks.push_back({components[i]->node, to, ";", true});
      }
    return sinks;
  }

  // Outwards: the parents' values; inwards: nothing yet.
  std::string carried_from_outside() const {
    std::string text, tables;
    std::vector<std::string> parents;  // slots to gather from
    const std::string at_lane = loop_.in_parts() ? " + lane" : "";
    for (const auto& [role, components] : carried_) {
      if (!paragraph_.written.empty() && !begins_with(role)) continue;
      std::vector<std::string> values;
      for (const ir::Carried* c : components) {
        if (loop_.direction == Direction::inwards) continue;
        std::vector<std::string> numbers;
        for (const auto& x : c->initial) numbers.push_back(literal(x.value_or(0), code_.scene.scalar));
        const bool equal =
            std::all_of(numbers.begin(), numbers.end(), [&](const std::string& x) { return x == numbers.front(); });
        if (c->known() && !equal && loop_.in_parts()) {
          const std::string table = fmt::format("{}_{}_of_parent", name(role), values.size());
          tables += fmt::format("    static constexpr Scalar {}[] = {{{}}};\n", table, fmt::join(numbers, ", "));
          values.push_back(target_.load(table + at_lane));
        } else if (c->known()) {
          values.push_back(equal ? target_.broadcast(numbers.front()) : target_.numbers(numbers));
        } else if (c->from.size() == 1) {
          values.push_back(of_all(c->from.front()));
        } else {
          values.push_back(target_.gather(kept(code_, role, c->component), "parents" + at_lane));
          parents.clear();
          for (const ir::Address& from : c->from) parents.push_back(slot_text(code_, from.body));
        }
      }
      text += fmt::format("    V {}[{}] = {{{}}};\n", name(role), components.size(), fmt::join(values, ",\n        "));
    }
    if (!parents.empty())
      tables = fmt::format("    static constexpr int parents[] = {{{}}};\n", fmt::join(parents, ", ")) + tables;
    return tables + text;
  }

  // Whether the first of the steps that are written out reads it.
  bool begins_with(int role) const {
    const ir::LimbStep& first = paragraph_.written.front();
    bool found = false;
    ir::each_input(first.graph, first.roots(),
                   [&](const ir::Input& in) { found = found || (in.kind == InputKind::carried && in.index == role); });
    return found;
  }

  // Runs of components of a role that go to one body in the same way are one call.
  std::string handed_on() const {
    std::string text;
    for (const ir::HandedOn& h : paragraph_.handed) {
      std::vector<const ir::HandedOn*> run;
      for (const ir::HandedOn& next : paragraph_.handed)
        if (next.role == h.role && next.to.role == h.to.role && next.to.body == h.to.body && next.first == h.first)
          run.push_back(&next);
      if (run.front() != &h) continue;  // printed with an earlier one
      for (size_t from = 0; from < run.size();) {
        size_t to = from + 1;
        const size_t first = place(h.role, run[from]->component);
        while (to < run.size() && run[to]->component == run[to - 1]->component + 1 &&
               place(h.role, run[to]->component) == first + (to - from))
          ++to;
        text += fmt::format("    dalembert::{}_lanes<{}>({}, {}, {} + {}, {});\n", h.first ? "set" : "add",
                            fmt::format("{}, {}, {}", loop_.width, to - from, fmt::join(h.lanes, ", ")), all(h.role), first,
                            kept(code_, h.to.role, run[from]->to.component), slot_text(code_, h.to.body), stride(code_));
        from = to;
      }
    }
    return text;
  }

  const CodeInput& code_;
  const ir::Segment& segment_;
  const ir::SegmentCode& rolled_;
  const ir::Paragraph& paragraph_;
  const ir::SlotLoop& loop_;
  const Target target_;
  std::map<int, std::vector<const ir::Carried*>> carried_;  // by role
};

}  // namespace

std::string paragraph_text(const CodeInput& code, size_t segment, const ir::Paragraph& paragraph) {
  return ParagraphWriter(code, segment, paragraph).run();
}

std::string segment_tables(const CodeInput& code, size_t segment) {
  const ir::Segment& s = code.plan.segments[segment];
  const ir::SegmentCode& c = code.rolled.segments[segment];
  std::set<int> read;
  for (const ir::SegmentStage& stage : c.stages)
    for (const ir::Paragraph& p : stage.paragraphs) {
      const auto note = [&](const ir::Graph& graph, const std::vector<ir::NodeId>& roots) {
        ir::each_input(graph, roots, [&](const ir::Input& in) {
          if (in.kind == InputKind::table) read.insert(in.index);
        });
      };
      if (p.written.empty()) note(p.graph, p.roots());
      for (const ir::LimbStep& step : p.written) note(step.graph, step.roots());
    }
  std::string text;
  for (int column : read) {
    const ir::Column& values = c.columns[static_cast<size_t>(column)];
    text += fmt::format("alignas(64) constexpr Scalar {}_{}[{}] = {{\n", s.name, column_name(c.columns, column),
                        (s.slots() + 7) / 8 * 8);
    for (int step = 0; step < s.steps; ++step) {
      std::string row;
      for (int lane = 0; lane < s.width; ++lane)
        row += literal(values.values[static_cast<size_t>(step * s.width + lane)], code.scene.scalar) + ", ";
      text += fmt::format("    {}\n", row.substr(0, row.size() - 1));
    }
    text += values.unit.empty() ? "};\n" : "};  // " + values.unit + "\n";
  }
  return text;
}

}  // namespace dalembert::backend
