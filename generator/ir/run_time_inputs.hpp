// What a scene has given at run time: members of the workspace. One table of them for declarations, batches, interfaces,
// self-tests and programs that load a robot.
#pragma once

#include <string>
#include <vector>

#include "ir/contact.hpp"
#include "ir/graph.hpp"
#include "ir/scene.hpp"

namespace dalembert::ir {

struct RunTimeInput {
  // A number or an array of numbers, as an expression behind the workspace: payload_hand.mass, wrench_tip.
  struct Member {
    std::string name;
    int size = 0;       // of an array; 0: it is a number
    bool flag = false;  // true or false, in programs 1 or 0
    int count() const { return size > 0 ? size : 1; }
  };

  InputKind kind;  // in programs, with the index there
  int index;
  std::string name;       // of the workspace's member
  std::string type;       // of a member that is a structure: Payload, Contact, Loop; empty: it is an array
  std::string each{};     // member of a batch that has one for each state
  std::string meaning{};  // beside the declaration, with unit and axes
  std::string unit{}, help{};
  std::vector<Member> members{};  // in order
  std::vector<double> start{};    // what a new workspace has

  int size() const { return static_cast<int>(start.size()); }
  // The number that a program knows by this component, and which of all in order it is; "" where there is none.
  std::string element(int component) const { return number(number_of(component)); }
  std::string number(int i) const;
  int number_of(int component) const { return kind == InputKind::constraint ? component - contact_active : component; }
};

// In the order in which batches and programs that load a robot have them: gravity, payloads, wrenches, contacts, loops.
std::vector<RunTimeInput> run_time_inputs(const Scene& scene);

// The input of a program.
RunTimeInput run_time_input(const Scene& scene, const Input& input);

}  // namespace dalembert::ir
