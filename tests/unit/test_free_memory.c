// SPDX-License-Identifier: GPL-3.0-or-later
// How many processes memory allows, by made-up /proc and /sys.
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "cli/common/memory.h"
#include "support/test.h"

enum { MB = 1 << 20 };

static char root[] = "/tmp/lacuna-memory-XXXXXX";

// A file below `root`, its folders made.
static void put(const char *name, const char *text)
{
    char path[256];
    (void)snprintf(path, sizeof path, "%s%s", root, name);
    for (char *at = path + strlen(root) + 1; (at = strchr(at, '/')) != NULL; at++) {
        *at = '\0';
        (void)mkdir(path, 0777);
        *at = '/';
    }
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

static int set_up(void **state)
{
    (void)state;
    return mkdtemp(root) != NULL ? 0 : -1;
}

static int tear_down(void **state)
{
    char command[64];
    (void)state;
    (void)snprintf(command, sizeof command, "rm -r %s", root);
    return system(command); // NOLINT(cert-env33-c): a fixed name
}

static void machine_and_groups(void **state)
{
    (void)state;
    assert_true(cli_memory_free(root) == INT64_MAX); // nothing is said
    put("/proc/meminfo", "MemTotal: 9000000 kB\nMemFree: 5 kB\nMemAvailable:    1048576 kB\n");
    assert_int_equal(cli_memory_free(root), 1024LL * MB);
    // Version 2: what is given back counts as free; the group above is tighter; "max" is no limit.
    put("/proc/self/cgroup", "9:name=systemd:/\n0::/a/b\n");
    put("/sys/fs/cgroup/a/b/memory.max", "104857600\n");
    put("/sys/fs/cgroup/a/b/memory.current", "73400320\n");
    assert_int_equal(cli_memory_free(root), 30LL * MB);
    put("/sys/fs/cgroup/a/b/memory.stat", "anon 1\ninactive_file 10485760\n");
    assert_int_equal(cli_memory_free(root), 40LL * MB);
    put("/sys/fs/cgroup/a/memory.max", "209715200\n");
    put("/sys/fs/cgroup/a/memory.current", "188743680\n");
    assert_int_equal(cli_memory_free(root), 20LL * MB);
    put("/sys/fs/cgroup/a/memory.current", "219715200\n");
    assert_int_equal(cli_memory_free(root), 0);
    put("/sys/fs/cgroup/a/memory.max", "max\n");
    put("/sys/fs/cgroup/a/b/memory.max", "max\n");
    assert_int_equal(cli_memory_free(root), 1024LL * MB);
    // Version 1.
    put("/proc/self/cgroup", "4:memory:/job\n0::/\n");
    put("/sys/fs/cgroup/memory/job/memory.limit_in_bytes", "52428800\n");
    put("/sys/fs/cgroup/memory/job/memory.usage_in_bytes", "20971520\n");
    assert_int_equal(cli_memory_free(root), 30LL * MB);
}

static void resident(void **state)
{
    (void)state;
    put("/proc/77/status", "Name: lacuna\nVmRSS:\t    2048 kB\n");
    assert_int_equal(cli_memory_resident(root, 77), 2 * MB);
    assert_int_equal(cli_memory_resident(root, 78), 0);
    assert_true(cli_memory_resident("", getpid()) > 0);
}

// 100 free, a peak of 20: two may be started at once, a third only once others have what they take.
static void how_many(void **state)
{
    (void)state;
    const int64_t none[] = {0, 0, 0}, half[] = {15, 15, 0}, more[] = {25, 20, 20};
    assert_true(cli_memory_allows(100, 20, none, 1));
    assert_false(cli_memory_allows(100, 20, none, 2));
    assert_true(cli_memory_allows(100, 20, half, 2));
    assert_false(cli_memory_allows(99, 20, half, 3));
    assert_true(cli_memory_allows(100, 20, more, 3)); // what grew past the peak owes nothing
    assert_false(cli_memory_allows(39, 20, more, 1));
    assert_true(cli_memory_allows(INT64_MAX, 1LL << 40, none, 3));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(machine_and_groups),
        cmocka_unit_test(resident),
        cmocka_unit_test(how_many),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
