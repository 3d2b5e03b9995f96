#include "passes/reference.hpp"

#include <algorithm>

namespace dalembert::passes {
namespace {

// Further up a branch no robot has gained: less is saved beyond than the first rows of M cost more.
constexpr int furthest = 4;
// Of what a straight line is chosen for; longer ones take long to compare.
constexpr int most_joints = 64;

}  // namespace

std::vector<int> reference_bodies(const ir::Algorithm& algorithm, const ir::KinematicTree& tree,
                                  const std::function<double(const std::vector<int>&)>& cost) {
  const bool free = std::any_of(algorithm.sweeps.begin(), algorithm.sweeps.end(),
                                [](const ir::Sweep& sweep) { return sweep.back.has_value(); });
  if (!free || tree.base_coordinates() > 0 || tree.joints() > most_joints) return {};
  std::vector<int> best;
  double least = cost(best);
  int branch = -1;  // whose body stands last in `best`
  for (int body = 0; body < tree.joints(); ++body) {
    int first = body, above = 0;
    for (int at = body; (at = tree.bodies[static_cast<std::size_t>(at)].parent) >= 0; ++above) first = at;
    if (above == 0 || above > furthest) continue;
    std::vector<int> tried = best;
    if (branch == first) tried.pop_back();
    tried.push_back(body);
    const double costs = cost(tried);
    if (costs >= least) continue;
    least = costs, best = std::move(tried), branch = first;
  }
  return best;
}

}  // namespace dalembert::passes
