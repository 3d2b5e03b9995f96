#include "passes/plan.hpp"

#include <algorithm>
#include <bit>
#include <set>

#include "dalembert/tile_shapes.hpp"
#include "ir/identifier.hpp"

namespace dalembert::passes {
namespace {

using Limb = std::vector<int>;

// Measured: more than four limbs side by side, and limbs of unlike length, pay up to this length. Of longer ones the elements
// of M and C take most of the time, and those fill registers of eight by fours as well, two steps at a time.
constexpr size_t longest_of_eight = 12;

// Runs of bodies without a branch and with rows in the same matrices, in depth-first order.
std::vector<Limb> limbs_of(const ir::KinematicTree& tree, const std::vector<int>& rows) {
  std::vector<int> children(tree.bodies.size(), 0);
  for (const ir::Body& b : tree.bodies)
    if (b.parent >= 0) ++children[static_cast<size_t>(b.parent)];
  std::vector<Limb> limbs;
  for (int k = 0; k < tree.joints(); ++k) {
    const int parent = tree.bodies[static_cast<size_t>(k)].parent;
    const bool other_rows = parent >= 0 && !rows.empty() && rows[static_cast<size_t>(parent)] != rows[static_cast<size_t>(k)];
    if (parent < 0 || children[static_cast<size_t>(parent)] > 1 || other_rows) limbs.emplace_back();
    limbs.back().push_back(k);
  }
  return limbs;
}

// Groups of limbs to be computed side by side: similar in length or few, none above another, not even by way of their groups.
class Grouping {
 public:
  Grouping(const ir::KinematicTree& tree, const std::vector<Limb>& limbs) : limbs_(limbs), group_of_(limbs.size(), -1) {
    std::vector<int> limb_of(tree.bodies.size());
    for (size_t i = 0; i < limbs.size(); ++i)
      for (int b : limbs[i]) limb_of[static_cast<size_t>(b)] = static_cast<int>(i);
    for (const Limb& limb : limbs) {
      const int parent = tree.bodies[static_cast<size_t>(limb.front())].parent;
      above_.push_back(parent < 0 ? -1 : limb_of[static_cast<size_t>(parent)]);
    }
  }

