#include "frontend/scene_check.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <unordered_map>

#include "frontend/function_names.hpp"
#include "frontend/nearest.hpp"
#include "ir/aliases.hpp"
#include "ir/emitted_function.hpp"
#include "ir/identifier.hpp"

namespace dalembert::frontend {

namespace {

class SceneCheck {
 public:
  SceneCheck(const SceneDocument& document, const ir::RobotDescription& robot, Diagnostics& warnings)
      : document_(document), robot_(robot), warnings_(warnings), scene_(document.scene) {
    for (size_t i = 0; i < robot.links.size(); ++i) links_.emplace(robot.links[i].name, static_cast<int>(i));
    for (size_t j = 0; j < robot.joints.size(); ++j) joints_.emplace(robot.joints[j].name, static_cast<int>(j));
    is_cut_.assign(robot.links.size(), false);
  }

  ir::Scene run() {
    if (!document_.given.count("loops")) scene_.loops = robot_.loops;
    if (!document_.given.count("base")) scene_.base = default_base(robot_);
    outputs();
    cut();
    kinds();
    locked();
    mimic();
    placed();
    links_asked("jacobians", scene_.jacobians);
    std::vector<std::string> frames;
    for (const ir::LinkOutput& output : scene_.frames)
      if (std::find(frames.begin(), frames.end(), output.link) == frames.end()) frames.push_back(output.link);
    links_asked("frames", frames);
    names_differ();
    functions();
    links_asked("payloads", scene_.payloads);
    wrenches();
    contacts();
    for (const std::string& joint : scene_.passive)
      if (free_joint("passive", joint) && scene_.mimic.count(joint))
        error("passive/" + joint, fmt::format("joint '{}' is driven by another", joint), "name the joint that drives it");
    for (const auto& [joint, value] : scene_.armature) free_joint("armature", joint);
    for (const auto& [joint, value] : scene_.damping) free_joint("damping", joint);
    for (const auto& [joint, value] : scene_.friction) free_joint("friction", joint);
    stiffness();
    elastic();
    parts();
    plan();
    rollouts();
    if (scene_.urdf_damping) urdf_values("damping", &ir::Joint::damping);
    if (scene_.urdf_friction) urdf_values("friction", &ir::Joint::friction);
    if (!errors_.empty()) throw InputError(errors_);
    say_what_base_is_taken();
    warn_of_mimic();
    say_what_loops_are_taken();
    warn_of_turned_rods();
    warn_of_losses("damping", scene_.urdf_damping, scene_.damping, &ir::Joint::damping);
    warn_of_losses("friction", scene_.urdf_friction, scene_.friction, &ir::Joint::friction);
    return std::move(scene_);
  }

 private:
  void outputs() {
    const bool given = document_.given.count("outputs") > 0;
    if (scene_.outputs.empty() && scene_.link_outputs().empty() && scene_.functions.empty())
      error("outputs", "no output is asked for", "name at least one quantity, such as mass_matrix");
    for (const ir::Quantity quantity : scene_.outputs) of_contacts("outputs/" + std::string(ir::name_of(quantity)), quantity);
    if (!scene_.rates_zero) return;
    if (!given) {
      scene_.outputs = {ir::Quantity::mass_matrix, ir::Quantity::gravity};
    } else if (std::count(scene_.outputs.begin(), scene_.outputs.end(), ir::Quantity::coriolis_matrix)) {
      error("outputs", "coriolis_matrix is zero when rates_zero is set",
            "remove one of the two; bias then knows no velocities, and may stay");
    }
  }

  // Others weld a URDF's root to the world (Pinocchio, MuJoCo) or let it float (Drake, DART).
  void say_what_base_is_taken() {
    const ir::Link& root = robot_.links[static_cast<size_t>(robot_.root)];
    if (document_.given.count("base") || robot_.floating_root || root.name == "world") return;
    const bool floats = scene_.base == ir::Base::floating;
    const bool any_moves =
        std::any_of(robot_.joints.begin(), robot_.joints.end(), [&](const ir::Joint& joint) { return moves(joint); });
    warnings_.push_back({Severity::notice, robot_.file, fmt::format("link '{}'", root.name),
                         fmt::format("neither the scene nor the URDF says whether this base moves: {}",
                                     floats ? "it floats, for it has an inertia" : "it is fixed, for it has no inertia"),
                         !floats     ? "let it move with --base floating, or say --base fixed"
                         : any_moves ? "weld it to the world with --base fixed, or say --base floating"
                                     : "say --base floating: no joint would move of one that is fixed"});
  }

