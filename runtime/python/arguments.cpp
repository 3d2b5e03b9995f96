#include "arguments.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <new>
#include <string>
#include <utility>

namespace dalembert::python {

namespace {

std::string described(PyArrayObject* array) {
  std::string text = "(";
  for (int i = 0; i < PyArray_NDIM(array); ++i) text += (i ? ", " : "") + std::to_string(PyArray_DIM(array, i));
  return text + (PyArray_NDIM(array) == 1 ? ",)" : ")");
}

bool same(PyObject* a, PyObject* b) { return a == b || PyUnicode_Compare(a, b) == 0; }

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

}  // namespace

Holds held_by(PyObject* name) {
  const char* const text = PyUnicode_AsUTF8(name);
  const auto begins = [&](const char* word) { return text && std::strncmp(text, word, std::strlen(word)) == 0; };
  return begins("contact_") ? Holds::contact : begins("loop_") ? Holds::loop : Holds::nothing;
}

bool can_hold(PyObject* who, PyObject* name, Holds holds, const void* numbers, int type, npy_intp size, npy_intp state) {
  const auto number = [&](npy_intp i) {
    return type == NPY_DOUBLE ? static_cast<const double*>(numbers)[i] : static_cast<const float*>(numbers)[i];
  };
  if (holds != Holds::nothing && number(0) == 0) return true;  // it is off
  // Before any contact's or loop's rows: active, gains, restitution; of a contact its anchor, too.
  const npy_intp before = holds == Holds::contact ? 11 : 4, rows = (size - before) / 2;
  const auto complain = [&](npy_intp i, const char* what) {
    static const char* const single[] = {"active", "kp", "kd", "restitution"};
    std::string member = holds == Holds::nothing ? "[" + std::to_string(i)
                         : i < 4                 ? single[i]
                         : i < before            ? "anchor[" + std::to_string(i - 4)
                         : i < before + rows     ? "regularization[" + std::to_string(i - before)
                                                 : "weight[" + std::to_string(i - before - rows);
    if (i >= 4 || holds == Holds::nothing) member += "]";
    const Owned value(PyFloat_FromDouble(number(i)));
    if (value)
      PyErr_Format(PyExc_ValueError, "%V%s%U%s%s%s is %R, expected %s", who, "", who ? ": " : "", name,
                   holds == Holds::nothing ? "" : ": ", member.c_str(),
                   state >= 0 ? (" of state " + std::to_string(state)).c_str() : "", value.get(), what);
    return false;
  };
  for (npy_intp i = 0; i < size; ++i) {
    const bool none_below = holds != Holds::nothing && i >= before;
    const bool switches = holds != Holds::nothing && i == 0;  // which is not off
    if (!std::isfinite(number(i)) || (none_below && number(i) < 0) || (switches && number(i) != 1))
      return complain(i, switches ? "true or false" : none_below ? "a finite number, zero or more" : "a finite number");
  }
  if (holds == Holds::contact && rows == 6 && number(1) != 0 && number(7) == 0 && number(8) == 0 && number(9) == 0)
    return number(10) != 0 || complain(10, "a quaternion x y z w in anchor[3] to anchor[6], such as 0 0 0 1: it has no length");
  return true;
}

PyObject* check_run_time_input(PyObject*, PyObject* args) {
  PyObject* name;
  PyArrayObject* numbers;
  if (!PyArg_ParseTuple(args, "UO!", &name, &PyArray_Type, &numbers)) return nullptr;
  if (PyArray_TYPE(numbers) != NPY_DOUBLE || !PyArray_ISCARRAY_RO(numbers))
    return PyErr_Format(PyExc_ValueError, "an array of float64 was expected");
  if (!can_hold(nullptr, name, held_by(name), PyArray_DATA(numbers), NPY_DOUBLE, PyArray_SIZE(numbers), -1)) return nullptr;
  Py_RETURN_NONE;
}

bool are_quaternions(const Contents& f, const StateRows& q, npy_intp states) {
  if (f.quaternions.empty()) return true;
  const npy_intp count = states < 0 ? 1 : q.step == 0 ? std::min<npy_intp>(states, 1) : states;
  const auto find = [&](const auto* numbers) -> bool {
    for (npy_intp s = 0; s < count; ++s, numbers += q.step)
      for (const Quaternion& quaternion : f.quaternions) {
        const auto* const x = numbers + quaternion.first;
        if (x[0] != 0 || x[1] != 0 || x[2] != 0 || x[3] != 0) continue;
        const auto first = static_cast<Py_ssize_t>(quaternion.first);
        PyErr_Format(
            PyExc_ValueError,
            "%U: q[%zd] to q[%zd]%s, %U, are zero, expected a unit quaternion x y z w, such as 0 0 0 1: neutral() has it",
            f.name, first, first + 3, states >= 0 ? (" of state " + std::to_string(s)).c_str() : "", quaternion.whose);
        return false;
      }
    return true;
  };
  return f.type == NPY_DOUBLE ? find(static_cast<const double*>(q.first)) : find(static_cast<const float*>(q.first));
}

PyObject* new_result(const Contents& f, const Shape& shape, npy_intp states) {
  npy_intp sizes[3];
  int dimensions = 0;
  if (states >= 0) sizes[dimensions++] = states;
  for (int i = 0; i < shape.dimensions; ++i) sizes[dimensions++] = shape.size[i];
  return PyArray_SimpleNew(dimensions, sizes, f.type);
}

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
    if (same(name, name_status) || (f.single.entry->has_constraints && same(name, name_constraints))) {
      const int truth = PyObject_IsTrue(value);
      if (truth < 0) return false;
      (same(name, name_status) ? to.return_status : to.return_constraint_status) = truth > 0;
    } else if (!place) {
      std::string known = f.more ? std::string("q, v, ") + PyUnicode_AsUTF8(f.more) : "q, v";
      for (const RunTimeInput& input : f.run_time_inputs) known += std::string(", ") + PyUnicode_AsUTF8(input.name);
      if (f.single.entry->has_constraints) known += ", return_constraint_status";
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

bool prepare_results(const Contents& f, PyObject* out, npy_intp states, const std::vector<const Argument*>& arguments,
                     Results& results) {
  const std::size_t count = f.shapes.size();
  std::vector<PyObject*> given(count, nullptr);
  if (out && !f.result_type) given[0] = out;
  Owned sequence;
  if (out && f.result_type) {
    if (PyArray_Check(out)) {
      PyErr_Format(PyExc_ValueError, "%U: out is one array, expected a tuple of %zd", f.name, static_cast<Py_ssize_t>(count));
      return false;
    }
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

namespace {

// Of a Payload, Contact or Loop, or a list of them for each state, the numbers; of anything else itself. Null with an error
// set.
PyObject* numbers_of(PyObject* object, Py_ssize_t size) {
  const auto is_record = [](PyObject* o) {
    return PyTuple_Check(o) && !PyTuple_CheckExact(o) && PyObject_HasAttrString(o, "numbers");
  };
  const auto of_one = [&](PyObject* o) { return is_record(o) ? PyObject_CallMethod(o, "numbers", "n", size) : Py_NewRef(o); };
  const bool of_states = PyList_CheckExact(object) && PyList_GET_SIZE(object) > 0 && is_record(PyList_GET_ITEM(object, 0));
  if (!of_states) return of_one(object);
  Owned all(PyList_New(0));
  for (Py_ssize_t i = 0; all && i < PyList_GET_SIZE(object); ++i) {
    const Owned one(of_one(PyList_GET_ITEM(object, i)));
    if (!one || PyList_Append(all.get(), one.get()) < 0) return nullptr;
  }
  return all.release();
}

}  // namespace

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
    const Owned numbers(numbers_of(given.run_time[r], input.size));
    if (!numbers || !take(f, numbers.get(), input.name, input.size, own[r])) return false;
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
  for (std::size_t r = 0; r < own.size(); ++r) {
    if (!given.run_time[r]) continue;
    const RunTimeInput& input = f.run_time_inputs[r];
    for (npy_intp s = 0; s < std::max<npy_intp>(own[r].states, own[r].states < 0); ++s)
      if (!can_hold(
              f.name, input.name, input.holds,
              static_cast<const unsigned char*>(own[r].rows.first) + s * own[r].rows.step * static_cast<npy_intp>(f.scalar),
              f.type, input.size, own[r].states < 0 ? -1 : s))
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

}  // namespace dalembert::python
