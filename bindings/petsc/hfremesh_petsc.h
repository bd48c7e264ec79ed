/* SPDX-License-Identifier: BSD-3-Clause */
/* HFRemesh as an adaptor of PETSc's DMPlex: -dm_adaptor hfremesh. docs/petsc.md tells the story. */
#ifndef HFREMESH_PETSC_H
#define HFREMESH_PETSC_H

#include <petscdm.h>

/* Makes the adaptor "hfremesh" known to DMAdaptLabel(), DMAdaptMetric() and DMRefine(). After
 * PetscInitialize(); calling it twice does no harm. A program that is started with -dll_prepend
 * FOLDER/libhfremesh_petsc.so (or has that in PETSC_OPTIONS) need not call it. */
PETSC_EXTERN PetscErrorCode hfremesh_petsc_register(void);

#endif