  // A file's loops are the scene's, where the scene says nothing of loops.
  void say_what_loops_are_taken() {
    const bool given = document_.given.count("loops") > 0;
    std::vector<std::string> names, left_out;
    for (const ir::Loop& loop : robot_.loops) {
      const auto is_it = [&](const ir::Loop& other) { return other.name == loop.name; };
      const bool taken = std::any_of(scene_.loops.begin(), scene_.loops.end(), is_it) ||
                         std::any_of(scene_.embedded.begin(), scene_.embedded.end(), is_it);
      (taken ? names : left_out).push_back("'" + loop.name + "'");
    }
    if (!given && !names.empty())
      warnings_.push_back(
          {Severity::notice, robot_.file, named(names),
           names.size() > 1 ? "they close loops, which are the scene's of these names"
                            : "it closes a loop, which is the scene's of this name",
           "constrained dynamics keep to them, all else is of the tree without; loops in the scene says otherwise"});
    if (given && !left_out.empty() && !(scene_.loops.empty() && scene_.embedded.empty()))
      warnings_.push_back({Severity::warning, robot_.file, named(left_out), "what they hold together is left out",
                           "name them under loops too, or leave loops out of the scene to have them as the file says"});
  }

  // A rod has a ball at each end.
  void warn_of_turned_rods() {
    if (!document_.given.count("loops")) return;
    for (const std::vector<ir::Loop>* list : {&scene_.loops, &scene_.embedded})
      for (const ir::Loop& loop : *list) {
        if (loop.type != ir::LoopType::distance || (loop.at[0].linear().isIdentity(0) && loop.at[1].linear().isIdentity(0)))
          continue;
        const Place place = place_of("loops/" + loop.name + part_of_entry + "at");
        warnings_.push_back(
            {Severity::warning, place.file, place.element,
             fmt::format("roll pitch yaw of loop '{}' are left out: a distance is between two points", loop.name),
             "write x y z alone, or another type"});
      }
  }

  void wrenches() {
    std::vector<std::string> links;
    for (const ir::ExternalWrench& wrench : scene_.wrenches) links.push_back(wrench.link);
    links_asked("wrenches", links);
  }

  void contacts() {
    std::set<std::string> names;
    for (const ir::Contact& contact : scene_.contacts) {
      const std::string key = "contacts/" + contact.name;
      const std::string link = key + part_of_entry + "link";
      kept_link(document_.places.count(link) ? link : key, contact.link);
      if (contact.name.empty()) error("contacts", "a contact has an empty name", "give it one");
      if (const std::string id = ir::identifier(contact.name); !names.insert(id).second)
        error(key, fmt::format("two contacts would be called '{}' in C++", id), "call one of them otherwise");
    }
    if (!document_.given.count("loops"))
      std::erase_if(scene_.loops, [&](const ir::Loop& loop) {
        return std::any_of(loop.links.begin(), loop.links.end(),
                           [&](const std::string& link) { return is_cut_[static_cast<size_t>(links_.at(link))]; });
      });
    std::set<std::string> loops;
    for (const std::vector<ir::Loop>* list : {&scene_.loops, &scene_.embedded})
      for (const ir::Loop& loop : *list) {
        const std::string key = "loops/" + loop.name;
        for (const std::string& link : loop.links) kept_link(key + part_of_entry + "links", link);
        for (const std::string& joint : loop.independent) free_joint(key + part_of_entry + "independent", joint);
        if (const std::string id = ir::identifier(loop.name); !loops.insert(id).second)
          error(key, fmt::format("two loops would be called '{}' in C++", id), "call one of them otherwise");
      }
    embedded();
    if (const int rows = scene_.constraint_rows(); rows > ir::most_constraint_rows)
      error(scene_.loops.empty() ? "contacts" : "loops",
            fmt::format("contacts and loops have {} rows; no more than {} are supported", rows, ir::most_constraint_rows),
            "name fewer of them, or take three points or more of one link as one weld");
  }

  // What is not worked out beside loops that are embedded.
  void embedded() {
    if (scene_.embedded.empty()) return;
    const std::string& name = scene_.embedded.front().name;
    const std::string own = "loops/" + name + part_of_entry + "independent";
    if (scene_.any_constraint())
      error(own,
            fmt::format("loop '{}' is embedded, and {} '{}' has rows: both together are not computed", name,
                        scene_.contacts.empty() ? "loop" : "contact",
                        scene_.contacts.empty() ? scene_.loops.front().name : scene_.contacts.front().name),
            scene_.contacts.empty()
                ? "give all loops independent joints, or none"
                : fmt::format("leave 'independent' out of loop '{}': it has rows beside those of contacts then", name));
    if (scene_.batch)
      error("batch", fmt::format("loop '{}' is embedded, and batches are of robots without", name),
            "leave batch out, or 'independent' of all loops");
    if (scene_.parallel == ir::Parallel::tasks)
      error("parallel", fmt::format("loop '{}' is embedded, and task graphs are of robots without", name),
            "leave parallel: tasks out");
    if (scene_.forward_dynamics == ir::Solver::articulated_bodies)
      error("forward_dynamics", fmt::format("loop '{}' is embedded: what is solved with M is solved by factorization", name),
            "leave the key out, or write forward_dynamics: factorization");
  }

