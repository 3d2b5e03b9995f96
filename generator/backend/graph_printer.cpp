#include "backend/graph_printer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <tuple>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "backend/literals.hpp"
#include "ir/latency.hpp"

namespace dalembert::backend {
namespace {

using ir::NodeId;
using ir::Op;

constexpr int longest_expression = 14;  // operations

constexpr int early = -1000;  // a cycle: does not wait for the step before

enum Precedence { sum = 1, product = 2, sign = 3, atom = 4 };

class Printer {
 public:
  Printer(const ir::Graph& graph, const std::vector<Sink>& sinks, const PrintStyle& style, bool halve)
      : graph_(graph), style_(style), halve_(halve), text_of_(static_cast<size_t>(graph.size())) {
    std::vector<NodeId> roots;
    for (const Sink& s : sinks) roots.push_back(s.node);
    uses_ = ir::uses_in_text(graph, roots);
    for (const Sink& s : sinks) sinks_[s.node].push_back(&s);
  }

  std::string run() {
    const bool by_number = style_.order.empty();
    const size_t count = by_number ? text_of_.size() : style_.order.size();
    for (size_t place = 0; place < count; ++place) {
      const NodeId id = by_number ? static_cast<NodeId>(place) : style_.order[place];
      if (uses_[at(id)] == 0) continue;
      const ir::Node& n = graph_[id];
      const bool leaf = n.op == Op::constant || n.op == Op::input;
      Text& t = text_of_[at(id)];
      t = expression(n, id);
      // Only where nothing folds: else an operation on numbers is a number.
      if (style_.broadcast && !leaf && of_numbers(n)) t = {style_.broadcast(t.text), atom, t.operations, {}, early};
      const auto sinks = sinks_.find(id);
      const bool shared = uses_[at(id)] > 1;
      const bool plain_sign = n.op == Op::negate && (graph_[n.a].op == Op::input || graph_[n.a].op == Op::constant);
      const bool once = shared || (n.op == Op::input && style_.held && style_.held(n.input));
      if (n.op == Op::input && style_.input_name && once) read_once(n, t);
      if (!leaf && !plain_sign && (shared || t.operations > longest_expression)) declare(id, t);
      if (sinks == sinks_.end()) continue;
      head(n.tag);
      for (const Sink* s : sinks->second) {
        out_ += style_.indent + s->before + t.text + s->after + "\n";
        if (s->carried) recurrence_ = std::max(recurrence_, t.ready);
      }
    }
    return std::move(out_);
  }

  // Whether a step of the loop takes longer to hand on its values than its operations take, two multiply-adds at a time.
  bool waits() const {
    const ir::Operations own = ir::count(graph_, uses_);
    return 3 * recurrence_ > own.add + own.multiply;
  }

 private:
  // A term of a sum.
  struct Term {
    std::string text;  // binds at least like a product
    bool negative = false;
    bool is_product = false;
    int ready = early;  // a product: its factors
  };
  struct Text {
    std::string text;
    int precedence = atom;
    int operations = 0;
    std::vector<Term> terms;  // of a sum that has no name
    int ready = early;        // cycles after what is carried from the step before
  };

  static size_t at(NodeId id) { return static_cast<size_t>(id); }

  bool is_number(NodeId id) const { return id == ir::no_node || graph_.is_constant(id); }
  bool of_numbers(const ir::Node& n) const { return n.op != Op::input && is_number(n.a) && is_number(n.b); }

  void head(const ir::Tag& tag) {
    if (!style_.heading || (tag.sweep == last_.sweep && tag.body == last_.body)) return;
    last_ = tag;
    const bool first = begun_.insert({tag.sweep, tag.body}).second;
    out_ += first || !style_.return_to ? style_.heading(tag) : style_.return_to(tag);
  }

  void declare(NodeId id, Text& t) {
    head(graph_[id].tag);
    std::string name = style_.name ? style_.name(id) : "";
    if (name.empty() || !names_.insert(name).second) {
      name = fmt::format("t{}", ++temporaries_);
      names_.insert(name);
    }
    out_ += fmt::format("{}const {} {} = {};\n", style_.indent, style_.type, name, t.text);
    t = {std::move(name), atom, 0, {}, t.ready};
  }

  void read_once(const ir::Node& n, Text& t) {
    const std::string name = style_.input_name(n.input);
    if (name == t.text) return;  // a variable already
    names_.insert(name);
    out_ += fmt::format("{}const {} {} = {};\n", style_.indent, style_.type, name, t.text);
    t = {name, atom, 0, {}, t.ready};
  }

  std::string operand(NodeId id, int least) const {
    const Text& t = text_of_[at(id)];
    return t.precedence < least ? "(" + t.text + ")" : t.text;
  }

  static int after(int ready, int cycles) { return ready == early ? early : ready + cycles; }

  void add_terms(NodeId id, bool negative, std::vector<Term>& terms) const {
    const Text& t = text_of_[at(id)];
    const bool is_product = graph_[id].op == Op::multiply && t.precedence == product;
    if (t.terms.empty())
      terms.push_back({operand(id, product), negative, is_product, is_product ? factors_ready(id) : t.ready});
    for (const Term& inner : t.terms) terms.push_back({inner.text, inner.negative != negative, inner.is_product, inner.ready});
  }
  int factors_ready(NodeId id) const { return std::max(text_of_[at(graph_[id].a)].ready, text_of_[at(graph_[id].b)].ready); }

