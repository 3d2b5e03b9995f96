// How constraints act, told to a workspace of compiled code through its C functions.
#pragma once

#include <vector>

#include "commands/compiler.hpp"
#include "ir/acting.hpp"
#include "pipeline.hpp"

namespace dalembert {

class ActingSetters {
 public:
  ActingSetters() = default;
  ActingSetters(const Model& model, const LoadedCode& code);

  // Whatever the workspace was told before.
  template <class Scalar>
  void set(const ir::Acting& acting, void* workspace) const;

 private:
  struct Constraint {
    void *set, *weigh;  // NAME_set_… and NAME_weigh_… of c_api.h
    bool loop;
    int rows;
  };
  std::vector<Constraint> constraints_;
};

}  // namespace dalembert