  // A quantity of constraints is none where there are none.
  void of_contacts(const std::string& key, ir::Quantity quantity) {
    if (!scene_.embedded.empty() && !ir::is_of_linkages(quantity))
      return error(key,
                   fmt::format("{} is asked for, and loop '{}' is embedded: it is not computed of independent coordinates",
                               ir::name_of(quantity), scene_.embedded.front().name),
                   ir::is_of_constraints(quantity)
                       ? "leave 'independent' out of all loops: they have rows and forces then"
                       : "leave 'independent' out of all loops and ask for constrained_forward_dynamics and its derivatives");
    if (!scene_.any_constraint() && ir::is_of_constraints(quantity))
      error(key, fmt::format("{} is asked for, and there is neither a contact nor a loop", ir::name_of(quantity)),
            "say where the robot is held: contacts: {left_foot: weld}, or which links hold each other: loops");
  }

  void cut() {
    std::vector<int> beyond;
    for (const std::string& name : scene_.cut) {
      if (!known("cut", "link", name, links_)) continue;
      const int link = links_.at(name);
      if (link == robot_.root)
        error("cut/" + name, fmt::format("link '{}' is the root: nothing would be left", name), "name a link below a joint");
      beyond.push_back(link);
    }
    while (!beyond.empty()) {
      const size_t link = static_cast<size_t>(beyond.back());
      beyond.pop_back();
      if (is_cut_[link]) continue;
      is_cut_[link] = true;
      for (int j : robot_.children[link]) beyond.push_back(robot_.joints[static_cast<size_t>(j)].child);
    }
  }

  void kinds() {
    for (const auto& [name, kind] : scene_.joints) {
      if (!moving_joint("joints", name)) continue;
      const ir::Joint& joint = robot_.joints[static_cast<size_t>(joints_.at(name))];
      if (ir::row_of(kind.type).has_axis && !joint.axis_is_known)
        error("joints/" + name,
              fmt::format("joint '{}' is {} in the URDF and has no <axis> there", name, ir::row_of(joint.type).word),
              "give it one in the URDF: <axis xyz=\"0 0 1\"/> or another direction");
      else if (kind.type == ir::JointType::universal && joint.axis.cross(kind.second).norm() < 1e-9)
        error("joints/" + name, fmt::format("the second axis of joint '{}' is its first: together they turn one way", name),
              "give the axis of the cross's other pin, in the child link's frame");
      if (!ir::turns(joint.type) && kind.type == ir::JointType::helical)
        error("joints/" + name,
              fmt::format("joint '{}' is {}: limits and losses of a screw are those of its angle", name,
                          ir::row_of(joint.type).word),
              "make it revolute or continuous in the URDF");
    }
  }

  // Of those of several coordinates only where they are zero.
  void locked() {
    for (const auto& [name, value] : scene_.locked)
      if (moving_joint("locked", name) && value != 0 && coordinates_of(name) > 1)
        error("locked/" + name, fmt::format("joint '{}' has {} coordinates", name, coordinates_of(name)),
              "lock it at zero, and say in the URDF's <origin> where that is");
  }

  ir::JointType type_of(const std::string& name) const {
    const auto kind = scene_.joints.find(name);
    return kind == scene_.joints.end() ? robot_.joints[static_cast<size_t>(joints_.at(name))].type : kind->second.type;
  }
  int coordinates_of(const std::string& name) const { return ir::coordinates_of(type_of(name)); }

  // A relation or spring is of one coordinate.
  bool of_one_coordinate(const std::string& key, const std::string& name) {
    if (coordinates_of(name) == 1) return true;
    error(locate(key, name), fmt::format("joint '{}' has {} coordinates", name, coordinates_of(name)),
          "name a joint of one coordinate, or remove it here");
    return false;
  }

  // What <dynamics> says of joints that move, asked for by the scene.
  void urdf_values(const char* kind, double ir::Joint::*value) {
    for (const ir::Joint& joint : robot_.joints)
      if (moves(joint) && !(joint.*value >= 0 && std::isfinite(joint.*value)))
        error(kind, fmt::format("the URDF's {} of joint '{}' is {}", kind, joint.name, not_usable(joint.*value)),
              fmt::format("correct it in the URDF, or give values: {}: {{joint: value}}", kind));
  }

  static std::string not_usable(double value) {
    return std::isfinite(value) ? fmt::format("negative ({})", value) : "no finite number";
  }

  void mimic() {
    if (document_.urdf_mimic)
      for (const ir::Joint& joint : robot_.joints)
        if (joint.mimic && moves(joint)) scene_.mimic.emplace(joint.name, *joint.mimic);
    for (const auto& [name, relation] : scene_.mimic) {
      const std::string key = "mimic/" + name, of = key + part_of_entry + "of";
      if (document_.urdf_mimic ? !sound_in_urdf(name, relation) : !free_joint(key, name) || !free_joint(of, relation.of))
        continue;
      if (!of_one_coordinate(key, name) || !of_one_coordinate(of, relation.of)) continue;
      if (relation.of == name) error(key, fmt::format("joint '{}' drives itself", name), "name another joint as its driver");
    }
    compose_mimic();
    for (const auto& [name, relation] : scene_.mimic)
      if (relation.multiplier == 0)
        error("mimic/" + name, fmt::format("the multiplier of joint '{}' is zero: it would not move", name),
              fmt::format("lock it at its offset instead: locked: {{{}: {}}}", name, relation.offset));
  }

