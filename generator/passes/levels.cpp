#include "passes/levels.hpp"

#include <algorithm>

namespace dalembert::passes {
namespace {

using ir::Direction;
using ir::InputKind;

int even(int level) { return (level + 1) / 2 * 2; }

class Leveller {
 public:
  explicit Leveller(const ir::Algorithm& algorithm)
      : algorithm_(algorithm), level_(algorithm.sweeps.size(), 0), producer_(algorithm.roles.size(), -1), base_(producer_) {}

  std::vector<int> run() {
    for (std::size_t s = 0; s < algorithm_.sweeps.size(); ++s) {
      const ir::Sweep& sweep = algorithm_.sweeps[s];
      int level = 0;
      for (ir::NodeId id = 0; id < sweep.graph.size(); ++id)
        if (sweep.graph[id].op == ir::Op::input) level = std::max(level, earliest(sweep, sweep.graph[id].input));
      if (sweep.over.is_base() || sweep.direction == Direction::outwards) level = even(level);
      if (sweep.direction == Direction::inwards) level |= 1;
      level_[s] = level;
      for (const ir::Value& v : sweep.stores)
        (sweep.over.is_base() ? base_ : producer_)[static_cast<std::size_t>(v.role)] = static_cast<int>(s);
    }
    return level_;
  }

 private:
  int of_bodies(int role) const {
    const int s = producer_[static_cast<std::size_t>(role)];
    return s < 0 ? 0 : level_[static_cast<std::size_t>(s)];
  }
  // When the base has it: after all that its limbs hand on.
  int of_base(int role) const {
    const int s = base_[static_cast<std::size_t>(role)];
    return s < 0 ? even(of_bodies(role)) : level_[static_cast<std::size_t>(s)];
  }
  int earliest(const ir::Sweep& sweep, const ir::Input& in) const {
    switch (in.kind) {
      case InputKind::state: return sweep.over.is_base() ? of_base(in.index) : of_bodies(in.index);
      case InputKind::carried:
        return sweep.direction == Direction::outwards ? std::max(of_bodies(in.index), of_base(in.index)) : 0;
      case InputKind::of_body: return in.body < 0 ? of_base(in.index) : of_bodies(in.index) + 1;
      default: return 0;
    }
  }

  const ir::Algorithm& algorithm_;
  std::vector<int> level_, producer_, base_;
};

}  // namespace

std::vector<int> levels(const ir::Algorithm& algorithm) { return Leveller(algorithm).run(); }

std::vector<int> phases(const ir::Algorithm& algorithm) {
  const std::vector<int> level = levels(algorithm);
  std::vector<int> phase;
  for (std::size_t s = 0; s < algorithm.sweeps.size(); ++s) {
    const Direction d = algorithm.sweeps[s].direction;
    const bool outwards = d == Direction::outwards || algorithm.sweeps[s].over.is_base();
    phase.push_back(level[s] == 0 ? (outwards ? 1 : 2) : d == Direction::inwards ? 2 : 3);
  }
  phase.resize(phase.size() + algorithm.pairs.size() + algorithm.projections.size() + algorithm.written_out.size(), 3);
  return phase;
}

}  // namespace dalembert::passes
