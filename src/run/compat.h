/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

// SUNDIALS 6.4 (Debian 12) and 7.x (Debian 13 has 7.1) from one source: contexts, error handlers,
// types and values of status, names of ARKODE's functions and the control of explicit steps are all
// that differ. LAC_SUN_ERK_CONTROL: Gustafsson's, of the larger caution of its explicit and its
// implicit form.
#include <sundials/sundials_config.h>
#include <sundials/sundials_context.h>
#include <sundials/sundials_linearsolver.h>
#include <sundials/sundials_nvector.h>
#include <sundials/sundials_types.h>

#define LAC_SUN_SINCE(major, minor)      \
    (SUNDIALS_VERSION_MAJOR > (major) || \
     (SUNDIALS_VERSION_MAJOR == (major) && SUNDIALS_VERSION_MINOR >= (minor)))

// ARKODE's functions lost the name of their stepper in 7.1, but for those that make one.
#if LAC_SUN_SINCE(7, 1)
#define LAC_SUN_ERK(name) ARKode##name
#else
#define LAC_SUN_ERK(name) ERKStep##name
#endif
#if LAC_SUN_SINCE(7, 2)
#define LAC_SUN_ERK_EVALUATIONS(mem, count) ARKodeGetNumRhsEvals((mem), 0, (count))
#else
#define LAC_SUN_ERK_EVALUATIONS(mem, count) ERKStepGetNumRhsEvals((mem), (count))
#endif

// Whether a step of ARKODE's ends with dy/dt there.
enum { LAC_SUN_ERK_ENDS_WITH_RATES = !LAC_SUN_SINCE(7, 0) };

#if LAC_SUN_SINCE(7, 0)
// What solvers return to CVODE where no smaller step would help.
enum { LAC_SUN_BROKEN = SUN_ERR_ARG_CORRUPT };
#define LAC_SUN_CONTEXT_CREATE(out) SUNContext_Create(SUN_COMM_NULL, (out))
static inline void lac_sun_silent(int line, const char *function, const char *file,
                                  const char *message, SUNErrCode code, void *data, SUNContext sun)
{
    (void)line, (void)function, (void)file, (void)message, (void)code, (void)data, (void)sun;
}
#define LAC_SUN_SILENCE_CONTEXT(sun)         \
    ((void)SUNContext_ClearErrHandlers(sun), \
     (void)SUNContext_PushErrHandler((sun), lac_sun_silent, NULL))
#define LAC_SUN_SILENCE_CVODE(mem) ((void)(mem))
#define LAC_SUN_SILENCE_ERK(mem) ((void)(mem))
typedef SUNErrCode lac_sun_status;
#include <sunadaptcontroller/sunadaptcontroller_imexgus.h>
#define LAC_SUN_ERK_CONTROL(mem, sun, keep)     \
    (*(keep) = SUNAdaptController_ImExGus(sun), \
     *(keep) == NULL ? -1 : LAC_SUN_ERK(SetAdaptController)((mem), *(keep)))
#define LAC_SUN_ERK_CONTROL_FREE(control) ((void)SUNAdaptController_Destroy(control))
#else
enum { LAC_SUN_BROKEN = SUNLS_MEM_NULL };
#define LAC_SUN_CONTEXT_CREATE(out) SUNContext_Create(NULL, (out))
#define LAC_SUN_SILENCE_CONTEXT(sun) ((void)(sun))
#define LAC_SUN_SILENCE_CVODE(mem) ((void)CVodeSetErrFile((mem), NULL))
#define LAC_SUN_SILENCE_ERK(mem) ((void)ERKStepSetErrFile((mem), NULL))
typedef int lac_sun_status;
enum { LAC_SUN_IMEX_GUSTAFSSON = 5 };
#define LAC_SUN_ERK_CONTROL(mem, sun, keep) \
    ((void)(sun), *(keep) = NULL,           \
     ERKStepSetAdaptivityMethod((mem), LAC_SUN_IMEX_GUSTAFSSON, 1, 0, NULL))
#define LAC_SUN_ERK_CONTROL_FREE(control) ((void)(control))
#endif

// Gives ERKStep a pair of order 8, the same for all of them. @return ARK_SUCCESS or another status
int lac_erk_set_order_8(void *mem);