  // Who follows a follower follows whom that one follows: q_a = m_a (m_b q_c + o_b) + o_a. Each chain is walked once, up to
  // what has been composed before.
  void compose_mimic() {
    std::set<std::string> walked;
    for (const auto& [first, relation] : scene_.mimic) {
      std::vector<std::string> chain;
      std::string name = first;
      for (; scene_.mimic.count(name) && walked.insert(name).second; name = scene_.mimic.at(name).of) chain.push_back(name);
      if (const auto ring = std::find(chain.begin(), chain.end(), name); chain.end() - ring > 1)
        error(
            "mimic/" + name,
            fmt::format("joints '{}' follow one another in a ring: none moves by itself", fmt::join(ring, chain.end(), "', '")),
            "let one of them follow a joint outside of the ring, or none");
      for (size_t i = chain.size(); i-- > 0;) {
        ir::Mimic& follower = scene_.mimic.at(chain[i]);
        if (const auto driver = scene_.mimic.find(follower.of); driver != scene_.mimic.end()) {
          const ir::Mimic& its = driver->second;
          follower = {its.of, follower.multiplier * its.multiplier, follower.multiplier * its.offset + follower.offset};
        }
      }
    }
  }

  // Whether the URDF's <mimic> of a joint that moves has numbers, and names another that moves.
  bool sound_in_urdf(const std::string& name, const ir::Mimic& relation) {
    const std::string otherwise = "in the URDF, or write the relations in the scene: mimic: {joint: {of: other_joint}}";
    const auto refuse = [&](const std::string& message, const std::string& remedy) {
      error("mimic/" + name, message, remedy);
      return false;
    };
    if (relation.of.empty()) return refuse("its <mimic> names no joint", "correct it " + otherwise);
    if (!std::isfinite(relation.multiplier) || !std::isfinite(relation.offset))
      return refuse("its <mimic> has no finite multiplier and offset", "correct it " + otherwise);
    const auto driver = joints_.find(relation.of);
    if (driver == joints_.end()) {
      std::vector<std::string> others;  // that have a coordinate of their own
      for (const ir::Joint& joint : robot_.joints)
        if (moves(joint) && !scene_.mimic.count(joint.name)) others.push_back(joint.name);
      const std::string remedy = others.empty() ? "add that joint, or remove the <mimic>"
                                                : fmt::format("correct its <mimic> {}; {}", otherwise,
                                                              other_kind(relation.of, suggestion(relation.of, others)));
      return refuse(fmt::format("it follows joint '{}', which does not exist", relation.of), remedy);
    }
    const ir::Joint& joint = robot_.joints[static_cast<size_t>(driver->second)];
    if (is_cut(joint))
      return refuse(fmt::format("it follows joint '{}', which is cut off", relation.of),
                    fmt::format("cut it off too, lock it, or take the link that '{}' belongs to out of 'cut'", relation.of));
    if (joint.type == ir::JointType::fixed)
      return refuse(
          fmt::format("it follows joint '{}', which is fixed", relation.of),
          fmt::format("lock it too: locked: {{{}: {}}}; or correct its <mimic> {}", name, relation.offset, otherwise));
    if (const auto locked = scene_.locked.find(relation.of); locked != scene_.locked.end())
      return refuse(fmt::format("it follows joint '{}', which is locked", relation.of),
                    fmt::format("lock it too: locked: {{{}: {}}}; or unlock '{}'", name,
                                relation.multiplier * locked->second + relation.offset, relation.of));
    return true;
  }

  // A driven joint's spring would not be at rest where its driver's is.
  void stiffness() {
    for (const auto& [joint, spring] : scene_.stiffness) {
      if (!free_joint("stiffness", joint) || !of_one_coordinate("stiffness", joint)) continue;
      if (const auto relation = scene_.mimic.find(joint); relation != scene_.mimic.end())
        error("stiffness/" + joint, fmt::format("joint '{}' mimics '{}'", joint, relation->second.of),
              fmt::format("give the spring to '{}'", relation->second.of));
    }
  }

  // Steps of whole motions, dampers and springs of the joints at their ends.
  void rollouts() {
    const std::string key = scene_.impacts ? "rollouts/impacts" : "rollouts/linearly_implicit";
    if (!scene_.linearly_implicit && !scene_.impacts) return;
    if (!scene_.batch)
      error(key, "rollouts are of batches, which are not asked for",
            "write batch: true, and leave out what says otherwise (--batch false; dalembert_add_robot() without BATCH)");
    const std::vector<ir::Quantity> all = scene_.quantities();
    const auto asked = [&](ir::Quantity quantity) { return std::find(all.begin(), all.end(), quantity) != all.end(); };
    if (scene_.impacts && !asked(ir::Quantity::constrained_forward_dynamics))
      error(key, "no function tells how the robot moves where contacts and loops hold it",
            "ask for constrained_forward_dynamics");
    if (scene_.impacts && !asked(ir::Quantity::impact))
      error(key, "no function tells what an impact does", "ask for impact, beside constrained_forward_dynamics");
    if (scene_.rates_zero)
      error(key, "velocities are zero, and nothing moves",
            std::string("leave rates_zero out, or ") + (scene_.impacts ? "impacts" : "linearly_implicit"));
    if (!scene_.linearly_implicit) return;
    if (!asked(ir::Quantity::forward_dynamics)) error(key, "no function tells how the robot moves", "ask for forward_dynamics");
    if (scene_.any_constraint())
      error(key,
            fmt::format("{} '{}' holds the robot, and linearly implicit steps are of robots that nothing holds",
                        scene_.contacts.empty() ? "loop" : "contact",
                        scene_.contacts.empty() ? scene_.loops.front().name : scene_.contacts.front().name),
            "leave linearly_implicit out, or the contacts and loops");
  }

