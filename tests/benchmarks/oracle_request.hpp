// The robot as the tests' oracles, MuJoCo and DART, are asked for it.
#pragma once

#include "benchmark_robot.hpp"
#include "oracle.hpp"

namespace dalembert::benchmarks {

inline oracle::Request request_for(const BenchmarkRobot& robot) {
  oracle::Request request{
      robot.urdf(), robot.tree().base_coordinates() > 0 ? oracle::Base::floating : oracle::Base::fixed, {}, robot.gravity()};
  for (const ir::Body& body : robot.tree().bodies) request.joints.push_back(body.joint);
  return request;
}

}  // namespace dalembert::benchmarks
