// A frame of the user's own, fixed to a link: wherever the name of a link stands, this one may.
#pragma once

#include <Eigen/Geometry>
#include <string>

#include "ir/rotation.hpp"

namespace dalembert::ir {

struct Frame {
  std::string name;
  std::string link;
  Eigen::Vector3d xyz = Eigen::Vector3d::Zero();  // its origin in the link's frame, m
  Eigen::Vector3d rpy = Eigen::Vector3d::Zero();  // roll, pitch, yaw as in a URDF's <origin>, rad
  bool operator==(const Frame&) const = default;

  Eigen::Isometry3d in_link() const {
    Eigen::Isometry3d placement = Eigen::Isometry3d::Identity();
    placement.translation() = xyz;
    placement.linear() = without_rounding_dust(rotation_from_rpy(rpy));
    return placement;
  }
};

}  // namespace dalembert::ir