  // The joints and links whose rows and columns are asked for.
  void parts() {
    for (const auto& [quantity, part] : scene_.parts) of_part("outputs/" + std::string(ir::name_of(quantity)), part);
    for (const ir::LinkOutput& output : scene_.frames)
      if (output.part) of_part("frames/" + output.link + part_of_entry + ir::row_of(output.quantity).name, *output.part);
    for (const ir::NamedFunction& function : scene_.functions) {
      const std::string inside = "functions/" + function.name + part_of_entry;
      for (const auto& [quantity, part] : function.parts) of_part(inside + std::string(ir::name_of(quantity)), part);
      for (const ir::LinkOutput& output : function.of_links)
        if (output.part) of_part(inside + output.link, *output.part);
    }
  }
  void of_part(const std::string& where, const ir::Part& part) {
    for (const std::string& name : part.joints) {
      if (!ir::is_pattern(name)) {
        if (const auto relation = scene_.mimic.find(name); free_joint(where, name) && relation != scene_.mimic.end())
          error(where, fmt::format("joint '{}' mimics '{}', and has no row of its own", name, relation->second.of),
                fmt::format("name '{}', whose row has the sum", relation->second.of));
        continue;
      }
      std::vector<std::string> all;
      for (const ir::Joint& joint : robot_.joints)
        if (joint.type != ir::JointType::fixed && !is_cut(joint) && !scene_.locked.count(joint.name) &&
            !scene_.mimic.count(joint.name))
          all.push_back(joint.name);
      if (std::none_of(all.begin(), all.end(), [&](const std::string& joint) { return ir::matches(name, joint); })) {
        std::string letters = name;
        std::erase_if(letters, [](char c) { return c == '*' || c == '?'; });
        error(where, fmt::format("no joint that moves is called like '{}'", name), suggestion(letters, all));
      }
    }
    for (const std::string& link : part.subtrees) kept_link(where, link);
    for (const std::string& link : part.links) kept_link(where, link);
    if (part.base.value_or(false) && scene_.base == ir::Base::fixed)
      error(where, "the base is fixed, and has no rows", "leave 'base' out, or say base: floating in the scene");
  }

  void elastic() {
    for (const auto& [joint, spring] : scene_.elastic)
      if (free_joint("elastic", joint) && of_one_coordinate("elastic", joint) && scene_.armature.count(joint))
        error("armature/" + joint, fmt::format("joint '{}' is elastic", joint),
              "remove it here: the inertia in 'elastic' is that of the motor");
  }

  template <class Names>
  bool known(const std::string& key, const char* kind, const std::string& name, const Names& names) {
    if (names.count(name)) return true;
    for (const auto& [joint, elasticity] : scene_.elastic)
      if (name == joint + "_spring" || name == joint + "_motor") {
        error(locate(key, name), fmt::format("'{}' is a part of elastic joint '{}'", name, joint),
              fmt::format("what belongs to it stands under elastic, and what belongs to the motor under '{}'", joint));
        return false;
      }
    std::vector<std::string> all;
    for (const auto& entry : names) all.push_back(entry.first);
    std::sort(all.begin(), all.end());
    error(locate(key, name), fmt::format("there is no {} '{}'", kind, name), other_kind(name, suggestion(name, all)));
    return false;
  }

  // Of a joint where a link is wanted, or the other way round; else the remedy as it is.
  std::string other_kind(const std::string& name, std::string remedy) const {
    if (const auto joint = joints_.find(name); joint != joints_.end())
      return fmt::format("'{}' is a joint; the link that it moves is '{}'", name,
                         robot_.links[static_cast<size_t>(robot_.joints[static_cast<size_t>(joint->second)].child)].name);
    if (const auto link = links_.find(name); link != links_.end())
      for (const ir::Joint& joint : robot_.joints)
        if (joint.child == link->second)
          return fmt::format("'{}' is a link; the joint that moves it is '{}'", name, joint.name);
    return remedy;
  }

  // A joint that exists, moves and is not cut.
  bool moving_joint(const std::string& key, const std::string& name) {
    if (!known(key, "joint", name, joints_)) return false;
    const ir::Joint& joint = robot_.joints[static_cast<size_t>(joints_.at(name))];
    if (joint.type == ir::JointType::fixed)
      error(locate(key, name), fmt::format("joint '{}' is fixed", name), "name a joint that moves, or remove it here");
    else if (is_cut(joint))
      error(locate(key, name), fmt::format("joint '{}' is cut off", name),
            "remove it here, or remove the link it belongs to from 'cut'");
    else return true;
    return false;
  }

