/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef HFR_KERNELS_BASE_H
#define HFR_KERNELS_BASE_H

/* Ground for every formula that C++ and OpenCL C 1.2 share. Positions go by value; no address space, no
 * library call but fabs (exact) and, in reports only, sqrt (correctly rounded). With contraction off, what is
 * written here rounds alike on every host and device, so decisions are the same bits everywhere. A C++
 * program that includes these headers must be compiled with -ffp-contract=off (g++; clang reads the pragma
 * below). */

#ifdef __OPENCL_C_VERSION__
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#pragma OPENCL FP_CONTRACT OFF
#define HFR_FN static inline
#define HFR_ABS(x) fabs(x)
#define HFR_SQRT(x) sqrt(x)
#define HFR_INFINITY ((double)INFINITY)
#else
#include <math.h>
#ifdef __clang__
#pragma STDC FP_CONTRACT OFF
#endif
/* Left to itself g++ -O2 calls the larger functions out of line and passes their structs through memory,
 * which costs a third of the time of a dihedral form. */
#if defined(__cplusplus) && defined(__GNUC__)
#define HFR_FN __attribute__((always_inline)) inline
#elif defined(__cplusplus)
#define HFR_FN inline
#else
#define HFR_FN static inline
#endif
#define HFR_ABS(x) fabs(x)
#define HFR_SQRT(x) sqrt(x)
#define HFR_INFINITY ((double)INFINITY)
#endif

/* Largest and smallest normal double; a quantity outside is treated as degenerate. */
#define HFR_DOUBLE_MAX 1.7976931348623157e308
#define HFR_DOUBLE_MIN 2.2250738585072014e-308

typedef struct hfr_real3 {
  double x, y, z;
} hfr_real3;

HFR_FN hfr_real3 hfr_make3(double x, double y, double z) {
  hfr_real3 r;
  r.x = x;
  r.y = y;
  r.z = z;
  return r;
}

HFR_FN hfr_real3 hfr_sub3(hfr_real3 a, hfr_real3 b) { return hfr_make3(a.x - b.x, a.y - b.y, a.z - b.z); }

HFR_FN double hfr_dot3(hfr_real3 a, hfr_real3 b) { return (a.x * b.x + a.y * b.y) + a.z * b.z; }

HFR_FN hfr_real3 hfr_cross3(hfr_real3 a, hfr_real3 b) {
  return hfr_make3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

/* One machine instruction each; when an argument is NaN the second one is returned. */
HFR_FN double hfr_min(double a, double b) { return a < b ? a : b; }
HFR_FN double hfr_max(double a, double b) { return a > b ? a : b; }

/* True for a positive, finite, normal number: what may stand below a fraction bar. */
HFR_FN int hfr_is_normal_positive(double x) { return (x >= HFR_DOUBLE_MIN) & (x <= HFR_DOUBLE_MAX); }

#endif
