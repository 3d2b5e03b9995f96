// Times variants of one robot's generated code against each other: shared objects that forms.py has made, loaded into one
// process and called in turn, so that what the machine does to one it does to all.
//
//     forms_driver ROUNDS OBJECT...       prints, per object and line: median ns per call
#include <dlfcn.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <vector>

namespace {

struct Variant {
  void (*run)(const double* q, const double* v, const double* more, void* workspace) = nullptr;
  void* workspace = nullptr;
  std::vector<double> times;
};

template <class F>
F* find(void* library, const char* name) {
  void* at = dlsym(library, name);
  if (!at) std::fprintf(stderr, "forms_driver: no %s\n", name), std::exit(2);
  return reinterpret_cast<F*>(at);
}

}  // namespace

int main(int argc, char** argv) {
  const int rounds = argc > 2 ? std::atoi(argv[1]) : 0;
  if (rounds < 1) return std::fprintf(stderr, "usage: forms_driver ROUNDS OBJECT...\n"), 2;
  std::vector<Variant> variants;
  int nq = 0, nv = 0;
  for (int i = 2; i < argc; ++i) {
    void* library = dlopen(argv[i], RTLD_NOW | RTLD_LOCAL);
    if (!library) return std::fprintf(stderr, "forms_driver: %s\n", dlerror()), 2;
    variants.push_back({find<void(const double*, const double*, const double*, void*)>(library, "form_run"),
                        find<void*()>(library, "form_workspace")(),
                        {}});
    nq = find<int()>(library, "form_nq")();
    nv = find<int()>(library, "form_nv")();
  }
  constexpr int states = 64;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> number(-1, 1);
  std::vector<double> q, v, more;
  for (int s = 0; s < states; ++s) {
    const std::size_t from = q.size();
    for (int i = 0; i < nq; ++i) q.push_back(number(random));
    if (nq > nv) {
      double square = 0;
      for (std::size_t i = from + 3; i < from + 7; ++i) square += q[i] * q[i];
      for (std::size_t i = from + 3; i < from + 7; ++i) q[i] /= std::sqrt(square);
    }
    for (int i = 0; i < nv; ++i) v.push_back(number(random)), more.push_back(number(random));
  }
  using Clock = std::chrono::steady_clock;
  const auto turn = [&](Variant& x) {
    for (std::size_t s = 0; s < states; ++s)
      x.run(&q[s * static_cast<std::size_t>(nq)], &v[s * static_cast<std::size_t>(nv)], &more[s * static_cast<std::size_t>(nv)],
            x.workspace);
  };
  for (int round = 0; round < rounds; ++round)
    for (Variant& x : variants) {
      turn(x);
      const Clock::time_point start = Clock::now();
      turn(x);
      x.times.push_back(std::chrono::duration<double, std::nano>(Clock::now() - start).count() / states);
    }
  for (Variant& x : variants) {
    std::nth_element(x.times.begin(), x.times.begin() + rounds / 2, x.times.end());
    std::printf("%.2f\n", x.times[static_cast<std::size_t>(rounds / 2)]);
  }
}
