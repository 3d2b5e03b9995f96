#include "passes/live.hpp"

#include <algorithm>

namespace dalembert::passes {
namespace {

using ir::InputKind;

class Walk {
 public:
  Walk(const ir::Algorithm& algorithm, int base_coordinates) : algorithm_(algorithm) {
    live_.offset = algorithm.offsets();
    const auto size = static_cast<std::size_t>(live_.offset.back());
    for (auto* set : {&live_.body, &live_.base, &live_.coordinate, &live_.handed, &live_.handed_base}) set->assign(size, false);
    // The base's coordinates where the array has them, and bodies.
    const auto need = [&](int array, bool along_rows, int role, int from, int count, bool bodies = true) {
      const ir::OutputArray& a = algorithm.arrays[static_cast<std::size_t>(array)];
      const bool coordinates = base_coordinates > 0 && (along_rows ? a.row(0) : a.column(0)) >= 0;
      for (int i = from; i < from + count; ++i) {
        if (bodies) live_.body[live_.at(role, i)] = true;
        if (coordinates) live_.coordinate[live_.at(role, i)] = true;
      }
    };
    for (const ir::Pairs& p : algorithm.pairs) {
      for (const auto* terms : {&p.above, &p.below})
        for (const ir::PairTerm& t : *terms) {
          need(p.array, true, t.upper, t.upper_from, 3);
          need(p.array, true, t.lower, t.lower_from, 3);
        }
      if (p.between >= 0) live_.body[live_.at(p.between, 0)] = true;
    }
    for (const ir::Projection& p : algorithm.projections)
      each_input(p.graph, p.columns, [&](const ir::Input& in) {
        if (in.kind == InputKind::carried) return need(p.array, true, in.index, in.component, 1);
        live_.body[live_.at(in.index, in.component)] = true;
        const ir::OutputArray& a = algorithm.arrays[static_cast<std::size_t>(p.array)];
        if (base_coordinates > 0 && a.column(0) >= 0) live_.base[live_.at(in.index, in.component)] = true;
      });
    for (const ir::Result& r : algorithm.results) {
      const int count = algorithm.roles[static_cast<std::size_t>(r.role)].components();
      if (r.layout != ir::Layout::base) {
        const bool along_rows = r.layout == ir::Layout::per_coordinate;
        const ir::OutputArray& a = algorithm.arrays[static_cast<std::size_t>(r.array)];
        const std::vector<int>& map = along_rows ? a.row_map : a.column_map;
        const bool bodies =
            map.empty() || std::any_of(map.begin() + base_coordinates, map.end(), [](int at) { return at >= 0; });
        need(r.array, along_rows, r.role, 0, count, bodies);
      }
      for (int i = 0; i < count && r.layout == ir::Layout::base; ++i) live_.base[live_.at(r.role, i)] = true;
    }
  }

  Live run() {
    for (Live before; !(before == live_);) {
      before = live_;
      for (std::size_t s = algorithm_.sweeps.size(); s-- > 0;) visit(algorithm_.sweeps[s]);
    }
    return live_;
  }

 private:
  void visit(const ir::Sweep& s) {
    using ir::Direction;
    std::vector<ir::NodeId> at_body, at_base;
    for (const ir::Value& v : s.stores) {
      const std::size_t at = live_.at(v.role, v.component);
      if (s.over.is_base()) {
        if (v.coordinate < 0 ? live_.base[at] : live_.coordinate[at]) at_base.push_back(v.node);
      } else {
        if (live_.body[at]) at_body.push_back(v.node);
        if (live_.base[at] && s.direction != Direction::outwards) at_base.push_back(v.node);
      }
    }
    for (const ir::Value& v : s.carries)
      if (const std::size_t at = live_.at(v.role, v.component); live_.handed[at] || live_.handed_base[at])
        at_body.push_back(v.node);
    if (s.back && !at_body.empty()) of_reference(*s.back);
    each_input(s.graph, at_body, [&](const ir::Input& in) {
      if (in.kind == InputKind::state) live_.body[live_.at(in.index, in.component)] = true;
      if (in.kind == InputKind::carried && s.direction == Direction::inwards)
        live_.handed[live_.at(in.index, in.component)] = true;
      if (in.kind == InputKind::carried && s.direction == Direction::outwards)
        live_.body[live_.at(in.index, in.component)] = live_.base[live_.at(in.index, in.component)] = true;
      if (in.kind == InputKind::of_body) of_body(in);
    });
    each_input(s.graph, at_base, [&](const ir::Input& in) {
      if (in.kind == InputKind::state) live_.base[live_.at(in.index, in.component)] = true;
      if (in.kind == InputKind::carried) live_.handed_base[live_.at(in.index, in.component)] = true;
      if (in.kind == InputKind::of_body) of_body(in);
    });
  }
  // What the body whose frame is that of reference has already.
  void of_reference(const ir::Back& back) {
    std::vector<ir::NodeId> nodes;
    for (const ir::Value& v : back.at_reference) nodes.push_back(v.node);
    each_input(back.graph, nodes, [&](const ir::Input& in) { live_.body[live_.at(in.index, in.component)] = true; });
  }
  void of_body(const ir::Input& in) { (in.body < 0 ? live_.base : live_.body)[live_.at(in.index, in.component)] = true; }

  const ir::Algorithm& algorithm_;
  Live live_;
};

}  // namespace

Live live(const ir::Algorithm& algorithm, int base_coordinates) { return Walk(algorithm, base_coordinates).run(); }

}  // namespace dalembert::passes
