// The keys of the scene, a function each.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "frontend/scene_values.hpp"

namespace dalembert::frontend {

class SceneKeys : public SceneValues {
 public:
  using SceneValues::SceneValues;

  struct Key {
    const char* name;
    void (SceneKeys::*read)(const YamlNode&);
  };
  // In the order in which they are documented.
  static const std::vector<Key>& keys();

  // Throws InputError, with a remedy, where the key or its value is unknown.
  void read(const std::string& key, const YamlNode& name, const YamlNode& value);

 private:
  // How all is computed, and under what gravity: scene_keys.cpp.
  void base(const YamlNode& node);
  // [x, y, z], none, run_time, or {run_time: [x, y, z]}
  void gravity(const YamlNode& node);
  void coriolis(const YamlNode& node);
  void forward_dynamics(const YamlNode& node);
  void massless(const YamlNode& node);
  void inertia(const YamlNode& node);
  void rates_zero(const YamlNode& node);
  void scalar(const YamlNode& node);
  void parallel(const YamlNode& node);
  // {function: {form: straight, solver: factorization, order: as_written}, ...}
  void plan(const YamlNode& node);
  void batch(const YamlNode& node);
  // [linearly_implicit], [impacts]
  void rollouts(const YamlNode& node);

  // What is computed: scene_keys_outputs.cpp.
  // [quantity, {quantity: part}, ...]
  void outputs(const YamlNode& node);
  // {joints: [name or pattern, ...], subtree: link, base: true, links: [link, ...]}, of the result `name`.
  ir::Part part_of(const std::string& name, const ir::Parts& has, const YamlNode& node) const;
  // {name: [quantity, ..., frame, {what `frames` takes}], ...}
  void functions(const YamlNode& node);
  // Whether an item of a function is {quantity: part}, and not of frames.
  bool takes_parts(const YamlNode& item, ir::NamedFunction& function);
  // What the last quantity takes besides q and v is what those before it take, if anything.
  void takes_one_input(const YamlNode& item, const ir::NamedFunction& function) const;
  void jacobians(const YamlNode& node);
  // [link, ...] for what is given by default, or a map
  void frames(const YamlNode& node);
  // {link: [quantity, ...], name: {link: link, at: [x, y, z, roll, pitch, yaw], outputs: [quantity, ...]}, ...}; `function`: in
  // which it stands, if any.
  void frame_map(const YamlNode& node, const std::string& function, std::vector<ir::LinkOutput>& outputs,
                 std::vector<ir::Frame>& placed);
  void of_frame(const std::string& frame, const YamlEntry& entry, const YamlNode& asked, const std::string& inside,
                std::vector<ir::LinkOutput>& outputs);

  // What links carry and are held by: scene_keys_links.cpp.
  // The link that a frame or a contact is on.
  std::string link_of(const char* kind, const std::string& name, const YamlNode& node) const;
  // [x, y, z], or, where it turns, [x, y, z, roll, pitch, yaw].
  void place_on_link(const YamlNode& node, Eigen::Vector3d& xyz, Eigen::Vector3d* rpy) const;
  void payloads(const YamlNode& node);
  // [link, …], or {link: link | world, …}
  void wrenches(const YamlNode& node);
  // {link: weld | point, ...}, or {name: {link: link, type: weld, at: [x, y, z], axes: world | link}, ...}
  void contacts(const YamlNode& node);
  void part_of_contact(ir::Contact& contact, const YamlEntry& part);
  // {name: {links: [a, b], at: [pose, pose], type: hinge}, ...}
  void loops(const YamlNode& node);
  void part_of_loop(ir::Loop& loop, const YamlEntry& part);
  Eigen::Isometry3d pose(const YamlNode& node) const;

  // What joints are: scene_keys_joints.cpp.
  // {joint: value, ...}, or [joint, ...] for zero
  void locked(const YamlNode& node);
  void cut(const YamlNode& node);
  // {joint: planar | {helical: pitch} | {universal: [x, y, z]}, ...}
  void joints(const YamlNode& node);
  // {joint: {of: joint, multiplier: 1, offset: 0}, ...} or urdf
  void mimic(const YamlNode& node);
  std::string driver(const std::string& joint, const YamlNode& node) const;
  void passive(const YamlNode& node);
  void armature(const YamlNode& node);
  void damping(const YamlNode& node);
  void friction(const YamlNode& node);
  // {joint: {k: value, rest: 0}, ...}, or k alone
  void stiffness(const YamlNode& node);
  // {joint: {k: value, inertia: value, damping: 0}, ...}
  void elastic(const YamlNode& node);
  std::map<std::string, const YamlNode*> parts_of_spring(const std::string& joint, const YamlEntry& entry,
                                                         const std::vector<std::string>& known,
                                                         const std::vector<std::string>& needed, const std::string& remedy);
};

}  // namespace dalembert::frontend
