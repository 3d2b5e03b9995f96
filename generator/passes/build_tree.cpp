#include "passes/build_tree.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <unordered_set>

#include "ir/identifier.hpp"
#include "ir/loop_length.hpp"
#include "ir/rotation.hpp"
#include "passes/combine_inertia.hpp"
#include "passes/embed_loops.hpp"
#include "passes/joints/displacement.hpp"
#include "passes/joints_without_mass.hpp"
#include "passes/magnitudes.hpp"

namespace dalembert::passes {

namespace {

size_t at(int index) { return static_cast<size_t>(index); }

class TreeBuilder {
 public:
  TreeBuilder(const ir::RobotDescription& robot, const ir::Scene& scene, Diagnostics& warnings)
      : robot_(robot), scene_(scene), warnings_(warnings) {}

  ir::KinematicTree build() {
    tree_.robot = robot_.name;
    tree_.base_link = robot_.links[at(robot_.root)].name;
    if (scene_.base == ir::Base::floating) tree_.base_joint = ir::JointType::floating;
    parts_.resize(1);
    walk();
    place_frames();
    if (tree_.base_coordinates() > 0) tree_.base = combined(parts_[0]);
    for (size_t k = 0; k < tree_.bodies.size(); ++k) tree_.bodies[k].inertia = combined(parts_[k + 1]);
    for (size_t k = tree_.bodies.size(); k-- > 0;)
      if (const int parent = tree_.bodies[k].parent; parent >= 0)
        tree_.bodies[at(parent)].subtree_size += tree_.bodies[k].subtree_size;
    drive();
    check_something_moves();
    if (scene_.embedded.empty()) warn_of_massless_joints();
    for (const ir::ExternalWrench& wrench : scene_.wrenches)
      for (const ir::LinkPlacement& placement : tree_.links)
        if (placement.link == wrench.link) tree_.pushed.push_back(placement.body);
    tree_.constraint_rows = scene_.constraint_rows();
    check_contacts();
    check_loops();
    check_links();
    if (!errors_.empty()) throw InputError(errors_);
    if (!scene_.embedded.empty()) {
      embed_loops(tree_, scene_, robot_);
      warn_of_massless_joints();
    }
    for (const ir::Contact& contact : scene_.contacts) tree_.held.emplace_back(tree_.find_link(contact.link)->body, ir::nobody);
    for (const ir::Loop& loop : scene_.loops)
      tree_.held.emplace_back(tree_.find_link(loop.links[1])->body, tree_.find_link(loop.links[0])->body);
    check_magnitudes(tree_, scene_, robot_.file);
    return std::move(tree_);
  }

 private:
  // A link still to be visited: the joint above it (-1 for the root), and the body its parent link is part of.
  struct Visit {
    int link, joint, parent_body;
    Eigen::Isometry3d placement;  // of the link, in the parent's body at q = 0
  };

  void walk() {
    const bool fixed = scene_.base == ir::Base::fixed;
    std::vector<Visit> stack{{robot_.root, -1, -1, fixed ? robot_.root_pose : Eigen::Isometry3d::Identity()}};
    while (!stack.empty()) {
      Visit visit = std::move(stack.back());
      stack.pop_back();
      const int body = visit.joint >= 0 && moves(robot_.joints[at(visit.joint)]) ? start_bodies(visit) : visit.parent_body;
      const ir::Link& link = robot_.links[at(visit.link)];
      tree_.links.push_back({link.name, body, visit.placement});
      if (link.inertia) parts_[at(body + 1)].push_back(moved(*link.inertia, visit.placement));

      const std::vector<int>& children = robot_.children[at(visit.link)];
      for (auto j = children.rbegin(); j != children.rend(); ++j) {  // the first child on top of the stack
        const ir::Joint& joint = robot_.joints[at(*j)];
        if (!scene_.cut.count(robot_.links[at(joint.child)].name))
          stack.push_back({joint.child, *j, body, visit.placement * joint.origin * lock(joint)});
      }
    }
  }

  // Frames of the scene count as links from here on.
  void place_frames() {
    const size_t links = tree_.links.size();
    for (const ir::Frame& frame : scene_.placed)
      for (size_t l = 0; l < links; ++l)
        if (tree_.links[l].link == frame.link) {
          ir::LinkPlacement placed{frame.name, tree_.links[l].body, tree_.links[l].placement * frame.in_link(), frame.link};
          tree_.links.push_back(std::move(placed));
        }
  }

  bool moves(const ir::Joint& joint) const { return joint.type != ir::JointType::fixed && !scene_.locked.count(joint.name); }

