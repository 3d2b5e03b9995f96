#include "passes/part_of_tree.hpp"

#include <algorithm>
#include <vector>

#include "ir/moved_links.hpp"

namespace dalembert::passes {
namespace {

class Needed {
 public:
  Needed(const ir::EmittedFunction& function, const ir::KinematicTree& tree, const ir::Scene& scene)
      : tree_(tree), scene_(scene), bodies_(tree.bodies.size(), false) {
    whole_ = !function.any_part();
    for (const ir::Quantity quantity : function.quantities) {
      const ir::Part* const part = function.part(quantity);
      if (part) of_quantity(quantity, *part);
      else whole_ = true;
    }
    for (const ir::LinkOutput& output : function.of_links)
      for (const ir::LinkPlacement& at : tree.links)
        if (at.link == output.link) above(at.body);
    if (frame_of_base_)
      for (int k = tree.joints(); k-- > 0;)
        if (has(k)) above(k);
    // A joint that another drives has its position.
    for (std::size_t k = 0; k < bodies_.size(); ++k)
      if (bodies_[k] && tree.bodies[k].driven()) bodies_[static_cast<std::size_t>(tree.bodies[k].driven_by)] = true;
    // Parts of a joint stand together.
    for (std::size_t k = bodies_.size(); k-- > 1;)
      if (bodies_[k] && tree.bodies[k].part > 0) bodies_[k - 1] = true;
    for (std::size_t k = 0; k + 1 < bodies_.size(); ++k)
      if (bodies_[k] && tree.bodies[k].part + 1 < tree.bodies[k].parts) bodies_[k + 1] = true;
  }

  bool all() const {
    return whole_ || (frame_of_base_ && std::all_of(bodies_.begin(), bodies_.end(), [](bool b) { return b; }));
  }
  bool has(int body) const { return bodies_[static_cast<std::size_t>(body)]; }
  bool frame_of_base() const { return frame_of_base_; }

 private:
  void of_quantity(ir::Quantity quantity, const ir::Part& part) {
    const bool base = !part.some_coordinates || (!part.coordinates.empty() && part.coordinates.front() < base_rows());
    switch (quantity) {
      case ir::Quantity::mass_matrix: return base ? all_of_them() : beyond_rows(part);
      case ir::Quantity::inverse_dynamics:
        if (!scene_.wrenches.empty()) return all_of_them();
        [[fallthrough]];
      case ir::Quantity::coriolis_matrix:
      case ir::Quantity::gravity:
      case ir::Quantity::bias:
        frame_of_base_ = true;
        return base && tree_.base_coordinates() > 0 ? all_of_them() : beyond_rows(part);
      case ir::Quantity::wrench_influence:
      case ir::Quantity::regressor: {
        if (!part.some_links) return all_of_them();
        frame_of_base_ = true;
        const std::vector<int> numbers = ir::numbers_of_links(tree_);
        for (int k = 0; k < tree_.joints(); ++k)
          if (std::find(part.bodies.begin(), part.bodies.end(), numbers[static_cast<std::size_t>(k)]) != part.bodies.end())
            above(k);
        return;
      }
      default: return all_of_them();
    }
  }

  int base_rows() const { return tree_.base_coordinates(); }
  void all_of_them() { whole_ = true; }

  // The bodies that the rows' joints move.
  void beyond_rows(const ir::Part& part) {
    const std::vector<int> coordinates = tree_.coordinates();
    std::vector<bool> moved(bodies_.size(), false);
    for (std::size_t k = 0; k < moved.size(); ++k) {
      const int row = base_rows() + coordinates[k], parent = tree_.bodies[k].parent;
      moved[k] = !part.some_coordinates || std::binary_search(part.coordinates.begin(), part.coordinates.end(), row) ||
                 (parent >= 0 && moved[static_cast<std::size_t>(parent)]);
      if (moved[k]) bodies_[k] = true;
    }
  }

  void above(int body) {
    frame_of_base_ = true;
    for (; body >= 0; body = tree_.bodies[static_cast<std::size_t>(body)].parent)
      bodies_[static_cast<std::size_t>(body)] = true;
  }

  const ir::KinematicTree& tree_;
  const ir::Scene& scene_;
  std::vector<bool> bodies_;
  bool whole_ = false;
  bool frame_of_base_ = false;
};

}  // namespace

std::optional<ir::KinematicTree> part_of_tree(const ir::EmittedFunction& function, const ir::KinematicTree& tree,
                                              const ir::Scene& scene) {
  const Needed needed(function, tree, scene);
  if (needed.all()) return {};
  ir::KinematicTree part = tree;
  part.bodies.clear();
  part.links.clear();
  if (!needed.frame_of_base()) part.base_joint = ir::JointType::fixed;
  part.within.emplace();
  const int more_positions = tree.base_positions() - part.base_positions(),
            more_coordinates = tree.base_coordinates() - part.base_coordinates();
  const std::vector<int> positions = tree.positions(), coordinates = tree.coordinates(), links = ir::numbers_of_links(tree);
  std::vector<int> number(tree.bodies.size(), -1);
  const auto numbered = [&](int body) { return body < 0 ? body : number[static_cast<std::size_t>(body)]; };
  for (std::size_t k = 0; k < tree.bodies.size(); ++k) {
    if (!needed.has(static_cast<int>(k))) continue;
    number[k] = part.joints();
    ir::Body body = tree.bodies[k];
    int above = body.parent;
    while (above >= 0 && !needed.has(above)) above = tree.bodies[static_cast<std::size_t>(above)].parent;
    body.parent = numbered(above);
    body.subtree_size = 1;
    part.bodies.push_back(std::move(body));
    part.within->positions.push_back(positions[k] + more_positions);
    part.within->coordinates.push_back(coordinates[k] + more_coordinates);
    part.within->links.push_back(links[k]);
  }
  for (ir::Body& body : part.bodies) body.driven_by = numbered(body.driven_by);
  for (std::size_t k = part.bodies.size(); k-- > 0;)
    if (const int parent = part.bodies[k].parent; parent >= 0)
      part.bodies[static_cast<std::size_t>(parent)].subtree_size += part.bodies[k].subtree_size;
  for (ir::LinkPlacement at : tree.links) {
    if (at.body >= 0 && numbered(at.body) < 0) continue;
    at.body = numbered(at.body);
    part.links.push_back(std::move(at));
  }
  for (int& body : part.pushed) body = numbered(body);
  for (auto& [to, back] : part.held) to = numbered(to), back = back == ir::nobody ? back : numbered(back);
  part.within->nv = tree.nv();
  part.within->count_of_links = ir::count_of_links(tree);
  return part;
}

}  // namespace dalembert::passes