  std::vector<std::vector<int>> run(size_t widest) {
    std::vector<int> order(limbs_.size());
    for (size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
    std::stable_sort(order.begin(), order.end(), [this](int a, int b) { return length(a) > length(b); });
    for (size_t i = 0; i < order.size(); ++i) {
      if (group_of_[at(order[i])] >= 0) continue;
      const int group = static_cast<int>(groups_.size());
      groups_.push_back({order[i]});
      group_of_[at(order[i])] = group;
      const size_t most = length(order[i]) <= longest_of_eight ? widest : std::min(widest, size_t{4});
      for (size_t j = i + 1; j < order.size() && groups_.back().size() < most; ++j) {
        const int limb = order[j];
        // Padding costs as much as work: a limb joins when at least two thirds of its lane are its own.
        if (group_of_[at(limb)] >= 0 || 3 * length(limb) < 2 * length(order[i])) continue;
        group_of_[at(limb)] = group;
        groups_.back().push_back(limb);
        if (!cyclic(group)) continue;
        groups_.back().pop_back();
        group_of_[at(limb)] = -1;
      }
    }
    for (size_t longer = 0; longer < groups_.size(); ++longer)
      for (size_t shorter = longer + 1; shorter < groups_.size(); ++shorter) join(longer, shorter);
    std::erase_if(groups_, [](const std::vector<int>& group) { return group.empty(); });
    for (size_t g = 0; g < groups_.size(); ++g) {
      std::sort(groups_[g].begin(), groups_[g].end());
      for (int limb : groups_[g]) group_of_[at(limb)] = static_cast<int>(g);
    }
    return parents_first();
  }

 private:
  static size_t at(int i) { return static_cast<size_t>(i); }
  size_t length(int limb) const { return limbs_[at(limb)].size(); }

  // Puts two groups together, each with its longest limb first. Registers hold two limbs as well as one, so the shorter one's
  // steps and code come for nothing; and four as well as two, but without AVX: there half of a lane must be its limb's own.
  void join(size_t longer, size_t shorter) {
    std::vector<int>&all = groups_[longer], &more = groups_[shorter];
    const size_t own = all.size(), together = own + more.size();
    if (own == 0 || more.empty() || together > 4 || length(all.front()) > longest_of_eight) return;
    if (together > 2 && 2 * length(more.back()) < length(all.front())) return;
    all.insert(all.end(), more.begin(), more.end());
    for (int limb : more) group_of_[at(limb)] = static_cast<int>(longer);
    if (cyclic(static_cast<int>(longer))) {
      all.resize(own);
      for (int limb : more) group_of_[at(limb)] = static_cast<int>(shorter);
    } else {
      more.clear();
    }
  }

  // Calls f with the limb that each of `limbs` hangs on.
  template <class F>
  void each_above(const std::vector<int>& limbs, const F& f) const {
    for (int l : limbs)
      if (above_[at(l)] >= 0) f(above_[at(l)]);
  }

  // Whether going up from the group leads back to it: by way of whole groups, and of limbs that have none yet.
  bool cyclic(int group) const {
    std::set<int> seen;
    std::vector<int> todo;
    each_above(groups_[at(group)], [&](int l) { todo.push_back(l); });
    while (!todo.empty()) {
      const int limb = todo.back();
      todo.pop_back();
      if (group_of_[at(limb)] == group) return true;
      if (!seen.insert(limb).second) continue;
      const int its = group_of_[at(limb)];
      const std::vector<int> alone{limb};
      each_above(its >= 0 ? groups_[at(its)] : alone, [&](int l) { todo.push_back(l); });
    }
    return false;
  }

  std::vector<std::vector<int>> parents_first() const {
    std::vector<std::vector<int>> sorted;
    std::vector<bool> done(groups_.size(), false);
    while (sorted.size() < groups_.size())
      for (size_t g = 0; g < groups_.size(); ++g) {
        bool ready = !done[g];
        each_above(groups_[g], [&](int l) { ready = ready && done[at(group_of_[at(l)])]; });
        if (!ready) continue;
        done[g] = true;
        sorted.push_back(groups_[g]);
      }
    return sorted;
  }

  const std::vector<Limb>& limbs_;
  std::vector<int> above_;  // per limb: the limb it hangs on, -1: the base
  std::vector<int> group_of_;
  std::vector<std::vector<int>> groups_;
};

void lay_out(const ir::KinematicTree& tree, const std::vector<int>& rows, size_t widest, ir::Plan& plan) {
  const std::vector<Limb> limbs = limbs_of(tree, rows);
  plan.slot_of.assign(tree.bodies.size(), 0);
  int half = -1;  // free beside a short segment
  for (const std::vector<int>& group : Grouping(tree, limbs).run(widest)) {
    ir::Segment s;
    s.width = static_cast<int>(std::bit_ceil(group.size()));
    for (int l : group) s.steps = std::max(s.steps, static_cast<int>(limbs[static_cast<size_t>(l)].size()));
    s.limb_after_limb =
        tree.independent_joints() == tree.joints() && s.steps >= (s.width > 1 ? long_limb_beside_others : long_limb);
    const bool fits = s.is_short() && half >= 0;
    s.first_slot = fits ? half : plan.slots;
    s.name = ir::identifier(tree.bodies[static_cast<size_t>(limbs[static_cast<size_t>(group.front())].front())].joint);
    if (s.width > 1) s.name += "_x" + std::to_string(group.size());
    for (int lane = 0; lane < s.width; ++lane) {
      Limb bodies =
          static_cast<size_t>(lane) < group.size() ? limbs[static_cast<size_t>(group[static_cast<size_t>(lane)])] : Limb{};
      s.parents.push_back(bodies.empty() ? -1 : tree.bodies[static_cast<size_t>(bodies.front())].parent);
      for (size_t step = 0; step < bodies.size(); ++step)
        plan.slot_of[static_cast<size_t>(bodies[step])] = s.first_slot + static_cast<int>(step) * s.width + lane;
      bodies.resize(static_cast<size_t>(s.steps), -1);
      s.bodies.push_back(std::move(bodies));
    }
    if (s.is_short()) half = fits ? -1 : plan.slots + 4;
    if (!fits) plan.slots += (s.slots() + 7) / 8 * 8;
    plan.segments.push_back(std::move(s));
  }
  plan.root_slot = half >= 0 ? half : plan.slots;
}

}  // namespace

std::vector<int> rows_in_pairs(const ir::Algorithm& algorithm, const ir::KinematicTree& tree) {
  std::vector<int> rows(tree.bodies.size(), 0);
  const std::vector<int> coordinates = tree.coordinates();
  bool parts = false;
  for (const ir::Pairs& p : algorithm.pairs) {
    const ir::OutputArray& array = algorithm.arrays[static_cast<size_t>(p.array)];
    parts = parts || array.is_part();
    for (size_t k = 0; k < rows.size(); ++k)
      rows[k] = 2 * rows[k] + (array.row(tree.base_coordinates() + coordinates[k]) >= 0 ? 1 : 0);
  }
  return parts ? rows : std::vector<int>{};
}

ir::Plan plan(const ir::KinematicTree& tree, const ir::Scene& scene, ir::Form form, const ir::CompileOptions& options,
              const std::vector<int>& rows) {
  ir::Plan plan;
  plan.form = form;
  plan.tasks = scene.parallel == ir::Parallel::tasks;
  plan.write_limbs = options.write_limbs && options.fold;
  plan.join_tasks = options.join;
  plan.weigh_tasks = options.weigh;
  plan.costs = options.costs;
  if (form == ir::Form::rolled) lay_out(tree, rows, options.pack ? 8 : 1, plan);
  return plan;
}

std::vector<ir::Form> forms(const ir::KinematicTree& tree, const ir::Scene& scene, const ir::Operations& straight,
                            const ir::CompileOptions& options) {
  // Straight lines of more are slower than loops on any robot, and take compilers minutes.
  constexpr long longest_straight_line = 20000;
  if (tree.bodies.empty()) return {ir::Form::straight};  // a base alone has nothing to roll
  if (options.form != ir::Form::automatic) return {options.form};
  if (scene.parallel == ir::Parallel::tasks || straight.total() > longest_straight_line) return {ir::Form::rolled};
  return {ir::Form::straight, ir::Form::rolled};
}

}  // namespace dalembert::passes
