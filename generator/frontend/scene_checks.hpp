// Checks of a scene against its robot, and what is made of it: check_scene().
#pragma once

#include <map>
#include <string>
#include <unordered_map>
#include <vector>

#include "diagnostics.hpp"
#include "frontend/scene_reader.hpp"
#include "ir/robot_description.hpp"
#include "ir/scene.hpp"

namespace dalembert::frontend {

class SceneCheck {
 public:
  SceneCheck(const SceneDocument& document, const ir::RobotDescription& robot, Diagnostics& warnings);

  // The scene, complete. Throws InputError with all that is wrong. Once.
  ir::Scene run();

 private:
  // What is computed: scene_check_outputs.cpp.
  void outputs();
  // A quantity of constraints is none where there are none.
  void of_contacts(const std::string& key, ir::Quantity quantity);
  // The joints and links whose rows and columns are asked for.
  void parts();
  void of_part(const std::string& where, const ir::Part& part);
  // jacobian_world of a link hand and jacobian of a link world_hand have one name.
  void names_differ();
  void functions();
  void plan();
  // What a function is asked of frames: their results by name, all of a frame by its name, or as `frames` says it.
  void of_frames(ir::NamedFunction& function);
  // A name in a function: what `frames` calls so, or else what it has to be: jacobian_world_hand is the jacobian_world of a
  // hand, or the jacobian of a link world_hand. A link's name alone is all that `frames` asks of it, or what it asks by
  // default. A link is called by its name or as an identifier.
  std::vector<ir::LinkOutput> explained(const std::string& where, const std::string& name);
  // Steps of whole motions, dampers and springs of the joints at their ends.
  void rollouts();

  // What links carry and are held by, and frames on them: scene_check_links.cpp.
  void cut();
  // Frames of the user's own, those that stand in functions among them.
  void placed();
  std::string place_of(const ir::Frame& frame) const;
  void links_asked(const std::string& key, const std::vector<std::string>& links);
  void wrenches();
  void contacts();
  // What is not worked out beside loops that are embedded.
  void embedded();

  // What joints are: scene_check_joints.cpp.
  void kinds();
  // Of those of several coordinates only where they are zero.
  void locked();
  void mimic();
  // Who follows a follower follows whom that one follows: q_a = m_a (m_b q_c + o_b) + o_a. Each chain is walked once, up to
  // what has been composed before.
  void compose_mimic();
  // Whether the URDF's <mimic> of a joint that moves has numbers, and names another that moves.
  bool sound_in_urdf(const std::string& name, const ir::Mimic& relation);
  // A driven joint's spring would not be at rest where its driver's is.
  void stiffness();
  void elastic();
  // What <dynamics> says of joints that move, asked for by the scene.
  void urdf_values(const char* kind, double ir::Joint::*value);

  // What is taken or left out without a word of the scene: scene_check_notices.cpp.
  // Others weld a URDF's root to the world (Pinocchio, MuJoCo) or let it float (Drake, DART).
  void say_what_base_is_taken();
  // A file's loops are the scene's, where the scene says nothing of loops.
  void say_what_loops_are_taken();
  // A rod has a ball at each end.
  void warn_of_turned_rods();
  void warn_of_mimic();
  // Of joints whose loss in the URDF is neither taken nor given another value. An empty `damping: {}` says that none is wanted.
  void warn_of_losses(const char* kind, bool asked, const std::map<std::string, double>& values, double ir::Joint::*value);
  // Of "urdf" where there is nothing in the URDF to be taken.
  void warn_of_nothing_in_urdf(const std::string& key);

  // Names looked up, and refused with their places: scene_check.cpp.
  // A joint that exists, moves and is not cut.
  bool moving_joint(const std::string& key, const std::string& name);
  // … and is not locked either.
  bool free_joint(const std::string& key, const std::string& name);
  ir::JointType type_of(const std::string& name) const;
  // A relation or spring is of one coordinate.
  bool of_one_coordinate(const std::string& key, const std::string& name);
  void kept_link(const std::string& key, const std::string& name);
  // A name among names.
  bool known(const std::string& key, const char* kind, const std::string& name,
             const std::unordered_map<std::string, int>& names);
  // Of a joint where a link is wanted, or the other way round; else the remedy as it is.
  std::string other_kind(const std::string& name, std::string remedy) const;
  Place place_of(const std::string& where) const;
  void error(const std::string& where, std::string message, std::string remedy);
  int coordinates_of(const std::string& name) const { return ir::coordinates_of(type_of(name)); }
  bool is_cut(const ir::Joint& joint) const { return is_cut_[static_cast<size_t>(joint.child)]; }
  bool moves(const ir::Joint& joint) const {
    return joint.type != ir::JointType::fixed && !is_cut(joint) && !scene_.locked.count(joint.name);
  }
  // The place of an entry of a key; a key with a '/' is a place already.
  static std::string locate(const std::string& key, const std::string& name) {
    return key.find('/') == key.npos ? key + "/" + name : key;
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

}  // namespace dalembert::frontend
