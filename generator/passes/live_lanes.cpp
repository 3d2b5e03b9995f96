#include "passes/live_lanes.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <utility>
#include <vector>

namespace dalembert::passes {
namespace {

using ir::Address;
using ir::Direction;
using ir::InputKind;

class LiveLanes {
 public:
  LiveLanes(const ir::Algorithm& algorithm, const ir::Plan& plan, ir::RolledProgram& program) : plan_(plan), program_(program) {
    lane_of_.resize(plan.slot_of.size());
    for (std::size_t s = 0; s < plan.segments.size(); ++s)
      for (std::size_t lane = 0; lane < plan.segments[s].bodies.size(); ++lane)
        for (const int body : plan.segments[s].bodies[lane])
          if (body >= 0) lane_of_[static_cast<std::size_t>(body)] = {static_cast<int>(s), static_cast<int>(lane)};
    read_by_results(algorithm);
  }

  void run() {
    for (bool changed = true; changed;) {
      const std::size_t before = size();
      for (std::size_t s = 0; s < plan_.segments.size(); ++s)
        for (ir::SegmentStage& stage : program_.segments[s].stages)
          for (ir::Paragraph& p : stage.paragraphs) {
            p.live_lanes = live(s, p);
            for (const int lane : p.live_lanes) follow(s, p, lane);
          }
      changed = size() != before;
    }
    for (ir::SegmentCode& code : program_.segments) {
      for (ir::SegmentStage& stage : code.stages) {
        std::erase_if(stage.paragraphs, [](const ir::Paragraph& p) { return p.live_lanes.empty(); });
        for (ir::Paragraph& p : stage.paragraphs)
          if (p.loop.in_parts() && p.loop.direction == Direction::outwards) p.loop.limbs = p.live_lanes.back() + 1;
      }
      std::erase_if(code.stages, [](const ir::SegmentStage& stage) { return stage.paragraphs.empty(); });
    }
    for (ir::BaseStage& stage : program_.base)
      std::erase_if(stage.stores, [&](const ir::Store& s) {
        return s.to.body < 0 && stage.graph.is_constant(s.node) && !read_of_base_.contains(place_of(s.to.role, s.to.component));
      });
  }

 private:
  // Of an array of those that are kept, and a component of it: roles that are the same share it, and only one of them is
  // stored.
  using Place = std::pair<int, int>;
  using Lane = std::pair<int, int>;  // segment, lane

  Place place_of(int role, int component) const {
    const ir::Place& at = program_.places[static_cast<std::size_t>(role)];
    return {at.array, at.from + component};
  }

  std::size_t size() const {
    std::size_t sum = read_of_base_.size();
    for (const auto& [value, lanes] : read_) sum += lanes.size();
    return sum;
  }
  void read(int role, int component, const Lane& lane) { read_[place_of(role, component)].insert(lane); }
  void read(const Address& a) {
    if (a.body < 0) read_of_base_.insert(place_of(a.role, a.component));
    else read(a.role, a.component, lane_of_[static_cast<std::size_t>(a.body)]);
  }
  // By all lanes of all segments, and the base.
  void read_everywhere(int role) {
    if (role < 0) return;
    for (int i = 0; i < program_.roles[static_cast<std::size_t>(role)].components(); ++i) {
      read_of_base_.insert(place_of(role, i));
      for (std::size_t s = 0; s < plan_.segments.size(); ++s)
        for (int lane = 0; lane < plan_.segments[s].width; ++lane) read(role, i, {static_cast<int>(s), lane});
    }
  }

  void read_by_results(const ir::Algorithm& algorithm) {
    for (const ir::JointResult& result : program_.results)
      for (const ir::JointResult::Element& e : result.elements) read(e.from);
    for (const ir::AddedConstant& a : program_.added)
      if (a.role >= 0) read({a.role, 0, a.body});
    for (const ir::BaseStage& stage : program_.base)
      ir::each_input(stage.graph, stage.roots(), [&](const ir::Input& in) {
        if (in.kind == InputKind::kept) read(ir::address(in));
      });
    if (const auto& p = program_.pivots_in_slots)
      for (const int role : {p->pivot, p->diagonal, p->gain, p->linear, p->angular}) read_everywhere(role);
    // Elements of matrices are computed in whole registers.
    for (const ir::PairBlocks& blocks : program_.blocks)
      for (const auto* factors : {&blocks.lower, &blocks.upper})
        for (const ir::PairFactor& f : *factors) read_everywhere(f.role);
    for (const ir::RolledPairs& pairs : program_.pairs) read_everywhere(pairs.columns), read_everywhere(pairs.rows);
    for (const ir::Projection& p : algorithm.projections)
      ir::each_input(p.graph, p.columns, [&](const ir::Input& in) { read_everywhere(in.index); });
  }

  std::vector<int> live(std::size_t segment, const ir::Paragraph& p) const {
    std::vector<int> lanes;
    const ir::Segment& s = plan_.segments[segment];
    for (int lane = 0; lane < s.width; ++lane) {
      if (s.bodies[static_cast<std::size_t>(lane)].front() < 0) continue;
      const bool stored = std::any_of(p.stores.begin(), p.stores.end(), [&](const ir::Store& store) {
        const auto lanes_that_read = read_.find(place_of(store.to.role, store.to.component));
        return lanes_that_read != read_.end() && lanes_that_read->second.contains({static_cast<int>(segment), lane});
      });
      const bool handed = std::any_of(p.handed.begin(), p.handed.end(), [&](const ir::HandedOn& h) {
        return std::find(h.lanes.begin(), h.lanes.end(), lane) != h.lanes.end();
      });
      if (stored || handed) lanes.push_back(lane);
    }
    return lanes;
  }

  void follow(std::size_t segment, const ir::Paragraph& p, int lane) {
    ir::each_input(p.graph, p.roots(), [&](const ir::Input& in) {
      if (in.kind != InputKind::kept) return;
      if (in.body == Address::own) read(in.index, in.component, {static_cast<int>(segment), lane});
      else read(ir::address(in));
    });
    for (const ir::Carried& c : p.carried) {
      if (p.loop.direction != Direction::outwards || c.known()) continue;
      // Constants too: lanes that are gathered are all gathered.
      read(c.from.size() == 1 ? c.from.front() : c.from[static_cast<std::size_t>(lane)]);
    }
    for (const ir::HandedOn& h : p.handed) read(h.to);
  }

  const ir::Plan& plan_;
  ir::RolledProgram& program_;
  std::vector<Lane> lane_of_;  // per body
  std::map<Place, std::set<Lane>> read_;
  std::set<Place> read_of_base_;
};

}  // namespace

void find_live_lanes(const ir::Algorithm& algorithm, const ir::Plan& plan, ir::RolledProgram& program) {
  LiveLanes(algorithm, plan, program).run();
}

}  // namespace dalembert::passes