  // … and is not locked either.
  bool free_joint(const std::string& key, const std::string& name) {
    if (!moving_joint(key, name)) return false;
    if (!scene_.locked.count(name)) return true;
    error(locate(key, name), fmt::format("joint '{}' is locked", name), "remove it here, or from 'locked'");
    return false;
  }

  void links_asked(const std::string& key, const std::vector<std::string>& links) {
    if (links.size() > most_links_asked)
      return error(key, fmt::format("there are {} links; no more than {} are supported", links.size(), most_links_asked),
                   "name fewer of them");
    for (const std::string& link : links) kept_link(key, link);
  }

  // jacobian_world of a link hand and jacobian of a link world_hand have one name.
  void names_differ() {
    std::set<std::string> names;
    for (const ir::LinkOutput& output : scene_.link_outputs())
      if (!names.insert(ir::name_of(output)).second)
        error("frames/" + output.link, fmt::format("two outputs would be called '{}'", ir::name_of(output)),
              "leave one of them out");
  }

  void functions() {
    if (scene_.functions.size() > most_functions)
      return error(
          "functions",
          fmt::format("there are {} functions; no more than {} are supported", scene_.functions.size(), most_functions),
          "name fewer of them");
    for (ir::NamedFunction& function : scene_.functions) of_frames(function);
    for (const ir::NamedFunction& function : scene_.functions)
      for (const ir::Quantity quantity : function.quantities)
        of_contacts("functions/" + function.name + part_of_entry + std::string(ir::name_of(quantity)), quantity);
    for (const auto& [function, taken] : taken_names(scene_))
      error("functions/" + function, fmt::format("the generated code has another '{}'", taken),
            fmt::format("call the function '{}' otherwise", function));
    for (const ir::NamedFunction& function : scene_.functions)
      if (scene_.rates_zero &&
          std::count(function.quantities.begin(), function.quantities.end(), ir::Quantity::coriolis_matrix))
        error("functions/" + function.name + part_of_entry + "coriolis_matrix",
              "coriolis_matrix is zero when rates_zero is set", "remove one of the two");
  }

  void plan() {
    std::vector<std::string> names;
    for (const ir::EmittedFunction& function : ir::functions_of(scene_)) names.push_back(function.name);
    for (const auto& [function, how] : scene_.plan)
      if (std::find(names.begin(), names.end(), function) == names.end())
        error("plan/" + function, fmt::format("the scene asks for no function '{}'", function), suggestion(function, names));
  }

  // What a function is asked of frames: their results by name, all of a frame by its name, or as `frames` says it.
  void of_frames(ir::NamedFunction& function) {
    const auto all = document_.of_frames.find(function.name);
    if (all == document_.of_frames.end()) return;
    std::set<std::string> names;
    for (const AskedOfFrame& asked : all->second) {
      const std::string entry = asked.output ? asked.output->link : asked.name;
      const std::string where = "functions/" + function.name + part_of_entry + entry;
      for (const ir::LinkOutput& output : asked.output ? std::vector{*asked.output} : explained(where, asked.name)) {
        kept_link(where, output.link);
        if (!names.insert(ir::name_of(output)).second)
          error(where, fmt::format("two outputs would be called '{}_{}'", function.name, ir::name_of(output)),
                "leave one of them out");
        function.of_links.push_back(output);
      }
    }
    if (function.quantities.empty() && function.of_links.empty() && errors_.empty())
      error("functions/" + function.name, fmt::format("function '{}' computes nothing", function.name),
            "name at least one quantity, such as mass_matrix");
    if (function.of_links.size() > most_links_asked)
      error("functions/" + function.name,
            fmt::format("there are {} results of links; no more than {} are supported", function.of_links.size(),
                        most_links_asked),
            "name fewer of them");
  }

