// An algorithm on a tree of bodies, written once: what one body does, and in which order bodies do it.
//
// A role is a value kept per body. A sweep is one body's share of a recursion: a graph of scalar operations whose inputs are
// the body's parameters, roles of the body itself, of its parent (outwards) or summed over its children (inwards), and roles of
// one given body. Pairs fill a matrix with products of a role of a body and a role of its ancestors. Results say which role
// goes to which array, steps what is then done with whole arrays. Both forms of the emitted code, and every count, are made
// from this and from nothing else (passes/unroll.hpp, passes/roll.hpp).
//
// The base is a body like the others (−1) with up to six coordinates of its own: sweeps over the base alone give its roles
// where it has an equation of its own, and those of its coordinates.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ir/emitted_function.hpp"
#include "ir/graph.hpp"
#include "ir/kernel.hpp"
#include "ir/kinematic_tree.hpp"
#include "ir/quantity.hpp"
#include "ir/row_runs.hpp"

namespace dalembert::ir {

enum class Shape { scalar, vector, symmetric, matrix, wrench };  // 1, 3, 6 (xx xy xz yy yz zz), 9 and 6 (linear first) numbers

int components(Shape shape);
// "", "x", "xy", "vx": which component of a value it is.
std::string component_suffix(Shape shape, int component);

// Where the values of a role come from: a sweep stores them, or they are the joint's coordinate, before any sweep.
enum class Source { sweep, sine, cosine, slide, position, rate, acceleration, effort };

struct Role {
  std::string name;     // "joint_linear"
  std::string symbol;   // "J"; begins the names of values
  std::string meaning;  // "J, linear part"
  std::string unit;     // "m"; empty for a number
  Shape shape = Shape::scalar;
  int over = -1;  // the role whose place it may take, body by body: each component is the last to read the other's
  Source source = Source::sweep;
  bool held = false;  // of a joint's coordinate: at rest where the joint carries the frame of reference

  int components() const { return ir::components(shape); }
};

// Bodies of a tree. The base is above all others, and nothing is above it.
class BodySet {
 public:
  static BodySet all() { return {}; }
  static BodySet base() { return above(-1); }                     // alone
  static BodySet above(int body) { return above(body, nobody); }  // it and those above it
  // … but those that are above the other one, or are it.
  static BodySet above(int body, int beside) { return {body, beside}; }

  bool is_all() const { return lowest_ == everybody; }
  bool is_base() const { return lowest_ == -1; }
  bool contains(const KinematicTree& tree, int body) const {
    return is_all() || (tree.is_above(body, lowest_) && !tree.is_above(body, beside_));
  }

 private:
  static constexpr int everybody = -2, nobody = -3;
  BodySet() = default;
  BodySet(int lowest, int beside) : lowest_(lowest), beside_(beside) {}

  int lowest_ = everybody, beside_ = nobody;
};

// In which order a sweep takes the bodies that it is over.
enum class Direction {
  outwards,  // from the base to the leaves; a body reads its parent's roles
  inwards,   // from the leaves to the base; a body reads what its children hand on, summed
  anywhere,  // in any order
};

struct Value {
  int role = 0;
  int component = 0;
  NodeId node = no_node;
  int coordinate = -1;  // over the base: to which of its coordinates it belongs; −1: to the base itself
};

// Of a sweep outwards by a frame of reference: the same roles of a body from those of one below it, whose parameters,
// coordinates and roles (carried) the graph reads; and what they are at the body whose frame that is, from what it has itself.
struct Back {
  Graph graph;
  std::vector<Value> stores{}, at_reference{};
};

struct Sweep {
  std::string name;               // "poses"
  std::string equation;           // what it computes, for the reader
  BodySet over = BodySet::all();  // roles of other bodies are zero
  Direction direction = Direction::anywhere;
  Graph graph;
  std::vector<Value> stores{};   // roles of the body
  std::vector<Value> carries{};  // inwards: what is handed on to the parent, in the parent's terms
  // Where the frame of reference is a matter of choice (passes/reference.hpp):
  std::optional<Back> back{};       // of poses
  bool first_at_its_joint = false;  // of moments: those of a branch's first body count at its joint's axis instead
};

// Three components of a role of the lower body times three of a role of the upper one.
struct PairTerm {
  int lower = 0, lower_from = 0;
  int upper = 0, upper_from = 0;
};

// A matrix whose element (i, k) is a sum of products of roles of k and i, i being an ancestor of k or k itself; zero elsewhere.
struct Pairs {
  int array = 0;
  std::string equation;
  std::vector<PairTerm> above;  // element (i, k)
  std::vector<PairTerm> below;  // element (k, i); empty: none
  bool symmetric = false;       // element (k, i) is element (i, k)
  int diagonal = -1;            // parameter added to element (k, k)
  int between = -1;             // role added, with its sign, to element (i, k) of two parts of one joint that do not commute
};

// A matrix with some columns per body and a row per coordinate: what the body sees of every joint above it, itself included.
struct Projection {
  int array = 0;
  std::string equation;
  Graph graph;                  // inputs of kind state: roles of the body; of kind carried: of the joint above it
  std::vector<NodeId> columns;  // the elements of the joint's row, the body's columns from left to right
  // Of straight lines (passes/project_by_rows.hpp): the bodies whose columns lanes give, which run along rows, and what lines
  // leave for them, arrays: the graph's inputs of kind state, a column per body; those of kind carried, a row per joint.
  std::vector<ProjectedBody> by_rows{};
  int bodies = -1, joints = -1;

