#include <algorithm>

#include "passes/roll_state.hpp"

namespace dalembert::passes {
namespace {

using ir::Direction;
using ir::InputKind;
using ir::NodeId;
using ir::Paragraph;
using Values = std::set<RoleComponent>;

class Pruning {
 public:
  explicit Pruning(RollState& state) : state_(state), slots_(state.program.segments.size()) {
    for (std::size_t s = 0; s < slots_.size(); ++s) slots_[s].read = read_by_results(state.plan.segments[s]);
    const Live& live = state.unroll.live();
    for (const ir::Sweep& sweep : state.algorithm.sweeps) {
      if (!sweep.over.is_base()) continue;
      std::vector<NodeId> roots;
      for (const ir::Value& v : sweep.stores)
        if ((v.coordinate < 0 ? live.base : live.coordinate)[live.at(v.role, v.component)]) roots.push_back(v.node);
      each_input(sweep.graph, roots, [&](const ir::Input& in) { read_of_body(in); });
    }
  }

  // Segments exchange values at branches: what is read is followed until nothing new turns up, then the rest is dropped.
  void run() {
    for (bool changed = true; changed;) {
      const auto before = std::pair(slots_, state_.base_needs);
      for (std::size_t s = 0; s < slots_.size(); ++s) each_paragraph(s, [&](Paragraph& p) { follow(s, p); });
      changed = std::pair(slots_, state_.base_needs) != before;
    }
    for (std::size_t s = 0; s < slots_.size(); ++s) {
      ir::SegmentCode& code = state_.program.segments[s];
      each_paragraph(s, [&](Paragraph& p) {
        const Values live = follow(s, p);
        std::erase_if(p.stores, [&](const ir::Store& v) { return !slots_[s].keeps({v.to.role, v.to.component}); });
        std::erase_if(p.carried, [&](const ir::Carried& c) { return !carries(s, p, c, live); });
      });
      for (ir::SegmentStage& stage : code.stages)
        std::erase_if(stage.paragraphs, [](const Paragraph& p) { return p.stores.empty() && p.carried.empty(); });
      std::erase_if(code.stages, [](const ir::SegmentStage& stage) { return stage.paragraphs.empty(); });
      state_.read.push_back(slots_[s].read);
    }
    hand_on();
  }

 private:
  struct Slots {
    Values read;      // by the segment itself and by the results
    Values gathered;  // by limbs attached to it, at their start
    Values received;  // what they hand on, in a place of its own
    bool operator==(const Slots&) const = default;
    bool keeps(const RoleComponent& v) const { return read.contains(v) || gathered.contains(v); }
  };

  void read_of_body(const ir::Input& in) {
    if (in.kind == InputKind::of_body && in.body >= 0)
      slots_[static_cast<std::size_t>(state_.plan.segment_of(in.body))].read.insert({in.index, in.component});
  }

  template <class F>
  void each_paragraph(std::size_t segment, const F& f) {
    auto& stages = state_.program.segments[segment].stages;
    for (std::size_t i = stages.size(); i-- > 0;)
      for (std::size_t p = stages[i].paragraphs.size(); p-- > 0;) f(stages[i].paragraphs[p]);
  }

  bool wanted_by(int parent, const RoleComponent& value) const {
    if (parent < 0) {
      const Live& live = state_.unroll.live();
      return live.handed_base[live.at(value.first, value.second)] &&
             !state_.constant(state_.unroll.handed(value.first, value.second, -1));
    }
    const int segment = state_.plan.segment_of(parent);
    const Slots& s = slots_[static_cast<std::size_t>(segment)];
    if (!state_.adds_to_own(segment, value)) return s.received.contains(value);
    return s.read.contains(value) && !receives_constants(state_.plan.segments[static_cast<std::size_t>(segment)], value);
  }

  // Whether what bodies of the segment receive is known: loops have it in a column then, with what branches hand on.
  bool receives_constants(const ir::Segment& segment, const RoleComponent& value) const {
    for (const auto& limb : segment.bodies)
      for (const int body : limb)
        if (body >= 0 && !state_.constant(state_.unroll.handed(value.first, value.second, body))) return false;
    return true;
  }

  bool carries(std::size_t segment, const Paragraph& p, const ir::Carried& c, const Values& live) const {
    const RoleComponent value{c.role, c.component};
    if (live.contains(value)) return true;
    const ir::Segment& s = state_.plan.segments[segment];
    if (p.loop.direction != Direction::inwards) return false;
    for (std::size_t lane = 0; lane < s.parents.size(); ++lane)
      if (s.bodies[lane].front() >= 0 && wanted_by(s.parents[lane], value)) return true;
    return false;
  }