  // A name in a function: what `frames` calls so, or else what it has to be: jacobian_world_hand is the jacobian_world of a
  // hand, or the jacobian of a link world_hand. A link's name alone is all that `frames` asks of it, or what it asks by
  // default. A link is called by its name or as an identifier.
  std::vector<ir::LinkOutput> explained(const std::string& where, const std::string& name) {
    const auto is = [](const std::string& link, std::string_view called) {
      return called == link || called == ir::identifier(link);
    };
    for (const ir::LinkOutput& output : scene_.link_outputs())
      if (ir::name_of(output) == ir::identifier(name)) return {{output.quantity, output.link}};
    std::vector<ir::LinkOutput> of_links;
    for (const ir::LinkQuantityRow& row : ir::link_quantities()) {
      const std::string prefix = std::string(row.name) + "_";
      if (!name.starts_with(prefix)) continue;
      for (const std::string& link : in_order_)
        if (is(link, std::string_view(name).substr(prefix.size()))) of_links.push_back({row.quantity, link});
    }
    if (of_links.size() > 1)
      error(where, fmt::format("'{}' is two things: {}, and {}", name, ir::help_of(of_links[0]), ir::help_of(of_links[1])),
            "ask for one of them in `frames`: the function takes that");
    if (!of_links.empty()) return {of_links.front()};
    for (const std::string& link : in_order_) {
      if (!is(link, name)) continue;
      std::vector<ir::LinkOutput> outputs;
      for (const ir::LinkOutput& output : scene_.link_outputs())
        if (output.link == link) outputs.push_back(output);
      if (!outputs.empty()) return outputs;
      for (const ir::LinkQuantityRow& row : ir::link_quantities())
        if (row.by_default) outputs.push_back({row.quantity, link});
      return outputs;
    }
    // Of no link: the longest quantity was meant.
    const ir::LinkQuantityRow* meant = nullptr;
    for (const ir::LinkQuantityRow& row : ir::link_quantities())
      if (const std::string prefix = std::string(row.name) + "_"; name.starts_with(prefix) && name != prefix)
        if (!meant || std::string_view(meant->name).size() < prefix.size()) meant = &row;
    if (meant) return {{meant->quantity, name.substr(std::string_view(meant->name).size() + 1)}};
    std::vector<std::string> known;
    for (const ir::QuantityRow& row : ir::quantities()) known.emplace_back(row.name);
    for (const ir::LinkQuantityRow& row : ir::link_quantities()) known.push_back(std::string(row.name) + "_LINK");
    for (const ir::Frame& frame : scene_.placed) known.push_back(frame.name);
    std::vector<std::string> also = ir::names_of(ir::quantity_aliases());
    for (const std::string& link : in_order_)
      for (const ir::LinkQuantityRow& row : ir::link_quantities())
        also.push_back(std::string(row.name) + "_" + ir::identifier(link));
    error(where, fmt::format("the quantity '{}' is unknown", name), suggestion(name, known, also));
    return {};
  }

  // Frames of the user's own, those that stand in functions among them.
  void placed() {
    scene_.placed.insert(scene_.placed.end(), document_.placed_by_functions.begin(), document_.placed_by_functions.end());
    for (const ir::Link& link : robot_.links) in_order_.push_back(link.name);
    if (scene_.placed.size() > most_links_asked)
      return error("frames",
                   fmt::format("there are {} frames; no more than {} are supported", scene_.placed.size(), most_links_asked),
                   "name fewer of them");
    std::map<std::string, std::string> names;  // as identifiers
    for (const ir::Link& link : robot_.links) names.emplace(ir::identifier(link.name), "link '" + link.name + "'");
    for (const ir::Frame& frame : scene_.placed) {
      const std::string key = place_of(frame);
      const std::string link = key + part_of_entry + "link";
      if (const auto other = names.find(ir::identifier(frame.name)); other != names.end())
        error(key, fmt::format("frame '{}' is called as {} is", frame.name, other->second),
              links_.contains(frame.name)
                  ? fmt::format("give it a name of its own: {{my_frame: {{link: {}, ...}}}}", frame.link)
                  : "call one of them otherwise; what stands under frames, functions may name");
      else names.emplace(ir::identifier(frame.name), "frame '" + frame.name + "'");
      if (frame.link == frame.name && !links_.contains(frame.link))
        error(key, fmt::format("frame '{}' does not say which link it is on", frame.name), "write link: left_foot");
      else if (const auto other = frames_.find(frame.link); other != frames_.end())
        error(document_.places.count(link) ? link : key, fmt::format("'{}' is a frame, and frames are on links", frame.link),
              fmt::format("write link: {}, and where on it", robot_.links[static_cast<size_t>(other->second)].name));
      else kept_link(document_.places.count(link) ? link : key, frame.link);
      const auto on = links_.find(frame.link);
      frames_.emplace(frame.name, on == links_.end() ? robot_.root : on->second);
      in_order_.push_back(frame.name);
    }
  }
  std::string place_of(const ir::Frame& frame) const {
    if (document_.places.count("frames/" + frame.name)) return "frames/" + frame.name;
    for (const ir::NamedFunction& function : scene_.functions)
      if (const std::string key = "functions/" + function.name + part_of_entry + frame.name; document_.places.count(key))
        return key;
    return "frames";
  }

  void kept_link(const std::string& key, const std::string& name) {
    if (frames_.contains(name)) return;  // its link has been looked at
    if (!links_.contains(name)) {
      std::map<std::string, int> places(links_.begin(), links_.end());
      places.insert(frames_.begin(), frames_.end());
      known(key, "link", name, places);
    } else if (is_cut_[static_cast<size_t>(links_.at(name))]) {
      error(locate(key, name), fmt::format("link '{}' is cut off", name),
            "remove it here, or remove the link it hangs on from 'cut'");
    }
  }

  bool is_cut(const ir::Joint& joint) const { return is_cut_[static_cast<size_t>(joint.child)]; }
  bool moves(const ir::Joint& joint) const {
    return joint.type != ir::JointType::fixed && !is_cut(joint) && !scene_.locked.count(joint.name);
  }

  // The place of an entry of a key; a key with a '/' is a place already.
  static std::string locate(const std::string& key, const std::string& name) {
    return key.find('/') == key.npos ? key + "/" + name : key;
  }

