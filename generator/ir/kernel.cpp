#include "ir/kernel.hpp"

#include <algorithm>
#include <iterator>
#include <sstream>

namespace dalembert::ir {

namespace {

struct WholeRow {
  KernelRow row;
  const char *calls, *more;
};
constexpr WholeRow rows[] = {
#define DALEMBERT_KERNEL(kind, header, status, calls, more, meaning) {{#kind, header, status, meaning}, calls, more},
#include "ir/kernels.def"
#undef DALEMBERT_OPERAND
#undef DALEMBERT_KERNEL
};
constexpr OperandRow operands[] = {
#define DALEMBERT_OPERAND(name, meaning) {#name, meaning},
#include "ir/kernels.def"
#undef DALEMBERT_OPERAND
#undef DALEMBERT_KERNEL
};

const WholeRow& whole_row(Kernel::Kind kind) { return rows[static_cast<std::size_t>(kind)]; }

Operand operand_called(const std::string& name) {
  const auto at = std::find_if(std::begin(operands), std::end(operands), [&](const OperandRow& o) { return name == o.name; });
  return static_cast<Operand>(at - std::begin(operands));
}

using Access = KernelArgument::Access;

// Arrays of the operands that are used in one of the ways.
std::vector<int> arrays_with(const Kernel& kernel, std::initializer_list<Access> ways, bool more) {
  std::vector<int> arrays;
  const auto add = [&](int array) {
    if (array >= 0 && std::find(arrays.begin(), arrays.end(), array) == arrays.end()) arrays.push_back(array);
  };
  for (const KernelCall& call : calls_of(kernel))
    for (std::size_t at = call.text.find('{'); at != std::string::npos; at = call.text.find('{', at + 1)) {
      const KernelArgument argument = kernel_argument(call.text.substr(at + 1, call.text.find('}', at) - at - 1));
      if (argument.operand != Operand::count && std::find(ways.begin(), ways.end(), argument.access) != ways.end())
        add(kernel[argument.operand]);
    }
  if (more) {
    std::istringstream names(whole_row(kernel.kind).more);
    for (std::string name; names >> name;) add(kernel[operand_called(name)]);
  }
  return arrays;
}

}  // namespace

const KernelRow& row_of(Kernel::Kind kind) { return whole_row(kind).row; }
std::vector<std::string> kernel_statuses() {
  std::vector<std::string> all;
  for (const WholeRow& whole : rows)
    if (*whole.row.status != 0 && std::find(all.begin(), all.end(), whole.row.status) == all.end())
      all.push_back(whole.row.status);
  return all;
}
const OperandRow& row_of(Operand operand) { return operands[static_cast<std::size_t>(operand)]; }

KernelArgument kernel_argument(const std::string& text) {
  KernelArgument argument;
  argument.may_be_absent = text.starts_with(", ");
  argument.name = argument.may_be_absent ? text.substr(2) : text;
  constexpr std::pair<char, Access> marks[] = {
      {'<', Access::read}, {'>', Access::filled}, {'+', Access::changed}, {'~', Access::room}, {'?', Access::may_be_null}};
  for (const auto& [mark, access] : marks)
    if (argument.name.starts_with(mark)) {
      argument.access = access;
      argument.name.erase(0, 1);
      break;
    }
  argument.operand = operand_called(argument.name);
  return argument;
}

std::vector<KernelCall> calls_of(const Kernel& kernel) {
  std::vector<KernelCall> calls;
  std::istringstream all(whole_row(kernel.kind).calls);
  for (std::string text; std::getline(all, text, ';');) {
    KernelCall call{text};
    if (text.starts_with('[')) {
      const std::size_t end = text.find(']');
      const std::string condition = text.substr(1, end - 1);
      call = {text.substr(end + 1), condition == "each chain"};
      if (!call.each_chain && kernel[operand_called(condition)] < 0) continue;
    }
    calls.push_back(std::move(call));
  }
  return calls;
}

bool Kernel::by_limbs() const {
  return kind == Kind::delassus_by_limbs || kind == Kind::solve_constrained_by_limbs || kind == Kind::impact_by_limbs;
}

std::vector<int> Kernel::read() const { return arrays_with(*this, {Access::read, Access::changed}, true); }
std::vector<int> Kernel::filled() const { return arrays_with(*this, {Access::filled, Access::changed}, false); }
std::vector<int> Kernel::touched() const {
  return arrays_with(*this, {Access::read, Access::filled, Access::changed, Access::room, Access::may_be_null}, true);
}

}  // namespace dalembert::ir