  std::vector<Input> inputs(InputKind kind) const;  // each once, in the order of the graph
};

// How a role becomes an array.
enum class Layout {
  per_coordinate,  // nv × 1, from a scalar role of every coordinate
  columns,         // components × nv, a column per coordinate
  base,            // a role of the base: elements one after another, column by column
};
struct Result {
  int array = 0;
  Layout layout = Layout::per_coordinate;
  int role = 0;
  int from = 0;                   // columns: first row; base: first element
  BodySet over = BodySet::all();  // as of the sweep that stores the role
};

// A matrix or vector the emitted code offers.
struct OutputArray {
  std::string name;  // mass_matrix, …, jacobian_<link>
  int rows = 0;
  int columns = 1;
  bool internal = false;     // a step between, which users do not ask for
  bool written_out = false;  // nothing reads it: its elements became operands (passes/write_out.hpp)
  // Of a part of a result (ir/part.hpp): where the rows and columns of the whole stand in it, -1: not asked for. Empty: all.
  std::vector<int> row_map{}, column_map{};

  int row(int of_whole) const { return row_map.empty() ? of_whole : row_map[static_cast<std::size_t>(of_whole)]; }
  int column(int of_whole) const { return column_map.empty() ? of_whole : column_map[static_cast<std::size_t>(of_whole)]; }
  bool is_part() const { return !row_map.empty() || !column_map.empty(); }
};

// Arrays that mean something only where the mass matrix is positive definite: where a pivot of its factorisation is not above
// what rounding leaves of M's diagonal they are zero, and the function's status says which.
struct Guard {
  // Arrays, nv × 1; −1: a section before has found out. Where joints follow others, the diagonal is what they feel apart.
  int pivots = 0, diagonal = 0;
  std::vector<int> arrays{};
  // By what it tells what rounding may have left of pivots (dalembert/factor.hpp): U of M = U D U', above the diagonal of an
  // nv × nv array; or, where there is none, V and J of articulated bodies, 6 × nv each. −1: none.
  int factor = -1, gain = -1, joint = -1;

  bool tells_by(int array) const { return array >= 0 && (array == factor || array == gain || array == joint); }
};

// How what another function computes on the tree without embedded loops becomes what is asked for of the independent
// coordinates, by T and T' of the followers (ir/linkage.hpp), before the kernels.
struct Projected {
  enum class Kind {
    same,            // to = from
    columns,         // to = from T
    rows,            // to = T' from
    both,            // to = T' from T
    both_turned,     // to = T' (from T + more T'), more being M
    turned,          // to = from + more a, a = T' y': more is a Jacobian
    rows_of_turned,  // to = T' (from + more a): more is M
    unbalanced,      // to = input - T' from
  };
  Kind kind;
  std::string from, more;  // arrays of that function
  int from_rows = 0, from_columns = 0;
  int to = 0, room = -1;  // arrays
};
struct Embedding {
  std::string called;        // the function
  bool accelerated = false;  // it takes accelerations: T' y', and T y'' where the input is y''
  bool of_input = false;
  bool moving = false;                 // velocities of all joints are asked for
  int elements = -1, rates = -1;       // arrays: numbers of the followers; of G'; −1: nothing asks how they change
  int speeds = 0, accelerations = -1;  // arrays: of all coordinates
  std::vector<Projected> projected;
};

// A function is computed in sections, one behind another: sweeps, then what is done to whole matrices. What waits for such a
// matrix, as what is differentiated at a v̇ that M's factors give, has its sweeps in a section behind it. Arrays are the
// function's: a section reads what those before it have filled. In the emitted code each is a function, which ends by calling
// the next; users call the first.
struct Section {
  int number = 0;
  std::string name, type;            // of the C++ function; where types are named
  Function inputs;                   // the standard function whose sweeps take the same
  std::vector<Quantity> quantities;  // that it fills; the first: all that the function has, if only to clear them
  int accelerations = -1;            // behind the first: the array that its sweeps take for dv/dt
  int forces = -1;                   // likewise, where constraints act at that dv/dt: the array of their forces

  bool is_first() const { return number == 0; }
  bool computes(Quantity quantity) const;
  const char* input() const { return row_of(inputs).input; }  // what its sweeps take after q and v
};

// One section of a function of the emitted code: inputs in, arrays out.
struct Algorithm {
  EmittedFunction function;  // whole
  Section section;
  std::vector<OutputArray> arrays;  // of the sections before, with the same numbers, then its own
  std::size_t inherited = 0;        // how many are of those before
  std::vector<Role> roles;
  std::vector<Sweep> sweeps;  // in an order in which every sweep finds what it reads
  std::vector<Pairs> pairs;
  std::vector<Projection> projections;
  std::vector<Result> results;
  std::vector<Kernel> kernels;  // in order, after all results
  // Equations of kernels that became nodes, and of the sections behind that did (passes/write_out.hpp); tags count on to them.
  std::vector<std::string> written_out;
  std::optional<Guard> guard;
  int factor = -1;                     // the array that equations with M are solved by, if the code is to offer that
  std::optional<Embedding> embedding;  // then there are no sweeps

  std::span<const OutputArray> own_arrays() const { return std::span(arrays).subspan(inherited); }
  // The name of what is the section's own in a robot's workspace or namespace: "scratch",
  // "forward_dynamics_derivatives_scratch".
  std::string own_name(const std::string& what) const {
    return section.is_first() ? function.own_name(what) : section.name + "_" + what;
  }
  // The number of tags before those of what is written out; and the equation that a tag of a sweep or more stands for.
  std::size_t written() const { return sweeps.size() + pairs.size() + projections.size(); }
  const std::string& equation(const Tag& tag) const;
  // First of a role's components among all of them.
  std::vector<int> offsets() const;
};

}  // namespace dalembert::ir
