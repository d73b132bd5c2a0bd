// SPDX-License-Identifier: GPL-3.0-or-later
// How much memory further processes may take.
#include "cli/common/memory.h"

#include <unistd.h>

enum { PATH = 4096, LINE = 4096 };

// The two kinds of control groups: their line in /proc/self/cgroup, and their files.
static const struct {
    const char *mark, *top, *limit, *used;
} groups[] = {
    {"0::", "/sys/fs/cgroup", "memory.max", "memory.current"},
    {":memory:", "/sys/fs/cgroup/memory", "memory.limit_in_bytes", "memory.usage_in_bytes"},
};

static FILE *open_below(const char *root, const char *folder, const char *name)
{
    char path[PATH];
    const int n = snprintf(path, sizeof path, "%s%s/%s", root, folder, name);
    return n < (int)sizeof path ? fopen(path, "r") : NULL;
}

// The number that follows `key` at the start of a line; -1 where there is none ("max" is none).
static int64_t read_number(FILE *file, const char *key)
{
    char line[LINE];
    int64_t found = -1;
    while (file != NULL && found < 0 && fgets(line, sizeof line, file) != NULL) {
        char *end, *at = line + strlen(key);
        if (strncmp(line, key, strlen(key)) == 0) {
            const long long value = strtoll(at, &end, 10);
            found = end != at ? value : -1;
        }
    }
    if (file != NULL) {
        (void)fclose(file);
    }
    return found;
}

static int64_t least(int64_t a, int64_t b) { return a < b ? a : b; }

// What its own group leaves and all that this one is in; pages of files that nobody uses are given
// back when they are needed.
static int64_t left_of_groups(const char *root, size_t kind, const char *group)
{
    char folder[PATH];
    int64_t left = INT64_MAX;
    const size_t top = strlen(groups[kind].top);
    const int n = snprintf(folder, sizeof folder, "%s%s", groups[kind].top, group);
    while (n < (int)sizeof folder) {
        const int64_t limit = read_number(open_below(root, folder, groups[kind].limit), "");
        const int64_t used = read_number(open_below(root, folder, groups[kind].used), "");
        const int64_t cached =
            read_number(open_below(root, folder, "memory.stat"), "inactive_file ");
        if (limit >= 0 && used >= 0) {
            const int64_t of_group = limit - used + (cached > 0 ? cached : 0);
            left = least(left, of_group > 0 ? of_group : 0);
        }
        char *last = strrchr(folder, '/');
        if (last == NULL || (size_t)(last - folder) < top) {
            break;
        }
        *last = '\0';
    }
    return left;
}

int64_t cli_memory_free(const char *root)
{
    char line[LINE];
    const int64_t kilobytes = read_number(open_below(root, "/proc", "meminfo"), "MemAvailable:");
    int64_t left = kilobytes >= 0 ? kilobytes * 1024 : INT64_MAX;
    FILE *file = open_below(root, "/proc/self", "cgroup");
    while (file != NULL && fgets(line, sizeof line, file) != NULL) {
        line[strcspn(line, "\n")] = '\0';
        for (size_t kind = 0; kind < sizeof groups / sizeof groups[0]; kind++) {
            const char *mark = strstr(line, groups[kind].mark);
            if (mark != NULL && (kind > 0 || mark == line)) {
                const char *group = mark + strlen(groups[kind].mark);
                left = least(left, left_of_groups(root, kind, group));
            }
        }
    }
    if (file != NULL) {
        (void)fclose(file);
    }
    return left;
}

int64_t cli_memory_resident(const char *root, pid_t pid)
{
    char folder[64];
    (void)snprintf(folder, sizeof folder, "/proc/%ld", (long)pid);
    const int64_t kilobytes = read_number(open_below(root, folder, "status"), "VmRSS:");
    return kilobytes >= 0 ? kilobytes * 1024 : 0;
}

bool cli_memory_allows(int64_t free, int64_t peak, const int64_t *resident, size_t running)
{
    int64_t room = free / 2 - peak;
    for (size_t i = 0; i < running && room >= 0; i++) {
        room -= peak > resident[i] ? peak - resident[i] : 0;
    }
    return room >= 0;
}