  // The joint's displacement where it is locked; the identity elsewhere.
  Eigen::Isometry3d lock(const ir::Joint& joint) const {
    const auto locked = scene_.locked.find(joint.name);
    if (locked == scene_.locked.end()) return Eigen::Isometry3d::Identity();
    return displacement(as_asked(joint), locked->second);
  }

  // With the kind that the scene gives it.
  ir::Joint as_asked(const ir::Joint& joint) const {
    const auto kind = scene_.joints.find(joint.name);
    return kind == scene_.joints.end() ? joint : with_kind(joint, kind->second);
  }

  // The link begins a body, or the last of several in a row: its frame becomes theirs.
  int start_bodies(Visit& visit) {
    const ir::Joint joint = as_asked(robot_.joints[at(visit.joint)]);
    const std::vector<ir::JointPart> parts = ir::row_of(joint.type).parts(joint);
    const std::string& link = robot_.links[at(visit.link)].name;
    if (parts.size() == 1) return start_body(visit, joint, parts.front(), joint.name, link);
    int body = visit.parent_body;
    for (size_t i = 0; i < parts.size(); ++i) {
      const bool last = i + 1 == parts.size();
      const std::string name = distinct(joint.name + "_" + parts[i].suffix);
      body = start_body(visit, joint, parts[i], name, last ? link : distinct(joint.name + "_" + parts[i].suffix + "_body"));
      ir::Body& made = tree_.bodies[at(body)];
      made.of = joint.name;
      made.kind = joint.type;
      made.part = static_cast<int>(i);
      made.parts = static_cast<int>(parts.size());
      visit.parent_body = body;
    }
    return body;
  }

  int start_body(Visit& visit, const ir::Joint& joint, const ir::JointPart& part, const std::string& name,
                 const std::string& moved) {
    ir::Body body;
    body.name = moved;
    body.joint = name;
    body.type = part.type;
    body.pitch = joint.pitch;
    if (ir::row_of(joint.type).nv == 1) body.limits = joint.limits;
    body.parent = visit.parent_body;
    // Here rather than in a later pass: what counts as the robot is the same for generated code and for its references.
    body.placement = visit.placement;
    body.placement.linear() = ir::without_rounding_dust(body.placement.linear());
    body.axis = part.axis;
    const auto asked = [&](const std::map<std::string, double>& values, double otherwise) {
      const auto value = values.find(joint.name);
      return value == values.end() ? otherwise : value->second;
    };
    body.armature = asked(scene_.armature, 0);
    body.damping = asked(scene_.damping, scene_.urdf_damping ? joint.damping : 0);
    body.friction = asked(scene_.friction, scene_.urdf_friction ? joint.friction : 0);
    if (const auto spring = scene_.stiffness.find(joint.name); spring != scene_.stiffness.end()) body.spring = spring->second;
    visit.placement.setIdentity();
    const auto elastic = scene_.elastic.find(joint.name);
    if (elastic == scene_.elastic.end()) return add(std::move(body));

    ir::Body link = body;  // behind the motor
    body.name = distinct(joint.name + "_motor");
    body.armature = elastic->second.inertia;
    link.joint = distinct(joint.name + "_spring");
    link.parent = add(std::move(body));
    link.placement.setIdentity();
    link.limits = {};
    link.friction = 0;
    link.damping = elastic->second.damping;
    link.spring = {elastic->second.k, 0};
    link.elastic = joint.name;
    return add(std::move(link));
  }

  int add(ir::Body body) {
    parts_.emplace_back();
    tree_.bodies.push_back(std::move(body));
    return tree_.joints() - 1;
  }

  // A name that neither a link nor a joint of the file has, in C++ neither.
  std::string distinct(std::string name) {
    if (names_.empty()) {
      for (const ir::Link& link : robot_.links) names_.insert(ir::identifier(link.name));
      for (const ir::Joint& joint : robot_.joints) names_.insert(ir::identifier(joint.name));
    }
    while (!names_.insert(ir::identifier(name)).second) name += '_';
    return name;
  }

  // Mimic relations. What a driven joint adds to its driver's coordinate v: armature (c v̇ = force/c), so c² of it; likewise
  // damping; Coulomb friction does not grow with speed, so |c|.
  void drive() {
    if (scene_.mimic.empty()) return;
    std::unordered_map<std::string, int> body_of;
    for (int k = 0; k < tree_.joints(); ++k) body_of.emplace(tree_.bodies[at(k)].joint, k);
    for (const auto& [name, relation] : scene_.mimic) {
      ir::Body& driven = tree_.bodies[at(body_of.at(name))];
      driven.driven_by = body_of.at(relation.of);
      driven.multiplier = relation.multiplier;
      driven.offset = relation.offset;
      ir::Body& driver = tree_.bodies[at(driven.driven_by)];
      driver.armature += relation.multiplier * relation.multiplier * driven.armature;
      driver.damping += relation.multiplier * relation.multiplier * driven.damping;
      driver.friction += std::abs(relation.multiplier) * driven.friction;
      driven.armature = driven.damping = driven.friction = 0;
    }
  }

