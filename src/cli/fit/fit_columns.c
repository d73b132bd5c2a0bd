// SPDX-License-Identifier: GPL-3.0-or-later
// --time, --displacement ... of `lacuna fit` are settings of the case's section fit, so that they
// are checked there and stand in the files that are written.
#include <stdlib.h>
#include <string.h>

#include "cli/fit/fit.h"

// A word as a YAML text in single quotes, within which only they themselves are doubled.
static char *quote(const char *word)
{
    char *text = malloc(2 * strlen(word) + 3);
    char *at = text;
    if (text == NULL) {
        return NULL;
    }
    *at++ = '\'';
    for (; *word != '\0'; word++) {
        *at++ = *word;
        if (*word == '\'') {
            *at++ = '\'';
        }
    }
    *at++ = '\'';
    *at = '\0';
    return text;
}

lac_status cli_fit_columns_create(const cli_request *request, cli_fit_columns *out, lac_error *err)
{
    const cli_series_words *words = &request->series;
    const struct {
        const char *key, *word;
    } given[CLI_FIT_COLUMNS] = {{"fit.time", words->time},
                                {"fit.time_format", words->time_format},
                                {"fit.displacement", words->displacement},
                                {"fit.velocity", words->velocity},
                                {"fit.sigma", words->sigma}};
    size_t n = request->set_count;
    *out = (cli_fit_columns){.request = *request};
    out->overrides = calloc(n + CLI_FIT_COLUMNS, sizeof *out->overrides);
    if (out->overrides == NULL) {
        return lac_fail_memory(err);
    }
    if (n > 0) {
        memcpy(out->overrides, request->overrides, n * sizeof *out->overrides);
    }
    for (size_t i = 0; i < CLI_FIT_COLUMNS; i++) {
        if (given[i].word == NULL) {
            continue;
        }
        out->text[i] = quote(given[i].word);
        if (out->text[i] == NULL) {
            return lac_fail_memory(err);
        }
        out->overrides[n++] = (lac_override){given[i].key, out->text[i]};
    }
    out->request.overrides = out->overrides;
    out->request.set_count = n;
    return LAC_OK;
}

void cli_fit_columns_clear(cli_fit_columns *columns)
{
    for (size_t i = 0; i < CLI_FIT_COLUMNS; i++) {
        free(columns->text[i]);
    }
    free(columns->overrides);
    *columns = (cli_fit_columns){0};
}