  Place place_of(const std::string& where) const {
    constexpr std::string_view of_mimic = "mimic/";
    if (document_.urdf_mimic && where.starts_with(of_mimic)) {
      const std::string name = where.substr(of_mimic.size(), where.find(part_of_entry) - of_mimic.size());
      return {robot_.file,
              fmt::format("joint '{}' (line {})", name, robot_.joints[static_cast<size_t>(joints_.at(name))].line)};
    }
    auto found = document_.places.find(where);
    if (found == document_.places.end()) found = document_.places.find(where.substr(0, where.find('/')));
    if (found != document_.places.end()) return found->second;
    return {robot_.file, ""};  // neither written in the scene nor on the command line: the URDF's
  }

  void error(const std::string& where, std::string message, std::string remedy) {
    const Place place = place_of(where);
    add_error(errors_, {Severity::error, place.file, place.element, std::move(message), std::move(remedy)});
  }

  // Of "urdf" where there is nothing in the URDF to be taken.
  void warn_of_nothing_in_urdf(const std::string& key) {
    const Place place = place_of(key);
    warnings_.push_back({Severity::warning, place.file, place.element,
                         fmt::format("no joint that moves has a {} in the URDF", key),
                         "remove the key, or write in the scene what is meant"});
  }

  void warn_of_mimic() {
    if (document_.urdf_mimic && scene_.mimic.empty()) warn_of_nothing_in_urdf("mimic");
    std::vector<std::string> still, joints;
    for (const ir::Joint& joint : robot_.joints)
      if (document_.urdf_mimic && joint.mimic && joint.type == ir::JointType::fixed && !is_cut(joint))
        still.push_back("'" + joint.name + "'");
    if (!still.empty())
      warnings_.push_back({Severity::warning, robot_.file, named(still), "a fixed joint follows no other: <mimic> is left out",
                           "remove it there, or give the joint another type"});
    for (const ir::Joint& joint : robot_.joints)
      if (joint.mimic && moves(joint) && !scene_.mimic.count(joint.name)) joints.push_back("'" + joint.name + "'");
    if (!joints.empty())
      warnings_.push_back({Severity::warning, robot_.file, named(joints),
                           joints.size() > 1 ? "their <mimic> is left out: they are joints of their own"
                                             : "its <mimic> is left out: it is a joint of its own",
                           "ask for it with mimic: urdf in the scene"});
  }

  static std::string named(const std::vector<std::string>& joints) {
    return fmt::format("joint{} {}", joints.size() > 1 ? "s" : "", fmt::join(joints, ", "));
  }

  // Of joints whose loss in the URDF is neither taken nor given another value. An empty `damping: {}` says that none is wanted.
  void warn_of_losses(const char* kind, bool asked, const std::map<std::string, double>& values, double ir::Joint::*value) {
    if (asked) {
      if (std::none_of(robot_.joints.begin(), robot_.joints.end(),
                       [&](const ir::Joint& joint) { return joint.*value != 0 && moves(joint); }))
        warn_of_nothing_in_urdf(kind);
      return;
    }
    if (values.empty() && document_.given.count(kind)) return;
    std::vector<std::string> joints;
    for (const ir::Joint& joint : robot_.joints)
      if (joint.*value != 0 && moves(joint) && !values.count(joint.name)) joints.push_back("'" + joint.name + "'");
    if (!joints.empty())
      warnings_.push_back({Severity::warning, robot_.file, named(joints), fmt::format("<dynamics {}> is left out", kind),
                           values.empty() ? fmt::format("ask for it with {}: urdf in the scene", kind)
                                          : fmt::format("name them under {} too, with 0 where none is meant", kind)});
  }

  const SceneDocument& document_;
  const ir::RobotDescription& robot_;
  Diagnostics& warnings_;
  ir::Scene scene_;
  std::unordered_map<std::string, int> links_, joints_;
  std::map<std::string, int> frames_;  // of the user's own → the link they are on
  std::vector<std::string> in_order_;  // links, then frames
  std::vector<bool> is_cut_;           // per link
  Diagnostics errors_;
};

}  // namespace

ir::Base default_base(const ir::RobotDescription& robot) {
  if (robot.floating_root) return ir::Base::floating;
  if (robot.links[static_cast<size_t>(robot.root)].name == "world") return ir::Base::fixed;
  std::vector<int> welded{robot.root};
  for (size_t i = 0; i < welded.size(); ++i) {
    const size_t link = static_cast<size_t>(welded[i]);
    if (robot.links[link].inertia) return ir::Base::floating;
    for (int j : robot.children[link])
      if (const ir::Joint& joint = robot.joints[static_cast<size_t>(j)]; joint.type == ir::JointType::fixed)
        welded.push_back(joint.child);
  }
  return ir::Base::fixed;
}

ir::Scene check_scene(const SceneDocument& document, const ir::RobotDescription& robot, Diagnostics& warnings) {
  return SceneCheck(document, robot, warnings).run();
}

}  // namespace dalembert::frontend
