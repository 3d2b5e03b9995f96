// Arguments and results of a call, the long way: whatever numpy makes an array of is taken or refused by name.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "function.hpp"

namespace dalembert::python {

struct Argument {
  Owned array;
  StateRows rows;
  npy_intp states = -1;  // -1: one state, without an axis
};

struct Given {
  PyObject *q = nullptr, *v = nullptr, *more = nullptr, *out = nullptr;
  bool return_status = false, return_constraint_status = false;
  std::vector<PyObject*> run_time;  // per run-time input
};

struct Results {
  std::vector<Owned> arrays;      // what the caller gets
  std::vector<Owned> written_to;  // another array where the caller's is not plain, or shares memory with an argument
};

// The argument as rows of the function's scalar: as it is where its rows are whole and lie at equal distances, else a copy.
// These return false with an error set.
bool take(const Contents& f, PyObject* object, PyObject* name, npy_intp size, Argument& to);

// Which argument is which, by place and by name.
bool sort_arguments(const Contents& f, PyObject* const* args, Py_ssize_t given, PyObject* keywords, Given& to);

// The caller's arrays where there are some, else new ones. states: -1 for one without an axis.
bool prepare_results(const Contents& f, PyObject* out, npy_intp states, const std::vector<const Argument*>& arguments,
                     Results& results);

// The run-time inputs: the robot's own, or of each state; `memory` holds the rows.
bool take_run_time(const Contents& f, const Given& given, std::vector<Argument>& own, npy_intp& states,
                   std::vector<unsigned char>& memory, StateRows& rows);

// What a run-time input of that name holds.
Holds held_by(PyObject* name);

// Whether the numbers of a run-time input will do: none is infinite or NaN. Those of a contact or loop matter where it acts,
// and have to be ones that can hold: no regularization and no weight negative, a weld's anchor turned somehow. who: whose
// argument it is, or null. False with an error set that names the number. As a function of Python: of (name, float64 numbers).
bool can_hold(PyObject* who, PyObject* name, Holds holds, const void* numbers, int type, npy_intp size, npy_intp state);
PyObject* check_run_time_input(PyObject* module, PyObject* args);

// Whether quaternions of q are no zeros: those turn nothing, and dynamics would be of no robot. states: -1 for one without an
// axis. False with an error set that names the four numbers.
bool are_quaternions(const Contents& f, const StateRows& q, npy_intp states);

PyObject* new_result(const Contents& f, const Shape& shape, npy_intp states);

}  // namespace dalembert::python
