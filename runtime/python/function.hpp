// A function of a robot as a Python object: what it holds.
#pragma once

#include <cstdint>
#include <dalembert/function_table.hpp>
#include <vector>

#include "numpy.hpp"
#include "owned.hpp"

namespace dalembert::python {

inline constexpr const char* library_capsule = "dalembert.library";

// Made with the module, and never given up.
extern PyObject *singular_error, *singular_warning, *stopped_warning;
extern PyTypeObject* constraint_status_type;  // of residual, least_pivot and rank
extern PyObject *name_out, *name_status, *name_constraints, *name_q, *name_v, *name_active;
extern PyTypeObject function_type;

struct Shape {
  int dimensions = 0;
  npy_intp size[2] = {1, 1};
};

enum class Holds { nothing, contact, loop };

struct RunTimeInput {
  PyObject* name;  // interned
  int at, size;
  Holds holds;  // what the numbers say of
};

// Four numbers of q.
struct Quaternion {
  npy_intp first;
  PyObject* whose;  // "the base's quaternion"
};

// A function of compiled code, and what calls of it need.
struct Code {
  const FunctionEntry* entry = nullptr;
  PyObject* library = nullptr;      // a capsule
  std::vector<void*> workspaces{};  // that nobody uses
  double nanoseconds = 0;           // of one state, as measured last; 0: not yet
};

struct Contents {
  Code single, batch;              // of one state; of states in lanes, once somebody has asked for it
  PyObject* find_batch = nullptr;  // returns (library, entry) of the batch, or None; null: batches are single states
  npy_intp nq = 0, nv = 0;
  bool needs_v = true;
  int acceleration = -1;  // which result is v̇
  int type = NPY_DOUBLE;
  std::size_t scalar = sizeof(double);
  PyObject *name = nullptr, *more = nullptr, *result_type = nullptr, *run_time = nullptr, *coordinates = nullptr,
           *doc = nullptr, *signature = nullptr;
  std::vector<Shape> shapes;
  std::vector<RunTimeInput> run_time_inputs;
  std::vector<Quaternion> quaternions;
  std::vector<double> zeros;  // where v is not read and not given
  const char* text() const { return PyUnicode_AsUTF8(name); }
};

struct Function {
  PyObject_HEAD vectorcallfunc call;
  Contents* contents;
};

// A workspace while it is used.
class Workspace {
 public:
  explicit Workspace(Code& of) : of_(of) {
    if (of.workspaces.empty()) {
      pointer_ = of.entry->create();
      return;
    }
    pointer_ = of.workspaces.back();
    of.workspaces.pop_back();
  }
  Workspace(Workspace&& other) noexcept : of_(other.of_), pointer_(other.pointer_) { other.pointer_ = nullptr; }
  ~Workspace() {
    if (pointer_) of_.workspaces.push_back(pointer_);
  }
  void* get() const { return pointer_; }

 private:
  Code& of_;
  void* pointer_;
};

// The table of a library's functions; null, with an error set, where the capsule is none.
const FunctionTable* table_of(PyObject* library);

// Fills the type's slots. False with an error set.
bool prepare_function_type();

}  // namespace dalembert::python
