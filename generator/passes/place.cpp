#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include "passes/roll_state.hpp"

namespace dalembert::passes {
namespace {

using ir::InputKind;

constexpr int always = std::numeric_limits<int>::max();

class Placing {
 public:
  explicit Placing(RollState& state) : state_(state), program_(state.program) {
    const std::size_t roles = program_.roles.size();
    program_.places.resize(roles);
    received_.resize(roles, -1);
    used_.resize(roles, false);
    at_base_.resize(roles, false);
    of_few_.resize(roles, false);
    read_.resize(roles);
    written_.resize(roles);
    for (std::size_t r = 0; r < roles; ++r) {
      read_[r].assign(static_cast<std::size_t>(program_.roles[r].components()), -1);
      written_[r] = read_[r];
    }
  }

  void run() {
    collect();
    keep_sines_in_pairs();
    share_equal_values();
    const bool large = lower_factors() > few_factors;
    for (std::size_t r = 0; r < program_.roles.size(); ++r)
      if (used_[r] && program_.places[r].array < 0 && equal_to_[r].first < 0) give_place(static_cast<int>(r), large);
    for (std::size_t r = 0; r < program_.roles.size(); ++r)
      if (used_[r] && equal_to_[r].first >= 0) {
        const ir::Place& at = program_.places[static_cast<std::size_t>(equal_to_[r].first)];
        program_.places[r] = {at.array, at.from + equal_to_[r].second};
      }
    say_addresses();
  }

 private:
  // With so few factors of matrices the whole workspace fits the first-level cache as it is, and a store to what was just read
  // costs more than the room it saves.
  static constexpr std::size_t few_factors = 2;

  std::size_t lower_factors() const {
    std::set<RoleComponent> factors;
    for (const ir::Pairs& p : state_.algorithm.pairs)
      for (const auto* terms : {&p.above, &p.below})
        for (const ir::PairTerm& t : *terms) factors.insert({t.lower, t.lower_from});
    return factors.size();
  }

  void note_read(int role, int component, int level) {
    int& last = read_[static_cast<std::size_t>(role)][static_cast<std::size_t>(component)];
    last = std::max(last, level);
    used_[static_cast<std::size_t>(role)] = true;
  }
  void note_write(int role, int component, int level) {
    int& last = written_[static_cast<std::size_t>(role)][static_cast<std::size_t>(component)];
    last = last < 0 ? level : std::max(last, level);
    used_[static_cast<std::size_t>(role)] = true;
  }

  void collect() {
    first_written_.assign(program_.roles.size(), always);
    for (const ir::SegmentCode& code : program_.segments)
      for (const ir::SegmentStage& stage : code.stages)
        for (const ir::Paragraph& p : stage.paragraphs) {
          std::vector<ir::NodeId> roots;
          for (const auto& [to, node] : p.stores) {
            roots.push_back(node);
            note_write(to.role, to.component, stage.level);
            int& first = first_written_[static_cast<std::size_t>(to.role)];
            first = std::min(first, stage.level);
          }
          for (const ir::Carried& c : p.carried) {
            roots.push_back(c.node);
            if (p.loop.direction == ir::Direction::outwards && !c.known()) note_read(c.role, c.component, stage.level);
          }
          each_input(p.graph, roots, [&](const ir::Input& in) {
            if (in.kind == InputKind::state || in.kind == InputKind::of_body) note_read(in.index, in.component, stage.level);
          });
          for (const ir::HandedOn& h : p.handed)
            if (h.to.role == h.role) note_read(h.role, h.component, stage.level), note_write(h.role, h.component, stage.level);
        }
    for (const ir::BaseStage& stage : program_.base) {
      std::vector<ir::NodeId> roots;
      for (const auto& [to, node] : stage.stores) {
        roots.push_back(node);
        note_write(to.role, to.component, stage.level);
        at_base_[static_cast<std::size_t>(to.role)] = true;
        if (to.body >= 0) of_few_[static_cast<std::size_t>(to.role)] = true;
      }
      for (const ir::BlockElement& e : stage.elements) roots.push_back(e.node);
      each_input(stage.graph, roots, [&](const ir::Input& in) {
        // The base's own slot is nobody else's.
        if (in.kind == InputKind::of_body && in.body >= 0) note_read(in.index, in.component, stage.level);
        if (in.kind == InputKind::of_body) used_[static_cast<std::size_t>(in.index)] = true;
      });
    }
    const ir::Algorithm& a = state_.algorithm;
    for (std::size_t p = 0; p < a.pairs.size(); ++p) {
      for (const auto* terms : {&a.pairs[p].above, &a.pairs[p].below})
        for (const ir::PairTerm& t : *terms)
          for (int i = 0; i < 3; ++i)
            note_read(t.lower, t.lower_from + i, always), note_read(t.upper, t.upper_from + i, always);
      if (a.pairs[p].between >= 0) note_read(a.pairs[p].between, 0, always);
      for (const int role : {program_.pairs[p].columns, program_.pairs[p].rows})
        for (int i = 0; i < 6 && role >= 0; ++i) note_read(role, i, always);
    }
    for (const ir::Projection& p : a.projections)
      each_input(p.graph, p.columns, [&](const ir::Input& in) { note_read(in.index, in.component, always); });
    for (const ir::Result& r : a.results)
      for (int i = 0; i < a.roles[static_cast<std::size_t>(r.role)].components() && r.layout != ir::Layout::base; ++i)
        note_read(r.role, i, always);
  }