  // A remedy that works: a base that floats has a mass, and an extent where M is solved with.
  void check_something_moves() {
    if (tree_.nv() > 0) return;
    const ir::Inertia all = combined(parts_[0]);
    const std::vector<ir::Quantity> asked = scene_.quantities();
    const bool solved = std::any_of(asked.begin(), asked.end(),
                                    [](ir::Quantity quantity) { return ir::is_solved(ir::row_of(quantity).scale); });
    const bool may_float = all.mass != 0 && (!solved || !all.inertia.isZero(0));
    const char* joint = !scene_.locked.empty() ? scene_.lock_massless ? "let a joint move a mass" : "unlock a joint"
                        : !scene_.cut.empty()  ? "cut off less"
                                               : "give it a joint that moves";
    throw InputError({Severity::error, robot_.file, fmt::format("robot '{}'", robot_.name),
                      "no joint is left to move and the base is fixed",
                      fmt::format("{}, or {}ask for --base floating", joint,
                                  may_float ? "" : "give a link an <inertial> with a mass and an extent and ")});
  }

  // Where M is singular.
  void warn_of_massless_joints() {
    if (moves_no_mass(tree_, scene_)) return;  // check_mass says it once
    const std::vector<int> massless = joints_without_mass(tree_, scene_);
    std::vector<std::string> names;
    for (int k : massless)
      if (const std::string name = in_words(tree_.bodies[at(k)]); names.empty() || names.back() != name) names.push_back(name);
    if (!names.empty() && !scene_.lock_massless)
      warnings_.push_back(
          {Severity::warning, robot_.file, fmt::format("joint{} {}", names.size() > 1 ? "s" : "", fmt::join(names, ", ")),
           "nothing that moves there has a mass: M is singular",
           "lock such joints with massless: lock in the scene, give the links <inertial> with a mass, or the joints an "
           "armature in the scene"});
    for (size_t k = 0; k < tree_.bodies.size(); ++k)
      if (const ir::Body& body = tree_.bodies[k]; no_inertia_about_axis(body) && !carries_payload(static_cast<int>(k)) &&
                                                  !std::binary_search(massless.begin(), massless.end(), static_cast<int>(k)))
        warnings_.push_back({Severity::warning, robot_.file, "joint " + in_words(body),
                             fmt::format("link '{}' has no inertia about the joint's axis: M is singular", body.name),
                             body.elastic.empty() ? "give the link a rotational inertia, or the joint an armature in the scene"
                                                  : "give the link a rotational inertia, or leave the joint out of 'elastic'",
                             "no inertia about axis"});
  }

  bool no_inertia_about_axis(const ir::Body& body) const {
    if (tree_.in_linkage(static_cast<int>(&body - tree_.bodies.data()))) return false;  // what it moves with counts
    if (body.slides() || body.driven() || body.subtree_size > 1 || body.armature > 0) return false;
    const Eigen::Vector3d lever = body.axis.cross(body.inertia.com);
    return body.axis.dot(body.inertia.inertia * body.axis) + body.inertia.mass * lever.squaredNorm() == 0;
  }

  bool carries_payload(int body) const {
    return std::any_of(tree_.links.begin(), tree_.links.end(),
                       [&](const ir::LinkPlacement& link) { return link.body == body && scene_.has_payload(link.link); });
  }

  // With a fixed base, links welded to it carry nothing and have neither a pose nor a Jacobian worth computing.
  void check_links() {
    if (tree_.base_coordinates() > 0) return;
    std::vector<ir::LinkOutput> outputs = scene_.link_outputs();
    for (const ir::NamedFunction& function : scene_.functions)
      outputs.insert(outputs.end(), function.of_links.begin(), function.of_links.end());
    for (const ir::LinkPlacement& placement : tree_.links) {
      if (placement.body >= 0) continue;
      const std::string element = placement.in_words();
      if (std::any_of(scene_.wrenches.begin(), scene_.wrenches.end(),
                      [&](const ir::ExternalWrench& wrench) { return wrench.link == placement.link; }))
        error(element, "a wrench is asked for on a link that does not move",
              "name a descendant of a joint that moves, or ask for base: floating");
      if (scene_.has_payload(placement.link))
        error(element, "a payload is asked for at a link that does not move",
              "name a descendant of a joint that moves, or ask for base: floating");
      const auto asked = std::find_if(outputs.begin(), outputs.end(),
                                      [&](const ir::LinkOutput& output) { return output.link == placement.link; });
      if (asked != outputs.end())
        error(element, fmt::format("{} is asked for of a link that does not move: the base is fixed", ir::name_of(*asked)),
              "name a descendant of a joint that moves, or ask for base: floating");
    }
  }

