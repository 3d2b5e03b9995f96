// Kernels of the runtime as an algorithm has them: what is done with whole matrices, and with rows of constraints, once their
// elements are there (ir/kernels.def).
#pragma once

#include <array>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

#include "ir/constraint_paths.hpp"
#include "ir/graph.hpp"

namespace dalembert::ir {

struct KinematicTree;

enum class Operand {
#define DALEMBERT_OPERAND(name, meaning) name,
#include "ir/kernels.def"
#undef DALEMBERT_OPERAND
#undef DALEMBERT_KERNEL
  count
};

struct Kernel {
  enum class Kind {
#define DALEMBERT_KERNEL(kind, header, status, calls, more, meaning) kind,
#include "ir/kernels.def"
#undef DALEMBERT_OPERAND
#undef DALEMBERT_KERNEL
  };
  Kind kind;
  int first = 0;  // negative_product, derive: efforts' columns before this one are zero, and so far to's
  // Of constraints.
  ConstraintPaths paths{};
  int solutions = 2;  // proximal steps, and as dalembert/constraint_shapes.hpp has them:
  double mu = 0, unmoved = 0;
  double least = 0, largest = 0, smallest = 0;  // support
  bool of_forces = false;                       // respond: whether derivatives of forces are asked for, here or later
  int turning_rows = 0;                         // derive
  std::vector<int> undriven{};                  // support: the coordinates u, of which the first are the base's
  int base_undriven = 0;                        // how many

  explicit Kernel(Kind k, std::initializer_list<std::pair<Operand, int>> operands = {}) : kind(k) {
    arrays_.fill(-1);
    for (const auto& [operand, array] : operands) (*this)[operand] = array;
  }

  // The array; -1: nobody asks for it, or the kernel has none.
  int operator[](Operand operand) const { return arrays_[static_cast<std::size_t>(operand)]; }
  int& operator[](Operand operand) { return arrays_[static_cast<std::size_t>(operand)]; }

  // Whether it has to do with rows of constraints; whether these go up limbs body by body, by articulated bodies; whether as
  // wrenches on the base.
  bool of_constraints() const { return kind >= Kind::delassus; }
  bool by_limbs() const;
  bool by_wrenches() const { return kind == Kind::support_by_wrenches || kind == Kind::support_at_points; }

  // Arrays that it reads, and that it fills; rooms that nothing else reads are neither. All that it has to do with.
  std::vector<int> read() const;
  std::vector<int> filled() const;
  std::vector<int> touched() const;

 private:
  std::array<int, static_cast<std::size_t>(Operand::count)> arrays_{};
};

struct KernelRow {
  const char *name, *header, *status, *meaning;
};
const KernelRow& row_of(Kernel::Kind kind);
// The members of workspaces in which kernels tell how they fared, each once.
std::vector<std::string> kernel_statuses();
struct OperandRow {
  const char *name, *meaning;
};
const OperandRow& row_of(Operand operand);

// A call as its row has it, of those that the kernel makes.
struct KernelCall {
  std::string text;
  bool each_chain = false;
};
std::vector<KernelCall> calls_of(const Kernel& kernel);

// What stands in braces in a call: an operand, or a name that is none.
struct KernelArgument {
  enum class Access { same, read, filled, changed, room, may_be_null };
  std::string name;
  Operand operand = Operand::count;
  Access access = Access::same;
  bool may_be_absent = false;
};
KernelArgument kernel_argument(const std::string& text);

// Padding left out, or with it, as the code executes it; in_loops: where loops over branches have left what it reads.
Operations operations_of(const Kernel& kernel, const KinematicTree& tree, bool executed, bool in_loops = false);

}  // namespace dalembert::ir