  // A sine comes with its cosine.
  void keep_sines_in_pairs() {
    for (std::size_t a = 0; a < used_.size(); ++a) {
      const ir::Role& sine = program_.roles[a];
      for (std::size_t b = 0; sine.source == ir::Source::sine && b < used_.size(); ++b)
        if (program_.roles[b].source == ir::Source::cosine && sine.held == program_.roles[b].held && (used_[a] || used_[b]))
          used_[a] = used_[b] = true;
    }
  }

  // What a paragraph stores, by role and component and by node: the first of each.
  struct Stored {
    std::size_t segment = 0;
    ir::Paragraph* paragraph = nullptr;
    std::map<RoleComponent, ir::NodeId> nodes{};
    std::map<ir::NodeId, std::vector<RoleComponent>> of_node{};

    std::optional<ir::NodeId> node(int role, int component) const {
      const auto found = nodes.find({role, component});
      return found == nodes.end() ? std::nullopt : std::optional(found->second);
    }
  };

  void find_stores() {
    storing_.resize(program_.roles.size());
    for (std::size_t segment = 0; segment < program_.segments.size(); ++segment)
      for (ir::SegmentStage& stage : program_.segments[segment].stages)
        for (ir::Paragraph& p : stage.paragraphs) {
          const std::size_t number = stored_.size();
          Stored& stored = stored_.emplace_back(Stored{segment, &p});
          for (const ir::Store& s : p.stores) {
            const RoleComponent place{s.to.role, s.to.component};
            if (s.to.body != ir::Address::own || !stored.nodes.emplace(place, s.node).second) continue;
            stored.of_node[s.node].push_back(place);
            std::vector<std::size_t>& storing = storing_[static_cast<std::size_t>(s.to.role)];
            if (storing.empty() || storing.back() != number) storing.push_back(number);
          }
        }
  }

  // Where a role is, in every paragraph that stores it, what some components of another are, it is kept there.
  void share_equal_values() {
    find_stores();
    equal_to_.assign(program_.roles.size(), {-1, 0});
    std::vector<bool> stands_for(program_.roles.size(), false);
    for (int r = 0; r < static_cast<int>(program_.roles.size()); ++r) {
      const auto at = static_cast<std::size_t>(r);
      if (!used_[at] || at_base_[at] || stands_for[at]) continue;
      for (const auto& [other, from] : candidates(r)) {
        const auto o = static_cast<std::size_t>(other);
        if (!used_[o] || equal_to_[o].first >= 0 || !equal(r, other, from) || !alone_at(r, other, from)) continue;
        equal_to_[at] = {other, from};
        stands_for[o] = true;
        break;
      }
      if (equal_to_[at].first < 0) continue;
      const auto [other, from] = equal_to_[at];
      for (int i = 0; i < program_.roles[at].components(); ++i) {  // what is read of one is read of the other
        int& last = read_[static_cast<std::size_t>(other)][static_cast<std::size_t>(from + i)];
        last = std::max(last, read_[at][static_cast<std::size_t>(i)]);
      }
      drop_equal_stores(r, other, from);
    }
  }
  const std::vector<std::size_t>& storing(int role) const { return storing_[static_cast<std::size_t>(role)]; }
  int components(int role) const { return program_.roles[static_cast<std::size_t>(role)].components(); }

