// A generated robot behind one interface, so that one test can loop over all of them.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <dalembert/self_test.hpp>
#include <map>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

namespace dalembert::testing {

// Two ways to evaluate, each with a workspace of its own.
enum class Variant { serial, tasks };

// By the names of ir/quantities.def: those that were generated.
using Results = std::map<std::string, Eigen::MatrixXd>;

class GeneratedRobot {
 public:
  virtual ~GeneratedRobot() = default;

  virtual int nq() const = 0;
  virtual int nv() const = 0;
  virtual bool single_precision() const = 0;
  virtual bool has_tasks() const = 0;  // else there is the serial variant alone
  virtual std::vector<std::string> joint_names() const = 0;
  virtual std::vector<std::string> body_names() const = 0;

  // Rounds to the robot's scalar.
  virtual void set_state(const Eigen::VectorXd& q, const Eigen::VectorXd& v) = 0;
  // Nothing but the generated function: what it allocates is seen.
  virtual void evaluate(Variant variant) = 0;
  // A new workspace for each variant.
  virtual void renew_workspaces() = 0;

  // The emitted self-test.
  virtual bool self_test(SelfTestReport& report) const = 0;

  virtual Results results(Variant variant) const = 0;
  // All results as they lie in memory.
  virtual std::vector<std::byte> bits(Variant variant) const = 0;
};

// One row of the table that CMake writes: a robot in one scene.
struct GeneratedCase {
  const char* name;
  const char* urdf;
  std::vector<std::pair<const char*, const char*>> settings;  // scene keys and values, as on the command line
  std::unique_ptr<GeneratedRobot> (*make)();
};
inline void PrintTo(const GeneratedCase& generated, std::ostream* out) { *out << generated.name; }

const std::vector<GeneratedCase>& generated_cases();

}  // namespace dalembert::testing
