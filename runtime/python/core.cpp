// dalembert._core: the functions of a robot's compiled code as Python objects that take and give numpy arrays.
//
// A call of one state costs little beside the computation: positional arguments that are arrays of the right kind go to the
// code as they are, under the GIL, into a workspace of the function's own. Everything else (other dtypes, batches, keywords)
// takes the long way, which converts, checks and says by name what is wrong. Of batches the GIL is released, and the states are
// shared among threads. Whatever a function owns is changed only by who holds the GIL.
#define PY_SSIZE_T_CLEAN
#include <Python.h>
#define NPY_NO_DEPRECATED_API NPY_1_7_API_VERSION
#include <dlfcn.h>
#include <numpy/arrayobject.h>
#include <structmember.h>

#include <Eigen/Core>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <dalembert/function_table.hpp>
#include <dalembert/integrators/motion.hpp>
#include <new>
#include <string>
#include <vector>

#include "workers.hpp"

namespace dalembert::python {
namespace {

// A reference that is given up at the end.
class Owned {
 public:
  explicit Owned(PyObject* object = nullptr) : object_(object) {}
  Owned(Owned&& other) noexcept : object_(other.release()) {}
  Owned& operator=(Owned&& other) noexcept {
    std::swap(object_, other.object_);
    return *this;
  }
  ~Owned() { Py_XDECREF(object_); }
  PyObject* get() const { return object_; }
  PyArrayObject* array() const { return reinterpret_cast<PyArrayObject*>(object_); }
  PyObject* release() {
    PyObject* const object = object_;
    object_ = nullptr;
    return object;
  }
  explicit operator bool() const { return object_ != nullptr; }

