/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef HFR_KERNELS_ORDER_H
#define HFR_KERNELS_ORDER_H

#include "base.h"

/* The first unless the second is less, or greater: as std::min and std::max choose. */
HFR_FN double hfr_lesser(double a, double b) { return b < a ? b : a; }
HFR_FN double hfr_greater(double a, double b) { return a < b ? b : a; }

#endif