  // The carried values a paragraph needs for what it keeps; notes what it reads.
  Values follow(std::size_t segment, const Paragraph& p) {
    Slots& own = slots_[segment];
    Values live;
    for (Values before{{-1, -1}}; live != before;) {
      before = live;
      std::vector<NodeId> roots;
      for (const ir::Store& s : p.stores)
        if (own.keeps({s.to.role, s.to.component})) roots.push_back(s.node);
      for (const ir::Carried& c : p.carried)
        if (carries(segment, p, c, live)) roots.push_back(c.node);
      each_input(p.graph, roots, [&](const ir::Input& in) {
        const RoleComponent value{in.index, in.component};
        if (in.kind == InputKind::carried) live.insert(value);
        if (in.kind == InputKind::state) own.read.insert(value);
        if (in.kind == InputKind::received) own.received.insert(value);
        if (in.kind == InputKind::of_body && in.body < 0) state_.base_needs.insert(value);
        read_of_body(in);
      });
    }
    if (p.loop.direction == Direction::outwards)
      for (const ir::Carried& c : p.carried) {
        if (!live.contains({c.role, c.component})) continue;
        if (c.known()) continue;
        for (std::size_t lane = 0; lane < c.initial.size(); ++lane) {
          if (state_.plan.segments[segment].bodies[lane].front() < 0) continue;
          const int parent = state_.plan.segments[segment].parents[lane];
          if (parent < 0) state_.base_needs.insert({c.role, c.component});
          else slots_[static_cast<std::size_t>(state_.plan.segment_of(parent))].gathered.insert({c.role, c.component});
        }
      }
    return live;
  }

  // What pairs, projections and results read of the segment's bodies.
  Values read_by_results(const ir::Segment& segment) const {
    Values read;
    const auto any_asked = [&](int array, bool along_rows) {
      for (const auto& limb : segment.bodies)
        for (const int body : limb)
          if (body >= 0 && state_.asked(array, along_rows, body)) return true;
      return false;
    };
    const auto need = [&](int role, int from, int count) {
      for (int i = from; i < from + count && role >= 0; ++i) read.insert({role, i});
    };
    const ir::Algorithm& a = state_.algorithm;
    for (std::size_t p = 0; p < a.pairs.size(); ++p) {
      if (!any_asked(a.pairs[p].array, true)) continue;
      for (const auto* terms : {&a.pairs[p].above, &a.pairs[p].below})
        for (const ir::PairTerm& t : *terms) need(t.lower, t.lower_from, 3), need(t.upper, t.upper_from, 3);
      need(a.pairs[p].between, 0, 1);
      need(state_.program.pairs[p].columns, 0, 6);
      need(state_.program.pairs[p].rows, 0, 6);
    }
    for (const ir::Projection& p : a.projections)
      each_input(p.graph, p.columns, [&](const ir::Input& in) { need(in.index, in.component, 1); });
    for (const ir::Result& r : a.results)
      if (r.layout != ir::Layout::base && any_asked(r.array, r.layout == ir::Layout::per_coordinate))
        need(r.role, 0, a.roles[static_cast<std::size_t>(r.role)].components());
    return read;
  }

  // Who hands on what to whom, in the order of the stages: the last segment first.
  void hand_on() {
    std::set<std::tuple<int, RoleComponent, int>> set;  // level, value, parent
    for (std::size_t s = slots_.size(); s-- > 0;) {
      const ir::Segment& segment = state_.plan.segments[s];
      for (ir::SegmentStage& stage : state_.program.segments[s].stages)
        for (Paragraph& p : stage.paragraphs) {
          if (p.loop.direction != Direction::inwards) continue;
          for (const ir::Carried& c : p.carried) {
            std::map<int, std::vector<int>> lanes_of;  // by parent
            for (std::size_t lane = 0; lane < segment.parents.size(); ++lane)
              if (segment.bodies[lane].front() >= 0) lanes_of[segment.parents[lane]].push_back(static_cast<int>(lane));
            const RoleComponent value{c.role, c.component};
            for (const auto& [parent, lanes] : lanes_of) {
              if (!wanted_by(parent, value)) continue;
              const bool received = !state_.adds_to_own(parent < 0 ? -1 : state_.plan.segment_of(parent), value);
              const bool first = received && set.insert({stage.level, value, parent}).second;
              const ir::Address to{received ? ir::Address::unknown : c.role, c.component, parent};
              p.handed.push_back({c.role, c.component, to, lanes, first});
            }
          }
        }
    }
  }

  RollState& state_;
  std::vector<Slots> slots_;
};

}  // namespace

void prune(RollState& state) { Pruning(state).run(); }

}  // namespace dalembert::passes
