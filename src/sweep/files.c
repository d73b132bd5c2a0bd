// SPDX-License-Identifier: GPL-3.0-or-later
// Sums of the files that a sweep reads, those too that only some members name: with another content
// it is another sweep.
#include "base/temp_file.h"
#include "sweep/sweep.h"

// Adds the lines of sums that are not there yet; frees them.
static lac_status add(lac_sweep *sweep, char *sums, lac_error *err)
{
    lac_status status = sums != NULL ? LAC_OK : lac_fail_memory(err);
    for (char *line = sums, *end; status == LAC_OK && (end = strchr(line, '\n')) != NULL;) {
        const char next = *++end;
        *end = '\0';
        if (strstr(sweep->files, line) == NULL) {
            char *longer = lac_text_join(sweep->files, "", line);
            status = longer != NULL ? LAC_OK : lac_fail_memory(err);
            free(sweep->files);
            sweep->files = longer;
        }
        *end = next;
        line = end;
    }
    free(sums);
    return status;
}

// Whether a member takes a word, which may name a file, that is not among those seen.
// @param seen  [params][most]
// @param note  it is from now on
static bool takes_new(const lac_sweep *sweep, size_t member, size_t most, bool *seen, bool note)
{
    bool new = false;
    for (size_t p = 0; p < sweep->params; p++) {
        const lac_swept *param = &sweep->param[p];
        const double index = param->number ? NAN : lac_sweep_value(sweep, p, member);
        if (!isnan(index)) {
            size_t i = 0;
            while (strcmp(param->text[i], param->text[(size_t)index]) != 0) {
                i++; // the first that is alike
            }
            new = new || !seen[p * most + i];
            seen[p * most + i] |= note;
        }
    }
    return new;
}

static size_t most_words(const lac_sweep *sweep)
{
    size_t most = 0;
    for (size_t p = 0; p < sweep->params; p++) {
        const lac_swept *param = &sweep->param[p];
        most = !param->number && param->values > most ? param->values : most;
    }
    return most;
}

lac_status lac_sweep_sum_files(lac_sweep *sweep, char *(*sums)(const lac_case *c), lac_error *err)
{
    const size_t most = most_words(sweep);
    const lac_case *c = NULL;
    sweep->files = strdup("");
    bool *seen = calloc(sweep->params * (most + 1), sizeof *seen);
    lac_status status;
    LAC_TRY(sweep->files != NULL && seen != NULL ? LAC_OK : lac_fail_memory(err));
    LAC_TRY(sums != NULL ? add(sweep, sums(sweep->base), err) : LAC_OK);
    for (size_t i = 0; i < sweep->members && sums != NULL && most > 0; i++) {
        // a case that is refused breaks its member, which reads no file
        if (takes_new(sweep, i, most, seen, false) &&
            lac_sweep_case(sweep, i, &c, NULL) == LAC_OK) {
            LAC_TRY(add(sweep, sums(c), err));
            (void)takes_new(sweep, i, most, seen, true);
        }
    }
out:
    free(seen);
    return status;
}

static bool has_line(const char *text, const char *line, size_t length)
{
    while (*text != '\0' && strncmp(text, line, length) != 0) {
        text = strchr(text, '\n') + 1;
    }
    return *text != '\0';
}

const char *lac_sweep_changed_file(const char *before, const char *now, int *length)
{
    *length = 0;
    for (const char *line = before, *end; *line != '\0'; line = end + 1) {
        end = strchr(line, '\n');
        if (!has_line(now, line, (size_t)(end - line) + 1)) {
            line += strspn(line, " ");
            *length = (int)strcspn(line, ":");
            return line;
        }
    }
    return NULL;
}

lac_status lac_sweep_check_files(lac_sweep *sweep, char *(*sums)(const lac_case *c), lac_error *err)
{
    char *before = sweep->files;
    int length;
    sweep->files = NULL;
    lac_status status = lac_sweep_sum_files(sweep, sums, err);
    const char *changed =
        status == LAC_OK ? lac_sweep_changed_file(before, sweep->files, &length) : NULL;
    if (changed != NULL) {
        status = lac_fail(err, LAC_EIO,
                          "%.*s was changed while the sweep went on: its members are of both; run "
                          "it again, with --force",
                          length, changed);
    }
    free(sweep->files);
    sweep->files = before;
    return status;
}
