// Where two links are held by each other: rows that the motion of the second against the first keeps to.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <string>
#include <vector>

namespace dalembert::ir {

// What a loop holds, by the axes of its frame on the first link; z is the axis that a joint of that kind turns about or slides
// along.
enum class LoopType {
  point,     // the point: x y z
  weld,      // all six
  hinge,     // the point, and turning about x y
  cylinder,  // the point along x y, and turning about x y
  planar,    // the point along z, and turning about x y
  pin,       // the point along x y, of linkages that are planar anyway
  distance,  // between the two points
};

// Rows: the velocity of the second link's point against the first link there, along axes of the frame on the first; then the
// angular velocity along them.
struct Loop {
  std::string name;
  std::array<std::string, 2> links;
  std::array<Eigen::Isometry3d, 2> at{Eigen::Isometry3d::Identity(), Eigen::Isometry3d::Identity()};  // on each, in its frame
  LoopType type = LoopType::point;
  std::optional<double> length{};  // of a distance, m; else what it is where all joints are at zero
  std::vector<std::string>
      independent{};  // joints that others between the links follow: the loop is embedded; else it has rows

  // Numbers of axes, and 0 of a distance.
  std::vector<int> linear_axes() const {
    switch (type) {
      case LoopType::point:
      case LoopType::weld:
      case LoopType::hinge: return {0, 1, 2};
      case LoopType::cylinder:
      case LoopType::pin: return {0, 1};
      case LoopType::planar: return {2};
      case LoopType::distance: return {0};
    }
    return {};
  }
  std::vector<int> angular_axes() const {
    switch (type) {
      case LoopType::weld: return {0, 1, 2};
      case LoopType::hinge:
      case LoopType::cylinder:
      case LoopType::planar: return {0, 1};
      case LoopType::point:
      case LoopType::pin:
      case LoopType::distance: return {};
    }
    return {};
  }
  int linear_rows() const { return static_cast<int>(linear_axes().size()); }
  int rows() const { return linear_rows() + static_cast<int>(angular_axes().size()); }
};

}  // namespace dalembert::ir
