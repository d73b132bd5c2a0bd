// SPDX-License-Identifier: GPL-3.0-or-later
// Texts as files: whole or not at all, also where a file system knows no hard links.
#include <stdlib.h>
#include <string.h>

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/temp_file.h"
#include "support/scratch_group.h"
#include "support/test.h"

enum { PATH = 400, LONGEST = 255 };

static bool no_links; // as of FAT

// Stands in for that of the C library.
int link(const char *from, const char *to)
{
    if (no_links) {
        errno = EPERM;
        return -1;
    }
    return linkat(AT_FDCWD, from, AT_FDCWD, to, 0);
}

static const char *place(const char *name)
{
    static char path[PATH];
    (void)snprintf(path, sizeof path, "%s/%s", folder.folder, name);
    return path;
}

static void assert_holds(const char *name, const char *text)
{
    char got[64] = "";
    FILE *file = fopen(place(name), "r");
    assert_non_null(file);
    got[fread(got, 1, sizeof got - 1, file)] = '\0';
    (void)fclose(file);
    assert_string_equal(got, text);
}

// Nothing but what should stand there.
static void assert_files(size_t wanted) { assert_int_equal(scratch_count(&folder), wanted); }

static void take_away(const char *name) { assert_int_equal(unlink(place(name)), 0); }

static void check_new_and_old(void)
{
    lac_error err = {0};
    assert_int_equal(lac_write_text(place("a"), "one", false, &err), LAC_OK);
    assert_int_equal(lac_write_text(place("a"), "two", false, &err), LAC_EINPUT);
    assert_non_null(strstr(err.message, "/a: exists already"));
    assert_holds("a", "one");
    assert_int_equal(lac_write_text(place("a"), "two", true, &err), LAC_OK);
    assert_holds("a", "two");
    assert_files(1);
    take_away("a");
}

static void test_replaces_only_where_told(void **state)
{
    (void)state;
    check_new_and_old();
}

static void test_without_hard_links(void **state)
{
    (void)state;
    no_links = true;
    check_new_and_old();
    no_links = false;
}

static void test_follows_a_link(void **state)
{
    (void)state;
    char at[PATH];
    assert_int_equal(lac_write_text(place("a"), "one", false, NULL), LAC_OK);
    (void)snprintf(at, sizeof at, "%s", place("b"));
    assert_int_equal(symlink("a", at), 0);
    assert_int_equal(lac_write_text(at, "two", true, NULL), LAC_OK);
    assert_holds("a", "two");
    struct stat info;
    assert_int_equal(lstat(at, &info), 0);
    assert_true(S_ISLNK(info.st_mode));
    take_away("a");
    take_away("b");
}

// What stands beside it under a name that one would think of is another's.
static void test_spares_other_files(void **state)
{
    (void)state;
    assert_int_equal(lac_write_text(place("a.part"), "mine", false, NULL), LAC_OK);
    assert_int_equal(lac_write_text(place("a"), "one", false, NULL), LAC_OK);
    assert_holds("a.part", "mine");
    assert_files(2);
    take_away("a");
    take_away("a.part");
}

static void test_longest_name(void **state)
{
    (void)state;
    char name[LONGEST + 1];
    memset(name, 'n', LONGEST);
    name[LONGEST] = '\0';
    assert_int_equal(lac_write_text(place(name), "one", false, NULL), LAC_OK);
    assert_holds(name, "one");
    take_away(name);
}

static void test_refuses_what_is_no_file(void **state)
{
    (void)state;
    lac_error err = {0};
    assert_int_equal(mkfifo(place("pipe"), 0600), 0);
    assert_int_equal(lac_write_text(place("pipe"), "one", true, &err), LAC_EIO);
    assert_non_null(strstr(err.message, "is not a regular file"));
    assert_int_equal(lac_write_text(folder.folder, "one", true, &err), LAC_EIO);
    assert_non_null(strstr(err.message, "is a folder"));
    assert_int_equal(lac_write_text(place("no/a"), "one", false, &err), LAC_EIO);
    assert_non_null(strstr(err.message, "No such file"));
    assert_files(1);
    take_away("pipe");
}

// No room: the old file stays, and no part of the new one.
static void test_full_disk(void **state)
{
    (void)state;
    struct rlimit before, tight;
    lac_error err = {0};
    assert_int_equal(lac_write_text(place("a"), "one", false, NULL), LAC_OK);
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
    tight = before;
    tight.rlim_cur = 1;
    assert_true(signal(SIGXFSZ, SIG_IGN) != SIG_ERR);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &tight), 0);
    const lac_status status = lac_write_text(place("a"), "twofold", true, &err);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &before), 0);
    assert_int_equal(status, LAC_EIO);
    assert_non_null(strstr(err.message, "/a: cannot be written: File too large"));
    assert_holds("a", "one");
    assert_files(1);
    take_away("a");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_replaces_only_where_told),
        cmocka_unit_test(test_without_hard_links),
        cmocka_unit_test(test_follows_a_link),
        cmocka_unit_test(test_spares_other_files),
        cmocka_unit_test(test_longest_name),
        cmocka_unit_test(test_refuses_what_is_no_file),
        cmocka_unit_test(test_full_disk),
    };
    return cmocka_run_group_tests(tests, open_scratch, close_scratch);
}