  // Roles, and components of theirs from which on, that somewhere are the same number as one of the role's.
  std::set<std::pair<int, int>> candidates(int role) const {
    std::set<std::pair<int, int>> found;
    for (const std::size_t number : storing(role))
      for (int i = 0; i < components(role); ++i)
        if (const std::optional<ir::NodeId> node = stored_[number].node(role, i))
          for (const auto& [other, component] : stored_[number].of_node.at(*node))
            if (other != role && component >= i && component - i + components(role) <= components(other))
              found.insert({other, component - i});
    return found;
  }
  bool equal(int role, int other, int from) const {
    bool somewhere = false;
    for (const std::size_t number : storing(role))
      for (int i = 0; i < components(role); ++i) {
        const std::optional<ir::NodeId> a = stored_[number].node(role, i), b = stored_[number].node(other, from + i);
        if (!a && b) return false;
        if (!a) continue;
        if (b ? *b != *a : stored_elsewhere(number, other, from + i)) return false;
        somewhere = somewhere || b;
      }
    return somewhere;
  }
  // Whether no third role that stands there already has values of its own where this one has.
  bool alone_at(int role, int other, int from) const {
    for (int third = 0; third < static_cast<int>(equal_to_.size()); ++third) {
      const auto [place, first] = equal_to_[static_cast<std::size_t>(third)];
      if (place != other || first >= from + components(role) || from >= first + components(third)) continue;
      for (const std::size_t a : storing(role))
        for (const std::size_t b : storing(third))
          if (stored_[a].segment == stored_[b].segment) return false;
    }
    return true;
  }
  // By another paragraph of the segment.
  bool stored_elsewhere(std::size_t own, int role, int component) const {
    return std::any_of(storing(role).begin(), storing(role).end(), [&](std::size_t number) {
      return number != own && stored_[number].segment == stored_[own].segment && stored_[number].node(role, component);
    });
  }
  void drop_equal_stores(int role, int other, int from) {
    std::erase_if(storing_[static_cast<std::size_t>(role)], [&](std::size_t number) {
      Stored& in = stored_[number];
      const auto is_stored = [&](int component) { return in.node(other, from + component).has_value(); };
      std::erase_if(in.paragraph->stores, [&](const ir::Store& s) { return s.to.role == role && is_stored(s.to.component); });
      bool left = false;
      for (int i = 0; i < components(role); ++i) {
        const std::optional<ir::NodeId> node = in.node(role, i);
        if (!node) continue;
        left = left || !is_stored(i);
        if (!is_stored(i)) continue;
        in.nodes.erase({role, i});
        std::erase(in.of_node.at(*node), RoleComponent{role, i});
      }
      return !left;
    });
  }

  ir::Place new_array(const std::string& name, const std::string& meaning, int components) {
    program_.arrays.push_back({name, meaning, components});
    return {static_cast<int>(program_.arrays.size()) - 1, 0};
  }

  void give_place(int role, bool share) {
    const auto at = static_cast<std::size_t>(role);
    const ir::Role& r = program_.roles[at];
    ir::Place& place = program_.places[at];
    occupants_.resize(program_.arrays.size());
    if (r.over >= 0 && used_[static_cast<std::size_t>(r.over)] &&
        program_.places[static_cast<std::size_t>(r.over)].array >= 0 && read_no_more(r.over, first_written_[at]))
      place = program_.places[static_cast<std::size_t>(r.over)];
    else if (share && r.source == ir::Source::sweep && !at_base_[at]) place = free_place(role);
    if (place.array < 0) place = new_array(r.name, r.meaning + (r.unit.empty() ? "" : ", " + r.unit), r.components());
    occupants_.resize(program_.arrays.size());
    occupants_[static_cast<std::size_t>(place.array)].push_back(role);
  }

  // Whether nobody reads the role after the level.
  bool read_no_more(int role, int level) const {
    const auto& read = read_[static_cast<std::size_t>(role)];
    return std::all_of(read.begin(), read.end(), [&](int last) { return last <= level; });
  }

