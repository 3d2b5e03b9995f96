// Registers that hold lanes of every width (lanes_kept_test.sh).
#include <dalembert/lanes.hpp>

template <class T, int n>
void keep(T* at) {
  dalembert::Lanes<T, n> x = dalembert::load<n, T>(at);
  dalembert::keep_in_register<T>(x);
  dalembert::store<n, T>(at, x * x);
}
template <class T>
void keep_all(T* at) {
  keep<T, 2>(at), keep<T, 4>(at), keep<T, 8>(at);
  T x = *at;
  dalembert::keep_in_register<T>(x);
  *at = x;
}
template void keep_all(float*);
template void keep_all(double*);
template void keep_all(long double*);
