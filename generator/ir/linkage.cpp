#include "ir/linkage.hpp"

#include <algorithm>
#include <numbers>
#include <random>

#include "ir/kinematic_tree.hpp"

namespace dalembert::ir {
namespace {

void set_frame(const Eigen::Isometry3d& frame, double* rotation, double* translation) {
  const Eigen::Matrix3d R = frame.linear();
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) rotation[3 * i + k] = R(i, k);
    translation[i] = frame.translation()[i];
  }
}

int bits(const std::vector<int>& axes) {
  int sum = 0;
  for (const int i : axes) sum |= 1 << i;
  return sum;
}

}  // namespace

LinkageTable linkage_table(const Linkage& linkage, const KinematicTree& tree) {
  LinkageTable table;
  table.dependent = static_cast<int>(linkage.dependent.size());
  table.independent = static_cast<int>(linkage.independent.size());
  const std::vector<int> positions = tree.positions(), coordinates = tree.coordinates(), all = tree.opened().coordinates();
  const int base = tree.floating_base ? 6 : 0;
  for (const int k : linkage.dependent) {
    table.dependent_positions.push_back(tree.base_positions() + positions[static_cast<std::size_t>(k)]);
    table.dependent_coordinates.push_back(base + all[static_cast<std::size_t>(k)]);
  }
  for (const int k : linkage.independent)
    table.independent_coordinates.push_back(base + coordinates[static_cast<std::size_t>(k)]);
  const auto column = [&](int body) {
    const auto at = std::find(linkage.dependent.begin(), linkage.dependent.end(), body);
    if (at != linkage.dependent.end()) return static_cast<int>(at - linkage.dependent.begin());
    return table.dependent + static_cast<int>(std::find(linkage.independent.begin(), linkage.independent.end(), body) -
                                              linkage.independent.begin());
  };
  for (const LinkageLoop& loop : linkage.loops) {
    LinkedLoop<double> own{};
    own.begin[0] = static_cast<int>(table.joints.size());
    for (std::size_t side = 0; side < 2; ++side) {
      for (const int k : loop.joints[side]) {
        const Body& body = tree.bodies[static_cast<std::size_t>(k)];
        LinkedJoint<double> joint{};
        joint.position = tree.base_positions() + positions[static_cast<std::size_t>(k)];
        joint.column = column(k);
        joint.turns = body.turns() ? 1 : 0;
        joint.slides = body.slide_per_unit();
        set_frame(body.placement, joint.rotation, joint.translation);
        for (int i = 0; i < 3; ++i) joint.axis[i] = body.axis[i];
        table.joints.push_back(joint);
      }
      own.begin[side + 1] = static_cast<int>(table.joints.size());
      set_frame(loop.frames[side], own.rotation[side], own.translation[side]);
    }
    own.linear = loop.length > 0 ? 0 : bits(loop.linear);
    own.angular = bits(loop.angular);
    own.length = loop.length;
    table.loops.push_back(own);
  }
  return table;
}

Followers followers(const KinematicTree& tree) {
  const KinematicTree opened = tree.opened();
  const std::vector<int> all = opened.coordinates(), own = tree.coordinates();
  const int base = tree.floating_base ? 6 : 0;
  Followers f;
  f.all = opened.nv();
  for (int j = 0; j < base; ++j) f.at.push_back(j);
  for (std::size_t k = 0; k < tree.bodies.size(); ++k)
    if (tree.bodies[k].independent()) f.at.push_back(base + all[k]);
  for (const Linkage& linkage : tree.linkages)
    for (const int d : linkage.dependent)
      for (const int y : linkage.independent)
        f.elements.push_back({base + all[static_cast<std::size_t>(d)], base + own[static_cast<std::size_t>(y)]});
  return f;
}

LinkageStatus<double> close_loops(const KinematicTree& tree, int steps, Eigen::VectorXd& q) {
  LinkageStatus<double> status;
  for (std::size_t i = 0; i < tree.linkages.size(); ++i) {
    const LinkageTable table = linkage_table(tree.linkages[i], tree);
    close_linkage<most_dependent_joints, most_independent_joints>(table.view(), static_cast<int>(i), steps, q.data(), status);
  }
  return status;
}

ClosedState draw_closed(const KinematicTree& tree, Eigen::VectorXd& q, int tries, double least_pivot, bool from_q) {
  constexpr int patient = 60;
  constexpr double closed = 1e-12;  // m, rad: rounding
  const std::vector<int> positions = tree.positions();
  ClosedState state;
  std::mt19937_64 engine(31);  // whose numbers are the same on every system
  const auto uniform = [&](double most) { return most * (static_cast<double>(engine() >> 11) * 0x1p-52 - 1); };
  for (int i = 0; i < tries && !state.closed; ++i) {
    for (const Linkage& linkage : tree.linkages)
      for (const std::vector<int>* joints : {&linkage.dependent, &linkage.independent})
        for (const int k : *joints) {
          const Body& body = tree.bodies[static_cast<std::size_t>(k)];
          double& position = q[tree.base_positions() + positions[static_cast<std::size_t>(k)]];
          // Where joints are first is kept for the independent ones.
          if (i > 0 || !from_q) {
            const double drawn = uniform(body.prismatic() ? 0.5 : std::numbers::pi);
            if (i > tries / 4 || body.follows) position = drawn;
          }
        }
    Eigen::VectorXd start = q;
    const double pivot = close_loops(tree, 1, start).least_pivot;
    const LinkageStatus<double> status = close_loops(tree, patient, q);
    if (i == 0 || status.error < state.least_error) state.least_error = status.error;
    state.most_regular = std::max({state.most_regular, pivot, status.least_pivot});
    state.closed = status.error < closed && status.least_pivot > least_pivot;
  }
  return state;
}

}  // namespace dalembert::ir