  // Components in a row that nobody reads or writes any more when the role is first written.
  ir::Place free_place(int role) const {
    const int components = program_.roles[static_cast<std::size_t>(role)].components();
    const int first = first_written_[static_cast<std::size_t>(role)];
    if (first == always) return {};
    for (int array = 0; array < static_cast<int>(program_.arrays.size()); ++array)
      for (int from = 0; from + components <= program_.arrays[static_cast<std::size_t>(array)].components; ++from) {
        bool free = true;
        for (const int other : occupants_[static_cast<std::size_t>(array)]) {
          const auto o = static_cast<std::size_t>(other);
          const ir::Place& place = program_.places[o];
          for (int i = 0; i < program_.roles[o].components(); ++i) {
            const bool touched = place.from + i >= from && place.from + i < from + components;
            const int last = std::max(read_[o][static_cast<std::size_t>(i)], written_[o][static_cast<std::size_t>(i)]);
            free = free && !(touched && (last >= first || program_.roles[o].source != ir::Source::sweep || of_few_[o]));
          }
        }
        if (free) return {array, from};
      }
    return {};
  }

  // The role that is what limbs hand on of a role.
  int received(int role) {
    int& made = received_[static_cast<std::size_t>(role)];
    if (made >= 0) return made;
    made = static_cast<int>(program_.roles.size());
    ir::Role own = program_.roles[static_cast<std::size_t>(role)];
    own.name = "received_" + own.name, own.meaning += ", accumulated from attached branches", own.unit = "";
    own.over = -1;
    program_.places.push_back(new_array(own.name, own.meaning, own.components()));
    program_.roles.push_back(std::move(own));
    return made;
  }

  // From here on nobody asks of which kind an input is, or where to what limbs hand on goes.
  void say_addresses() {
    for (ir::SegmentCode& code : program_.segments)
      for (ir::SegmentStage& stage : code.stages)
        for (ir::Paragraph& p : stage.paragraphs)
          for (ir::HandedOn& h : p.handed)
            if (h.to.role == ir::Address::unknown) h.to.role = received(h.role);
    for (std::size_t s = 0; s < program_.segments.size(); ++s)
      for (ir::SegmentStage& stage : program_.segments[s].stages)
        for (ir::Paragraph& p : stage.paragraphs) {
          say_addresses(p.graph, ir::Address::own);
          for (ir::Carried& c : p.carried)
            if (p.loop.direction == ir::Direction::outwards && !c.known()) c.from = parents(state_.plan.segments[s], c);
        }
    for (ir::BaseStage& stage : program_.base) say_addresses(stage.graph, -1);
  }
  void say_addresses(ir::Graph& graph, int own) const {
    graph.rename_inputs([&](const ir::Input& in) {
      switch (in.kind) {
        case InputKind::state: return ir::Address{in.index, in.component, own}.input();
        case InputKind::of_body: return ir::Address{in.index, in.component, in.body}.input();
        case InputKind::received: return ir::Address{received_[static_cast<std::size_t>(in.index)], in.component, own}.input();
        default: return in;
      }
    });
  }
  static std::vector<ir::Address> parents(const ir::Segment& segment, const ir::Carried& c) {
    std::set<int> all;
    std::vector<ir::Address> of_lanes;
    for (std::size_t lane = 0; lane < segment.parents.size(); ++lane) {
      if (segment.bodies[lane].front() >= 0) all.insert(segment.parents[lane]);
      of_lanes.push_back({c.role, c.component, segment.parents[lane]});
    }
    if (all.size() == 1) return {{c.role, c.component, *all.begin()}};
    return of_lanes;
  }

  RollState& state_;
  ir::RolledProgram& program_;
  std::vector<int> received_;                      // per role: the one that is what limbs hand on of it, −1: none
  std::vector<bool> used_, at_base_;               // per role; at_base_: stored for the base, or for single bodies
  std::vector<bool> of_few_;                       // per role: stored for single bodies; the others' zeros are from the start
  std::vector<std::vector<int>> read_, written_;   // per role and component: the last level that does, −1: none
  std::vector<int> first_written_;                 // per role
  std::vector<std::pair<int, int>> equal_to_;      // per role: the role, and the component from which on, that it equals
  std::vector<Stored> stored_;                     // of each paragraph
  std::vector<std::vector<std::size_t>> storing_;  // per role: the paragraphs that store it
  std::vector<std::vector<int>> occupants_;        // per array: roles that have a place there, in order
};

}  // namespace

void place(RollState& state) { Placing(state).run(); }

}  // namespace dalembert::passes