  // When a chain of multiply-adds in this order is done.
  static int done(const std::vector<Term>& terms) {
    int ready = after(terms.front().ready, terms.front().is_product ? ir::latency : 0);
    for (size_t i = 1; i < terms.size(); ++i) ready = after(std::max(ready, terms[i].ready), ir::latency);
    return ready;
  }

  static std::string chain(const std::vector<Term>& terms, bool negated = false) {
    std::string text;
    for (const Term& term : terms) {
      const bool minus = term.negative != negated;
      text += (text.empty() ? (minus ? "-" : "") : (minus ? " - " : " + ")) + term.text;
    }
    return text;
  }

  Text sum_of(const ir::Node& n) const {
    Text t{"", sum, 1 + text_of_[at(n.a)].operations + text_of_[at(n.b)].operations, {}};
    add_terms(n.a, false, t.terms);
    add_terms(n.b, n.op == Op::subtract, t.terms);
    std::stable_sort(t.terms.begin(), t.terms.end(), [](const Term& a, const Term& b) {
      return std::pair(a.is_product, a.negative) < std::pair(b.is_product, b.negative);
    });
    const auto lead = std::find_if(t.terms.begin(), t.terms.end(), [](const Term& term) { return !term.negative; });
    if (lead != t.terms.end()) std::rotate(t.terms.begin(), lead, lead + 1);
    t.ready = done(t.terms);
    t.text = chain(t.terms);
    if (halve_) halve(t);
    return t;
  }

  // Two chains, what is there first standing first in either, where so the sum is sooner there by two operations, for one more.
  static void halve(Text& t) {
    std::vector<Term> terms = t.terms, halves[2];
    std::stable_sort(terms.begin(), terms.end(), [](const Term& a, const Term& b) {
      return std::tuple(a.ready, a.is_product, a.negative) < std::tuple(b.ready, b.is_product, b.negative);
    });
    for (size_t i = 0; i < terms.size(); ++i) halves[(terms.size() - i) % 2].push_back(terms[i]);
    const int ready = after(std::max(done(halves[0]), done(halves[1])), ir::latency);
    if (t.ready - ready < 2 * ir::latency) return;
    t.ready = ready;
    const bool negated = halves[1].front().negative;
    t.text = chain(halves[0]) + (negated ? " - (" : " + (") + chain(halves[1], negated) + ")";
  }

  Text expression(const ir::Node& n, NodeId id) const {
    const auto binary = [&](const char* op, int precedence, int right) {
      return Text{operand(n.a, precedence) + op + operand(n.b, right),
                  precedence,
                  1 + text_of_[at(n.a)].operations + text_of_[at(n.b)].operations,
                  {},
                  after(std::max(text_of_[at(n.a)].ready, text_of_[at(n.b)].ready),
                        n.op == Op::divide ? ir::divide_latency : ir::latency)};
    };
    switch (n.op) {
      case Op::constant: {
        std::string text = literal(n.value, style_.scalar);
        const bool negative = text[0] == '-';
        return {std::move(text), negative ? sign : atom, 0, {}, early};
      }
      case Op::input: {
        return {style_.input(n.input), atom, 0, {}, n.input.kind == ir::InputKind::carried ? 0 : early};
      }
      case Op::sine:
      case Op::cosine: return {style_.sine_or_cosine(graph_, id), atom, 0, {}};
      case Op::sign: {
        // In lanes numbers must be of the lanes' type. What is no number stays none.
        return {fmt::format("({0} > 0 ? {1} : ({0} < 0 ? {2} : {0}))", operand(n.a, product), literal(1, style_.scalar),
                            literal(-1, style_.scalar)),
                atom,
                2,
                {}};
      }
      case Op::negate: return {"-" + operand(n.a, atom), sign, text_of_[at(n.a)].operations, {}, text_of_[at(n.a)].ready};
      case Op::add: return style_.flat_sums ? sum_of(n) : binary(" + ", sum, product);
      case Op::subtract: return style_.flat_sums ? sum_of(n) : binary(" - ", sum, product);
      case Op::multiply: return binary(" * ", product, sign);
      case Op::divide: return binary(" / ", product, sign);
      case Op::where: {
        const std::string chosen = operand(n.b, product);
        return {fmt::format("({} > 0 ? {} : {})", operand(n.a, product),
                            style_.broadcast && is_number(n.b) ? style_.broadcast(chosen) : chosen, literal(0, style_.scalar)),
                atom,
                2 + text_of_[at(n.a)].operations + text_of_[at(n.b)].operations,
                {}};
      }
    }
    return {};
  }

  const ir::Graph& graph_;
  const PrintStyle& style_;
  const bool halve_;    // long chains, where the step before is waited for
  int recurrence_ = 0;  // cycles from what is carried to what is handed on
  std::vector<std::int32_t> uses_;
  std::unordered_map<NodeId, std::vector<const Sink*>> sinks_;
  std::vector<Text> text_of_;
  std::unordered_set<std::string> names_;
  ir::Tag last_{-1, -2};
  std::set<std::pair<int, int>> begun_;  // paragraphs, by sweep and body
  int temporaries_ = 0;
  std::string out_;
};

}  // namespace

std::string print(const ir::Graph& graph, const std::vector<Sink>& sinks, const PrintStyle& style) {
  Printer printer(graph, sinks, style, false);
  std::string text = printer.run();
  return printer.waits() ? Printer(graph, sinks, style, true).run() : text;
}

}  // namespace dalembert::backend
