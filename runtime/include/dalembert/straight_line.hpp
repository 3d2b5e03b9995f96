// How straight lines of scalar operations are compiled that fill matrices.
#pragma once

// g++'s vectoriser of straight lines packs elements whose factors lie apart: gathering these takes longer than packing saves
// (measured with g++ 12: M of quadrupeds and bipeds takes 0.78 to 0.85 of the time without it, of arms 0.95). Where there is
// nothing but recursions it saves some per cent. Clang leaves such elements alone.
#if defined(__GNUC__) && !defined(__clang__)
#define DALEMBERT_STRAIGHT_LINE __attribute__((optimize("no-tree-slp-vectorize")))
#else
#define DALEMBERT_STRAIGHT_LINE
#endif
