// Where a link is held by the world: rows that its motion keeps to, one per direction.
#pragma once

#include <Eigen/Core>
#include <string>

namespace dalembert::ir {

enum class ContactType { weld, point };  // all six directions, or the point's three

// Rows: the velocity of the point along the axes, then, of a weld, the angular velocity along them.
struct Contact {
  std::string name;
  std::string link;
  ContactType type = ContactType::weld;
  Eigen::Vector3d at = Eigen::Vector3d::Zero();  // the point in the link's frame, m
  bool along_link = false;                       // the axes are the link's; else the world's

  int rows() const { return type == ContactType::weld ? 6 : 3; }
  bool operator==(const Contact&) const = default;
};

// What a contact is given at run time, as components of an input; behind them regularization and weight of each row. A loop
// has no anchor.
inline constexpr int contact_active = -1, contact_kp = 0, contact_kd = 1, contact_restitution = 2;
inline constexpr int contact_anchor = 3;  // position, quaternion x y z w
inline constexpr int contact_rows = 10, loop_rows = 3;

// More rows than any robot stands on; what is solved for takes the cube of them.
inline constexpr int most_constraint_rows = 96;

}  // namespace dalembert::ir
