// What g++ packs by itself, in the code behind this, takes registers of four doubles and not of eight.
//
// It packs neighbouring stores of scalars, such as results that are copied to where users find them. Numbers that have just
// been left piece by piece reach a register of eight late, and a few operations on such registers take arithmetic units from
// the scalars beside them: on Intel's Emerald Rapids, with units of 512 bits, inverse dynamics of a quadruped take 0.83 of the
// time without them, forward dynamics of humanoids 0.91 to 0.94 (g++ 12.2). Loops that are written for eight lanes keep them.
#pragma once

#if defined(__AVX512F__) && defined(__GNUC__) && !defined(__clang__)
#pragma GCC target("prefer-vector-width=256")
#endif