  // What holds a link twice says nothing the second time.
  void check_contacts() {
    struct Held {
      const ir::Contact* contact;
      int body;
      Eigen::Vector3d point;  // in the body
    };
    std::vector<Held> all;
    for (const ir::Contact& contact : scene_.contacts) {
      const ir::LinkPlacement* const link = tree_.find_link(contact.link);
      if (!link) continue;  // the scene's check has said so
      const Held held{&contact, link->body, link->placement * contact.at};
      const std::string element = fmt::format("contact '{}'", contact.name);
      if (held.body < 0 && tree_.base_coordinates() == 0)
        error(element, fmt::format("link '{}' is welded to a fixed base: there is nothing to hold", contact.link),
              "name a descendant of a joint that moves, or ask for base: floating");
      const bool weld = contact.type == ir::ContactType::weld;
      for (const Held& other : all)
        if (other.body == held.body && other.contact->type == contact.type &&
            (weld || (other.point - held.point).norm() < 1e-9))
          error(element,
                fmt::format("it is contact '{}' again: {}", other.contact->name,
                            weld ? "both weld the same body" : "both hold the same point of one body"),
                "keep one of the two");
      all.push_back(held);
    }
  }

  // Two points of one body hold nothing that could move; the same twice says nothing the second time.
  void check_loops() {
    struct Held {
      const ir::Loop* loop;
      int bodies[2];
      Eigen::Isometry3d at[2];  // in the bodies
    };
    std::vector<Held> all;
    std::vector<ir::Loop> loops = scene_.loops;
    loops.insert(loops.end(), scene_.embedded.begin(), scene_.embedded.end());
    for (const ir::Loop& loop : loops) {
      Held held{&loop, {}, {}};
      bool there = true;
      for (std::size_t i = 0; i < 2; ++i) {
        const ir::LinkPlacement* const link = tree_.find_link(loop.links[i]);
        there = there && link;
        if (!there) break;  // the scene's check has said so
        held.bodies[i] = link->body;
        held.at[i] = link->placement * loop.at[i];
      }
      if (!there) continue;
      const std::string element = fmt::format("loop '{}'", loop.name);
      if (held.bodies[0] == held.bodies[1]) {
        error(element,
              loop.links[0] == loop.links[1]
                  ? fmt::format("it holds link '{}' to itself", loop.links[0])
                  : fmt::format("links '{}' and '{}' are one body: no joint between them moves", loop.links[0], loop.links[1]),
              "name two links that move against each other");
        continue;
      }
      if (loop.type == ir::LoopType::distance && !(ir::loop_length(tree_, loop) > 1e-9))
        error(element, "its points coincide where all joints are at zero, and nothing says how far apart they are",
              "write its length, m, or type: point");
      for (const Held& other : all) {
        if (other.loop->type != loop.type) continue;
        const auto same = [&](std::size_t i, std::size_t k) {
          return held.bodies[i] == other.bodies[k] && held.at[i].isApprox(other.at[k], 1e-9);
        };
        if ((same(0, 0) && same(1, 1)) || (same(0, 1) && same(1, 0)))
          error(element, fmt::format("it is loop '{}' again: both hold the same frames of the same bodies", other.loop->name),
                "keep one of the two");
      }
      all.push_back(held);
    }
  }

  void error(std::string element, std::string message, std::string remedy) {
    add_error(errors_, {Severity::error, robot_.file, std::move(element), std::move(message), std::move(remedy)});
  }

  const ir::RobotDescription& robot_;
  const ir::Scene& scene_;
  Diagnostics& warnings_;
  ir::KinematicTree tree_;
  std::vector<std::vector<ir::Inertia>> parts_;  // per body, the base's first: inertias of its links
  std::unordered_set<std::string> names_;        // identifiers of links and joints; empty until one is made up
  Diagnostics errors_;
};

}  // namespace

ir::KinematicTree build_tree(const ir::RobotDescription& robot, const ir::Scene& scene, Diagnostics& warnings) {
  return TreeBuilder(robot, scene, warnings).build();
}

}  // namespace dalembert::passes
