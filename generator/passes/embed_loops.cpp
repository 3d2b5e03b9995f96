#include "passes/embed_loops.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <numeric>
#include <set>

#include "ir/loop_length.hpp"
#include "passes/joints_without_mass.hpp"

namespace dalembert::passes {
namespace {

class Embedding {
 public:
  Embedding(ir::KinematicTree& tree, const ir::Scene& scene, const ir::RobotDescription& robot)
      : tree_(tree), scene_(scene), robot_(robot) {}

  void run() {
    for (const ir::Loop& loop : scene_.embedded) loops_.push_back(placed(loop));
    stop();
    for (const ir::Loop& loop : scene_.embedded) choose_independent(loop);
    stop();
    group();
    stop();
    for (const ir::Linkage& linkage : tree_.linkages)
      for (const int k : linkage.dependent) body(k).follows = true;
    for (size_t i = 0; i < tree_.linkages.size(); ++i) try_to_close(i);
    stop();
  }

 private:
  ir::Body& body(int k) { return tree_.bodies[static_cast<size_t>(k)]; }
  std::string joint(int k) { return in_words(body(k)); }
  std::string joints(const std::vector<int>& bodies) {
    std::vector<std::string> names;
    for (const int k : bodies)
      if (const std::string name = joint(k); names.empty() || names.back() != name) names.push_back(name);
    return fmt::format("{}", fmt::join(names, ", "));
  }
  static std::vector<int> path(const ir::LinkageLoop& loop) {
    std::vector<int> all = loop.joints[0];
    all.insert(all.end(), loop.joints[1].begin(), loop.joints[1].end());
    return all;
  }

  ir::LinkageLoop placed(const ir::Loop& loop) {
    ir::LinkageLoop own;
    own.name = loop.name;
    std::array<std::vector<int>, 2> above;
    for (size_t i = 0; i < 2; ++i) {
      const ir::LinkPlacement* const link = tree_.find_link(loop.links[i]);
      own.frames[i] = link->placement * loop.at[i];
      for (int k = link->body; k >= 0; k = body(k).parent) above[i].insert(above[i].begin(), k);
    }
    const auto fork = std::mismatch(above[0].begin(), above[0].end(), above[1].begin(), above[1].end());
    own.joints[0].assign(fork.first, above[0].end());
    own.joints[1].assign(fork.second, above[1].end());
    own.linear = loop.linear_axes();
    own.angular = loop.angular_axes();
    if (loop.type == ir::LoopType::distance) own.length = ir::loop_length(tree_, loop);
    for (const int k : path(own)) {
      const ir::Body& moved = body(k);
      const std::string leave = "leave 'independent' out of the loop: it has rows then";
      if (moved.of_quaternion() && moved.part > 0) continue;  // said of the first
      if (moved.of_quaternion())
        error(loop,
              fmt::format("joint {} between its links has a quaternion, and can neither follow nor be followed", joint(k)),
              "make it universal, or " + leave);
      else if (moved.driven())
        error(loop, fmt::format("joint {} between its links is a mimic joint, of {}", joint(k), joint(moved.driven_by)),
              "remove the mimic relation, or " + leave);
      else if (!moved.elastic.empty())
        error(loop, fmt::format("joint '{}' between its links is elastic", moved.elastic), "make it rigid, or " + leave);
    }
    return own;
  }

  void choose_independent(const ir::Loop& loop) {
    const ir::LinkageLoop& own = loops_[static_cast<size_t>(&loop - scene_.embedded.data())];
    for (const std::string& name : loop.independent) {
      bool found = false;
      for (const int k : path(own)) {
        if (body(k).joint != name && body(k).of != name) continue;
        independent_.insert(k);
        found = true;
      }
      if (!found)
        error(loop,
              fmt::format("joint '{}' is named as independent, and the loop does not move it: it is not between links '{}' and "
                          "'{}'",
                          name, loop.links[0], loop.links[1]),
              fmt::format("name one of joints {}", joints(path(own))));
    }
  }

  // Loops that share a dependent joint are solved for together.
  void group() {
    std::vector<size_t> of(loops_.size());
    std::iota(of.begin(), of.end(), size_t{0});
    std::vector<std::set<int>> dependent(loops_.size());
    for (size_t l = 0; l < loops_.size(); ++l)
      for (const int k : path(loops_[l]))
        if (!independent_.contains(k)) dependent[l].insert(k);
    for (size_t l = 0; l < loops_.size(); ++l)
      for (size_t other = 0; other < l; ++other)
        if (std::any_of(dependent[l].begin(), dependent[l].end(), [&](int k) { return dependent[other].contains(k); })) {
          const size_t from = of[l], to = of[other];
          std::replace(of.begin(), of.end(), from, to);
        }
    for (size_t g = 0; g < loops_.size(); ++g) {
      if (std::find(of.begin(), of.end(), g) == of.end()) continue;
      ir::Linkage linkage;
      std::set<int> follow, lead;
      int rows = 0;
      for (size_t l = 0; l < loops_.size(); ++l) {
        if (of[l] != g) continue;
        linkage.loops.push_back(loops_[l]);
        rows += loops_[l].rows();
        follow.insert(dependent[l].begin(), dependent[l].end());
        for (const int k : path(loops_[l]))
          if (independent_.contains(k)) lead.insert(k);
      }
      linkage.dependent.assign(follow.begin(), follow.end());
      linkage.independent.assign(lead.begin(), lead.end());
      check_count(linkage, rows);
      tree_.linkages.push_back(std::move(linkage));
    }
  }

