// SPDX-License-Identifier: GPL-3.0-or-later
// A case as users of the library have it: read with one call, its numbers by their keys.
#include <stdlib.h>
#include <string.h>

#include "base/ask.h"
#include "case/case.h"

static lac_status read_case(const char *name, const char *text, size_t size,
                            const lac_case_options *given, lac_case **out, lac_error *err)
{
    lac_case_options options = lac_case_options_default();
    lac_case_issues report = {0};
    lac_status status;
    *out = NULL;
    LAC_TRY(lac_take_options("lac_case_options", given, &options, sizeof options, err));
    const lac_case_request how = {options.purpose, options.overrides, options.count};
    LAC_TRY(options.purpose >= LAC_FOR_RUN && options.purpose <= LAC_FOR_CHECK
                ? LAC_OK
                : lac_fail(err, LAC_EINPUT, "no case is read for purpose %d", options.purpose));
    for (size_t i = 0; i < options.count; i++) {
        const lac_override *set = options.overrides;
        LAC_TRY(set != NULL && set[i].key != NULL && set[i].key[0] != '\0' && set[i].value != NULL
                    ? LAC_OK
                    : lac_fail(err, LAC_EINPUT, "override %zu must be key.path=value", i));
    }
    status = text == NULL ? lac_case_read(name, &how, out, &report, err)
                          : lac_case_read_text(name, text, size, &how, out, &report, err);
    if (status == LAC_OK && ((*out)->use = calloc(1, sizeof *(*out)->use)) == NULL) {
        lac_case_free(*out);
        *out = NULL;
        status = lac_fail_memory(err);
    }
    for (size_t i = 0; i < report.count && options.issue != NULL; i++) {
        options.issue(options.context, &report.issue[i]);
    }
out:
    lac_case_issues_clear(&report);
    return status;
}

lac_status lac_case_load(const char *path, const lac_case_options *options, lac_case **out,
                         lac_error *err)
{
    lac_status status = LAC_NEED(err, path, out);
    return status == LAC_OK ? read_case(path, NULL, 0, options, out, err) : status;
}

lac_status lac_case_parse(const char *name, const char *text, size_t size,
                          const lac_case_options *options, lac_case **out, lac_error *err)
{
    lac_status status = LAC_NEED(err, name, text, out);
    return status == LAC_OK ? read_case(name, text, size, options, out, err) : status;
}

lac_status lac_case_serves(const lac_case *c, lac_case_purpose purpose, lac_error *err)
{
    static const char *const names[] = {[LAC_FOR_RUN] = "LAC_FOR_RUN",
                                        [LAC_FOR_CONTACT] = "LAC_FOR_CONTACT",
                                        [LAC_FOR_RG] = "LAC_FOR_RG",
                                        [LAC_FOR_FIT] = "LAC_FOR_FIT"};
    const bool runs = c->purpose == LAC_FOR_RUN || c->purpose == LAC_FOR_FIT;
    const bool serves = c->purpose == purpose || (purpose == LAC_FOR_RUN && runs) ||
                        (purpose == LAC_FOR_CONTACT && (runs || c->purpose == LAC_FOR_RG)) ||
                        (purpose == LAC_FOR_RG && runs && c->rg.named) ||
                        (purpose == LAC_FOR_FIT && runs && c->fit.named);
    return serves ? LAC_OK
                  : lac_fail(err, LAC_EINPUT, "%s: must be read with %s", c->path, names[purpose]);
}

static lac_status find_number(const lac_case *c, const char *key, lac_case_value *out,
                              lac_error *err)
{
    return lac_case_find((lac_case *)c, key, out)
               ? LAC_OK
               : lac_fail(err, LAC_EINPUT, "%s: has no number \"%s\"", c->path, key);
}

lac_status lac_case_get(const lac_case *c, const char *key, double *value, lac_error *err)
{
    lac_case_value found;
    lac_status status;
    LAC_TRY(LAC_NEED(err, c, key, value));
    LAC_TRY(find_number(c, key, &found, err));
    *value = *found.at;
out:
    return status;
}

lac_status lac_case_set(lac_case *c, const char *key, double value, lac_error *err)
{
    char why[200];
    lac_case_value found;
    lac_status status;
    LAC_TRY(LAC_NEED(err, c, key));
    LAC_TRY(find_number(c, key, &found, err));
    LAC_FAIL_IF(c->use != NULL && c->use->simulations > 0, err, LAC_EINPUT,
                "%s: %s: a simulation of the case is not freed yet", c->path, key);
    const double before = *found.at;
    LAC_FAIL_IF(!lac_param_allows(found.param, value, why, sizeof why), err, LAC_EINPUT,
                "%s: %s: %g %s", c->path, key, value, why);
    *found.at = value;
    const char *fault = lac_case_validate(c);
    if (fault != NULL) {
        *found.at = before;
        status = lac_fail(err, LAC_EINPUT, "%s: %s: %g: %s", c->path, key, value, fault);
    }
out:
    return status;
}

const lac_model_info *lac_model_find(const char *kind, const char *name)
{
    const lac_kind *of = NULL;
    for (size_t i = 0; kind != NULL && name != NULL && (of = lac_kind_get(i)) != NULL; i++) {
        const lac_model_info *model = NULL;
        for (size_t k = 0; strcmp(of->name, kind) == 0 && (model = of->at(k)) != NULL; k++) {
            if (strcmp(model->name, name) == 0) {
                return model;
            }
        }
    }
    return NULL;
}

const lac_param *lac_model_param(const lac_model_info *model, size_t index)
{
    return model != NULL && index < model->param_count ? &model->params[index] : NULL;
}