 private:
  PyObject* object_;
};

PyObject* singular_error = nullptr;
PyObject* singular_warning = nullptr;
PyObject* name_out = nullptr;
PyObject* name_status = nullptr;
PyObject* name_v = nullptr;

constexpr const char* library_capsule = "dalembert.library";

// ---- A function

struct Shape {
  int dimensions = 0;
  npy_intp size[2] = {1, 1};
};

struct RunTimeInput {
  PyObject* name;  // interned
  int at, size;
};

struct Contents {
  const FunctionEntry* entry = nullptr;
  npy_intp nq = 0, nv = 0;
  bool needs_v = true;
  int type = NPY_DOUBLE;
  std::size_t scalar = sizeof(double);
  PyObject *library = nullptr, *name = nullptr, *more = nullptr, *result_type = nullptr, *run_time = nullptr,
           *coordinates = nullptr, *doc = nullptr, *signature = nullptr;
  std::vector<Shape> shapes;
  std::vector<RunTimeInput> run_time_inputs;
  std::vector<void*> workspaces;  // that nobody uses
  std::vector<double> zeros;      // where v is not read and not given
  double nanoseconds = 0;         // of one state, as measured last; 0: not yet
  const char* text() const { return PyUnicode_AsUTF8(name); }
};

struct Function {
  PyObject_HEAD vectorcallfunc call;
  Contents* contents;
};

PyTypeObject function_type = {PyVarObject_HEAD_INIT(nullptr, 0)};

// A workspace while it is used.
class Workspace {
 public:
  explicit Workspace(Contents& of) : of_(of) {
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
  Contents& of_;
  void* pointer_;
};

// What the coordinate is called: "joint 'knee' (v[7])".
PyObject* complain_singular(const Contents& f, std::int32_t coordinate) {
  PyObject* const name = coordinate < PyTuple_GET_SIZE(f.coordinates) ? PyTuple_GET_ITEM(f.coordinates, coordinate) : f.name;
  return PyErr_Format(singular_error,
                      "%U: the mass matrix is not positive definite at this state, as the pivot of %U shows: look for bodies "
                      "without mass and for states that are no poses",
                      f.name, name);
}

// Of one state that was refused: where a number is not finite.
bool all_finite(const Contents& f, const char* what, const void* data, npy_intp size) {
  for (npy_intp i = 0; i < size; ++i) {
    const double x = f.type == NPY_DOUBLE ? static_cast<const double*>(data)[i] : static_cast<const float*>(data)[i];
    if (std::isfinite(x)) continue;
    PyErr_Format(PyExc_ValueError, "%U: %s[%zd] is %s, and the function needs finite numbers", f.name, what,
                 static_cast<Py_ssize_t>(i), std::isnan(x) ? "nan" : "infinite");
    return false;
  }
  return true;
}

PyObject* new_result(const Contents& f, const Shape& shape, npy_intp states) {
  npy_intp sizes[3];
  int dimensions = 0;
  if (states >= 0) sizes[dimensions++] = states;
  for (int i = 0; i < shape.dimensions; ++i) sizes[dimensions++] = shape.size[i];
  return PyArray_SimpleNew(dimensions, sizes, f.type);
}

// The results as the caller gets them: one, or a named tuple.
PyObject* packed(const Contents& f, std::vector<Owned>& results, bool as_scalar) {
  const auto item = [&](Owned& owned) {
    PyObject* const object = owned.release();
    return as_scalar && PyArray_NDIM(reinterpret_cast<PyArrayObject*>(object)) == 0
               ? PyArray_Return(reinterpret_cast<PyArrayObject*>(object))
               : object;
  };
  if (!f.result_type) return item(results[0]);
  auto* const type = reinterpret_cast<PyTypeObject*>(f.result_type);
  Owned tuple(type->tp_alloc(type, static_cast<Py_ssize_t>(results.size())));
  if (!tuple) return nullptr;
  for (std::size_t i = 0; i < results.size(); ++i) {
    PyObject* const object = item(results[i]);
    if (!object) return nullptr;
    PyTuple_SET_ITEM(tuple.get(), static_cast<Py_ssize_t>(i), object);
  }
  return tuple.release();
}

// ---- The short way

// The numbers of one state, where the argument needs nothing done to it.
inline const void* plain(const Contents& f, PyObject* object, npy_intp size) {
  if (Py_TYPE(object) != &PyArray_Type) return nullptr;
  auto* const array = reinterpret_cast<PyArrayObject*>(object);
  if (PyArray_NDIM(array) != 1 || PyArray_DIM(array, 0) != size || PyArray_TYPE(array) != f.type || !PyArray_ISCARRAY_RO(array))
    return nullptr;
  return PyArray_DATA(array);
}

inline bool is_plain_result(const Contents& f, PyObject* object, const Shape& shape) {
  if (Py_TYPE(object) != &PyArray_Type) return false;
  auto* const array = reinterpret_cast<PyArrayObject*>(object);
  if (PyArray_NDIM(array) != shape.dimensions || PyArray_TYPE(array) != f.type || !PyArray_ISCARRAY(array)) return false;
  for (int i = 0; i < shape.dimensions; ++i)
    if (PyArray_DIM(array, i) != shape.size[i]) return false;
  return true;
}

PyObject* long_way(Contents& f, PyObject* const* args, Py_ssize_t given, PyObject* keywords);

PyObject* call(PyObject* self, PyObject* const* args, std::size_t flagged, PyObject* keywords) {
  Contents& f = *reinterpret_cast<Function*>(self)->contents;
  const Py_ssize_t given = PyVectorcall_NARGS(flagged);
  const Py_ssize_t most = f.more ? 3 : 2, least = f.more ? 3 : f.needs_v ? 2 : 1;
  PyObject* out = nullptr;
  if (keywords) {
    if (PyTuple_GET_SIZE(keywords) != 1 || PyTuple_GET_ITEM(keywords, 0) != name_out || f.result_type)
      return long_way(f, args, given, keywords);
    out = args[given];
    if (!is_plain_result(f, out, f.shapes[0])) return long_way(f, args, given, keywords);
  }
  if (given < least || given > most) return long_way(f, args, given, keywords);
  FunctionCall call{};
  call.q.first = plain(f, args[0], f.nq);
  call.v.first = given > 1 ? plain(f, args[1], f.nv) : f.zeros.data();
  call.more.first = given > 2 ? plain(f, args[2], f.nv) : nullptr;
  if (!call.q.first || !call.v.first || (given > 2 && !call.more.first)) return long_way(f, args, given, keywords);
  const Workspace workspace(f);
  if (!workspace.get()) return PyErr_NoMemory();
  if (f.run_time) call.run_time.first = PyArray_DATA(reinterpret_cast<PyArrayObject*>(f.run_time));
  std::int32_t status = -1;
  call.status = f.entry->has_status ? &status : nullptr;
  call.end = 1;
  const auto refused = [&]() -> PyObject* {
    if (all_finite(f, "q", call.q.first, f.nq) && all_finite(f, "v", call.v.first, f.nv)) complain_singular(f, status);
    return nullptr;
  };
  if (!f.result_type) {
    PyObject* const result = out ? Py_NewRef(out) : new_result(f, f.shapes[0], -1);
    if (!result) return nullptr;
    void* const data = PyArray_DATA(reinterpret_cast<PyArrayObject*>(result));
    call.results = &data;
    f.entry->run(call, workspace.get());
    if (status >= 0) {
      Py_DECREF(result);
      return refused();
    }
    return out || f.shapes[0].dimensions > 0 ? result : PyArray_Return(reinterpret_cast<PyArrayObject*>(result));
  }
  std::vector<Owned> results;
  std::vector<void*> data;
  for (const Shape& shape : f.shapes) {
    results.emplace_back(new_result(f, shape, -1));
    if (!results.back()) return nullptr;
    data.push_back(PyArray_DATA(results.back().array()));
  }
  call.results = data.data();
  f.entry->run(call, workspace.get());
  return status >= 0 ? refused() : packed(f, results, true);
}

// ---- The long way

struct Argument {
  Owned array;
  StateRows rows;
  npy_intp states = -1;  // -1: one state, without an axis
};

std::string described(PyArrayObject* array) {
  std::string text = "(";
  for (int i = 0; i < PyArray_NDIM(array); ++i) text += (i ? ", " : "") + std::to_string(PyArray_DIM(array, i));
  return text + (PyArray_NDIM(array) == 1 ? ",)" : ")");
}

// The argument as rows of the function's scalar: as it is where its rows are whole and lie at equal distances, else a copy.
bool take(const Contents& f, PyObject* object, PyObject* name, npy_intp size, Argument& to) {
  Owned array(PyArray_Check(object) ? Py_NewRef(object) : PyArray_FromAny(object, nullptr, 0, 0, 0, nullptr));
  if (!array) return false;
  const int type = PyArray_TYPE(array.array());
  const auto wanted = [&] { return f.type == NPY_DOUBLE ? "float64" : "float32"; };
  if (!PyTypeNum_ISBOOL(type) && !PyTypeNum_ISINTEGER(type) && !PyTypeNum_ISFLOAT(type)) {
    PyErr_Format(PyExc_ValueError, "%U: %U has dtype %S, expected %s or what converts to it", f.name, name,
                 PyArray_DESCR(array.array()), wanted());
    return false;
  }
  const int dimensions = PyArray_NDIM(array.array());
  if (dimensions < 1 || dimensions > 2 || PyArray_DIM(array.array(), dimensions - 1) != size) {
    PyErr_Format(PyExc_ValueError, "%U: %U has shape %s, expected (%zd,) for one state or (n, %zd) for n", f.name, name,
                 described(array.array()).c_str(), static_cast<Py_ssize_t>(size), static_cast<Py_ssize_t>(size));
    return false;
  }
  const npy_intp bytes = static_cast<npy_intp>(f.scalar);
  const bool as_it_is = type == f.type && PyArray_ISALIGNED(array.array()) && PyArray_ISNOTSWAPPED(array.array()) &&
                        (size <= 1 || PyArray_STRIDE(array.array(), dimensions - 1) == bytes) &&
                        (dimensions == 1 || PyArray_STRIDE(array.array(), 0) % bytes == 0);
  if (!as_it_is) {
    array = Owned(PyArray_FROM_OTF(array.get(), f.type, NPY_ARRAY_CARRAY_RO | NPY_ARRAY_FORCECAST));
    if (!array) return false;
  }
  to.rows.first = PyArray_DATA(array.array());
  if (dimensions == 2) {
    to.states = PyArray_DIM(array.array(), 0);
    to.rows.step = PyArray_STRIDE(array.array(), 0) / bytes;
  }
  to.array = std::move(array);
  return true;
}

struct Given {
  PyObject *q = nullptr, *v = nullptr, *more = nullptr, *out = nullptr;
  bool return_status = false;
  std::vector<PyObject*> run_time;  // per run-time input
};

bool same(PyObject* a, PyObject* b) { return a == b || PyUnicode_Compare(a, b) == 0; }

bool sort_arguments(const Contents& f, PyObject* const* args, Py_ssize_t given, PyObject* keywords, Given& to) {
  const Py_ssize_t most = f.more ? 3 : 2;
  PyObject** const places[] = {&to.q, &to.v, &to.more};
  to.run_time.assign(f.run_time_inputs.size(), nullptr);
  if (given > most) {
    PyErr_Format(PyExc_TypeError, "%U takes q%s%s%V, and %zd arguments were given", f.name, ", v", f.more ? ", " : "", f.more,
                 "", given);
    return false;
  }
  for (Py_ssize_t i = 0; i < given; ++i) *places[i] = args[i];
  for (Py_ssize_t k = 0; keywords && k < PyTuple_GET_SIZE(keywords); ++k) {
    PyObject *const name = PyTuple_GET_ITEM(keywords, k), *const value = args[given + k];
    PyObject** place = nullptr;
    if (same(name, name_out)) place = &to.out;
    else if (PyUnicode_CompareWithASCIIString(name, "q") == 0) place = &to.q;
    else if (same(name, name_v)) place = &to.v;
    else if (f.more && same(name, f.more)) place = &to.more;
    for (std::size_t r = 0; r < f.run_time_inputs.size(); ++r)
      if (same(name, f.run_time_inputs[r].name)) place = &to.run_time[r];
    if (same(name, name_status)) {
      const int truth = PyObject_IsTrue(value);
      if (truth < 0) return false;
      to.return_status = truth > 0;
    } else if (!place) {
      std::string known = f.more ? std::string("q, v, ") + PyUnicode_AsUTF8(f.more) : "q, v";
      for (const RunTimeInput& input : f.run_time_inputs) known += std::string(", ") + PyUnicode_AsUTF8(input.name);
      PyErr_Format(PyExc_TypeError, "%U has no argument '%U'; there are %s, out and return_status", f.name, name,
                   known.c_str());
      return false;
    } else if (*place) {
      PyErr_Format(PyExc_TypeError, "%U: '%U' is given twice", f.name, name);
      return false;
    } else {
      *place = value;
    }
  }
  if (to.out == Py_None) to.out = nullptr;
  if (to.v == Py_None && !f.needs_v && !f.more) to.v = nullptr;
  const char* missing = !to.q ? "q" : !to.v && (f.needs_v || f.more) ? "v" : nullptr;
  if (!missing && f.more && !to.more) missing = PyUnicode_AsUTF8(f.more);
  if (missing) {
    PyErr_Format(PyExc_TypeError, "%U needs %s: it takes q%s%s%V", f.name, missing, f.needs_v || f.more ? ", v" : "",
                 f.more ? ", " : "", f.more, "");
    return false;
  }
  return true;
}

// The lowest and the byte behind the highest that an array has.
std::pair<const char*, const char*> bytes_of(PyArrayObject* array) {
  const char *low = PyArray_BYTES(array), *high = low + PyArray_ITEMSIZE(array);
  for (int i = 0; i < PyArray_NDIM(array); ++i) {
    if (PyArray_DIM(array, i) == 0) return {low, low};
    const npy_intp reach = PyArray_STRIDE(array, i) * (PyArray_DIM(array, i) - 1);
    (reach < 0 ? low : high) += reach;
  }
  return {low, high};
}

bool overlap(PyArrayObject* a, PyArrayObject* b) {
  const auto [a_low, a_high] = bytes_of(a);
  const auto [b_low, b_high] = bytes_of(b);
  return a_low < b_high && b_low < a_high;
}

struct Results {
  std::vector<Owned> arrays;      // what the caller gets
  std::vector<Owned> written_to;  // another array where the caller's is not plain, or shares memory with an argument
};

bool prepare_results(const Contents& f, PyObject* out, npy_intp states, const std::vector<const Argument*>& arguments,
                     Results& results) {
  const std::size_t count = f.shapes.size();
  std::vector<PyObject*> given(count, nullptr);
  if (out && !f.result_type) given[0] = out;
  Owned sequence;
  if (out && f.result_type) {
    sequence = Owned(PySequence_Fast(out, "out is one array per result, in a tuple"));
    if (!sequence) return false;
    if (PySequence_Fast_GET_SIZE(sequence.get()) != static_cast<Py_ssize_t>(count)) {
      PyErr_Format(PyExc_ValueError, "%U: out has %zd arrays, expected one for each of %zd results", f.name,
                   PySequence_Fast_GET_SIZE(sequence.get()), static_cast<Py_ssize_t>(count));
      return false;
    }
    for (std::size_t i = 0; i < count; ++i) given[i] = PySequence_Fast_GET_ITEM(sequence.get(), static_cast<Py_ssize_t>(i));
  }
  for (std::size_t i = 0; i < count; ++i) {
    const Shape& shape = f.shapes[i];
    if (!given[i]) {
      results.arrays.emplace_back(new_result(f, shape, states));
      if (!results.arrays.back()) return false;
      results.written_to.emplace_back();
      continue;
    }
    if (!PyArray_Check(given[i])) {
      PyErr_Format(PyExc_ValueError, "%U: out is of type %s, expected a numpy array", f.name, Py_TYPE(given[i])->tp_name);
      return false;
    }
    auto* const array = reinterpret_cast<PyArrayObject*>(given[i]);
    std::vector<npy_intp> sizes;
    if (states >= 0) sizes.push_back(states);
    sizes.insert(sizes.end(), shape.size, shape.size + shape.dimensions);
    const bool fits =
        PyArray_NDIM(array) == static_cast<int>(sizes.size()) && std::equal(sizes.begin(), sizes.end(), PyArray_DIMS(array));
    if (!fits) {
      std::string expected = "(";
      for (const npy_intp size : sizes) expected += (expected.size() > 1 ? ", " : "") + std::to_string(size);
      expected += sizes.size() == 1 ? ",)" : ")";
      PyErr_Format(PyExc_ValueError, "%U: out has shape %s, expected %s", f.name, described(array).c_str(), expected.c_str());
      return false;
    }
    if (PyArray_TYPE(array) != f.type) {
      PyErr_Format(PyExc_ValueError, "%U: out has dtype %S, expected %s", f.name, PyArray_DESCR(array),
                   f.type == NPY_DOUBLE ? "float64" : "float32");
      return false;
    }
    if (!PyArray_ISWRITEABLE(array)) {
      PyErr_Format(PyExc_ValueError, "%U: out is read-only", f.name);
      return false;
    }
    bool aside = !PyArray_ISCARRAY(array);
    for (const Argument* argument : arguments)
      if (argument->array) aside = aside || overlap(array, argument->array.array());
    results.arrays.emplace_back(Py_NewRef(given[i]));
    results.written_to.emplace_back(aside ? new_result(f, shape, states) : nullptr);
    if (aside && !results.written_to.back()) return false;
  }
  return true;
}

// Runs the call's states, on several threads where that pays. Without the GIL.
void run_states(Contents& f, FunctionCall call, const std::vector<Workspace>& workspaces, double& nanoseconds) {
  using Clock = std::chrono::steady_clock;
  const std::ptrdiff_t end = call.end;
  if (nanoseconds == 0) {  // the second of two: the first fetches code and tables
    for (std::ptrdiff_t part = 0; part < 2 && call.begin < end; ++part) {
      call.end = std::min(end, call.begin + 8);
      const auto start = Clock::now();
      f.entry->run(call, workspaces[0].get());
      const double taken = std::chrono::duration<double, std::nano>(Clock::now() - start).count();
      nanoseconds = std::max(1.0, taken / static_cast<double>(call.end - call.begin));
      call.begin = call.end;
    }
    call.end = end;
  }
  const std::ptrdiff_t left = end - call.begin;
  const int threads = static_cast<int>(workspaces.size());
  constexpr double worth_waking = 40e3;  // ns
  if (threads == 1 || static_cast<double>(left) * nanoseconds < worth_waking) {
    if (left > 0) f.entry->run(call, workspaces[0].get());
    return;
  }
  const std::ptrdiff_t chunk = std::max<std::ptrdiff_t>(1, left / (8 * threads));
  std::atomic<std::ptrdiff_t> next{call.begin};
  Workers::instance().run(threads, [&](int w) {
    FunctionCall part = call;
    for (;;) {
      part.begin = next.fetch_add(chunk);
      if (part.begin >= end) return;
      part.end = std::min(end, part.begin + chunk);
      f.entry->run(part, workspaces[static_cast<std::size_t>(w)].get());
    }
  });
}

// The run-time inputs: the robot's own, or of each state.
bool take_run_time(const Contents& f, const Given& given, std::vector<Argument>& own, npy_intp& states,
                   std::vector<unsigned char>& memory, StateRows& rows) {
  if (!f.run_time) return true;
  auto* const common = reinterpret_cast<PyArrayObject*>(f.run_time);
  const std::size_t width = static_cast<std::size_t>(PyArray_SIZE(common));
  bool per_state = false;
  own.resize(f.run_time_inputs.size());
  for (std::size_t r = 0; r < own.size(); ++r) {
    const RunTimeInput& input = f.run_time_inputs[r];
    if (!given.run_time[r]) continue;
    if (!take(f, given.run_time[r], input.name, input.size, own[r])) return false;
    per_state = per_state || own[r].states >= 0;
  }
  for (std::size_t r = 0; r < own.size(); ++r) {
    if (own[r].states < 0) continue;
    if (states >= 0 && own[r].states != states) {
      PyErr_Format(PyExc_ValueError, "%U: %U has %zd states, and other arguments have %zd", f.name, f.run_time_inputs[r].name,
                   static_cast<Py_ssize_t>(own[r].states), static_cast<Py_ssize_t>(states));
      return false;
    }
    states = own[r].states;
  }
  const std::size_t count = per_state ? static_cast<std::size_t>(std::max<npy_intp>(states, 0)) : 1;
  if (count > (std::size_t{1} << 40) / std::max<std::size_t>(1, width * f.scalar)) {
    PyErr_NoMemory();
    return false;
  }
  try {
    memory.resize(std::max<std::size_t>(1, count) * width * f.scalar);
  } catch (const std::bad_alloc&) {
    PyErr_NoMemory();
    return false;
  }
  for (std::size_t s = 0; s < count; ++s) {
    unsigned char* const to = memory.data() + s * width * f.scalar;
    std::memcpy(to, PyArray_DATA(common), width * f.scalar);
    for (std::size_t r = 0; r < own.size(); ++r)
      if (given.run_time[r])
        std::memcpy(to + static_cast<std::size_t>(f.run_time_inputs[r].at) * f.scalar,
                    static_cast<const unsigned char*>(own[r].rows.first) +
                        static_cast<std::ptrdiff_t>(s) * own[r].rows.step * static_cast<std::ptrdiff_t>(f.scalar),
                    static_cast<std::size_t>(f.run_time_inputs[r].size) * f.scalar);
  }
  rows.first = memory.data();
  rows.step = per_state ? static_cast<std::ptrdiff_t>(width) : 0;
  return true;
}

PyObject* long_way(Contents& f, PyObject* const* args, Py_ssize_t given_count, PyObject* keywords) {
  Given given;
  if (!sort_arguments(f, args, given_count, keywords, given)) return nullptr;
  static PyObject* const name_q = PyUnicode_InternFromString("q");
  Argument q, v, more;
  if (!take(f, given.q, name_q, f.nq, q)) return nullptr;
  if (given.v && !take(f, given.v, name_v, f.nv, v)) return nullptr;
  if (given.more && !take(f, given.more, f.more, f.nv, more)) return nullptr;
  if (!given.v) v.rows.first = f.zeros.data();
  npy_intp states = -1;
  PyObject* first = nullptr;
  for (const auto& [argument, name] : {std::pair{&q, name_q}, {&v, name_v}, {&more, f.more}}) {
    if (argument->states < 0) continue;
    if (states >= 0 && argument->states != states) {
      PyErr_Format(PyExc_ValueError, "%U: %U has %zd states and %U has %zd", f.name, first, static_cast<Py_ssize_t>(states),
                   name, static_cast<Py_ssize_t>(argument->states));
      return nullptr;
    }
    states = argument->states;
    if (!first) first = name;
  }
  FunctionCall call{};
  std::vector<Argument> own;
  std::vector<unsigned char> memory;
  if (!take_run_time(f, given, own, states, memory, call.run_time)) return nullptr;
  call.q = q.rows;
  call.v = v.rows;
  call.more = more.rows;
  Results results;
  if (!prepare_results(f, given.out, states, {&q, &v, &more}, results)) return nullptr;
  std::vector<void*> data;
  for (std::size_t i = 0; i < results.arrays.size(); ++i)
    data.push_back(PyArray_DATA((results.written_to[i] ? results.written_to[i] : results.arrays[i]).array()));
  call.results = data.data();
  const bool many = states >= 0;
  call.end = many ? states : 1;
  Owned status;
  if (f.entry->has_status || given.return_status) {
    npy_intp size = call.end;
    status = Owned(PyArray_SimpleNew(1, &size, NPY_INT32));
    if (!status) return nullptr;
    auto* const numbers = static_cast<std::int32_t*>(PyArray_DATA(status.array()));
    std::fill_n(numbers, size, -1);
    if (f.entry->has_status) call.status = numbers;
  }
  {
    std::vector<Workspace> workspaces;
    const int threads =
        many ? static_cast<int>(std::min<npy_intp>(std::max<npy_intp>(1, states), Workers::instance().count())) : 1;
    for (int w = 0; w < threads; ++w) {
      workspaces.emplace_back(f);
      if (!workspaces.back().get()) return PyErr_NoMemory();
    }
    double nanoseconds = many ? f.nanoseconds : 1;
    Py_BEGIN_ALLOW_THREADS;
    run_states(f, call, workspaces, nanoseconds);
    Py_END_ALLOW_THREADS;
    if (many) f.nanoseconds = nanoseconds;
  }
  if (call.status && !given.return_status) {
    const std::ptrdiff_t singular = std::count_if(call.status, call.status + call.end, [](std::int32_t s) { return s >= 0; });
    if (singular > 0 && !many) {
      if (all_finite(f, "q", q.rows.first, f.nq) && all_finite(f, "v", v.rows.first, f.nv))
        complain_singular(f, call.status[0]);
      return nullptr;
    }
    if (singular > 0) {
      const std::ptrdiff_t at =
          std::find_if(call.status, call.status + call.end, [](std::int32_t s) { return s >= 0; }) - call.status;
      if (PyErr_WarnFormat(
              singular_warning, 1,
              "%U: the mass matrix is not positive definite at %zd of %zd states, the first of them number %zd: what "
              "needs its inverse is zero there; return_status=True tells which",
              f.name, static_cast<Py_ssize_t>(singular), static_cast<Py_ssize_t>(call.end), static_cast<Py_ssize_t>(at)) < 0)
        return nullptr;
    }
  }
  for (std::size_t i = 0; i < results.arrays.size(); ++i)
    if (results.written_to[i] && PyArray_CopyInto(results.arrays[i].array(), results.written_to[i].array()) < 0) return nullptr;
  Owned packed_results(packed(f, results.arrays, !given.out));
  if (!packed_results) return nullptr;
  if (!given.return_status) return packed_results.release();
  if (many) return Py_BuildValue("(NN)", packed_results.release(), status.release());
  return Py_BuildValue("(Ni)", packed_results.release(), static_cast<std::int32_t*>(PyArray_DATA(status.array()))[0]);
}

// ---- The types' other slots

void deallocate(PyObject* self) {
  Contents* const f = reinterpret_cast<Function*>(self)->contents;
  if (f) {
    for (void* workspace : f->workspaces) f->entry->destroy(workspace);
    for (RunTimeInput& input : f->run_time_inputs) Py_DECREF(input.name);
    for (PyObject* object : {f->name, f->more, f->result_type, f->run_time, f->coordinates, f->doc, f->signature, f->library})
      Py_XDECREF(object);
    delete f;
  }
  Py_TYPE(self)->tp_free(self);
}

bool read_shapes(PyObject* list, Contents& f) {
  for (Py_ssize_t i = 0; i < PyTuple_GET_SIZE(list); ++i) {
    Shape shape;
    PyObject* const sizes = PyTuple_GET_ITEM(list, i);
    shape.dimensions = static_cast<int>(PyTuple_Size(sizes));
    if (shape.dimensions < 0 || shape.dimensions > 2) return false;
    for (int k = 0; k < shape.dimensions; ++k) shape.size[k] = PyLong_AsSsize_t(PyTuple_GET_ITEM(sizes, k));
    f.shapes.push_back(shape);
  }
  return !PyErr_Occurred();
}

PyObject* new_function(PyTypeObject* type, PyObject* args, PyObject*) {
  PyObject *library, *name, *more, *shapes, *result_type, *run_time, *run_time_inputs, *coordinates, *doc, *signature;
  int entry, needs_v;
  Py_ssize_t nq, nv;
  if (!PyArg_ParseTuple(args, "OiUOpnnO!OOO!O!UO", &library, &entry, &name, &more, &needs_v, &nq, &nv, &PyTuple_Type, &shapes,
                        &result_type, &run_time, &PyTuple_Type, &run_time_inputs, &PyTuple_Type, &coordinates, &doc,
                        &signature))
    return nullptr;
  void* const handle = PyCapsule_GetPointer(library, library_capsule);
  if (!handle) return nullptr;
  const auto table_of = reinterpret_cast<const FunctionTable* (*)()>(dlsym(handle, "dalembert_function_table"));
  const FunctionTable& table = *table_of();
  if (entry < 0 || entry >= table.functions || table.entries[entry].results != PyTuple_GET_SIZE(shapes)) {
    PyErr_SetString(PyExc_ValueError, "no such function in this library");
    return nullptr;
  }
  Owned self(type->tp_alloc(type, 0));
  if (!self) return nullptr;
  auto* const function = reinterpret_cast<Function*>(self.get());
  function->call = call;
  auto* const f = function->contents = new Contents;
  const auto keep = [](PyObject* object) { return object == Py_None ? nullptr : Py_NewRef(object); };
  f->entry = &table.entries[entry];
  f->nq = nq;
  f->nv = nv;
  f->needs_v = needs_v;
  f->type = table.scalar_bytes == 4 ? NPY_FLOAT32 : NPY_FLOAT64;
  f->scalar = static_cast<std::size_t>(table.scalar_bytes);
  f->library = keep(library);
  f->name = keep(name);
  f->more = keep(more);
  if (f->more) PyUnicode_InternInPlace(&f->more);
  f->result_type = keep(result_type);
  f->run_time = keep(run_time);
  f->coordinates = keep(coordinates);
  f->doc = keep(doc);
  f->signature = keep(signature);
  f->zeros.assign(static_cast<std::size_t>(nv), 0.0);
  if (!read_shapes(shapes, *f)) return nullptr;
  if (f->result_type &&
      (!PyType_Check(f->result_type) || !PyType_IsSubtype(reinterpret_cast<PyTypeObject*>(f->result_type), &PyTuple_Type))) {
    PyErr_SetString(PyExc_TypeError, "the results' type is no tuple");
    return nullptr;
  }
  if (f->run_time &&
      (Py_TYPE(f->run_time) != &PyArray_Type || PyArray_TYPE(reinterpret_cast<PyArrayObject*>(f->run_time)) != f->type ||
       !PyArray_ISCARRAY(reinterpret_cast<PyArrayObject*>(f->run_time)))) {
    PyErr_SetString(PyExc_TypeError, "the run-time inputs are no array of the library's scalar");
    return nullptr;
  }
  for (Py_ssize_t i = 0; i < PyTuple_GET_SIZE(run_time_inputs); ++i) {
    PyObject* input;
    int at, size;
    if (!PyArg_ParseTuple(PyTuple_GET_ITEM(run_time_inputs, i), "Uii", &input, &at, &size)) return nullptr;
    f->run_time_inputs.push_back({Py_NewRef(input), at, size});
  }
  return self.release();
}

PyObject* object_or_none(PyObject* object) { return Py_NewRef(object ? object : Py_None); }
Contents& of(PyObject* self) { return *reinterpret_cast<Function*>(self)->contents; }

PyObject* represent(PyObject* self) {
  return of(self).signature ? PyUnicode_FromFormat("<%U%S>", of(self).name, of(self).signature)
                            : PyUnicode_FromFormat("<%U>", of(self).name);
}

PyGetSetDef function_attributes[] = {
    {"__name__", [](PyObject* self, void*) { return object_or_none(of(self).name); }, nullptr, nullptr, nullptr},
    {"__doc__", [](PyObject* self, void*) { return object_or_none(of(self).doc); }, nullptr, nullptr, nullptr},
    {"__signature__", [](PyObject* self, void*) { return object_or_none(of(self).signature); }, nullptr, nullptr, nullptr},
    {"has_status", [](PyObject* self, void*) { return PyBool_FromLong(of(self).entry->has_status); }, nullptr,
     "Whether the function needs M to be positive definite, and says where it is not.", nullptr},
    {}};

// ---- The module's functions

PyObject* open_library(PyObject*, PyObject* args) {
  PyObject* path;
  if (!PyArg_ParseTuple(args, "O&", PyUnicode_FSConverter, &path)) return nullptr;
  const Owned bytes(path);
  void* const handle = dlopen(PyBytes_AS_STRING(path), RTLD_NOW | RTLD_LOCAL);
  if (!handle) return PyErr_Format(PyExc_OSError, "%s", dlerror());
  Owned capsule(
      PyCapsule_New(handle, library_capsule, [](PyObject* self) { dlclose(PyCapsule_GetPointer(self, library_capsule)); }));
  if (!capsule) return nullptr;
  const auto table_of = reinterpret_cast<const FunctionTable* (*)()>(dlsym(handle, "dalembert_function_table"));
  if (!table_of || table_of()->version != function_table_version)
    return PyErr_Format(PyExc_OSError, "%s is not of this version of dalembert", PyBytes_AS_STRING(path));
  return capsule.release();
}

// Two C-contiguous float64 arrays of n rows each.
bool two_arrays(PyObject* args, PyArrayObject*& a, PyArrayObject*& b) {
  if (!PyArg_ParseTuple(args, "O!O!", &PyArray_Type, &a, &PyArray_Type, &b)) return false;
  for (PyArrayObject* array : {a, b})
    if (PyArray_NDIM(array) != 2 || PyArray_TYPE(array) != NPY_FLOAT64 || !PyArray_ISCARRAY_RO(array) ||
        PyArray_DIM(array, 0) != PyArray_DIM(a, 0)) {
      PyErr_SetString(PyExc_ValueError, "two arrays of float64 with as many rows were expected");
      return false;
    }
  return true;
}

using Vector = Eigen::Map<Eigen::VectorXd>;
Vector row_of(PyArrayObject* array, npy_intp row) {
  return {static_cast<double*>(PyArray_DATA(array)) + row * PyArray_DIM(array, 1), PyArray_DIM(array, 1)};
}

// Joints with a quaternion, from rows of a C-contiguous int64 array: where they begin in q and v, and whether they slide.
bool quaternion_joints(PyArrayObject* array, std::vector<QuaternionJoint>& joints) {
  if (PyArray_NDIM(array) != 2 || PyArray_DIM(array, 1) != 3 || PyArray_TYPE(array) != NPY_INT64 ||
      !PyArray_ISCARRAY_RO(array)) {
    PyErr_SetString(PyExc_ValueError, "an array of int64 with three columns was expected");
    return false;
  }
  const auto* numbers = static_cast<const npy_int64*>(PyArray_DATA(array));
  for (npy_intp i = 0; i < PyArray_DIM(array, 0); ++i, numbers += 3)
    joints.push_back({static_cast<int>(numbers[0]), static_cast<int>(numbers[1]), numbers[2] != 0});
  return true;
}

PyObject* integrate(PyObject*, PyObject* args) {
  PyArrayObject *q, *step, *quaternions;
  if (!PyArg_ParseTuple(args, "O!O!O!", &PyArray_Type, &q, &PyArray_Type, &step, &PyArray_Type, &quaternions)) return nullptr;
  const Owned both(Py_BuildValue("(OO)", q, step));
  std::vector<QuaternionJoint> joints;
  if (!both || !two_arrays(both.get(), q, step) || !quaternion_joints(quaternions, joints)) return nullptr;
  Owned next(PyArray_SimpleNew(2, PyArray_DIMS(q), NPY_FLOAT64));
  if (!next) return nullptr;
  for (npy_intp s = 0; s < PyArray_DIM(q, 0); ++s) {
    Vector to = row_of(next.array(), s);
    integrators::move(row_of(q, s), row_of(step, s), to, joints);
  }
  return next.release();
}

PyObject* difference(PyObject*, PyObject* args) {
  PyArrayObject *from, *to, *quaternions;
  int floating;
  if (!PyArg_ParseTuple(args, "O!O!pO!", &PyArray_Type, &from, &PyArray_Type, &to, &floating, &PyArray_Type, &quaternions))
    return nullptr;
  const Owned both(Py_BuildValue("(OO)", from, to));
  std::vector<QuaternionJoint> joints;
  if (!both || !two_arrays(both.get(), from, to) || !quaternion_joints(quaternions, joints)) return nullptr;
  npy_intp sizes[] = {PyArray_DIM(from, 0), PyArray_DIM(from, 1) - (floating ? 1 : 0) - static_cast<npy_intp>(joints.size())};
  Owned step(PyArray_SimpleNew(2, sizes, NPY_FLOAT64));
  if (!step) return nullptr;
  for (npy_intp s = 0; s < sizes[0]; ++s) {
    Vector row = row_of(step.array(), s);
    integrators::difference(row_of(from, s), row_of(to, s), row, joints);
  }
  return step.release();
}

PyObject* threads(PyObject*, PyObject* args) {
  int count = 0;
  if (!PyArg_ParseTuple(args, "|i", &count)) return nullptr;
  if (count > 0) Workers::instance().set_count(std::min(count, 1024));
  return PyLong_FromLong(Workers::instance().count());
}

PyMethodDef module_functions[] = {{"open", open_library, METH_VARARGS, "A robot's compiled code, loaded."},
                                  {"integrate", integrate, METH_VARARGS, "Rows of q moved by rows of twists."},
                                  {"difference", difference, METH_VARARGS, "The twists that lead from rows of q to others."},
                                  {"threads", threads, METH_VARARGS, "How many threads share a batch; an argument sets it."},
                                  {}};

PyModuleDef module_definition = {
    PyModuleDef_HEAD_INIT, "dalembert._core", nullptr, -1, module_functions, nullptr, nullptr, nullptr, nullptr};

}  // namespace
}  // namespace dalembert::python

PyMODINIT_FUNC PyInit__core() {
  using namespace dalembert::python;
  import_array();
  function_type.tp_name = "dalembert.Function";
  function_type.tp_doc = "A function of a robot: q, q and v, or q, v and a or tau go in, arrays of one state or of n come out.";
  function_type.tp_basicsize = sizeof(Function);
  function_type.tp_flags = Py_TPFLAGS_DEFAULT | Py_TPFLAGS_HAVE_VECTORCALL;
  function_type.tp_vectorcall_offset = offsetof(Function, call);
  function_type.tp_call = PyVectorcall_Call;
  function_type.tp_new = new_function;
  function_type.tp_dealloc = deallocate;
  function_type.tp_repr = represent;
  function_type.tp_getset = function_attributes;
  if (PyType_Ready(&function_type) < 0) return nullptr;
  name_out = PyUnicode_InternFromString("out");
  name_status = PyUnicode_InternFromString("return_status");
  name_v = PyUnicode_InternFromString("v");
  Owned module(PyModule_Create(&module_definition));
  if (!module) return nullptr;
  singular_error = PyErr_NewExceptionWithDoc(
      "dalembert.SingularError", "The mass matrix is not positive definite at a state, and a result needs its inverse.",
      PyExc_ArithmeticError, nullptr);
  singular_warning = PyErr_NewExceptionWithDoc("dalembert.SingularWarning",
                                               "The mass matrix is not positive definite at some states of a batch.",
                                               PyExc_RuntimeWarning, nullptr);
  if (!singular_error || !singular_warning || PyModule_AddObjectRef(module.get(), "SingularError", singular_error) < 0 ||
      PyModule_AddObjectRef(module.get(), "SingularWarning", singular_warning) < 0 ||
      PyModule_AddObjectRef(module.get(), "Function", reinterpret_cast<PyObject*>(&function_type)) < 0)
    return nullptr;
  return module.release();
}
