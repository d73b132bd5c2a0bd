// SPDX-License-Identifier: GPL-3.0-or-later
// What a killed process left of a file that it was making: taken away with the next one of that
// name, nothing else being touched.
#include <stdlib.h>
#include <string.h>

#include <fcntl.h>
#include <stdio.h>
#include <sys/file.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/temp_file.h"
#include "support/scratch_group.h"
#include "support/test.h"

enum { PATH = 400 };

// The number of a process that is no more.
static long dead_process(void)
{
    pid_t child = fork();
    if (child == 0) {
        _exit(0);
    }
    assert_int_equal(waitpid(child, NULL, 0), child);
    return (long)child;
}

static void place(char *path, const char *name)
{
    (void)snprintf(path, PATH, "%s/%s", folder.folder, name);
}

// A part of the file `name`, by the process of that number.
static void make(char *path, const char *name, long pid, const char *ending)
{
    (void)snprintf(path, PATH, "%s/.%.200s.lacuna-%ld%s", folder.folder, name, pid, ending);
    int fd = open(path, O_WRONLY | O_CREAT, 0666);
    assert_true(fd >= 0);
    (void)close(fd);
}

static void sweep(const char *name)
{
    char path[PATH];
    place(path, name);
    lac_temp_file_sweep(path);
}

static void test_takes_away_what_the_dead_left(void **state)
{
    (void)state;
    char path[PATH];
    long dead = dead_process();
    make(path, "out.nc", dead, ".part");
    sweep("out.nc");
    assert_int_equal(access(path, F_OK), -1);
}

static void test_leaves_all_else(void **state)
{
    (void)state;
    char path[7][PATH];
    long dead = dead_process();
    make(path[0], "other.nc", dead, ".part");
    make(path[1], "out.ncc", dead, ".part");
    make(path[2], "out.nc", dead, ".parts");
    make(path[3], "out.nc", getpid(), ".part");
    make(path[4], "out.nc", 1, ".part");
    make(path[5], "out.nc", -dead, ".part");
    make(path[6], "out.nc", dead, "x.part");
    sweep("out.nc");
    for (size_t i = 0; i < 7; i++) {
        assert_int_equal(access(path[i], F_OK), 0);
        assert_int_equal(unlink(path[i]), 0);
    }
}

// HDF5 holds this lock while a file is made; another machine's processes have numbers of their own.
static void test_leaves_what_is_locked(void **state)
{
    (void)state;
    char path[PATH];
    make(path, "out.nc", dead_process(), ".part");
    int fd = open(path, O_RDWR);
    assert_int_equal(flock(fd, LOCK_EX | LOCK_NB), 0);
    sweep("out.nc");
    assert_int_equal(access(path, F_OK), 0);
    (void)close(fd);
    sweep("out.nc");
    assert_int_equal(access(path, F_OK), -1);
}

// The longest name that a file can have leaves no room for what is put around it.
static void test_longest_name(void **state)
{
    (void)state;
    char name[256];
    char path[PATH];
    memset(name, 'n', 255);
    name[255] = '\0';
    place(path, name);
    char *part = lac_temp_file_name(path);
    assert_non_null(part);
    int fd = open(part, O_WRONLY | O_CREAT | O_EXCL, 0666);
    assert_true(fd >= 0);
    (void)close(fd);
    assert_int_equal(unlink(part), 0);
    free(part);
    make(path, name, dead_process(), ".part");
    sweep(name);
    assert_int_equal(access(path, F_OK), -1);
}

static void test_name_stands_in_the_folder(void **state)
{
    (void)state;
    char want[64];
    (void)snprintf(want, sizeof want, ".c.nc.lacuna-%ld.part", (long)getpid());
    char *part = lac_temp_file_name("c.nc");
    assert_string_equal(part, want);
    free(part);
    part = lac_temp_file_name("/a/b/c.nc");
    assert_memory_equal(part, "/a/b/", 5);
    assert_string_equal(part + 5, want);
    free(part);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_takes_away_what_the_dead_left),
        cmocka_unit_test(test_leaves_all_else),
        cmocka_unit_test(test_leaves_what_is_locked),
        cmocka_unit_test(test_longest_name),
        cmocka_unit_test(test_name_stands_in_the_folder),
    };
    return cmocka_run_group_tests_name("part", tests, open_scratch, close_scratch);
}