  std::string called(const ir::Linkage& linkage) {
    std::vector<std::string> names;
    for (const ir::LinkageLoop& loop : linkage.loops) names.push_back("'" + loop.name + "'");
    return fmt::format("loop{} {}", names.size() > 1 ? "s" : "", fmt::join(names, ", "));
  }

  void check_count(const ir::Linkage& linkage, int rows) {
    const int count = static_cast<int>(linkage.dependent.size());
    const auto counted = [](int n, const char* what) { return fmt::format("{} {}{}", n, what, n == 1 ? "" : "s"); };
    if (count > rows)
      error(called(linkage),
            fmt::format("too few joints are independent: {} cannot tell where {} are, {}", counted(rows, "row"),
                        counted(count, "joint"), joints(linkage.dependent)),
            fmt::format("name {} more of them as independent, or let the loop hold more", count - rows));
    else if (count < rows)
      error(called(linkage),
            count == 0 ? fmt::format("too many joints are independent: {} {} none that follows", counted(rows, "row"),
                                     rows == 1 ? "has" : "have")
                       : fmt::format("too many joints are independent: {} hold {}, {}", counted(rows, "row"),
                                     counted(count, "joint"), joints(linkage.dependent)),
            (rows - count < static_cast<int>(linkage.independent.size())
                 ? fmt::format("name {} fewer of {}, or let the loop hold less", rows - count, joints(linkage.independent))
                 : std::string("let the loop hold less")) +
                ": a planar linkage takes type: pin, of two rows");
    else if (count > ir::most_dependent_joints || static_cast<int>(linkage.independent.size()) > ir::most_independent_joints)
      error(called(linkage),
            fmt::format("{} follow {}; no more than {} may follow {}", counted(count, "joint"),
                        counted(static_cast<int>(linkage.independent.size()), "joint"), ir::most_dependent_joints,
                        ir::most_independent_joints),
            "leave 'independent' out of the loops: they have rows then");
  }

  // From zero, and from elsewhere: loops that no position closes are a mistake in the numbers, and rows that say the same, or
  // that some dependent joint does not move, are one in their kind.
  void try_to_close(size_t number) {
    const ir::Linkage& linkage = tree_.linkages[number];
    ir::KinematicTree alone = tree_;
    alone.linkages = {linkage};
    Eigen::VectorXd q = Eigen::VectorXd::Zero(tree_.nq());
    for (const int first : tree_.quaternions()) q[first + 3] = 1;
    const ir::ClosedState state = ir::draw_closed(alone, q, 400, ir::well_off_toggle_points, true);
    if (state.closed) return;
    const std::string who = called(linkage);
    if (state.most_regular < 1e-6)
      error(
          who,
          fmt::format("what it holds does not tell where joint{} {} {}: rows say the same, or not all of these joints move "
                      "them",
                      linkage.dependent.size() > 1 ? "s" : "", joints(linkage.dependent),
                      linkage.dependent.size() > 1 ? "are" : "is"),
          "choose a type whose rows differ (a planar linkage takes pin, across the joints' axes), or other independent joints");
    else
      error(who, fmt::format("no position of its joints was found that closes it: {:.3g} are left at best", state.least_error),
            "correct 'at', which says where the links are held together, or the length");
  }

  void error(const ir::Loop& loop, const std::string& message, const std::string& remedy) {
    error(fmt::format("loop '{}'", loop.name), message, remedy);
  }
  void error(const std::string& element, const std::string& message, const std::string& remedy) {
    add_error(errors_, {Severity::error, robot_.file, element, message, remedy});
  }
  void stop() const {
    if (!errors_.empty()) throw InputError(errors_);
  }

  ir::KinematicTree& tree_;
  const ir::Scene& scene_;
  const ir::RobotDescription& robot_;
  std::vector<ir::LinkageLoop> loops_;
  std::set<int> independent_;
  Diagnostics errors_;
};

}  // namespace

void embed_loops(ir::KinematicTree& tree, const ir::Scene& scene, const ir::RobotDescription& robot) {
  Embedding(tree, scene, robot).run();
}

}  // namespace dalembert::passes
