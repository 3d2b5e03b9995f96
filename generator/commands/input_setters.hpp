// How constraints act and what the robot carries, told to a workspace of compiled code through its C functions.
#pragma once

#include <vector>

#include "commands/compiler.hpp"
#include "ir/acting.hpp"
#include "ir/loading.hpp"
#include "pipeline.hpp"

namespace dalembert {

class InputSetters {
 public:
  InputSetters() = default;
  InputSetters(const Model& model, const LoadedCode& code);

  // Whatever the workspace was told before.
  template <class Scalar>
  void set(const ir::Acting& acting, const ir::Loading& loading, void* workspace) const;

 private:
  struct Constraint {
    void *set, *weigh;  // NAME_set_… and NAME_weigh_… of c_api.h
    bool loop;
    int rows;
  };
  template <class Scalar>
  void set(const ir::Acting& acting, void* workspace) const;
  template <class Scalar>
  void set(const ir::Loading& loading, void* workspace) const;

  std::vector<Constraint> constraints_;
  std::vector<void*> payloads_;  // NAME_set_payload_…
  void* gravity_ = nullptr;      // NAME_set_gravity, where there is one
  Eigen::Vector3d own_gravity_ = Eigen::Vector3d::Zero();
};

}  // namespace dalembert
